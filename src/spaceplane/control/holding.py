"""The largest disturbance that limited controls can still bring back, whatever the control law.

Of a linear system with limited inputs exactly those states can be brought to rest whose unstable part lies inside the
set that it reaches in reversed time (Hu and Lin, Control Systems with Actuator Saturation, 2001, chapter 2):

    z = -integral of exp(-A t) B u(t) dt,  u within its limits.

For one real root l this is |z| < b u_max / l. In general it is a linear programme in the history of the inputs, taken
constant over short pieces: every history is admissible, so the answer is on the safe side.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm
from scipy.optimize import linprog

from spaceplane.control.authority import Authority, chosen
from spaceplane.control.subspaces import Part, unstable_part
from spaceplane.dynamics.response import checked_state
from spaceplane.dynamics.statespace import MOMENT_INPUTS, StateSpace
from spaceplane.errors import InputError, unknown_name

# A piece lasts this share of the time scale of the fastest mode still felt.
_PIECE = 0.08
# exp(-12): what comes later no longer matters.
_FADED = 12.0


@dataclass(frozen=True)
class Held:
    """How far a disturbance may go.

    Attributes:
        low, high: the multiples of the direction asked for between which it can be held; infinite where nothing grows.
    """

    low: float
    high: float


def largest_held(system: StateSpace, limits: Authority, direction: Mapping[str, float], floor: float = 0.0) -> Held:
    """How large an offset of states may be for the controls to bring its unstable part back.

    Args:
        system: the system.
        limits: inputs and what they may do.
        direction: {"alpha": 1.0}, say: the answer is then in rad of angle of attack, with all other states at trim.
        floor: modes that grow more slowly, 1/s, are left to slower means.

    Raises:
        InputError: an unknown state, or no direction.
    """
    plant = chosen(system, limits.inputs)
    along = checked_state(plant, direction)
    if not along.any():
        raise InputError("direction: names no state that moves")
    part = unstable_part(plant, floor)
    target = part.rows @ along
    reference = np.abs(part.rows) @ np.abs(along)
    if not len(part.A) or (np.abs(target) <= 1e-12 * np.maximum(reference, 1e-300)).all():
        return Held(-math.inf, math.inf)
    # Inputs in units of their limits: the solver drops coefficients that are small only by their units.
    size = np.maximum(np.abs(limits.low), np.abs(limits.high))
    columns = _reached(part) * size[:, None]
    norm = np.abs(columns).sum(axis=(1, 2)) + np.abs(target)
    matrix = np.column_stack([target / norm, columns.reshape(len(target), -1) / norm[:, None]])
    pieces = columns.shape[2]
    ranges = zip(limits.low / size, limits.high / size, strict=True)
    bounds = [(None, None)] + [pair for pair in ranges for _ in range(pieces)]
    ends = []
    for sign in (1.0, -1.0):
        cost = np.zeros(matrix.shape[1])
        cost[0] = -sign
        found = linprog(cost, A_eq=matrix, b_eq=np.zeros(len(target)), bounds=bounds, method="highs")
        ends.append(float(found.x[0]) if found.status == 0 else sign * math.inf)
    return Held(min(ends), max(ends))


def thruster_to_hold(
    system: StateSpace, limits: Authority, offsets: Mapping[str, float], thruster: str, floor: float = 0.0
) -> float:
    """Least moment of a thruster, N m either way, with which an offset can be brought back beside the other inputs.

    Args:
        system: the system, with the thruster's moment among its inputs.
        limits: of the other inputs.
        offsets: {"beta": offset, ...}, SI units and rad.
        thruster: `moment_x`, `moment_y` or `moment_z`.
        floor: modes that grow more slowly, 1/s, are left to slower means.

    Returns:
        0 where the other inputs suffice; infinite where no moment about that axis helps.

    Raises:
        InputError: an unknown name, or a thruster that is among the limited inputs.
    """
    if thruster not in MOMENT_INPUTS:
        raise InputError(unknown_name("thruster", thruster, MOMENT_INPUTS))
    if thruster in limits.inputs:
        raise InputError(f"{thruster}: is among the limited inputs already")
    plant = chosen(system, (*limits.inputs, thruster))
    part = unstable_part(plant, floor)
    target = part.rows @ checked_state(plant, offsets)
    if not len(part.A) or not target.any():
        return 0.0
    columns = _reached(part)
    inputs, pieces = columns.shape[1:]
    # The thruster counts in units of the moment that would turn the first coordinate back alone.
    unit = float(np.abs(target).max() / max(np.abs(columns[:, -1]).sum(axis=-1).max(), 1e-300))
    columns[:, -1] *= unit
    norm = np.abs(target) + np.abs(columns[:, -1]).sum(axis=-1)
    matrix = np.column_stack([columns.reshape(len(target), -1) / norm[:, None], np.zeros(len(target))])
    bounds = [pair for pair in zip(limits.low, limits.high, strict=True) for _ in range(pieces)]
    bounds += [(None, None)] * pieces + [(0.0, None)]
    rows = np.zeros((2 * pieces, matrix.shape[1]))
    own = np.arange((inputs - 1) * pieces, inputs * pieces)
    rows[np.arange(pieces), own], rows[pieces + np.arange(pieces), own] = 1.0, -1.0
    rows[:, -1] = -1.0
    cost = np.zeros(matrix.shape[1])
    cost[-1] = 1.0
    found = linprog(cost, rows, np.zeros(2 * pieces), A_eq=matrix, b_eq=-target / norm, bounds=bounds, method="highs")
    return float(found.x[-1]) * unit if found.status == 0 else math.inf


def _reached(part: Part) -> np.ndarray:
    """[coordinate, input, piece] integral of exp(-A t) B over each piece of time."""
    values = np.linalg.eigvals(part.A)
    k = len(part.A)
    known: dict[float, tuple[np.ndarray, np.ndarray]] = {}
    time, carry, columns = 0.0, np.eye(k), []
    while True:
        alive = values[values.real * time < _FADED]
        if not len(alive):
            return np.stack(columns, axis=-1)
        length = _PIECE / np.abs(alive).max()
        if length not in known:
            block = np.zeros((2 * k, 2 * k))
            block[:k, :k], block[:k, k:] = -part.A, np.eye(k)
            both = expm(block * length)
            known[length] = both[:k, :k], both[:k, k:] @ part.B
        step, piece = known[length]
        columns.append(carry @ piece)
        carry = carry @ step
        time += length
