"""Time responses of a linear system: to an offset, a step, a doublet, any inputs that are constant piece by piece.

Exact at every time asked for: between two times the state is carried by the matrix exponential of the system with its
inputs as further, constant states (Van Loan 1978), so there is no step size.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import expm

from spaceplane.dynamics.statespace import MOMENT_INPUTS, STATE_UNITS, StateSpace
from spaceplane.errors import InputError, unknown_name

if TYPE_CHECKING:
    import xarray as xr

Pieces = Sequence[tuple[float, float]]


def free(system: StateSpace, initial: Mapping[str, float], times: Sequence[float]) -> xr.Dataset:
    """Response to an initial condition with the controls fixed, see `respond`.

    Args:
        system: the system.
        initial: offsets of states from the flight point, SI units and rad.
        times: s.
    """
    return respond(system, times, initial=initial)


def step(system: StateSpace, control: str, amplitude: float, times: Sequence[float], start: float = 0.0) -> xr.Dataset:
    """Response to an input that is set at `start`, s, and kept, see `respond`.

    Args:
        system: the system.
        control: name of the input.
        amplitude: rad, or N m for a moment.
        times: s.
        start: s.
    """
    return respond(system, times, {control: [(start, amplitude)]})


def doublet(
    system: StateSpace,
    control: str,
    amplitude: float,
    duration: float,
    times: Sequence[float],
    start: float = 0.0,
) -> xr.Dataset:
    """Response to an input of `amplitude` for half the duration, of the opposite sign for the other, then zero.

    Args:
        system: the system.
        control: name of the input.
        amplitude: rad, or N m for a moment.
        duration: s, of both halves together.
        times: s.
        start: s.

    Raises:
        InputError: the duration is not above 0, or as `respond`.
    """
    if not duration > 0:
        raise InputError(f"duration = {duration}: must be above 0 s")
    pieces = [(start, amplitude), (start + duration / 2, -amplitude), (start + duration, 0.0)]
    return respond(system, times, {control: pieces})


def respond(
    system: StateSpace,
    times: Sequence[float],
    inputs: Mapping[str, Pieces] | None = None,
    initial: Mapping[str, float] | None = None,
) -> xr.Dataset:
    """Response to an initial condition and to inputs that are constant piece by piece.

    Args:
        system: the system.
        times: increasing, from 0 or later, s; the initial condition is that of t = 0.
        inputs: {"elevator": [(from time s, value), ...]}, rad or N m; zero before the first piece.
        initial: {"alpha": offset from the flight point, ...}, SI units and rad.

    Returns:
        Dims (time); one variable for each state and input. An input has its new value at the time of the change.

    Raises:
        InputError: an unknown state or input, times or pieces that do not increase, a value that is not finite.
    """
    import xarray as xr

    moments = checked_times(times)
    start = checked_state(system, initial or {})
    pieces = _checked_pieces(system, inputs or {})
    changes = sorted({time for steps in pieces.values() for time, _ in steps})
    n, m = len(system.states), len(system.inputs)
    extended = np.zeros((n + m, n + m))
    extended[:n, :n], extended[:n, n:] = system.A, system.B
    carry = Propagator(extended)
    stops = sorted({0.0, *moments.tolist(), *(t for t in changes if 0.0 < t <= moments[-1])})
    state, history = np.concatenate([start, _inputs_at(system, pieces, 0.0)]), {}
    for k, time in enumerate(stops):
        if k:
            state = carry(state, time - stops[k - 1])
            state[n:] = _inputs_at(system, pieces, time)
        history[time] = state
    table = np.array([history[time] for time in moments.tolist()])
    names = (*system.states, *system.inputs)
    roles = ["state"] * n + ["input"] * m
    return xr.Dataset(
        {
            name: ("time", table[:, k], {"units": unit_of(name), "role": role})
            for k, (name, role) in enumerate(zip(names, roles, strict=True))
        },
        coords={"time": ("time", moments, {"units": "s"})},
    )


class Propagator:
    """exp(A t) times a state, each different t computed once.

    Args:
        A: [state, state] of dx/dt = A x.
    """

    def __init__(self, A: np.ndarray) -> None:
        self.A = A
        self._known: dict[float, np.ndarray] = {}

    def __call__(self, state: np.ndarray, time: float) -> np.ndarray:
        """The state, [state], a `time`, s, later."""
        key = float(f"{time:.12e}")  # differences of equally spaced times differ by round-off
        if key not in self._known:
            self._known[key] = expm(self.A * key)
        return self._known[key] @ state


def unit_of(name: str) -> str:
    """Unit of a state or input of the usual names; rad for a control, empty if unknown."""
    if name in MOMENT_INPUTS:
        return "N m"
    units = {**STATE_UNITS, "u": "m/s", "v": "m/s", "w": "m/s", "theta": "rad", "phi": "rad", "psi": "rad", "h": "m"}
    return units.get(name, "rad")


def checked_times(times: Sequence[float]) -> np.ndarray:
    """[time] s, finite, increasing, from 0 on.

    Raises:
        InputError: they are not.
    """
    moments = np.asarray(times, dtype=float)
    increasing = moments.ndim == 1 and len(moments) and np.isfinite(moments).all() and (np.diff(moments) > 0).all()
    if not increasing or moments[0] < 0:
        raise InputError("times: must be finite, increasing and not below 0 s")
    return moments


def checked_state(system: StateSpace, offsets: Mapping[str, float]) -> np.ndarray:
    """[state] offsets by name, zero where not named.

    Raises:
        InputError: an unknown state or a value that is not finite.
    """
    state = np.zeros(len(system.states))
    for name, value in offsets.items():
        if name not in system.states:
            raise InputError(unknown_name("state", name, system.states))
        if not np.isfinite(value):
            raise InputError(f"{name} = {value}: must be a finite number")
        state[system.index(name)] = value
    return state


def _checked_pieces(system: StateSpace, inputs: Mapping[str, Pieces]) -> dict[str, list[tuple[float, float]]]:
    checked = {}
    for name, pieces in inputs.items():
        if name not in system.inputs:
            raise InputError(unknown_name("input", name, system.inputs))
        rows = [(float(time), float(value)) for time, value in pieces]
        if not np.isfinite(rows).all() or any(a >= b for (a, _), (b, _) in pairwise(rows)):
            raise InputError(f"{name}: pieces must be finite and their times increase")
        checked[name] = rows
    return checked


def _inputs_at(system: StateSpace, pieces: Mapping[str, Pieces], time: float) -> np.ndarray:
    values = np.zeros(len(system.inputs))
    for name, rows in pieces.items():
        past = [value for start, value in rows if start <= time]
        values[system.inputs.index(name)] = past[-1] if past else 0.0
    return values
