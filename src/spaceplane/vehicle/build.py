"""From shape and deflections to the one watertight surface.

The symmetric centre body (fuselage and body flap) is united and cut at y = 0; its right half is united with a right
wing once per distinct pair of elevon and rudder deflections, and the left half is the mirror image of such a right
half. A vehicle with equal deflections is therefore symmetric to the last bit.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.flaps import (
    SIDE_OVERLAP,
    Hinge,
    bay_cutter,
    body_flap_hinge,
    elevon_hinge,
    flap_shell,
    rudder_hinge,
)
from spaceplane.vehicle.fuselage import fuselage_shell, nose_end
from spaceplane.vehicle.layout import Layout
from spaceplane.vehicle.lofts import Shell
from spaceplane.vehicle.shape import ShapeParameters
from spaceplane.vehicle.solids import solid_of, welded
from spaceplane.vehicle.surface import Surface
from spaceplane.vehicle.validity import GeometryError, check
from spaceplane.vehicle.wing import wing_shell

PART_NAMES = (
    "fuselage", "nose", "wing_left", "wing_right", "winglet_left", "winglet_right", "elevon_left", "elevon_right",
    "rudder_left", "rudder_right", "body_flap",
)  # fmt: skip
DEFAULT_SPACING = 0.12  # m

_FUSELAGE, _NOSE, _WING, _WINGLET, _ELEVON, _RUDDER, _BODY_FLAP = range(7)
_RIGHT = ("fuselage", "nose", "wing_right", "winglet_right", "elevon_right", "rudder_right", "body_flap")
_LEFT = ("fuselage", "nose", "wing_left", "winglet_left", "elevon_left", "rudder_left", "body_flap")


def build(
    shape: ShapeParameters, deflections: ControlDeflections | None = None, spacing: float = DEFAULT_SPACING
) -> Surface:
    """The vehicle's watertight surface with part tags.

    Args:
        shape: shape parameters (not checked against their limits here; see `ShapeParameters.validate`).
        deflections: of the control surfaces, rad; none if omitted.
        spacing: triangle size wanted where the surface is curved, m.

    Returns:
        Closed, oriented, one piece, genus 0; part names `PART_NAMES`; mirror-symmetric in y to the last bit when the
        deflections are.

    Raises:
        GeometryError: the parameters give no valid body (possible outside their limits).
    """
    deflections = deflections or ControlDeflections()
    right = _half(shape, deflections.elevon_right, deflections.rudder_right, deflections.body_flap, spacing)
    left = _half(shape, deflections.elevon_left, deflections.rudder_left, deflections.body_flap, spacing)
    surface = _joined(right, left)
    check(surface, "vehicle")
    return surface


class _Solids:
    """manifold3d solids of one shape that do not depend on the deflections of the wing's flaps."""

    def __init__(self, shape: ShapeParameters, spacing: float) -> None:
        self.layout = Layout(shape)
        self.spacing = spacing
        self.elevon, self.rudder = elevon_hinge(self.layout), rudder_hinge(self.layout)
        self.body_flap = body_flap_hinge(self.layout)
        self.fuselage = _solid(fuselage_shell(self.layout, spacing), "fuselage")
        wing = _solid(wing_shell(self.layout, spacing), "wing")
        for hinge in (self.elevon, self.rudder):
            wing -= _solid(bay_cutter(hinge), "bay")
        self.wing = wing.as_original()


@lru_cache(maxsize=4)
def _solids(shape: ShapeParameters, spacing: float) -> _Solids:
    return _Solids(shape, spacing)


@lru_cache(maxsize=8)
def _centre(shape: ShapeParameters, body_flap: float, spacing: float):
    """Right half of fuselage and body flap, and the id of the flap in it."""
    solids = _solids(shape, spacing)
    flap = _solid(flap_shell(solids.body_flap, body_flap, spacing), "body flap")
    return (solids.fuselage + flap).trim_by_plane((0.0, 1.0, 0.0), 0.0), flap.original_id()


