"""Controllability Gramians, of unstable systems too, and the least energy that brings a disturbance to rest.

Inputs count in units of what they may do (`Authority.scale`), so that an energy of 1 s is one input at its limit for a
second.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from scipy.linalg import expm, solve_continuous_lyapunov

from spaceplane.control.authority import Authority, chosen
from spaceplane.control.subspaces import stable_part, unstable_part
from spaceplane.dynamics.modes import NEUTRAL_TOLERANCE
from spaceplane.dynamics.response import checked_state
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.errors import InputError


def finite_horizon(system: StateSpace, limits: Authority, horizon: float) -> np.ndarray:
    """[state, state] integral over `horizon`, s, of exp(A t) B B' exp(A' t): exact, by Van Loan (1978) and doubling.

    States are reached from rest with the energy x' W^-1 x.

    Raises:
        InputError: the horizon is not above 0.
    """
    if not (math.isfinite(horizon) and horizon > 0):
        raise InputError(f"horizon = {horizon}: must be above 0 s")
    A, B = system.A, _scaled(system, limits)
    n = len(A)
    doublings = max(0, math.ceil(math.log2(max(np.linalg.norm(A, 1) * horizon, 1e-300))))
    short = horizon / 2**doublings
    block = expm(np.block([[-A, B @ B.T], [np.zeros((n, n)), A.T]]) * short)
    carry = block[n:, n:].T
    gramian = carry @ block[:n, n:]
    for _ in range(doublings):
        gramian = gramian + carry @ gramian @ carry.T
        carry = carry @ carry
    return (gramian + gramian.T) / 2


def split_gramian(system: StateSpace, limits: Authority) -> np.ndarray:
    """[state, state] Gramian of a system with stable and unstable modes (Zhou, Salomon and Wu 1999).

    The stable part has the usual infinite-horizon Gramian, the unstable part that of reversed time. It equals
    the integral of (i w - A)^-1 B B' (-i w - A')^-1 over w / 2 pi.

    Raises:
        InputError: an eigenvalue lies on the imaginary axis.
    """
    scale = limits.scale()
    plant = chosen(system, limits.inputs)
    grow, decay = unstable_part(plant), stable_part(plant)
    values = np.linalg.eigvals(plant.A)
    neutral = np.abs(values.real) <= NEUTRAL_TOLERANCE * np.abs(values).max(initial=0.0)
    if neutral.any() or len(grow.A) + len(decay.A) != len(values):
        raise InputError("Gramian: a mode is neutral, so the integral over all time does not exist; give a horizon")
    basis = np.linalg.inv(np.vstack([decay.rows, grow.rows]))
    k = len(decay.A)
    total = np.zeros_like(system.A)
    for part, sign, columns in ((decay, 1.0, basis[:, :k]), (grow, -1.0, basis[:, k:])):
        if len(part.A):
            B = part.B * scale
            total = total + columns @ solve_continuous_lyapunov(sign * part.A, -B @ B.T) @ columns.T
    return (total + total.T) / 2


def energy_to_rest(system: StateSpace, limits: Authority, offsets: Mapping[str, float], floor: float = 0.0) -> float:
    """Least energy, s, of any control that brings the unstable part of an offset to rest: z' P^-1 z.

    P is the Gramian of the unstable part in reversed time. The feedback that needs just this much is
    `regulator.minimum_effort`. Infinite where the inputs do not reach the unstable part.

    Args:
        system: the system.
        limits: inputs and what they may do.
        offsets: {"alpha": offset, ...}, SI units and rad.
        floor: modes that grow more slowly, 1/s, are left alone.
    """
    scale = limits.scale()
    plant = chosen(system, limits.inputs)
    part = unstable_part(plant, floor)
    if not len(part.A):
        return 0.0
    z = part.rows @ checked_state(plant, offsets)
    B = part.B * scale
    gramian = solve_continuous_lyapunov(-part.A, -B @ B.T)
    values = np.linalg.eigvalsh(gramian)
    if values[0] <= 1e-13 * values[-1]:
        return math.inf
    return float(z @ np.linalg.solve(gramian, z))


def _scaled(system: StateSpace, limits: Authority) -> np.ndarray:
    return chosen(system, limits.inputs).B * limits.scale()
