"""Zeros of functions that are linear between nodes: all of them, exactly."""

from __future__ import annotations

import numpy as np

ROUND_OFF = 1e-12
"""Values this small against the largest count as zero: sums of printed decimals that cancel."""


def zeros(x: np.ndarray, y: np.ndarray) -> list[float]:
    """Every x with y = 0, in increasing order; where y vanishes along an interval, its ends.

    Args:
        x: [node] increasing, in any unit.
        y: [node] values; an interval with a NaN at one end is left out.
    """
    if np.any(np.isfinite(y)):
        y = np.where(np.abs(y) <= ROUND_OFF * np.nanmax(np.abs(y)), 0.0, y)
    found = []
    for i in range(len(x) - 1):
        left, right = y[i], y[i + 1]
        if left == 0.0 and np.isfinite(right):
            found.append(float(x[i]))
        elif left * right < 0.0:
            found.append(float(x[i] - left * (x[i + 1] - x[i]) / (right - left)))
    if y[-1] == 0.0 and (len(x) == 1 or np.isfinite(y[-2])):
        found.append(float(x[-1]))
    for i in range(1, len(x) - 1):  # at the edge of what is known, from the left
        if y[i] == 0.0 and np.isfinite(y[i - 1]) and not np.isfinite(y[i + 1]):
            found.append(float(x[i]))
    return sorted(found)


def beyond(x: np.ndarray, y: np.ndarray) -> float | None:
    """The zero nearest to the ends when the slopes at both ends are continued outward; None where they lead away.

    Args:
        x: [node] increasing, in any unit.
        y: [node] values without a zero; nodes that are NaN are left out.
    """
    known = np.isfinite(y)
    x, y = x[known], y[known]
    if len(x) < 2:
        return None
    candidates = []
    for end, inner, outward in ((0, 1, -1.0), (-1, -2, 1.0)):
        slope = (y[end] - y[inner]) / (x[end] - x[inner])
        if slope != 0.0 and -y[end] / slope * outward > 0.0:
            candidates.append((abs(y[end] / slope), float(x[end] - y[end] / slope)))
    return min(candidates)[1] if candidates else None
