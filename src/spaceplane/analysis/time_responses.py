"""How the vehicle moves with the controls fixed and with the feedback, after each disturbance and a pulse."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.analysis.control_demand import Disturbance
from spaceplane.control.disturbance import disturbed
from spaceplane.control.regulator import Regulator
from spaceplane.dynamics.modes import Mode, identify
from spaceplane.dynamics.response import doublet

if TYPE_CHECKING:
    import xarray as xr

POINTS = 121
LONGEST = 12.0  # s
GROWTH = 3.0
"""Time constants that are shown of the fastest growth in pitch, or in roll and yaw: a factor of twenty."""
COUPLED = 10.0
"""Most time constants of the fastest growth of all, which a bank lets into every motion."""
LATERAL = ("p", "r", "beta", "sigma")
PULSE, PULSE_TIME = math.radians(1.0), 2.0
"""rad and s of a doublet: half the time one way, half the other; shorter where less than three seconds are shown."""


@dataclass(frozen=True)
class Response:
    """One motion.

    Attributes:
        name: what happens.
        states, inputs: those worth showing.
        open_loop: dims (time) with the controls fixed.
        closed_loop: dims (time) with the feedback.
    """

    name: str
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    open_loop: xr.Dataset
    closed_loop: xr.Dataset


def responses(regulator: Regulator, events: Sequence[Disturbance]) -> tuple[Response, ...]:
    """Responses to each disturbance, and to a doublet of the elevator where there is one.

    Args:
        regulator: the feedback.
        events: what happens.
    """
    idle = replace(regulator, gain=np.zeros_like(regulator.gain))
    modes = identify(regulator.system)
    times = {pitching: _times(modes, pitching) for pitching in (True, False)}
    found = []
    for event in events:
        pitching = "alpha" in (*event.offsets, event.gust.axis if event.gust else "")
        runs = (disturbed(loop, times[pitching], event.offsets, event.gust) for loop in (idle, regulator))
        found.append(Response(event.name, *_shown(regulator, pitching), *runs))
    if "elevator" in regulator.limits.inputs:
        found.append(_pulse(regulator, times[True]))
    return tuple(found)


def _times(modes: Sequence[Mode], pitching: bool) -> np.ndarray:
    """[time] s, as long as the fastest growth of the modes that this motion is made of allows."""
    every = [mode.eigenvalue.real for mode in modes]
    own = [mode.eigenvalue.real for mode in modes if (mode.share(*LATERAL) < 0.5) == pitching]
    ends = [count / max(rates) for count, rates in ((GROWTH, own), (COUPLED, every)) if max(rates, default=0.0) > 0.0]
    return np.linspace(0.0, min([LONGEST, *ends]), POINTS)


def _shown(regulator: Regulator, pitching: bool) -> tuple[tuple[str, ...], tuple[str, ...]]:
    states = ("alpha", "q") if pitching else ("beta", "p")
    axis = ("elevator", "moment_y") if pitching else ("aileron", "moment_x", "rudder", "moment_z")
    return states, tuple(name for name in axis if name in regulator.limits.inputs)


def _pulse(regulator: Regulator, times: np.ndarray) -> Response:
    """A doublet of the elevator; in the closed loop the feedback adds to what is commanded."""
    pulse = min(PULSE_TIME, 2.0 / 3.0 * times[-1])
    name = f"elevator {math.degrees(PULSE):g} deg down and up, {pulse:.2g} s"
    loops = [regulator.system, regulator.closed()]
    runs = [doublet(loop, "elevator", PULSE, pulse, times) for loop in loops]
    motion = np.stack([runs[1][state].values for state in regulator.system.states])
    for row, control in zip(regulator.gain, regulator.limits.inputs, strict=True):
        runs[1][control] = runs[1][control] - row @ motion
    for control in regulator.limits.inputs:
        runs[1][control].attrs |= runs[0][control].attrs
    return Response(name, *_shown(regulator, True), *runs)
