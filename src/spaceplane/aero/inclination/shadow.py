"""Which panels other parts of the body hide from the stream.

Seen along the stream, a panel is hidden when its centroid lies behind a triangle that faces the stream. Each centroid
is tested against the triangles themselves, found through a grid of boxes: nothing is drawn into pixels, so that the
answer is exact at the centroid, a convex body hides nothing of itself to the last bit, and the panel's size is the only
resolution.
"""

from __future__ import annotations

import numpy as np

from spaceplane.aero.inclination.compiled import kernel
from spaceplane.aero.inclination.panels import Panels

GAP = 1e-6
"""A triangle hides what lies farther behind it than this fraction of the body's size."""
PER_BOX = 2.0
"""Centroids in a box of the grid, on average."""


def hidden(panels: Panels, wind: np.ndarray) -> np.ndarray:
    """[panel] whether a panel that faces the stream is hidden from it; panels that look away are not asked for.

    Args:
        panels: of a closed surface.
        wind: [xyz] unit vector of the stream.
    """
    surface = panels.surface
    across, up = _plane(wind)
    frame = np.stack([across, up, wind], axis=1)
    facing = np.flatnonzero(panels.normal @ wind < 0.0)
    front = np.flatnonzero(surface.area_vectors @ wind < 0.0)
    result = np.zeros(len(panels), dtype=bool)
    if not len(facing):
        return result
    points = surface.points @ frame
    size = float(np.ptp(surface.bounds, axis=0).max())
    result[facing] = _behind(panels.center[facing] @ frame, points, surface.triangles[front], GAP * size)
    return result


def _plane(wind: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors across the stream, the first across the plane of symmetry where there is one."""
    side = np.array([0.0, 1.0, 0.0]) if abs(wind[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    across = side - (side @ wind) * wind
    across /= np.linalg.norm(across)
    return across, np.cross(wind, across)


@kernel
def _behind(center, points, triangles, gap):
    """[center] whether one of the triangles covers the centre, more than `gap` before it; points are (u, v, depth)."""
    count = len(center)
    low_u, low_v = center[:, 0].min(), center[:, 1].min()
    wide, high = center[:, 0].max() - low_u, center[:, 1].max() - low_v
    box = max(np.sqrt(max(wide * high, 1e-300) * PER_BOX / count), max(wide, high) / 2048.0, 1e-300)
    columns, rows = int(wide / box) + 1, int(high / box) + 1
    # Centres sorted by box: those of box b are order[first[b]:first[b + 1]].
    first = np.zeros(columns * rows + 1, dtype=np.int64)
    own = np.empty(count, dtype=np.int64)
    for i in range(count):
        own[i] = int((center[i, 1] - low_v) / box) * columns + int((center[i, 0] - low_u) / box)
        first[own[i] + 1] += 1
    for b in range(columns * rows):
        first[b + 1] += first[b]
    free = first[:-1].copy()
    order = np.empty(count, dtype=np.int64)
    u, v, w = np.empty(count), np.empty(count), np.empty(count)
    for i in range(count):
        k = free[own[i]]
        free[own[i]] += 1
        order[k] = i
        u[k], v[k], w[k] = center[i, 0], center[i, 1], center[i, 2] - gap
    behind = np.zeros(count, dtype=np.bool_)
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        au, av, aw = points[a, 0], points[a, 1], points[a, 2]
        bu, bv, bw = points[b, 0] - au, points[b, 1] - av, points[b, 2] - aw
        cu, cv, cw = points[c, 0] - au, points[c, 1] - av, points[c, 2] - aw
        double = bu * cv - bv * cu
        if double == 0.0:
            continue
        left = max(int(np.floor((au + min(0.0, bu, cu) - low_u) / box)), 0)
        right = min(int(np.floor((au + max(0.0, bu, cu) - low_u) / box)), columns - 1)
        bottom = max(int(np.floor((av + min(0.0, bv, cv) - low_v) / box)), 0)
        top = min(int(np.floor((av + max(0.0, bv, cv) - low_v) / box)), rows - 1)
        if left > right:
            continue
        nearest = aw + min(0.0, bw, cw)
        for row in range(bottom, top + 1):
            for k in range(first[row * columns + left], first[row * columns + right + 1]):
                if behind[k] or w[k] <= nearest:
                    continue
                du, dv = u[k] - au, v[k] - av
                share_b = (du * cv - dv * cu) / double
                share_c = (bu * dv - bv * du) / double
                if share_b >= 0.0 and share_c >= 0.0 and share_b + share_c <= 1.0:
                    behind[k] = w[k] > aw + share_b * bw + share_c * cw
    result = np.zeros(count, dtype=np.bool_)
    for k in range(count):
        result[order[k]] = behind[k]
    return result
