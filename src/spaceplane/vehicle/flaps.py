"""Control surfaces: knuckle at the hinge, wedge behind it, and the bay each one leaves in the wing.

The knuckle is a round bar about the hinge axis that reaches into the part ahead: it seals the hinge at every angle.
The sides of a flap overlap the sides of its bay by `SIDE_OVERLAP`, so that an undeflected flap leaves no slot.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spaceplane.vehicle.layout import ELEVON_ROOT_GAP, TIP_THICKNESS_RATIO, Layout
from spaceplane.vehicle.lofts import CAMBER, Shell, box, profile_loft
from spaceplane.vehicle.validity import GeometryError

KNUCKLE_RATIO = 0.95  # knuckle radius over the local half-thickness
SIDE_OVERLAP = 0.008  # m
OPEN_END = 0.4  # m, by which an open bay is cut beyond the flap's end
EDGE_SETBACK = 0.004  # m, flap's trailing edge ahead of the wing's, so that no faces coincide
BODY_FLAP_RADIUS = 0.16  # m, height of the body flap's axis above the underside at its ends
KEEL_STEP = 0.015  # m, body flap's lower skin above the underside
CORNER_GAP = 0.15  # m, elevon's outboard end inboard of the bend


@dataclass(frozen=True)
class Hinge:
    """A flap on a straight hinge, right-hand side or centre.

    Attributes:
        origin: [xyz] inboard (or lower) end of the hinge axis, m.
        along: [xyz] unit vector of the hinge axis, outboard (or upwards).
        aft: [xyz] unit vector from the axis to the undeflected trailing edge, normal to `along`.
        up: [xyz] unit normal of the flap, away from the side a positive deflection goes to.
        length: of the axis, m.
        chord: from axis to trailing edge, m.
        radius: knuckle radius at stations evenly spaced along the axis, m.
        edge: half-thickness of the trailing edge, m.
        skew: shift of both ends along the axis per metre behind it.
        open_end: the bay runs out of the wing at the far end.
    """

    origin: np.ndarray
    along: np.ndarray
    aft: np.ndarray
    up: np.ndarray
    length: float
    chord: float
    radius: tuple[float, ...]
    edge: float
    skew: tuple[float, float] = (0.0, 0.0)
    open_end: bool = False

    def place(self, d: np.ndarray, t: np.ndarray, h: np.ndarray) -> np.ndarray:
        """[..., xyz] m, points at distances d behind, t along and h above the axis, m."""
        return self.origin + d[..., None] * self.aft + t[..., None] * self.along + h[..., None] * self.up


def flap_shell(hinge: Hinge, deflection: float, spacing: float) -> Shell:
    """Closed flap turned about its hinge.

    Args:
        hinge: the flap.
        deflection: rad, positive away from `hinge.up`.
        spacing: triangle size wanted, m.
    """
    return profile_loft(flap_grid(hinge, deflection, spacing))


def flap_grid(hinge: Hinge, deflection: float, spacing: float) -> np.ndarray:
    """[station, point, xyz] sections of the turned flap from one end of its axis to the other, m."""
    across = max(3, int(np.ceil(hinge.length / (1.3 * spacing))))
    u = np.linspace(0, 1, across + 1)
    radius = np.interp(u, np.linspace(0, 1, len(hinge.radius)), hinge.radius)
    radius = radius + CAMBER * 4 * u * (1 - u)
    # The upper tangent from the edge point (chord, edge) to the knuckle leaves it at this angle from `aft`.
    lean = np.arctan2(hinge.edge, hinge.chord)
    touch = lean + np.arccos(radius / np.hypot(hinge.chord, hinge.edge))
    wedge = np.linspace(1, 0, max(3, int(np.ceil(hinge.chord / (1.3 * spacing)))) + 1)
    d_touch, h_touch = radius * np.cos(touch), radius * np.sin(touch)
    d_up = d_touch[:, None] + (hinge.chord - d_touch)[:, None] * wedge
    h_up = h_touch[:, None] + (hinge.edge - h_touch)[:, None] * wedge
    arc = touch[:, None] + (np.pi - touch)[:, None] * np.linspace(0, 1, 11)[1:]
    d_up = np.concatenate([d_up, radius[:, None] * np.cos(arc)], axis=1)
    h_up = np.concatenate([h_up, radius[:, None] * np.sin(arc)], axis=1)
    h_up[:, -1] = 0.0
    d = np.concatenate([d_up, d_up[:, -2::-1]], axis=1)
    h = np.concatenate([h_up, -h_up[:, -2::-1]], axis=1)
    start = hinge.skew[0] * np.maximum(d, 0)
    end = hinge.length + hinge.skew[1] * np.maximum(d, 0)
    t = start + (end - start) * u[:, None]
    cos, sin = np.cos(deflection), np.sin(deflection)
    return hinge.place(d * cos + h * sin, t, h * cos - d * sin)


def bay_cutter(hinge: Hinge) -> Shell:
    """What is cut out of the wing: everything behind a plane slightly ahead of the axis, between the flap's ends."""
    front, back = -0.25 * min(hinge.radius), hinge.chord + 0.6
    corners = np.empty((2, 2, 2, 3))
    depth = min(0.35, 4 * max(hinge.radius))
    for i, d in enumerate((0.0, back)):
        # At the plane ahead of the axis the sides start at the flap's own ends, so that knuckle and bay overlap.
        far = OPEN_END if hinge.open_end else -SIDE_OVERLAP
        ends = (hinge.skew[0] * d + SIDE_OVERLAP, hinge.length + hinge.skew[1] * d + far)
        for j, t in enumerate(ends):
            for k, h in enumerate((-depth, depth)):
                corners[i, j, k] = hinge.place(np.array(front if i == 0 else d), np.array(t), np.array(h))
    return box(corners)


