"""Fuselage with nosecone and spherical nose."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from spaceplane.vehicle.layout import Layout
from spaceplane.vehicle.lofts import CAMBER, Shell, capped_loft

CHINE_ROUNDING = 0.3  # m, length taken off both legs of the chine's corner
NOSE_CAP_RADII = 2.0  # the part called nose ends this many nose radii behind the tip


def nose_end(layout: Layout) -> float:
    """Station where the part `nose` ends and `fuselage` begins, m."""
    return NOSE_CAP_RADII * layout.shape.nose_radius_m


def _bezier(points: list[tuple[float, float]], count: int) -> np.ndarray:
    """[count, yz] points of a quadratic or cubic Bezier curve."""
    t = np.linspace(0.0, 1.0, count)[:, None]
    p = [np.array(x, dtype=float) for x in points]
    while len(p) > 1:
        p = [a + t * (b - a) for a, b in pairwise(p)]
    return p[0]


def constant_section(layout: Layout, count: int) -> np.ndarray:
    """The section behind the nosecone.

    Underside parabola, rounded chine, straight side wall leaning inwards, arch tangent to the wall.

    Returns:
        [count, yz] points evenly spaced round the whole section, y in m, z in m above the keel; `count` is even and no
        point lies on the symmetry plane, so that the plane cuts edges only.
    """
    s = layout.shape
    half, top = layout.chine, layout.section_height
    zc = float(layout.underside(half))
    zt = zc + s.fuselage_height_m
    wall = np.array([s.fuselage_width_m - half, s.fuselage_height_m])
    reach = float(np.hypot(*wall))
    rounding = min(CHINE_ROUNDING, 0.4 * reach)
    inner = half - rounding
    bottom = np.stack([np.linspace(0, inner, 60), layout.underside(np.linspace(0, inner, 60))], -1)
    end_of_round = np.array([half, zc]) + wall * rounding / reach
    slope = 2 * float(layout.underside(inner)) / inner
    handle = (half, bottom[-1, 1] + slope * rounding)
    chine = _bezier([tuple(bottom[-1]), handle, (half, zc), tuple(end_of_round)], 24)
    # Handles of a quarter ellipse, the lower one along the wall so that wall and arch share a tangent.
    kappa = 0.5523
    handle = (s.fuselage_width_m + wall[0] / wall[1] * kappa * (top - zt), zt + kappa * (top - zt))
    arch = _bezier([(s.fuselage_width_m, zt), handle, (kappa * s.fuselage_width_m, top), (0.0, top)], 80)
    right = np.concatenate([bottom, chine[1:], arch])
    right[:, 0] *= half / right[:, 0].max()
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(right, axis=0), axis=1))])
    at = (np.arange(count // 2) + 0.5) * along[-1] / (count // 2)
    right = np.stack([np.interp(at, along, right[:, k]) for k in range(2)], -1)
    return np.concatenate([right, right[::-1] * [-1, 1]])


def _stations(layout: Layout, spacing: float) -> np.ndarray:
    """x behind the sphere, finer near the nose, with one station at the end of the part `nose`."""
    start, stop = layout.nose.x_join, layout.x_base
    fine, coarse = 0.4 * spacing, 1.3 * spacing
    x = [start]
    while x[-1] < stop:
        x.append(x[-1] + min(coarse, fine + 0.08 * (x[-1] - start)))
    stations = start + (np.array(x) - start) * (stop - start) / (x[-1] - start)
    cut = nose_end(layout)
    nearest = int(np.argmin(np.abs(stations - cut)))
    if 0 < nearest < len(stations) - 1:
        stations[nearest] = cut
    return stations


def fuselage_shell(layout: Layout, spacing: float) -> Shell:
    """Closed fuselage, both halves, symmetric in y.

    Args:
        layout: derived dimensions.
        spacing: triangle size wanted, m.
    """
    grid = fuselage_grid(layout, spacing)
    base = _base_rings(grid[-1], spacing)
    return capped_loft(np.concatenate([grid, base]), nose_tip(layout), base[-1].mean(axis=0))


def nose_tip(layout: Layout) -> np.ndarray:
    """[xyz] foremost point of the sphere, m."""
    return np.array([0.0, 0.0, layout.z_nose])


def fuselage_grid(layout: Layout, spacing: float) -> np.ndarray:
    """[station, point, xyz] sections from just behind the nose tip to the rim of the base, m."""
    shape, nose = layout.shape, layout.nose
    perimeter = 2 * (layout.chine + layout.section_height + layout.chine)
    count = 2 * int(np.ceil(0.5 * perimeter / spacing))
    section = constant_section(layout, count)
    body = section / [layout.chine, layout.section_height]
    angle = np.arctan2(body[:, 1] - 0.5, 0.5 * body[:, 0])
    circle = np.stack([np.cos(angle), 0.5 + 0.5 * np.sin(angle)], -1)

    x = _stations(layout, spacing)
    xi = np.clip((x - nose.x_join) / (shape.nosecone_length_m - nose.x_join), 0.0, 1.0)
    keel_0 = shape.nosecone_height_m - nose.r_join
    crown_0 = shape.nosecone_height_m + nose.r_join
    keel = keel_0 * (1 - xi) ** nose.exponents[0]
    crown = layout.section_height - (layout.section_height - crown_0) * (1 - xi) ** nose.exponents[1]
    half = layout.chine - (layout.chine - nose.r_join) * (1 - xi) ** nose.exponents[2]
    t = np.clip(xi / 0.75, 0, 1)
    morph = (t**2 * (3 - 2 * t))[:, None, None]
    unit = (1 - morph) * circle + morph * body
    # Circle and body are widest at different points; keep the planform at the half-width all the same.
    widest = (1 - morph[:, 0, 0]) * circle[:, 0].max() + morph[:, 0, 0] * body[:, 0].max()
    unit[..., 0] *= (widest / unit[..., 0].max(axis=1))[:, None]
    grid = np.empty((len(x), count, 3))
    grid[..., 0] = x[:, None]
    grid[..., 1] = half[:, None] * unit[..., 0]
    grid[..., 2] = keel[:, None] + (crown - keel)[:, None] * unit[..., 1] + layout.z_keel

    t = np.clip((x - shape.nosecone_length_m) / shape.fuselage_length_m, 0, 1)
    grid[..., 1:] *= 1 + CAMBER * (t * (1 - t))[:, None, None]
    return np.concatenate([_nose_rings(layout, angle, spacing), grid])


def _nose_rings(layout: Layout, angle: np.ndarray, spacing: float) -> np.ndarray:
    """[ring, point, xyz] rings on the sphere from near the tip to just ahead of the join."""
    radius = layout.shape.nose_radius_m
    end = np.arccos(1 - layout.nose.x_join / radius)
    rings = max(6, int(np.ceil(end * radius / (0.5 * spacing))))
    polar = end * np.arange(1, rings) / rings
    cap = np.empty((len(polar), len(angle), 3))
    cap[..., 0] = (radius * (1 - np.cos(polar)))[:, None]
    cap[..., 1] = radius * np.sin(polar)[:, None] * np.cos(angle)
    cap[..., 2] = layout.z_nose + radius * np.sin(polar)[:, None] * np.sin(angle)
    return cap


def _base_rings(rim: np.ndarray, spacing: float) -> np.ndarray:
    """[ring, point, xyz] rings that fill the flat base without long triangles."""
    centre = rim.mean(axis=0)
    centre[1] = 0.0
    rings = max(4, int(0.5 * np.ptp(rim[:, 1]) / (1.5 * spacing)))
    scale = 1 - np.arange(1, rings) / rings
    base = centre + scale[:, None, None] * (rim - centre)
    base[..., 0] += 10 * CAMBER * (1 - scale[:, None] ** 2)
    return base