@lru_cache(maxsize=8)
def _half(
    shape: ShapeParameters, elevon: float, rudder: float, body_flap: float, spacing: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Right half without its wall at y = 0: points, triangles, local part indices."""
    solids = _solids(shape, spacing)
    centre, flap_id = _centre(shape, body_flap, spacing)
    flaps = {
        "elevon": _solid(flap_shell(solids.elevon, elevon, spacing), "elevon"),
        "rudder": _solid(flap_shell(solids.rudder, rudder, spacing), "rudder"),
    }
    _refuse_overlap(centre, solids, flaps)
    half = centre + (solids.wing + flaps["elevon"] + flaps["rudder"])
    mesh = half.to_mesh64()
    points, triangles = welded(mesh)
    points[np.abs(points[:, 1]) < 1e-9, 1] = 0.0
    runs = np.repeat(mesh.run_original_id, np.diff(mesh.run_index) // 3)
    part = np.full(len(triangles), _FUSELAGE)
    centroid = points[triangles].mean(axis=1)
    ids = {flap_id: _BODY_FLAP, solids.wing.original_id(): _WING}
    ids |= {flaps["elevon"].original_id(): _ELEVON, flaps["rudder"].original_id(): _RUDDER}
    for run_id, tag in ids.items():
        part[runs == run_id] = tag
    part[(part == _FUSELAGE) & (centroid[:, 0] < nose_end(solids.layout))] = _NOSE
    part[(part == _WING) & _beyond_corner(solids.layout, centroid)] = _WINGLET
    wall = (points[triangles, 1] == 0.0).all(axis=1)
    return points, triangles[~wall], part[~wall]


def _beyond_corner(layout: Layout, points: np.ndarray) -> np.ndarray:
    """True for points on the winglet's side of the plane that bisects the bend."""
    y, z, elevation = layout.path(np.array([layout.panel_length]))
    return (points[:, 1] - y) * np.cos(elevation) + (points[:, 2] - z) * np.sin(elevation) > 0


def _refuse_overlap(centre, solids: _Solids, flaps: dict) -> None:
    """Flaps may meet the wing in knuckle and side overlap only, and nothing else."""
    allowed = {"elevon": _seal_volume(solids.elevon), "rudder": _seal_volume(solids.rudder)}
    for name, flap in flaps.items():
        if (flap ^ centre).volume() > 1e-9:
            raise GeometryError(f"{name}: runs into the fuselage or the body flap")
        if (flap ^ solids.wing).volume() > allowed[name]:
            raise GeometryError(f"{name}: runs into the wing")
    if (flaps["elevon"] ^ flaps["rudder"]).volume() > 1e-9:
        raise GeometryError("elevon: runs into the rudder")
    if solids.wing.bounding_box()[1] <= 0.0:
        raise GeometryError("wing: crosses the plane of symmetry")


def _seal_volume(hinge: Hinge) -> float:
    """Upper bound of the volume that a flap shares with its wing by design, m3."""
    radius = max(hinge.radius)
    return np.pi * radius**2 * hinge.length + 16 * radius * hinge.chord * SIDE_OVERLAP


def _solid(shell: Shell, what: str):
    """manifold3d solid of a shell, which can be told apart in unions; a GeometryError where it is not closed."""
    return solid_of(shell.points, shell.triangles, what).as_original()


def _joined(right: tuple, left: tuple) -> Surface:
    """Right half and mirrored left half, welded along y = 0."""
    right_points, right_triangles, right_part = right
    left_points, left_triangles, left_part = left
    mirrored = left_points * [1.0, -1.0, 1.0]
    mirrored[left_points[:, 1] == 0.0, 1] = 0.0
    points = np.concatenate([right_points, mirrored])
    triangles = np.concatenate([right_triangles, left_triangles[:, ::-1] + len(right_points)])
    names = {name: i for i, name in enumerate(PART_NAMES)}
    part = np.concatenate(
        [np.array([names[n] for n in _RIGHT])[right_part], np.array([names[n] for n in _LEFT])[left_part]]
    )
    seam = np.flatnonzero(points[:, 1] == 0.0)
    _, first, inverse = np.unique(points[seam][:, [0, 2]], axis=0, return_index=True, return_inverse=True)
    target = np.arange(len(points))
    target[seam] = seam[first[inverse.ravel()]]
    triangles = target[triangles]
    used, compact = np.unique(triangles, return_inverse=True)
    return Surface(
        np.ascontiguousarray(points[used]), compact.reshape(-1, 3).astype(np.int64), part.astype(np.int32), PART_NAMES
    )
