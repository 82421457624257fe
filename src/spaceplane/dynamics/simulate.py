"""Flight in time: the nonlinear equations integrated until an event, an end of the data or the end of time.

The integration is scipy's DOP853 (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, 2nd ed.,
section II.10; order 8 with dense output of order 7), taken step by step so that the flight can end cleanly where the
air or the
aerodynamics are not known: the step is halved until the boundary is met, and the reason is kept.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import DOP853, RK45, OdeSolution
from scipy.optimize import brentq

from spaceplane.dynamics.motion import state as coordinates
from spaceplane.dynamics.motion.body import fixed_rates, inertial_rates
from spaceplane.dynamics.motion.forces import Air, Controls, controls_at
from spaceplane.dynamics.motion.observe import QUANTITIES, observe
from spaceplane.dynamics.motion.state import FlightState
from spaceplane.dynamics.motion.trajectory import trajectory_rates
from spaceplane.dynamics.motion.vehicle import Vehicle
from spaceplane.dynamics.planet import EARTH_SPHERE, Planet
from spaceplane.dynamics.statespace import MOMENT_INPUTS
from spaceplane.environment.atmosphere import us1976
from spaceplane.errors import InputError, unknown_name
from spaceplane.progress import Progress, silent

if TYPE_CHECKING:
    import xarray as xr

METHODS = {"DOP853": DOP853, "RK45": RK45}
# A step shorter than this that still leaves the known data ends the flight, s.
_SHORTEST_STEP = 1e-7
# Scales of the coordinates for the absolute tolerance: position m, velocity m/s, attitude, rates rad/s, angles rad.
_BODY_SCALE = np.array([1e3] * 3 + [1.0] * 3 + [1.0] * 4 + [1e-2] * 3)
_TRAJECTORY_SCALE = np.array([1.0, 1e-2, 1e-2, 1e3, 1e-3, 1e-3, 1e-2, 1e-2, 1e-2, 1e-2, 1e-2, 1e-2])


@dataclass(frozen=True)
class Form:
    """One form of the equations of motion.

    Attributes:
        rates: time derivatives of its coordinates.
        pack: coordinates of a state on a planet at a time, s.
        unpack: the state back from them.
        scale: [coordinate] sizes for the absolute tolerance, SI and rad.
    """

    rates: Callable[..., np.ndarray]
    pack: Callable[[FlightState, Planet, float], np.ndarray]
    unpack: Callable[[np.ndarray, Planet, float], FlightState]
    scale: np.ndarray


FORMS: dict[str, Form] = {
    "trajectory": Form(
        trajectory_rates,
        lambda state, planet, time: coordinates.to_trajectory(state),
        lambda values, planet, time: coordinates.from_trajectory_array(values),
        _TRAJECTORY_SCALE,
    ),
    "body-fixed": Form(
        fixed_rates,
        lambda state, planet, time: coordinates.to_fixed(state),
        lambda values, planet, time: coordinates.from_fixed(values),
        _BODY_SCALE,
    ),
    "body-inertial": Form(inertial_rates, coordinates.to_inertial, coordinates.from_inertial, _BODY_SCALE),
}
"""The forms of the equations that can be chosen by name."""


@dataclass(frozen=True)
class Event:
    """A quantity that reaches a value.

    Attributes:
        quantity: of `QUANTITIES`.
        value: SI unit or rad.
        direction: 1 only when rising, -1 only when falling, 0 both.
        stop: whether the flight ends there.

    Raises:
        InputError: unknown quantity, value not finite or another direction.
    """

    quantity: str
    value: float
    direction: int = 0
    stop: bool = True

    def __post_init__(self) -> None:
        if self.quantity not in QUANTITIES:
            raise InputError(unknown_name("event quantity", self.quantity, QUANTITIES))
        if not math.isfinite(self.value):
            raise InputError(f"{self.quantity} = {self.value}: an event needs a finite value")
        if self.direction not in (-1, 0, 1):
            raise InputError(f"direction = {self.direction}: must be -1, 0 or 1")

    def __str__(self) -> str:
        unit = QUANTITIES[self.quantity][0]
        if unit.startswith("rad"):
            return f"{self.quantity} reached {math.degrees(self.value):.6g} {unit.replace('rad', 'deg')}"
        return f"{self.quantity} reached {self.value:.6g}{'' if unit == '1' else ' ' + unit}"


@dataclass(frozen=True)
class Occurrence:
    """An event and when it happened.

    Attributes:
        event: what was met.
        time: s.
    """

    event: Event
    time: float


@dataclass(frozen=True)
class Simulation:
    """A flight in time.

    Attributes:
        history: Dataset over `time`, s: `QUANTITIES`, position and attitude, controls; each with units and description.
        reason: why it ended, in words.
        completed: whether it came to the end of time or to an event, not to the end of the data.
        events: what was met on the way, in order.
        final: the last state.
        end: its time, s.
        state_at: the state at any time between 0 and `end`, s, from the dense output.
        steps: of the integration.
        evaluations: of the equations of motion.
    """

    history: xr.Dataset
    reason: str
    completed: bool
    events: tuple[Occurrence, ...]
    final: FlightState
    end: float
    state_at: Callable[[float], FlightState]
    steps: int
    evaluations: int


def simulate(
    vehicle: Vehicle,
    start: FlightState,
    duration: float,
    planet: Planet = EARTH_SPHERE,
    controls: Controls | None = None,
    events: Sequence[Event] = (),
    form: str = "body-inertial",
    air: Air = us1976,
    output_step: float = 1.0,
    breaks: Sequence[float] = (),
    rtol: float = 1e-9,
    max_step: float = 10.0,
    method: str = "DOP853",
    progress: Progress = silent,
) -> Simulation:
    """Fly from a state.

    Args:
        vehicle: mass, inertia, aerodynamics.
        start: state at time 0, when the inertial and the planet-fixed axes coincide.
        duration: s.
        planet: figure, gravity, rotation.
        controls: constant deflections (rad) and moments (N m), or a law of time and state; None leaves all at 0.
        events: what to look for, and whether to stop there; a quantity that meets its value twice within one step is
            not seen, so `max_step` bounds the steps.
        form: of `FORMS`.
        air: the air by altitude, m; a `motion.wind.MovingAir` for one that blows (body forms only). The velocity of
            `start` and of the states that a law sees is that against the planet.
        output_step: between the times of the history, s; the last time is always there.
        breaks: times at which a control law jumps, s; the integration starts anew there.
        rtol: relative tolerance, a fraction of each coordinate; the absolute one is this times a typical size.
        max_step: longest step, s.
        method: "DOP853" or, as a check, "RK45".
        progress: told of seconds flown.

    Raises:
        InputError: a name or number is not allowed, or the start lies outside of what is known.
    """
    _check(duration, output_step, rtol, max_step, breaks, form, method)
    chosen = FORMS[form]
    law: Controls = {} if controls is None else controls
    flight = _Flight(vehicle, planet, law, air, chosen)
    values = chosen.pack(start, planet, 0.0)
    # What the start lacks is the user's error; what is met later ends the flight.
    flight.rates(0.0, values)
    flight.observed(0.0, values)
    options = {"rtol": rtol, "atol": rtol * chosen.scale, "max_step": max_step}
    bounds = [*sorted(t for t in breaks if 0.0 < t < duration), duration]
    track = _Track([0.0], [], [])
    reason, completed = "", False
    for bound in bounds:
        reason, completed, values = _fly(
            flight, METHODS[method], track, values, bound, options, events, duration, progress
        )
        if reason:
            break
    if not reason:
        reason, completed = f"end of time after {duration:g} s", True
    end = track.times[-1]
    dense = OdeSolution(track.times, track.pieces) if end > 0.0 else None

    def state_at(time: float) -> FlightState:
        if not 0.0 <= time <= end:
            raise InputError(f"time = {time} s: must lie between 0 and {end:g} s")
        return chosen.unpack(values if dense is None or time == end else dense(time), planet, time)

    history = _history(flight, state_at, end, output_step, form, method, rtol, reason)
    return Simulation(
        history, reason, completed, tuple(track.events), state_at(end), end, state_at, track.steps, flight.count
    )


class _Flight:
    """The equations of one flight, counted."""

    def __init__(self, vehicle: Vehicle, planet: Planet, controls: Controls, air: Air, form: Form) -> None:
        self.vehicle, self.planet, self.controls, self.air, self.form = vehicle, planet, controls, air, form
        self.count = 0

    def rates(self, time: float, values: np.ndarray) -> np.ndarray:
        self.count += 1
        return self.form.rates(time, values, self.vehicle, self.planet, self.controls, self.air)

    def observed(self, time: float, values: np.ndarray) -> dict[str, float]:
        return self.observed_state(time, self.form.unpack(values, self.planet, time))

    def observed_state(self, time: float, state: FlightState) -> dict[str, float]:
        return observe(state, time, self.vehicle, self.planet, self.controls, self.air)


@dataclass
class _Track:
    """Accepted steps: times, interpolants and events."""

    times: list[float]
    pieces: list
    events: list[Occurrence]
    steps: int = 0


def _fly(
    flight: _Flight,
    method: type,
    track: _Track,
    values: np.ndarray,
    bound: float,
    options: dict,
    events: Sequence[Event],
    duration: float,
    progress: Progress,
) -> tuple[str, bool, np.ndarray]:
    """(why the flight ended or "", whether it is complete, last coordinates) from the track's end to a bound."""
    time = track.times[-1]
    before = flight.observed(time, values) if events else {}
    first: float | None = None
    solver = None
    # A law that jumps at the bound still has its old value at the end of the stretch.
    latest = np.nextafter(bound, 0.0)

    def rates(at: float, coordinates: np.ndarray) -> np.ndarray:
        return flight.rates(min(at, latest), coordinates)

    while time < bound:
        tried = first if first is not None else math.nan
        try:
            if solver is None:
                solver = method(rates, time, values, bound, first_step=first, **options)
            tried = solver.h_abs
            message = solver.step()
            if solver.status == "failed":
                return f"the integration failed: {message}", False, values
            piece = solver.dense_output()
            after = flight.observed(solver.t, solver.y) if events else {}
        except InputError as error:
            # Outside of what is known: nearer, until the boundary is met.
            step = min(tried, bound - time) if math.isfinite(tried) else min(1.0, bound - time)
            if step / 2 < _SHORTEST_STEP:
                return str(error), False, values
            solver, first = None, step / 2
            continue
        track.steps += 1
        met = _met(events, before, after, flight, piece, time, solver.t)
        stopped = next((one for one in met if one.event.stop), None)
        if stopped is not None:
            met = [one for one in met if one.time <= stopped.time]
        track.events.extend(met)
        if stopped is not None:
            if stopped.time > time:
                track.times.append(stopped.time)
                track.pieces.append(piece)
                values = piece(stopped.time)
            return f"{stopped.event} at {stopped.time:.6g} s", True, values
        time, values, before = solver.t, solver.y.copy(), after
        track.times.append(time)
        track.pieces.append(piece)
        progress("simulate", int(1000 * time / duration), 1000, f"{time:.1f} s")
    return "", False, values


