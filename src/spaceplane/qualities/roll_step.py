"""Answer of the lateral part of the linear model to a step of the aileron, exact: states p, r, beta, sigma."""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import expm

from spaceplane.dynamics.statespace import StateSpace
from spaceplane.errors import InputError

LATERAL = ("p", "r", "beta", "sigma")
LARGEST = 1e75  # rad and rad/s per rad; its square can still be multiplied


def lateral_part(system: StateSpace) -> tuple[np.ndarray, np.ndarray] | None:
    """A [4, 4] and the column of B [4] of an aileron that rolls to the right, or None where no aileron rolls.

    Args:
        system: rigid-body linear model; states as in `LATERAL` and others, which are held.

    Raises:
        InputError: the system lacks a lateral state.
    """
    missing = [name for name in LATERAL if name not in system.states]
    if missing:
        raise InputError(f"system: lacks the states {', '.join(missing)}")
    if "aileron" not in system.inputs:
        return None
    rows = [system.index(name) for name in LATERAL]
    b = system.B[rows, system.inputs.index("aileron")]
    return None if b[0] == 0.0 else (system.A[np.ix_(rows, rows)], math.copysign(1.0, b[0]) * b)


def step_states(A: np.ndarray, b: np.ndarray, step: float, doublings: int) -> np.ndarray:
    """[state, time] after a unit step at time 0 from rest, at 2^doublings times `step`, s, apart; exact.

    Fewer doublings where the next would grow beyond `LARGEST`: a fast divergence.
    """
    n = len(b)
    augmented = np.zeros((n + 1, n + 1))
    augmented[:n, :n], augmented[:n, n] = A, b
    power = expm(augmented * step)
    states = np.zeros((n + 1, 1))
    states[n] = 1.0
    for _ in range(doublings):
        if np.abs(power).max() > LARGEST:
            break
        states, power = np.hstack([states, power @ states]), power @ power
    return states[:n]


def roll_row(system: StateSpace) -> np.ndarray:
    """[4] row that gives the roll rate about the velocity, p cos(alpha) + r sin(alpha), from the lateral states."""
    alpha = system.reference.get("alpha", 0.0)
    return np.array([math.cos(alpha), math.sin(alpha), 0.0, 0.0])
