"""What gusts and offsets ask of a regulated vehicle's surfaces, and of thrusters where the surfaces saturate."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from spaceplane.analysis.control_inputs import AXES
from spaceplane.analysis.feedback_settings import FeedbackSettings
from spaceplane.control.disturbance import Gust, disturbed, gust_column
from spaceplane.control.effort import Effort, efforts
from spaceplane.control.regulator import Regulator
from spaceplane.control.saturation import saturated, takeover
from spaceplane.dynamics.statespace import MOMENT_INPUTS, StateSpace
from spaceplane.qualities.airframe import Airframe
from spaceplane.vehicle.controls import CONTROLS as SURFACES

HORIZON = 60.0
"""s over which peaks are looked for."""
_STEP = 0.01
_THRUSTERS = {control: moment for control, _, moment in AXES}


@dataclass(frozen=True)
class Disturbance:
    """One of the things a feedback is put to.

    Attributes:
        name: in words.
        offsets: of states at t = 0, rad.
        gust: or none.
    """

    name: str
    offsets: Mapping[str, float]
    gust: Gust | None = None


@dataclass(frozen=True)
class Demand:
    """What one disturbance asks.

    Attributes:
        disturbance: which.
        efforts: of every surface and thruster, as if nothing had a limit.
        thrusters: where surfaces saturate: {moment: greatest moment, N m, of a thruster about the axis of the saturated
            control that supplies what it lacks}.
        lost: whether the motion is lost in spite of them.
    """

    disturbance: Disturbance
    efforts: tuple[Effort, ...]
    thrusters: Mapping[str, float]
    lost: bool

    @property
    def within(self) -> bool:
        """Whether all surfaces stay within deflection and rate; thrusters have no known limit."""
        return all(one.within for one in self.efforts if one.name in SURFACES)


def disturbances(airframe: Airframe, settings: FeedbackSettings) -> tuple[Disturbance, ...]:
    """Offsets of angle of attack and sideslip, gusts from below and from the right."""
    degrees, strength = f"{math.degrees(settings.offset):.3g}", f"{settings.gust:.3g}"
    found = [
        Disturbance(f"offset of {degrees} deg in {name}", {axis: settings.offset})
        for axis, name in (("alpha", "angle of attack"), ("beta", "sideslip"))
    ]
    model = (airframe.point, airframe.mass, airframe.reference, airframe.derivatives)
    for axis, side in (("alpha", "below"), ("beta", "the right")):
        gust = Gust("sharp", axis, settings.gust / airframe.point.velocity, gust_column(axis, *model))
        found.append(Disturbance(f"gust of {strength} m/s from {side}", {}, gust))
    return tuple(found)


def demand(disturbance: Disturbance, regulator: Regulator, plant: StateSpace, settings: FeedbackSettings) -> Demand:
    """Peaks of deflections and rates, and the thruster moments that saturated surfaces call for.

    Args:
        disturbance: what happens.
        regulator: the feedback.
        plant: the open loop with all its inputs, thrusters among them.
        settings: rate limit.
    """
    times = np.linspace(0.0, HORIZON, round(HORIZON / _STEP) + 1)
    history = disturbed(regulator, times, disturbance.offsets, disturbance.gust)
    found = efforts(history, regulator.limits, dict.fromkeys(SURFACES, settings.rate_limit))
    full = _saturated_controls(regulator, {name: history[name].values for name in regulator.limits.inputs})
    if not full:
        return Demand(disturbance, found, {}, False)
    reliefs = [takeover(plant, control, _THRUSTERS[control]) for control in full]
    # One point in ten: peaks of the thruster's moment are as broad as those of the motion.
    run = saturated(
        _unlimited_thrusters(regulator), times[::10], disturbance.offsets, disturbance.gust, reliefs=reliefs
    )
    peaks = {relief.moment: float(np.abs(run[relief.moment].values).max(initial=0.0)) for relief in reliefs}
    return Demand(disturbance, found, peaks, bool(run.attrs["until"] < HORIZON))


def _saturated_controls(regulator: Regulator, values: Mapping[str, np.ndarray]) -> list[str]:
    limits = regulator.limits
    return [
        name
        for name, low, high in zip(limits.inputs, limits.low, limits.high, strict=True)
        if name not in MOMENT_INPUTS and (values[name].min() < low or values[name].max() > high)
    ]


def _unlimited_thrusters(regulator: Regulator) -> Regulator:
    limits = regulator.limits
    free = np.array([name in MOMENT_INPUTS for name in limits.inputs])
    low, high = np.where(free, -np.inf, limits.low), np.where(free, np.inf, limits.high)
    return replace(regulator, limits=replace(limits, low=low, high=high))
