"""How numbers are written: rounded to what is known, with a true minus sign, and an error where there is one."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

MISSING = "–"
MINUS = "\u2212"
LONG = 365.0 * 86400.0  # s
_BEFORE_UNIT = re.compile(r"(?<=\d) (?=(?:%|m|deg|s|K|Pa|kPa|decades|cells|iterations)(?![\w/]))")
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Measured:
    """A number as text: `value`, its `error` ("" when unknown) and a common power of ten ("" when none)."""

    value: str
    error: str = ""
    power: str = ""

    def __str__(self) -> str:
        if not self.error:
            return self.value + self.power
        if self.power:
            return f"({self.value} ± {self.error}){self.power}"
        return f"{self.value} ± {self.error}"


def is_number(value: object) -> bool:
    """Whether `value` is a finite number (a missing number is None)."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def number(value: float | None, digits: int = 4) -> str:
    """`value` to `digits` significant digits; a dash when missing, a power of ten when very small or large."""
    if not is_number(value):
        return MISSING
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if exponent < -4 or exponent >= 7:
        mantissa = f"{value / 10.0**exponent:.{max(digits - 1, 0)}f}"
        return _signed(mantissa) + power_of_ten(exponent)
    return _signed(f"{value:.{max(digits - 1 - exponent, 0)}f}")


def fixed(value: float | None, decimals: int = 2) -> str:
    """`value` with a fixed number of decimals; a dash when missing."""
    return _signed(f"{value:.{decimals}f}") if is_number(value) else MISSING


def grouped(value: float | None) -> str:
    """A count with thin spaces between thousands."""
    return f"{round(value):,}".replace(",", "\u202f") if is_number(value) else MISSING


def power_of_ten(exponent: int) -> str:
    """A factor such as `·10⁻⁵`."""
    return "·10" + str(exponent).translate(_SUPERSCRIPT)


def measured(value: float | None, error: float | None = None, digits: int = 4) -> Measured:
    """`value` rounded to the place its `error` allows.

    The error keeps one significant digit, two when it begins with 1 or 2. Numbers below 0.001 or from 1e6 share a
    power of ten with their error.
    """
    if not is_number(value):
        return Measured(MISSING)
    if not is_number(error) or error <= 0:
        return Measured(number(value, digits))
    size = max(abs(value), error)
    exponent = math.floor(math.log10(size))
    shift = exponent if exponent < -3 or exponent >= 6 else 0
    value, error = value / 10.0**shift, error / 10.0**shift
    place = math.floor(math.log10(error))
    if error / 10.0**place < 3.0:
        place -= 1
    decimals = min(max(-place, 0), 8)
    power = power_of_ten(shift) if shift else ""
    text = f"{error:.{decimals}f}"
    if float(text) == 0:  # far below what is worth printing
        text = f"<{10.0**-decimals:.{decimals}f}"
    return Measured(_signed(f"{value:.{decimals}f}"), text, power)


def duration(seconds: float | None) -> str:
    """Seconds as people say them: 0.4 s, 12 s, 3 min 05 s, 2 h 10 min."""
    if not is_number(seconds):
        return MISSING
    if abs(seconds) < 10:
        return f"{number(seconds, 3)} s"
    if abs(seconds) < 120:
        return f"{_signed(f'{seconds:.0f}')} s"
    if abs(seconds) > LONG:
        return "over a year"
    whole = round(seconds)
    if abs(whole) < 7200:
        return f"{whole // 60} min {whole % 60:02d} s"
    if abs(whole) < 172800:
        return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
    return f"{whole // 86400} days"


def unbroken(text: str) -> str:
    """`text` with no line break between a number and its unit."""
    return _BEFORE_UNIT.sub("\u00a0", text)


def _signed(text: str) -> str:
    if text.startswith("-"):
        digits = text[1:]
        return digits if not any(c in "123456789" for c in digits) else MINUS + digits
    return text
