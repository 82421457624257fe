"""Errors of derivatives as users give them: half widths of 95 % intervals, in their units or as shares.

`Cn_beta=0.01` is absolute, `Cm_alpha=10%` relative to the value at each flight point, and `all=10%` stands for every
derivative, C_L and C_D that has no entry of its own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from spaceplane.aero.model.derivatives import CONTROL_DERIVATIVES, PAIRS, Derivatives
from spaceplane.dynamics.flightpoint import FlightPoint
from spaceplane.dynamics.sensitivity import PARAMETERS, value_of
from spaceplane.errors import InputError, unknown_name

ALL = "all"
NAMES = (*PARAMETERS, *CONTROL_DERIVATIVES, ALL)
GREATEST = 1e4  # of an absolute half width
GREATEST_SHARE = 10.0


@dataclass(frozen=True)
class GivenError:
    """Half width of a 95 % interval.

    Attributes:
        amount: per rad, per unit Mach number or reduced rate; with `relative` a ratio to the value.
        relative: whether it is a share of the value.
    """

    amount: float
    relative: bool = False

    def half_width(self, value: float) -> float:
        """About a value, in its unit (per rad, per unit Mach number or reduced rate)."""
        return self.amount * abs(value) if self.relative else self.amount


def given_error(where: str, name: str, value: object) -> GivenError:
    """One entry, from a number or a text such as `0.01` or `10 %`.

    Args:
        where: what to put before the name in messages, such as an option.
        name: of `NAMES`.
        value: number, or text with or without a per-cent sign.

    Raises:
        InputError: an unknown name, or no number from 0 to the greatest allowed.
    """
    if name not in NAMES:
        raise InputError(f"{where} {unknown_name('derivative', name, NAMES)}")
    text = value.strip() if isinstance(value, str) else value
    relative = isinstance(text, str) and text.endswith("%")
    try:
        number = math.nan if isinstance(text, bool) else float(text.removesuffix("%") if relative else text)  # type: ignore[union-attr,arg-type]
    except (TypeError, ValueError):
        number = math.nan
    amount, most = (number / 100.0, GREATEST_SHARE) if relative else (number, GREATEST)
    if not 0.0 <= amount <= most:
        limits = f"0 to {100 * GREATEST_SHARE:g} % or 0 to {GREATEST:g} per rad, the half width of a 95 % interval"
        raise InputError(f"{where} {name} = {value!r}: must be {limits}")
    if name == ALL and not relative:
        raise InputError(f"{where} {ALL} = {value!r}: must be a share such as 10%, since the units differ")
    return GivenError(amount, relative)


def read_errors(option: str, text: str) -> dict[str, GivenError]:
    """`Cm_alpha=10%,Cn_beta=0.01,all=5%`, absolute ones per rad, per unit Mach number or reduced rate.

    Raises:
        InputError: not of this form, a name twice, or as `given_error`.
    """
    found: dict[str, GivenError] = {}
    for piece in text.split(","):
        name, equals, value = (part.strip() for part in piece.partition("="))
        if not (name and equals and value):
            raise InputError(f"{option}: {piece.strip()!r} is not name=value, such as Cm_alpha=10%")
        if name in found:
            raise InputError(f"{option}: {name} is given twice")
        found[name] = given_error(option, name, value)
    return found


def half_widths(
    errors: Mapping[str, GivenError], point: FlightPoint, derivatives: Derivatives, where: str = "uncertainty"
) -> dict[str, float]:
    """Half widths at a flight point, per rad, per unit Mach number or reduced rate; what is 0 has none by `all`.

    Args:
        errors: by name.
        point: with C_L and C_D.
        derivatives: per rad and per unit Mach number.
        where: what to put before the name in messages.

    Raises:
        InputError: a control derivative that the vehicle does not have.
    """
    has = (*PARAMETERS, *derivatives.controls)
    for name in errors:
        if name not in (*has, ALL):
            raise InputError(f"{where} {name}: the vehicle has no {name}")
    wanted = has if ALL in errors else tuple(name for name in has if name in errors)
    widths = {
        name: errors.get(name, errors.get(ALL, GivenError(0.0))).half_width(value_of(name, point, derivatives))
        for name in wanted
    }
    return {name: width for name, width in widths.items() if width > 0.0 or name in errors}


def by_surface(
    widths: Mapping[str, float], correlation: Mapping[tuple[str, str], float]
) -> tuple[dict[str, GivenError], dict[tuple[str, str], float]]:
    """Errors and correlations with those of elevator, aileron and rudder shared out between their two surfaces.

    Args:
        widths: name to half width, per rad, per unit Mach number or reduced rate.
        correlation: pair of names to coefficient of correlation, -1 to 1.
    """
    errors = {part: GivenError(abs(share) * width) for name, width in widths.items() for part, share in _parts(name)}
    pairs = {
        (a, b): math.copysign(1.0, sign * other) * value
        for (one, two), value in correlation.items()
        for a, sign in _parts(one)
        for b, other in _parts(two)
    }
    return errors, pairs


def _parts(name: str) -> tuple[tuple[str, float], ...]:
    """A derivative with a combined control as those with its surfaces and their shares; any other is itself."""
    coefficient, _, control = name.partition("_")
    if control not in PAIRS:
        return ((name, 1.0),)
    first, second, sign = PAIRS[control]
    return ((f"{coefficient}_{first}", 0.5), (f"{coefficient}_{second}", 0.5 * sign))
