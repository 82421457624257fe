"""The unstable part of a linear system: its coordinates z = L x with dz/dt = A z + B u."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import matrix_balance, schur

from spaceplane.dynamics.statespace import StateSpace
from spaceplane.errors import InputError


@dataclass(frozen=True)
class Part:
    """An invariant part of a system.

    Attributes:
        rows: [coordinate, state] L; its rows span the left eigenvectors.
        A: [coordinate, coordinate], 1/s.
        B: [coordinate, input].
    """

    rows: np.ndarray
    A: np.ndarray
    B: np.ndarray


def unstable_part(system: StateSpace, floor: float = 0.0) -> Part:
    """What grows faster than `floor`, 1/s; no coordinates where nothing does.

    From the ordered real Schur form of the transposed, balanced matrix.

    Raises:
        InputError: the floor is not a finite number.
    """
    return _part(system, floor, "rhp")


def stable_part(system: StateSpace, floor: float = 0.0) -> Part:
    """What grows more slowly than `floor`, 1/s, or decays."""
    return _part(system, floor, "lhp")


def balancing(system: StateSpace) -> np.ndarray:
    """[state] scales that make rows and columns of A alike: x = scales * x_balanced."""
    _, (scales, _) = matrix_balance(system.A, permute=False, separate=True)
    return scales


def _part(system: StateSpace, floor: float, half: str) -> Part:
    if not math.isfinite(floor):
        raise InputError(f"floor = {floor}: must be a finite number, 1/s")
    scales = balancing(system)
    n = len(system.states)
    balanced = system.A / scales[:, None] * scales[None, :] - floor * np.eye(n)
    T, Q, k = schur(balanced.T, output="real", sort=half)
    rows = Q[:, :k].T / scales[None, :]
    return Part(rows, T[:k, :k].T + floor * np.eye(k), rows @ system.B)
