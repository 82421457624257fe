"""Which eigenmode of one vehicle is which of another: by motion and eigenvalue, never by order in a list."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from spaceplane.environment.constants import STANDARD_GRAVITY

EIGENVALUE_FLOOR = 1e-3  # 1/s: modes slower than this (a quarter of an hour) are compared by their motion alone
UNMATCHED = 0.5  # cost of leaving one mode of a pair alone; a pair must cost less than two of these


@dataclass(frozen=True)
class Pair:
    """Two modes held to be the same, or one without a counterpart.

    Attributes:
        first: index in the first list, or None.
        second: index in the second list, or None.
        similarity: modal assurance criterion of the two eigenvectors, 0 to 1; None without a counterpart.
    """

    first: int | None
    second: int | None
    similarity: float | None


def match_modes(first: Sequence[dict], second: Sequence[dict], speed_first: float, speed_second: float) -> list[Pair]:
    """Pair the modes of two vehicles or flight points.

    The cost of a pair is the sum of 1 - MAC and of the eigenvalues' distance relative to their sizes, both 0 to 1; the
    assignment with the least total is taken (Hungarian method). MAC is the modal assurance criterion
    |x* y|^2 / (|x|^2 |y|^2) of Allemang and Brown (1982), on eigenvectors made dimensionless with speed and gravity.

    Args:
        first, second: modes as in result.json ("eigenvalue": [re, im], "eigenvector": {state: {magnitude, phase_deg}}).
        speed_first, speed_second: flight speeds, m/s.

    Returns:
        Pairs in the order of `first`, then what is left of `second`.
    """
    mac = np.array([[_mac(a, b, speed_first, speed_second) for b in second] for a in first])
    mac = mac.reshape(len(first), len(second))
    gap = np.array([[_gap(a, b) for b in second] for a in first]).reshape(len(first), len(second))
    size = len(first) + len(second)
    cost = np.full((size, size), UNMATCHED)
    cost[len(first) :, len(second) :] = 0.0
    cost[: len(first), : len(second)] = 1.0 - mac + gap
    rows, columns = linear_sum_assignment(cost)
    partner = {int(i): int(j) for i, j in zip(rows, columns, strict=True) if i < len(first) and j < len(second)}
    pairs = [Pair(i, partner.get(i), float(mac[i, partner[i]]) if i in partner else None) for i in range(len(first))]
    taken = set(partner.values())
    return pairs + [Pair(None, j, None) for j in range(len(second)) if j not in taken]


def _gap(a: dict, b: dict) -> float:
    x, y = _eigenvalue(a), _eigenvalue(b)
    return abs(x - y) / (abs(x) + abs(y) + EIGENVALUE_FLOOR)


def _mac(a: dict, b: dict, speed_a: float, speed_b: float) -> float:
    states = [name for name in a["eigenvector"] if name in b["eigenvector"]]
    x, y = _vector(a, states, speed_a), _vector(b, states, speed_b)
    size = np.vdot(x, x).real * np.vdot(y, y).real
    return float(abs(np.vdot(x, y)) ** 2 / size) if size > 0 else 0.0


def _vector(mode: dict, states: list[str], speed: float) -> np.ndarray:
    entries = []
    for name in states:
        entry = mode["eigenvector"][name]
        phase = math.radians(entry["phase_deg"] or 0.0)
        entries.append((entry["magnitude"] or 0.0) / _scale(name, speed) * complex(math.cos(phase), math.sin(phase)))
    vector = np.array(entries)
    return vector.conj() if mode["eigenvalue"][1] < 0 else vector


def _scale(state: str, speed: float) -> float:
    if state == "V":
        return speed
    if state == "R":
        return speed**2 / STANDARD_GRAVITY
    return 1.0


def _eigenvalue(mode: dict) -> complex:
    re, im = mode["eigenvalue"]
    return complex(re, abs(im))
