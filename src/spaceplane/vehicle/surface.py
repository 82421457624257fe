"""The one watertight surface every later stage starts from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class Surface:
    """A closed triangulated surface with a part tag on every triangle.

    Axes: x aft from the nose, y right (starboard), z up; metres. Triangles are counter-clockwise
    seen from the air, so that their normals point out of the body.

    Attributes:
        points: [vertex, xyz] float64, m.
        triangles: [triangle, 3] int64 vertex indices.
        part: [triangle] int32 index into `part_names`.
        part_names: names such as fuselage, nose, wing_left, winglet_left, elevon_left, rudder_left, body_flap.
    """

    points: np.ndarray
    triangles: np.ndarray
    part: np.ndarray
    part_names: tuple[str, ...]

    @cached_property
    def corners(self) -> np.ndarray:
        """[triangle, corner, xyz] corner positions, m."""
        return self.points[self.triangles]

    @cached_property
    def area_vectors(self) -> np.ndarray:
        """[triangle, xyz] outward area vectors, m2."""
        c = self.corners
        return 0.5 * np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])

    @cached_property
    def centroids(self) -> np.ndarray:
        """[triangle, xyz] triangle centroids, m."""
        return self.corners.mean(axis=1)

    @cached_property
    def area(self) -> float:
        """Wetted area, m2."""
        return float(np.linalg.norm(self.area_vectors, axis=1).sum())

    @cached_property
    def volume(self) -> float:
        """Enclosed volume by the divergence theorem, m3."""
        return float(np.einsum("ij,ij->", self.centroids, self.area_vectors) / 3.0)

    @cached_property
    def bounds(self) -> np.ndarray:
        """[2, xyz] lower and upper corner of the bounding box, m."""
        return np.array([self.points.min(axis=0), self.points.max(axis=0)])
