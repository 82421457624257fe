"""A regulated vehicle whose controls saturate, and the thruster moment that makes up for it.

The vehicle stays linear; the inputs stop at their limits and, if asked, move no faster than a rate. Where an input
saturates, a thruster about the same axis can take over the moment that is missing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import solve_ivp

from spaceplane.control.disturbance import Gust
from spaceplane.control.regulator import Regulator
from spaceplane.control.subspaces import unstable_part
from spaceplane.dynamics.response import checked_state, checked_times, unit_of
from spaceplane.dynamics.statespace import MOMENT_INPUTS, StateSpace
from spaceplane.errors import InputError, unknown_name

if TYPE_CHECKING:
    import xarray as xr

# A feedback that asks for this many times its limits, and its start, has lost the vehicle.
_LOST = 1e4


@dataclass(frozen=True)
class Takeover:
    """A thruster that supplies the moment which a saturated input lacks.

    Attributes:
        control: the input that saturates, such as rudder.
        moment: `moment_x`, `moment_y` or `moment_z`.
        ratio: N m per rad of the input, from its column of B and those of the moments.
        column: [state] of the moment, per N m.
    """

    control: str
    moment: str
    ratio: float
    column: np.ndarray


def takeover(system: StateSpace, control: str, moment: str) -> Takeover:
    """A thruster for an input, with the moment that the input makes about the thruster's axis.

    Args:
        system: the open loop with both and all of `moment_x`, `moment_y`, `moment_z` among its inputs.
        control: such as rudder.
        moment: such as `moment_z`.

    Raises:
        InputError: an unknown name, or an input that makes no moment about this axis.
    """
    if moment not in MOMENT_INPUTS:
        raise InputError(unknown_name("moment", moment, MOMENT_INPUTS))
    for name in (control, *MOMENT_INPUTS):
        if name not in system.inputs:
            raise InputError(unknown_name("input", name, system.inputs))
    rates = [system.index(name) for name in ("p", "q", "r")]
    columns = [system.inputs.index(name) for name in MOMENT_INPUTS]
    # All three at once: with a product of inertia a moment about x turns about z too.
    made = np.linalg.solve(system.B[np.ix_(rates, columns)], system.B[rates, system.inputs.index(control)])
    ratio = float(made[MOMENT_INPUTS.index(moment)])
    if abs(ratio) <= 1e-12 * np.abs(made).max():
        raise InputError(f"{control}: makes no {moment} that a thruster could take over")
    return Takeover(control, moment, ratio, system.B[:, system.inputs.index(moment)])


def saturated(
    regulator: Regulator,
    times: Sequence[float],
    offsets: Mapping[str, float] | None = None,
    gust: Gust | None = None,
    rate_limit: float = math.inf,
    lag: float = 0.0,
    reliefs: Sequence[Takeover] = (),
) -> xr.Dataset:
    """Response of the closed loop with limited inputs.

    Args:
        regulator: the feedback, with the limits of its inputs.
        times: from 0 on, s.
        offsets: {"alpha": at t = 0, ...}, SI units and rad.
        gust: or none.
        rate_limit: greatest rate of the deflections, rad/s; needs a lag.
        lag: time constant of the actuators, s, which start from trim; 0 for inputs that follow at once.
        reliefs: thrusters that take over what inputs lack, one about each axis.

    Returns:
        Dims (time): states, inputs, the moment of each relief (N m). Attributes `held` (1 if the unstable part of the
        motion ends below a tenth of its peak: give it time) and `until` (s; earlier than asked if it is lost for good).

    Raises:
        InputError: unknown states, bad times, a rate limit or lag that is none, a relief of another input, two
            reliefs about one axis.
    """
    import xarray as xr

    moments = checked_times(times)
    plant, K, limits = regulator.system, regulator.gain, regulator.limits
    n, m = len(plant.states), len(plant.inputs)
    if not (lag >= 0 and math.isfinite(lag)):
        raise InputError(f"lag = {lag}: must be 0 s or above")
    if not rate_limit > 0 or (math.isfinite(rate_limit) and lag == 0):
        raise InputError(f"rate_limit = {rate_limit}: must be above 0 rad/s, and needs a lag above 0 s")
    for relief in reliefs:
        if relief.control not in plant.inputs:
            raise InputError(unknown_name("input to relieve", relief.control, plant.inputs))
    if len({relief.moment for relief in reliefs}) < len(reliefs):
        raise InputError(f"reliefs = {', '.join(relief.moment for relief in reliefs)}: one about each axis is allowed")
    start = np.concatenate([checked_state(plant, offsets or {}), np.zeros(m if lag > 0 else 0)])
    fastest = np.array([math.inf if name in MOMENT_INPUTS else rate_limit for name in plant.inputs])
    relieved = [plant.inputs.index(relief.control) for relief in reliefs]
    ratios = np.array([relief.ratio for relief in reliefs])
    columns = np.array([relief.column for relief in reliefs]).reshape(len(reliefs), n)

    def actual(y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(what is wanted, what the inputs give, [relief] thruster moments)."""
        wanted = -K @ y[:n]
        given = np.clip(y[n:] if lag > 0 else wanted, limits.low, limits.high)
        lacking = wanted - np.clip(wanted, limits.low, limits.high)
        return wanted, given, ratios * lacking[relieved]

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        """Time derivatives with the inputs that the limits leave."""
        wanted, given, missing = actual(y)
        x = plant.A @ y[:n] + plant.B @ given + missing @ columns
        if gust is not None:
            x = x + gust.column * gust.at(t)
        if lag == 0:
            return x
        goal = np.clip(wanted, limits.low, limits.high)
        return np.concatenate([x, np.clip((goal - y[n:]) / lag, -fastest, fastest)])

    part = unstable_part(plant)
    scale = (limits.high - limits.low) / 2
    bound = _LOST * max(1.0, float(np.max(np.abs(K @ start[:n]) / scale)))

    def lost(t: float, y: np.ndarray) -> float:
        return bound - float(np.max(np.abs(K @ y[:n]) / scale))

    lost.terminal = True  # type: ignore[attr-defined]
    longest = 0.05 * (gust.duration if gust is not None and gust.duration > 0 else math.inf)
    run = solve_ivp(
        rates, (0.0, moments[-1]), start, "RK45", moments, events=lost, rtol=1e-8, atol=1e-11, max_step=longest
    )
    found = [actual(y) for y in run.y.T]
    variables = {name: ("time", run.y[k], {"units": unit_of(name)}) for k, name in enumerate(plant.states)}
    for k, name in enumerate(plant.inputs):
        variables[name] = ("time", np.array([given[k] for _, given, _ in found]), {"units": unit_of(name)})
    for k, relief in enumerate(reliefs):
        variables[relief.moment] = ("time", np.array([missing[k] for *_, missing in found]), {"units": "N m"})
    growing = np.linalg.norm(part.rows @ run.y[:n], axis=0) if len(part.A) else np.zeros(len(run.t))
    held = run.status == 0 and bool(growing[-1] <= 0.1 * growing.max(initial=0.0))
    return xr.Dataset(
        variables,
        coords={"time": ("time", run.t, {"units": "s"})},
        attrs={"held": int(held), "until": float(run.t_events[0][0]) if run.status == 1 else float(moments[-1])},
    )
