"""Stations, angles and lines that follow from the shape parameters and that several lofts share.

Axes: x aft from the nose, y right, z up, metres. z = 0 is the reference axis, parallel to x and `KEEL_DEPTH` above the
keel of the constant section; at the default nosecone height the nose tip lies on it. All lines are those of the right
half.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from spaceplane.vehicle.shape import ShapeParameters
from spaceplane.vehicle.validity import GeometryError

KEEL_DEPTH = 1.5  # m, keel of the constant section below the reference axis
STUB = 0.7  # m, wing inboard of the chine, inside the fuselage
HINGE_THICKNESS_RATIO = 0.85  # thickness at the hinge over the local (winglet) or corner (wing) thickness
TIP_THICKNESS_RATIO = 0.85  # winglet thickness at the tip over that at the corner
KINK_BLEND = 0.5  # m, half-width over which leading-edge kinks are rounded
CORNER_BLEND = 0.25  # m, the same for the trailing edge at the corner
ELEVON_ROOT_GAP = 0.3  # m, from the chine to the elevon's inboard end at the hinge, along y


@dataclass(frozen=True)
class NoseLines:
    """Spherical cap and how keel, crown and chine leave it.

    Attributes:
        x_join: station where sphere and nosecone join, m.
        r_join: radius of the sphere there, m.
        slope: tangent of the surface angle there.
        exponents: of the power laws of keel, crown and half-width; each is tangent to sphere and constant section.
    """

    x_join: float
    r_join: float
    slope: float
    exponents: tuple[float, float, float]


@dataclass(frozen=True)
class Layout:
    """Derived dimensions of one shape, m and rad."""

    shape: ShapeParameters

    @property
    def x_base(self) -> float:
        """Station of the base, m."""
        return self.shape.nosecone_length_m + self.shape.fuselage_length_m

    @property
    def chine(self) -> float:
        """Half-width of the fuselage at the chine, m."""
        return self.shape.fuselage_width_m + self.shape.fuselage_flare_m

    def underside(self, y: float | np.ndarray) -> float | np.ndarray:
        """Height of the fuselage's underside above the keel, m, at y, m."""
        s = self.shape
        return s.fuselage_bottom_curvature_height_m * (y / s.fuselage_bottom_curvature_width_m) ** 2

    @property
    def section_height(self) -> float:
        """Height of the constant section, keel to crown, m."""
        s = self.shape
        return float(self.underside(self.chine)) + s.fuselage_height_m + s.fuselage_crown_ratio * s.fuselage_width_m

    @property
    def z_keel(self) -> float:
        """Height of the keel, m."""
        return -KEEL_DEPTH

    @property
    def z_nose(self) -> float:
        """Height of the nose tip above the reference axis, m."""
        return self.shape.nosecone_height_m - KEEL_DEPTH

    @cached_property
    def nose(self) -> NoseLines:
        """Join angle that lets every line run monotonically from the sphere to the constant section.

        The lines are z = z1 - (z1 - z0) (1 - xi)^n: tangent at both ends and without a dip for any n; n >= 2 keeps
        the curvature finite at the constant section, which fixes the join angle.

        Raises:
            GeometryError: the nose's sphere is too large for the fuselage.
        """
        s = self.shape
        radius, length = s.nose_radius_m, s.nosecone_length_m
        slope = 0.4
        for _ in range(60):
            cos, sin = 1 / np.hypot(1, slope), slope / np.hypot(1, slope)
            x_join, r_join = radius * (1 - sin), radius * cos
            rises = np.array(
                [
                    s.nosecone_height_m - r_join,
                    self.section_height - s.nosecone_height_m - r_join,
                    self.chine - r_join,
                ]
            )
            slope = 0.5 * slope + 0.5 * max(0.2, 2.2 * rises.max() / (length - x_join))
        if rises.min() <= 0.02 * radius:
            name = ("keel", "crown", "side")[int(rises.argmin())]
            raise GeometryError(f"nose_radius_m = {radius:g} m: the nose reaches below the {name} line of the fuselage")
        exponents = tuple(float(slope * (length - x_join) / rise) for rise in rises)
        return NoseLines(float(x_join), float(r_join), float(slope), exponents)  # type: ignore[arg-type]

    # --- wing and winglet: q runs along the sharp-cornered path chine -> corner -> winglet tip, seen from ahead ---

    @property
    def dihedral(self) -> float:
        """Dihedral of the wing panel, rad: chord of the underside parabola between chine and corner."""
        s = self.shape
        rise = float(self.underside(self.chine + s.wing_width_m) - self.underside(self.chine))
        return float(np.arctan2(rise, s.wing_width_m))

    @property
    def winglet_elevation(self) -> float:
        """Angle of the winglet's span direction above the horizontal, rad."""
        return float(np.pi / 2 - np.radians(self.shape.winglet_angle_deg))

    @property
    def panel_length(self) -> float:
        """q of the corner, m."""
        return self.shape.wing_width_m / float(np.cos(self.dihedral))

    @property
    def q_tip(self) -> float:
        """Distance of the winglet's tip from the chine along panel and winglet, m."""
        return self.panel_length + self.shape.winglet_length_m

    @cached_property
    def bend_tangent(self) -> float:
        """Distance from the corner to where the bend begins, m; the bend must end below the rudder.

        Raises:
            GeometryError: the winglet lies in the wing's plane.
        """
        turn = self.winglet_elevation - self.dihedral
        if turn <= np.radians(5):
            raise GeometryError(
                f"winglet_angle_deg = {self.shape.winglet_angle_deg:g} deg: the winglet lies in the wing's plane "
                f"(dihedral {np.degrees(self.dihedral):.1f} deg)"
            )
        limit = 0.8 * self.shape.rudder_height_bottom_m
        return float(min(self.shape.winglet_bend_radius_m * np.tan(turn / 2), limit))

    def path(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Lower skin of the wing and outer skin of the winglet, seen from ahead.

        Args:
            q: [station] distance along the sharp-cornered path, m; negative inside the fuselage.

        Returns:
            y, z [station] of the skin and elevation [station] of its span direction, rad.
        """
        q = np.asarray(q, dtype=float)
        gamma, top, tau, lp = self.dihedral, self.winglet_elevation, self.bend_tangent, self.panel_length
        radius = tau / np.tan((top - gamma) / 2)
        y0, z0 = self.chine, self.z_keel + float(self.underside(self.chine))
        corner = np.array([y0 + lp * np.cos(gamma), z0 + lp * np.sin(gamma)])
        start = corner - tau * np.array([np.cos(gamma), np.sin(gamma)])
        angle = np.clip(gamma + (top - gamma) * (q - lp + tau) / (2 * tau), gamma, top)
        y = start[0] + radius * (np.sin(angle) - np.sin(gamma))
        z = start[1] - radius * (np.cos(angle) - np.cos(gamma))
        before, after = np.minimum(q - lp + tau, 0.0), np.maximum(q - lp - tau, 0.0)
        y = y + before * np.cos(gamma) + after * np.cos(top)
        z = z + before * np.sin(gamma) + after * np.sin(top)
        inside = q < 0
        return np.where(inside, y0 + q, y), np.where(inside, z0, z), np.where(inside, 0.0, angle)

    @property
    def x_corner(self) -> float:
        """Station of the trailing edge at the corner, m."""
        return self.x_base + self.shape.wing_width_m * float(np.tan(np.radians(self.shape.trailing_edge_sweep_deg)))

    @property
    def trailing_slopes(self) -> tuple[float, float]:
        """dx/dq of the trailing edge on wing and winglet, a ratio."""
        s = self.shape
        wing = np.tan(np.radians(s.trailing_edge_sweep_deg)) * np.cos(self.dihedral)
        return float(wing), float(np.tan(np.radians(s.winglet_angle_back_deg)))

    @cached_property
    def x_apex(self) -> float:
        """Station of the strake apex at the chine, m: not ahead of where the nosecone has 97 % of its final width."""
        s, nose = self.shape, self.nose
        spread = (0.03 * self.chine / (self.chine - nose.r_join)) ** (1 / nose.exponents[2])
        x_wide = s.nosecone_length_m - (s.nosecone_length_m - nose.x_join) * min(spread, 1.0)
        return float(max(self.x_base - s.strake_length_m, x_wide))

    @cached_property
    def _edges(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Tabulated q, rounded leading edge, rounded trailing edge and hinge offset."""
        s = self.shape
        q = np.arange(-3.0, self.q_tip + 3.0, 0.01)
        q_kink = s.wing_corner_width_m / np.cos(self.dihedral)
        x_kink = self.x_base - s.wing_corner_length_m
        lp = self.panel_length
        if q_kink >= lp - 0.1:
            raise GeometryError(
                f"wing_corner_width_m = {s.wing_corner_width_m:g} m: kink outboard of the wing's corner"
            )
        if x_kink - self.x_apex < 0.5:
            raise GeometryError(f"wing_corner_length_m = {s.wing_corner_length_m:g} m: kink ahead of the strake's apex")
        mean = (x_kink - self.x_apex) / q_kink
        inner = 1.35 * mean  # an ogee: more sweep at the body than at the kink
        strake = self.x_apex + inner * q - (0.35 * mean / q_kink) * q**2
        strake = np.where(q < 0, self.x_apex + np.minimum(inner, 4.0) * q, strake)
        x_root = self.x_corner - s.winglet_bottom_length_m
        back = self.trailing_slopes[1]
        x_top = self.x_corner + back * s.winglet_length_m - s.winglet_top_length_m
        outer = x_kink + (q - q_kink) * (x_root - x_kink) / (lp - q_kink)
        winglet = x_root + (q - lp) * (x_top - x_root) / s.winglet_length_m
        leading = np.where(q < q_kink, strake, np.where(q < lp, outer, winglet))
        trailing = self.x_corner + (q - lp) * np.where(q < lp, *self.trailing_slopes)
        offsets = [
            length * np.hypot(1.0, slope)
            for length, slope in zip((s.elevon_length_m, s.rudder_length_m), self.trailing_slopes, strict=True)
        ]
        blend = np.clip((q - lp + CORNER_BLEND) / (2 * CORNER_BLEND), 0, 1)
        hinge = offsets[0] + (offsets[1] - offsets[0]) * blend**2 * (3 - 2 * blend)
        return q, _rounded(leading, KINK_BLEND), _rounded(trailing, CORNER_BLEND), hinge

    def leading_edge(self, q: np.ndarray) -> np.ndarray:
        """[station] x of the leading edge at q, m, kinks rounded."""
        return np.interp(q, self._edges[0], self._edges[1])

    def leading_slope(self, q: np.ndarray) -> np.ndarray:
        """[station] dx/dq of the leading edge, a ratio, at q, m."""
        return (self.leading_edge(q + 0.02) - self.leading_edge(q - 0.02)) / 0.04

    def trailing_edge(self, q: np.ndarray) -> np.ndarray:
        """[station] x of the trailing edge at q, m."""
        return np.interp(q, self._edges[0], self._edges[2])

    def hinge_offset(self, q: np.ndarray) -> np.ndarray:
        """[station] distance along x from the hinge line to the trailing edge at q, m."""
        return np.interp(q, self._edges[0], self._edges[3])

    def thickness(self, q: np.ndarray) -> np.ndarray:
        """[station] largest thickness of the section at q, m."""
        s, lp = self.shape, self.panel_length
        thick = s.wing_thickness_m
        return np.interp(q, [0.0, lp, self.q_tip], [s.wing_root_thickness_m, thick, TIP_THICKNESS_RATIO * thick])

    def hinge_thickness(self, q: np.ndarray) -> np.ndarray:
        """[station] thickness at the hinge at q, m.

        Constant along the wing and linear along the winglet, so that hinges are straight.
        """
        return HINGE_THICKNESS_RATIO * np.minimum(self.thickness(q), self.shape.wing_thickness_m)


def _rounded(values: np.ndarray, half_width: float) -> np.ndarray:
    """Smooth a function tabulated every 0.01 m by a triangular kernel: straight parts stay, kinks become arcs."""
    n = round(half_width / 0.01)
    kernel = n + 1 - np.abs(np.arange(-n, n + 1))
    padded = np.concatenate(
        [
            values[0] + (values[1] - values[0]) * np.arange(-n, 0),
            values,
            values[-1] + (values[-1] - values[-2]) * np.arange(1, n + 1),
        ]
    )
    return np.convolve(padded, kernel / kernel.sum(), mode="valid")
