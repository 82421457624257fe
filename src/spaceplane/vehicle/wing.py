"""Right wing with strake, bend and winglet as one solid."""

from __future__ import annotations

import numpy as np

from spaceplane.vehicle.layout import STUB, Layout
from spaceplane.vehicle.lofts import CAMBER, Shell, profile_loft

NOSE_POINTS = 9  # on each quarter of the leading edge
APEX_RADIUS_RATIO = 0.3  # leading-edge radius at the strake's apex over that outboard: the apex grows out of the chine
APEX_GROWTH = 0.7  # m of span over which the radius reaches its full value
TIP_ROUNDING = 0.35  # m, over which the winglet's tip is rounded in plan


def section_profile(
    chord: np.ndarray, nose: np.ndarray, radius: np.ndarray, thick: np.ndarray, hinge: np.ndarray,
    hinge_thick: np.ndarray, edge: float, counts: tuple[int, int, int],
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Flat-bottomed sections with an elliptic nose, a smooth hump and a straight wedge behind the hinge.

    Args:
        chord: [station] m.
        nose: [station] length of the nose ellipse along the chord, m.
        radius: [station] half-height of the nose ellipse, m.
        thick: [station] largest thickness, m.
        hinge: [station] distance of the hinge ahead of the trailing edge, m.
        hinge_thick: [station] thickness there, m.
        edge: thickness of the trailing edge, m.
        counts: intervals on hump, between hump and hinge, and behind the hinge.

    Returns:
        x, z [station, point]: from lower trailing edge round the nose to the upper one; z above the flat lower skin.
    """
    x_hinge = chord - hinge
    x_top = np.minimum(0.35 * chord, 0.75 * x_hinge)
    x_top = np.maximum(x_top, nose + 0.15 * (x_hinge - nose))
    theta = np.linspace(0, np.pi / 2, NOSE_POINTS + 1)
    nose_x = nose[:, None] * (1 - np.sin(theta))  # from the end of the ellipse to the nose
    nose_z = radius[:, None] * (1 - np.cos(theta))
    wedge = (edge - hinge_thick) / hinge

    def hermite(x0, x1, z0, z1, d1, n):
        t = np.linspace(0, 1, n + 1)[1:]
        span = (x1 - x0)[:, None]
        rise = t**2 * (3 - 2 * t)
        return x0[:, None] + span * t, z0[:, None] + (z1 - z0)[:, None] * rise + span * d1[:, None] * (t**3 - t**2)

    hump = hermite(nose, x_top, 2 * radius, thick, np.zeros_like(nose), counts[0])
    rear = hermite(x_top, x_hinge, thick, hinge_thick, wedge, counts[1])
    t = np.linspace(0, 1, counts[2] + 1)[1:]
    tail = x_hinge[:, None] + hinge[:, None] * t, hinge_thick[:, None] + (edge - hinge_thick)[:, None] * t
    upper_x = np.concatenate([nose_x[:, ::-1], hump[0], rear[0], tail[0]], axis=1)
    upper_z = np.concatenate([2 * radius[:, None] - nose_z[:, ::-1], hump[1], rear[1], tail[1]], axis=1)
    lower_z = np.zeros_like(upper_z)
    lower_z[:, : NOSE_POINTS + 1] = nose_z[:, ::-1]
    x = np.concatenate([upper_x[:, :0:-1], upper_x], axis=1)
    z = np.concatenate([lower_z[:, :0:-1], upper_z], axis=1)
    return x, z


def _stations(layout: Layout, spacing: float) -> np.ndarray:
    """q of the sections: even steps along the leading edge or the path, with one at the chine and one at the corner."""
    q = np.arange(0.0, layout.q_tip + 5e-3, 0.005)
    step = np.maximum(np.abs(layout.leading_slope(q)) * 0.7, 1.0)
    measure = np.concatenate([[0.0], np.cumsum(0.5 * (step[1:] + step[:-1])) * 0.005])
    tip_start = layout.q_tip - TIP_ROUNDING
    stations = [-STUB * np.array([1.0, 0.75, 0.5, 0.25])]
    for low, high in ((0.0, layout.panel_length), (layout.panel_length, tip_start)):
        m = np.interp([low, high], q, measure)
        stations.append(np.interp(np.linspace(*m, max(4, int(np.ceil((m[1] - m[0]) / spacing))) + 1), measure, q)[:-1])
    t = np.linspace(0, np.pi / 2, 11)
    stations.append(tip_start + TIP_ROUNDING * np.sin(t) * 0.999)
    return np.concatenate(stations)


def wing_shell(layout: Layout, spacing: float) -> Shell:
    """Closed right wing, winglet included, reaching into the fuselage.

    Args:
        layout: derived dimensions.
        spacing: triangle size wanted, m.
    """
    return profile_loft(wing_grid(layout, spacing))


def wing_grid(layout: Layout, spacing: float) -> np.ndarray:
    """[station, point, xyz] sections of the right wing from the stub to the winglet's tip, m."""
    shape = layout.shape
    q = _stations(layout, spacing)
    u = np.clip((q - layout.q_tip + TIP_ROUNDING) / TIP_ROUNDING, 0, 1)
    x_lead = layout.leading_edge(q) + 0.8 * TIP_ROUNDING * (1 - np.sqrt(1 - u**2))
    x_trail = layout.trailing_edge(q)
    chord = x_trail - x_lead
    thick = layout.thickness(np.maximum(q, 0.0))
    grown = np.clip(q / APEX_GROWTH, 0, 1)
    radius = np.minimum(shape.leading_edge_radius_m, 0.49 * thick)
    radius = radius * (APEX_RADIUS_RATIO + (1 - APEX_RADIUS_RATIO) * grown**2 * (3 - 2 * grown))
    hinge = layout.hinge_offset(q)
    sweep = np.hypot(1.0, layout.leading_slope(q))
    nose = np.minimum(radius * sweep, 0.3 * (chord - hinge))
    counts = tuple(max(4, int(np.ceil(length / spacing))) for length in (2.2, 2.4, 0.8))
    x, z = section_profile(
        chord, nose, radius, thick, hinge, layout.hinge_thickness(np.maximum(q, 0.0)),
        shape.trailing_edge_thickness_m, counts,
    )  # fmt: skip
    # Round the tip seen from ahead: the section shrinks towards its middle line over the last half-thickness.
    v = np.clip((q - layout.q_tip + 0.5 * thick) / (0.5 * thick), 0, 1)
    middle = 0.5 * (z + z[:, ::-1])
    z = middle + np.sqrt(1 - v**2)[:, None] * (z - middle)
    share = x / chord[:, None]
    z = z + CAMBER * (4 * share * (1 - share) + (q / layout.q_tip)[:, None] ** 2)
    y0, z0, _ = layout.path(q)
    across = _section_directions(layout, q)
    grid = np.empty((*x.shape, 3))
    grid[..., 0] = x_lead[:, None] + x
    grid[..., 1] = y0[:, None] + z * across[:, :1]
    grid[..., 2] = z0[:, None] + z * across[:, 1:]
    return grid


def _section_directions(layout: Layout, q: np.ndarray) -> np.ndarray:
    """[station, yz] along which a section's thickness is laid off from the lower skin.

    The skin's normal, except near the root: there sections turn to the vertical, so that a thick root with much
    dihedral does not fold over the stub inside the fuselage; the vector is longer by as much as it is oblique, which
    keeps the upper skin.
    """
    elevation = layout.path(np.maximum(q, 1e-9))[2]
    ramp = 0.3 + 2.5 * layout.shape.wing_root_thickness_m * np.tan(layout.dihedral)
    ramp = min(ramp, 0.9 * (layout.panel_length - layout.bend_tangent))
    t = np.clip(q / ramp, 0.0, 1.0)
    angle = elevation * t**2 * (3 - 2 * t)
    length = 1.0 / np.cos(elevation - angle)
    return np.stack([-np.sin(angle) * length, np.cos(angle) * length], -1)
