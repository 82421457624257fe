"""The largest disturbance that limited controls can still bring back, whatever the control law.

Of a linear system with limited inputs exactly those states can be brought to rest whose unstable part lies inside the
set that it reaches in reversed time (Hu and Lin, Control Systems with Actuator Saturation, 2001, chapter 2):

    z = -integral of exp(-A t) B u(t) dt,  u within its limits.

For one real root l this is |z| < b u_max / l. In general the bound along a direction d is the least support h(c) of
the set over all c with c' d = 1, where h(c) is the integral of the greatest c' exp(-A t) B u. It is found by cutting
planes: each c gives the bang-bang history that reaches farthest along it, and the hull of these bounds the answer from
inside. Inputs are taken constant over short pieces of time, which is admissible, so the answer is on the safe side.
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
_PIECE = 0.1
# exp(-12): what comes later no longer matters.
_FADED = 12.0
# Cutting planes: relative width of the answer, most planes, and how far c may stray from its first guess.
_CLOSE = 1e-5
_MOST = 400
_FAR = 1e4


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
    size = np.abs(part.rows) @ np.abs(along)
    if not len(part.A) or (np.abs(target) <= 1e-12 * np.maximum(size, 1e-300)).all():
        return Held(-math.inf, math.inf)
    reached = _reached(part)
    ends = [_Hull(reached, sign * target).extent(limits.low, limits.high)[0] for sign in (-1.0, 1.0)]
    return Held(-ends[0], ends[1])


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
    hull = _Hull(_reached(part), target)
    low, high, moment = np.append(limits.low, 0.0), np.append(limits.high, 0.0), 0.0
    # The extent is concave in the moment, so Newton's method climbs to the least moment from below.
    for _ in range(_MOST):
        extent, along = hull.extent(low, high)
        if extent >= 1.0 - _CLOSE:
            return moment
        gain = hull.support(along, low * 0, np.append(0 * limits.high, 1.0), symmetric=True)
        if gain <= 1e-12 * hull.unit[-1]:
            return math.inf
        moment += max(1.0 - extent, _CLOSE) / gain
        low[-1], high[-1] = -moment, moment
    return math.inf


class _Hull:
    """The set of -z reached in reversed time, and how far it goes along a direction.

    Args:
        reached: [coordinate, input, piece] of `_reached`.
        direction: [coordinate].
    """

    def __init__(self, reached: np.ndarray, direction: np.ndarray) -> None:
        # Coordinates in which the set is about as wide one way as another, each input counted alike.
        self.unit = np.sqrt((reached**2).sum(axis=2)).max(axis=0)
        even = reached / np.maximum(self.unit, 1e-300)[:, None]
        flat = even.reshape(len(reached), -1)
        values, axes = np.linalg.eigh(flat @ flat.T)
        kept = values > 1e-15 * values[-1]
        whiten = axes[:, kept].T / np.sqrt(values[kept])[:, None]
        self.outside = bool(np.linalg.norm(axes[:, ~kept].T @ direction) > 1e-7 * np.linalg.norm(direction))
        self.columns = np.einsum("ck,kip->cip", whiten, reached)
        self.direction = whiten @ direction

    def support(self, along: np.ndarray, low: np.ndarray, high: np.ndarray, symmetric: bool = False) -> float:
        """h(c) for inputs between `low` and `high`, or within +-`high`."""
        push = np.einsum("c,cip->ip", along, -self.columns)
        least = -high if symmetric else low
        return float(np.maximum(push * least[:, None], push * high[:, None]).sum())

    def farthest(self, along: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """[coordinate] the point of the set that lies farthest along c."""
        push = np.einsum("c,cip->ip", along, -self.columns)
        history = np.where(push > 0, high[:, None], low[:, None])
        return -np.einsum("cip,ip->c", self.columns, history)

    def extent(self, low: np.ndarray, high: np.ndarray) -> tuple[float, np.ndarray]:
        """(greatest multiple of the direction in the set, the c of its supporting plane)."""
        size = float(self.direction @ self.direction)
        along = self.direction / size if size > 0 else self.direction
        if self.outside or size == 0:
            return 0.0, along
        n = len(along)
        # c in units of the first guess; the bounds only keep the first few planes finite.
        scale = np.linalg.norm(along)
        points, best, inner = [], (math.inf, along), 0.0
        for _ in range(_MOST):
            point = self.farthest(along, low, high)
            points.append(point)
            value = float(point @ along)
            if value < best[0]:
                best = value, along
            height = max(best[0], 1e-300)
            rows = np.column_stack([np.array(points) * scale / height, -np.ones(len(points))])
            equal = np.append(self.direction * scale, 0.0)[None, :]
            cost = np.append(np.zeros(n), 1.0)
            bounds = [(-_FAR, _FAR)] * n + [(None, None)]
            found = linprog(cost, rows, np.zeros(len(points)), equal, np.ones(1), bounds, method="highs")
            inner, along = float(found.x[-1]) * height, found.x[:n] * scale
            if best[0] - inner <= _CLOSE * best[0]:
                break
        return max(inner, 0.0), best[1]


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
