"""Stabilising feedback u = -K x: with the least effort, or with Bryson's weights."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_continuous_are, solve_continuous_lyapunov

from spaceplane.control.authority import Authority, chosen
from spaceplane.control.measures import modal_control
from spaceplane.control.subspaces import unstable_part
from spaceplane.dynamics.response import checked_state
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.errors import InputError


@dataclass(frozen=True)
class Regulator:
    """State feedback u = -K x.

    Attributes:
        kind: "minimum effort" or "Bryson".
        system: the open loop with the inputs that the feedback uses.
        gain: [input, state] K.
        limits: what the inputs may do.
    """

    kind: str
    system: StateSpace
    gain: np.ndarray
    limits: Authority

    def closed(self) -> StateSpace:
        """The closed loop; its inputs are commands added to the feedback's."""
        s = self.system
        return StateSpace(s.A - s.B @ self.gain, s.B, s.states, s.inputs, f"{s.form}, {self.kind}", s.reference)


def minimum_effort(system: StateSpace, limits: Authority, decay: float = 0.0) -> Regulator:
    """The stabilising feedback of least energy of the inputs, each in units of its limit.

    The limit of the linear quadratic regulator for vanishing weights of the states: eigenvalues to the right of
    -`decay` are mirrored at it, the others stay where they are (Kwakernaak and Sivan, Linear Optimal Control Systems,
    1972, section 3.8). With the unstable part dz/dt = A z + B u and its Gramian P in reversed time, A P + P A' = B B',
    the gain is B' P^-1 on z. A neutral mode is left neutral; give it a decay.

    Args:
        system: the open loop.
        limits: inputs and what they may do.
        decay: 1/s; everything shall decay at least so fast.

    Raises:
        InputError: the decay is negative, or a mode to be mirrored is out of reach of the inputs.
    """
    if not (math.isfinite(decay) and decay >= 0):
        raise InputError(f"decay = {decay}: must be 0 or above, 1/s")
    scale = limits.scale()
    plant = chosen(system, limits.inputs)
    gain = np.zeros((len(limits.inputs), len(plant.states)))
    part = unstable_part(plant, -decay)
    if len(part.A):
        _require_reach(plant, limits, decay)
        B = part.B * scale
        gramian = solve_continuous_lyapunov(part.A + decay * np.eye(len(part.A)), B @ B.T)
        gain = scale[:, None] * (B.T @ np.linalg.solve((gramian + gramian.T) / 2, part.rows))
    return Regulator("minimum effort", plant, gain, limits)


def bryson(system: StateSpace, limits: Authority, greatest: Mapping[str, float]) -> Regulator:
    """Linear quadratic regulator that weighs states by 1/greatest^2 and inputs by 1/limit^2 (Bryson and Ho 1975).

    Args:
        system: the open loop.
        limits: inputs and what they may do.
        greatest: {"alpha": acceptable excursion, ...}, SI units and rad; states not named count nothing.

    Raises:
        InputError: an unknown state, an excursion not above 0, or weights that leave a mode undecided.
    """
    scale = limits.scale()
    plant = chosen(system, limits.inputs)
    excursions = checked_state(plant, greatest)
    for name, value in greatest.items():
        if not value > 0:
            raise InputError(f"{name} = {value}: the acceptable excursion must be above 0")
    weights = np.diag([1.0 / x**2 if x > 0 else 0.0 for x in excursions])
    _require_reach(plant, limits, 0.0)
    B = plant.B * scale
    try:
        solution = solve_continuous_are(plant.A, B, weights, np.eye(len(scale)))
    except (np.linalg.LinAlgError, ValueError) as error:
        raise InputError(
            f"regulator: no solution; a mode on the imaginary axis moves none of {', '.join(greatest)} ({error})"
        ) from error
    return Regulator("Bryson", plant, scale[:, None] * (B.T @ solution), limits)


def _require_reach(plant: StateSpace, limits: Authority, decay: float) -> None:
    for entry in modal_control(plant, limits):
        if entry.mode.eigenvalue.real > -decay and entry.distance < 1e-12 * np.linalg.norm(plant.A):
            raise InputError(f"inputs = {', '.join(limits.inputs)}: cannot reach the {entry.mode.name}")