def _panel_hinge(layout: Layout, ends: tuple[float, float], chord: float) -> tuple[np.ndarray, ...]:
    """Hinge axis ends, trailing-edge middle and skin normal between two q on a planar panel."""
    q = np.array(ends)
    y, z, elevation = layout.path(q)
    up = np.array([0.0, -np.sin(elevation.mean()), np.cos(elevation.mean())])
    half = 0.5 * layout.hinge_thickness(q)
    edge = 0.5 * layout.shape.trailing_edge_thickness_m
    skin = np.stack([layout.trailing_edge(q), y, z], -1)
    axis = skin - np.stack([layout.hinge_offset(q), 0 * q, 0 * q], -1) + half[:, None] * up
    return axis, skin + edge * up, up, KNUCKLE_RATIO * half


def _frame(
    axis: np.ndarray, trailing: np.ndarray, up: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float, float]:
    """Unit vectors along and aft, the normal, axis length and chord."""
    along = axis[1] - axis[0]
    length = float(np.linalg.norm(along))
    along = along / length
    reach = trailing.mean(axis=0) - axis.mean(axis=0)
    aft = reach - along * (reach @ along)
    chord = float(np.linalg.norm(aft))
    aft = aft / chord
    normal = np.cross(along, aft)
    return along, aft, normal if normal @ up > 0 else -normal, length, chord


def elevon_hinge(layout: Layout) -> Hinge:
    """Right elevon; its inboard end is slanted so that it clears the fuselage when it is up.

    Raises:
        GeometryError: the flap does not fit into the part that carries it.
    """
    q_in = ELEVON_ROOT_GAP / np.cos(layout.dihedral)
    q_out = layout.panel_length - layout.bend_tangent - CORNER_GAP
    axis, trailing, up, radius = _panel_hinge(layout, (q_in, q_out), layout.shape.elevon_length_m)
    along, aft, normal, length, chord = _frame(axis, trailing, up)
    angle = np.radians(np.linspace(0, 40, 41))
    inward = -(np.cos(angle) * aft[1] + np.sin(angle) * normal[1])
    skew = float(inward.max() / along[1])
    hinge = Hinge(
        axis[0], along, aft, normal, length, chord - EDGE_SETBACK, (float(radius[0]), float(radius[1])),
        0.5 * KNUCKLE_RATIO * layout.shape.trailing_edge_thickness_m, (max(skew, 0.0), 0.0),
    )  # fmt: skip
    if length - hinge.skew[0] * chord < 0.2:
        raise GeometryError(
            f"elevon_length_m = {layout.shape.elevon_length_m:g} m: no room for an elevon on a wing of "
            f"wing_width_m = {layout.shape.wing_width_m:g} m"
        )
    return hinge


def rudder_hinge(layout: Layout) -> Hinge:
    """Right rudder, from above the corner to the winglet's tip; both ends along the flow.

    Raises:
        GeometryError: the flap does not fit into the part that carries it.
    """
    thick = layout.shape.wing_thickness_m * TIP_THICKNESS_RATIO
    ends = (layout.panel_length + layout.shape.rudder_height_bottom_m, layout.q_tip - 0.25 * thick)
    if ends[1] - ends[0] < 0.3:
        raise GeometryError(f"rudder_height_bottom_m = {layout.shape.rudder_height_bottom_m:g} m: no room for a rudder")
    axis, trailing, up, radius = _panel_hinge(layout, ends, layout.shape.rudder_length_m)
    along, aft, normal, length, chord = _frame(axis, trailing, up)
    # Ends along the flow: moving by d * aft along x only.
    span = np.array([0.0, *(axis[1] - axis[0])[1:]])
    span /= np.linalg.norm(span)
    skew = float(-(aft @ span) / (along @ span))
    return Hinge(
        axis[0], along, aft, normal, length, chord - EDGE_SETBACK, (float(radius[0]), float(radius[1])),
        0.5 * KNUCKLE_RATIO * layout.shape.trailing_edge_thickness_m, (skew, skew), open_end=True,
    )  # fmt: skip


def body_flap_hinge(layout: Layout) -> Hinge:
    """Body flap below the base; its knuckle is sunk into the base and follows the curved underside.

    Raises:
        GeometryError: the flap does not fit into the part that carries it.
    """
    s = layout.shape
    half_width = 0.5 * s.body_flap_width_m
    if half_width > layout.chine - 0.295:
        raise GeometryError(f"body_flap_width_m = {s.body_flap_width_m:g} m: wider than the fuselage's underside")
    axis = float(layout.underside(half_width)) + BODY_FLAP_RADIUS
    y = np.linspace(-half_width, half_width, 41)
    radius = axis - layout.underside(y) - KEEL_STEP
    ahead = 0.3 * BODY_FLAP_RADIUS  # of the axis, the base
    return Hinge(
        np.array([layout.x_base + ahead, -half_width, layout.z_keel + axis]),
        np.array([0.0, 1.0, 0.0]),
        np.array([1.0, 0.0, 0.0]),
        np.array([0.0, 0.0, 1.0]),
        2 * half_width,
        s.body_flap_length_m - ahead,
        tuple(float(r) for r in radius),
        0.5 * s.trailing_edge_thickness_m,
    )
