"""What a stabilising feedback is put to: gust, offset, and what its surfaces and thrusters may do."""

from __future__ import annotations

import math
from dataclasses import dataclass

from spaceplane.control.authority import RATE_LIMIT
from spaceplane.errors import InputError

GUST = 9.0
"""m/s: the discrete gust of Apollo and of the Space Shuttle, there a quasi-square wave 60 to 300 m long (F. Leahy,
Discrete gust model for launch vehicle assessments, AMS 12th Conference on Aviation, Range and Aerospace Meteorology,
2008). Here its edge is sharp and it stays, which asks more."""

_MOST = {"gust": 100.0, "offset": math.radians(20.0), "decay": 10.0}


@dataclass(frozen=True)
class FeedbackSettings:
    """What is asked of the feedback.

    Attributes:
        gust: m/s, sharp-edged and lasting, from below and from the right in turn.
        offset: rad, of angle of attack and of sideslip in turn.
        decay: 1/s; every motion shall decay at least so fast; 0 only stabilises.
        rate_limit: rad/s, of every surface.
        thruster: N m that count as much as a surface at its limit where a thruster stands in for an axis without a
            known surface. A weight, a round number, and no limit: thrusters of HORUS-2B are not published.

    Raises:
        InputError: a value out of range.
    """

    gust: float = GUST
    offset: float = math.radians(1.0)
    decay: float = 0.0
    rate_limit: float = RATE_LIMIT
    thruster: float = 1e4

    def __post_init__(self) -> None:
        for name, most in _MOST.items():
            value = getattr(self, name)
            least = 0.0 if name == "decay" else 1e-9
            if not (math.isfinite(value) and least <= value <= most):
                factor, unit = (math.degrees(1.0), " deg") if name == "offset" else (1.0, "")
                unit = unit or {"gust": " m/s", "decay": " 1/s"}[name]
                allowed = "0 or above" if name == "decay" else "above 0"
                raise InputError(f"{name} = {factor * value:g}{unit}: {allowed} and at most {factor * most:g}{unit}")
        for name, unit in (("rate_limit", "rad/s"), ("thruster", "N m")):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise InputError(f"{name} = {value:g} {unit}: must be above 0")