def _met(
    events: Sequence[Event], before: dict, after: dict, flight: _Flight, piece: Callable, start: float, end: float
) -> list[Occurrence]:
    """Events within one step, in order of time."""
    found = []
    for event in events:
        low, high = before[event.quantity] - event.value, after[event.quantity] - event.value
        # A quantity that starts on its value has met it before; one that ends on it meets it now.
        if not (low * high < 0 or (low != 0 and high == 0)) or event.direction * (high - low) < 0:
            continue
        if event.quantity in ("chi", "lon", "sigma", "psi", "phi", "alpha", "track") and abs(high - low) > math.pi:
            continue  # the jump from pi to -pi

        def miss(time: float, event: Event = event) -> float:
            return flight.observed(time, piece(time))[event.quantity] - event.value

        time = end if high == 0 else float(brentq(miss, start, end, xtol=1e-10))
        found.append(Occurrence(event, time))
    return sorted(found, key=lambda one: one.time)


def _history(
    flight: _Flight,
    state_at: Callable[[float], FlightState],
    end: float,
    output_step: float,
    form: str,
    method: str,
    rtol: float,
    reason: str,
) -> xr.Dataset:
    """The Dataset of a flight."""
    import xarray as xr

    times = np.arange(0.0, end, output_step)
    if not len(times) or end - times[-1] > 1e-9 * max(end, 1.0):
        times = np.append(times, end)
    else:
        times[-1] = end
    rows, places, attitudes, given = [], [], [], []
    for time in times:
        state = state_at(float(time))
        rows.append(flight.observed_state(float(time), state))
        places.append(state.position)
        attitudes.append(state.attitude)
        given.append(dict(controls_at(flight.controls, float(time), lambda state=state: state)))
    data = {
        name: ("time", np.array([row[name] for row in rows]), {"units": unit, "long_name": meaning})
        for name, (unit, meaning) in QUANTITIES.items()
    }
    data["position"] = (
        ("time", "axis"), np.array(places), {"units": "m", "long_name": "from the centre, planet-fixed axes"},
    )  # fmt: skip
    data["attitude"] = (
        ("time", "component"), np.array(attitudes),
        {"units": "1", "long_name": "quaternion of the body axes against the planet-fixed axes, scalar first"},
    )  # fmt: skip
    for name in dict.fromkeys(name for one in given for name in one):
        unit = "N m" if name in MOMENT_INPUTS else "rad"
        meaning = "moment of thrusters" if name in MOMENT_INPUTS else "deflection"
        values = np.array([float(one.get(name, 0.0)) for one in given])
        data[f"control_{name}"] = ("time", values, {"units": unit, "long_name": f"{meaning}: {name}"})
    return xr.Dataset(
        data,
        coords={
            "time": ("time", times, {"units": "s"}),
            "axis": ["x", "y", "z"],
            "component": ["w", "x", "y", "z"],
        },
        attrs={
            "planet": flight.planet.name,
            "form": form,
            "method": method,
            "relative_tolerance": rtol,
            "ended": reason,
            "axes": "body axes x forward, y right, z down; planet-fixed axes x at longitude 0, z north",
        },
    )


def _check(
    duration: float, output_step: float, rtol: float, max_step: float, breaks: Sequence[float], form: str, method: str
) -> None:
    """Refuse what `simulate` cannot take."""
    for name, value in (("duration", duration), ("output_step", output_step), ("max_step", max_step)):
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"{name} = {value} s: must be a finite number above 0")
    if duration / output_step > 1e6:
        raise InputError(f"output_step = {output_step:g} s: more than a million times in {duration:g} s")
    if not 1e-13 <= rtol <= 1e-2:
        raise InputError(f"rtol = {rtol}: must lie between 1e-13 and 1e-2")
    for time in breaks:
        if not math.isfinite(time):
            raise InputError(f"breaks = {time} s: must be finite numbers")
    if form not in FORMS:
        raise InputError(unknown_name("form of the equations of motion", form, FORMS))
    if method not in METHODS:
        raise InputError(unknown_name("method of integration", method, METHODS))
