"""The thesis's derivatives, and how far our changes with shape agree with its.

Source of the numbers: J. A. Reijne, MSc thesis, TU Delft, 2022, Tables 7.1, 7.6, 7.8 and C.1 to C.15 (data/README.md).
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from importlib import resources

DERIVATIVES = ("CD_alpha", "CL_alpha", "Cm_alpha", "CY_beta", "Cl_beta", "Cn_beta", "CD_M", "CL_M", "Cm_M")
"""Derivatives of the thesis's Table 7.1 in its order; its C_S_beta is `CY_beta` here."""

RESOLUTION = 0.02
"""Changes below this fraction of the value are too small to tell, unless the printed digits hide even more."""

_MISSING = {("wing_thickness_m", "Cl_beta"), ("wing_thickness_m", "Cn_beta")}


@dataclass(frozen=True)
class Sensitivity:
    """How one derivative changes when one parameter leaves its default.

    Attributes:
        parameter: shape parameter with its unit, for example wing_width_m.
        side: "low" or "high".
        parameter_value: m or deg.
        mach: flight point.
        derivative: name, see `DERIVATIVES`.
        value: of the changed shape, per radian or per unit Mach.
        default: of the default shape, same unit.
        noise: changes below this are not told from zero, same unit.
    """

    parameter: str
    side: str
    parameter_value: float
    mach: float
    derivative: str
    value: float
    default: float
    noise: float

    @property
    def change(self) -> float:
        """Value less default, per radian or per unit Mach."""
        return self.value - self.default

    @property
    def sign(self) -> int:
        """+1, -1, or 0 where the change is too small to tell."""
        return 0 if abs(self.change) <= self.noise else int(math.copysign(1, self.change))


def unit_factor(derivative: str) -> float:
    """Return what the thesis's printed derivative is multiplied with: 180/pi for angles, 1 for Mach derivatives."""
    return 1.0 if derivative.endswith("_M") else 180.0 / math.pi


def resolution(value: float, default: float) -> float:
    """Return the change below which a sign is not trusted, in the unit of the values."""
    return RESOLUTION * max(abs(value), abs(default))


@cache
def sensitivities() -> tuple[Sensitivity, ...]:
    """Return Appendix C, per radian and per unit Mach, without its missing entries."""
    rows = _rows("thesis_appendix_c.csv")
    defaults = {
        (row["parameter"], row["mach"], row["derivative"]): _value(row) for row in rows if row["variant"] == "original"
    }
    last_digit = _last_digits(rows)
    found = []
    for row in rows:
        name = _name(row["derivative"])
        if row["variant"] == "original" or (row["parameter"], name) in _MISSING:
            continue
        value, default = _value(row), defaults[row["parameter"], row["mach"], row["derivative"]]
        found.append(
            Sensitivity(
                row["parameter"],
                row["variant"],
                float(row["parameter_value"]),
                float(row["mach"]),
                name,
                value,
                default,
                max(resolution(value, default), last_digit[row["table"], row["derivative"]] * unit_factor(name)),
            )
        )
    return tuple(found)


@cache
def derivatives(shape: str) -> dict[float, dict[str, float]]:
    """Return {Mach: {derivative: value}} of the "original" or "optimised" shape, per radian and per unit Mach."""
    found: dict[float, dict[str, float]] = {}
    for row in _rows("thesis_derivatives.csv"):
        if row["shape"] == shape:
            found.setdefault(float(row["mach"]), {})[_name(row["derivative"])] = _value(row)
    return found


def agreement(ours: Iterable[Sensitivity]) -> list[dict]:
    """Set our changes beside the thesis's: one row for each pair of parameter side, Mach number and derivative.

    The thesis did not always go to the parameter's limit, so besides the signs the slopes (change of the derivative by
    change of the parameter) are given, each as a fraction of its own default derivative per unit of the parameter.

    Returns:
        Rows with parameter, side, mach, derivative, both parameter values, values, changes, relative slopes, and
        verdict: "agree", "disagree", "both too small", "ours too small" or "thesis too small".
    """
    published = {(row.parameter, row.side, row.mach, row.derivative): row for row in sensitivities()}
    start = {
        (row["parameter"]): float(row["parameter_value"]) for row in _rows("thesis_appendix_c.csv") if _is_start(row)
    }
    rows = []
    for mine in ours:
        theirs = published.get((mine.parameter, mine.side, mine.mach, mine.derivative))
        if theirs is None:
            continue
        origin = start[mine.parameter]
        rows.append(
            {
                "parameter": mine.parameter,
                "side": mine.side,
                "mach": mine.mach,
                "derivative": mine.derivative,
                "parameter_value": mine.parameter_value,
                "parameter_value_thesis": theirs.parameter_value,
                "default": mine.default,
                "change": mine.change,
                "noise": mine.noise,
                "default_thesis": theirs.default,
                "change_thesis": theirs.change,
                "slope": _slope(mine, origin),
                "slope_thesis": _slope(theirs, origin),
                "verdict": _verdict(mine.sign, theirs.sign),
            }
        )
    return rows


def agreement_table(rows: Iterable[dict], by: str) -> list[dict]:
    """Count the verdicts of `agreement` by one of its columns, for example "parameter" or "derivative"."""
    table: dict[object, dict] = {}
    for row in rows:
        line = table.setdefault(row[by], {by: row[by], "agree": 0, "disagree": 0, "too small to tell": 0})
        line[row["verdict"] if row["verdict"] in line else "too small to tell"] += 1
    for line in table.values():
        told = line["agree"] + line["disagree"]
        line["agreement_percent"] = 100.0 * line["agree"] / told if told else None
    return list(table.values())


def _verdict(ours: int, theirs: int) -> str:
    if ours == 0 or theirs == 0:
        return "both too small" if ours == theirs else "ours too small" if ours == 0 else "thesis too small"
    return "agree" if ours == theirs else "disagree"


def _slope(row: Sensitivity, origin: float) -> float | None:
    step = row.parameter_value - origin
    return row.change / abs(row.default) / step if row.default and step else None


def _is_start(row: dict) -> bool:
    return row["variant"] == "original"


def _name(derivative: str) -> str:
    return derivative.replace("CS_", "CY_")


def _value(row: dict) -> float:
    return float(row["value_per_degree"]) * unit_factor(row["derivative"])


def _last_digits(rows: tuple[dict, ...]) -> dict[tuple[str, str], float]:
    """Return one unit of the last printed digit by table and derivative, as printed (trailing zeros may be lost)."""
    decimals: dict[tuple[str, str], int] = {}
    for row in rows:
        key = row["table"], row["derivative"]
        decimals[key] = max(decimals.get(key, 0), -int(Decimal(row["value_per_degree"]).as_tuple().exponent))
    return {key: 10.0**-places for key, places in decimals.items()}


@cache
def _rows(file: str) -> tuple[dict, ...]:
    text = (resources.files("spaceplane.study") / "data" / file).read_text(encoding="utf-8")
    return tuple(csv.DictReader(text.splitlines()))
