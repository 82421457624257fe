"""What a response asks of the control surfaces and thrusters, and whether they can give it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.control.authority import RATE_LIMIT, Authority, surface_limits, surface_positions
from spaceplane.dynamics.statespace import MOMENT_INPUTS
from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle.controls import CONTROLS as SURFACES

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Effort:
    """What is asked of one surface or thruster.

    Attributes:
        name: surface, or moment of a thruster.
        unit: rad or N m.
        least, greatest: over the response, trim included.
        low, high: limits.
        rate: greatest rate after t = 0, either way, per s.
        rate_limit: rad/s; infinite for a thruster.
        jump: what an offset at t = 0 asks at once, as a difference from trim; no actuator follows it.
    """

    name: str
    unit: str
    least: float
    greatest: float
    low: float
    high: float
    rate: float
    rate_limit: float
    jump: float

    @property
    def within(self) -> bool:
        """Whether deflection and rate stay within their limits."""
        return self.margin >= 0 and self.rate <= self.rate_limit

    @property
    def margin(self) -> float:
        """What is left to the nearer limit; negative beyond it."""
        return min(self.greatest - self.low, self.high - self.greatest, self.least - self.low, self.high - self.least)


def efforts(
    history: xr.Dataset, limits: Authority, rate_limits: Mapping[str, float] | None = None
) -> tuple[Effort, ...]:
    """Peaks of every surface and thruster in a response of `disturbance.disturbed`, against the limits.

    Args:
        history: the response; its times should be close enough to show the peaks.
        limits: of the inputs of the response.
        rate_limits: {surface: rad/s}; `authority.RATE_LIMIT` where not named.

    Raises:
        InputError: an unknown surface, a rate limit not above 0, or an input that the response lacks.
    """
    given = rate_limits or {}
    for name, value in given.items():
        if name not in SURFACES:
            raise InputError(unknown_name("control surface", name, SURFACES))
        if not value > 0:
            raise InputError(f"rate limit of {name} = {value}: must be above 0 rad/s")
    missing = [name for name in limits.inputs if f"{name}_rate" not in history]
    if missing:
        raise InputError(f"response: has no {missing[0]}")
    values = {name: history[name].values for name in limits.inputs}
    rates = {name: history[f"{name}_rate"].values for name in limits.inputs}
    found = []
    for name, positions in surface_positions(limits, values).items():
        low, high = surface_limits(name)
        found.append(
            Effort(
                name=name,
                unit="rad",
                least=float(positions.min()),
                greatest=float(positions.max()),
                low=low,
                high=high,
                rate=float(np.abs(_surface_rate(name, limits, values, rates)).max()),
                rate_limit=given.get(name, RATE_LIMIT),
                jump=float(positions[0] - limits.trim.get(name, 0.0)),
            )
        )
    for k, name in enumerate(limits.inputs):
        if name in MOMENT_INPUTS:
            x = values[name]
            bounds = float(limits.low[k]), float(limits.high[k])
            rate = float(np.abs(rates[name]).max())
            found.append(Effort(name, "N m", float(x.min()), float(x.max()), *bounds, rate, math.inf, float(x[0])))
    return tuple(found)


def _surface_rate(
    name: str, limits: Authority, values: Mapping[str, np.ndarray], rates: Mapping[str, np.ndarray]
) -> np.ndarray:
    """Rate of a surface along a history: how its position answers a small step of all inputs."""
    step = 1e-6
    ahead = {key: values[key] + step * rates[key] for key in values}
    behind = {key: values[key] - step * rates[key] for key in values}
    return (surface_positions(limits, ahead)[name] - surface_positions(limits, behind)[name]) / (2 * step)
