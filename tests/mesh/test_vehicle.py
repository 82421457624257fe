"""HORUS-2B with its flaps anywhere within their limits, and bodies no mesh generator likes: the mesh keeps the body."""

import itertools

import numpy as np
import pytest
import trimesh

from spaceplane.analysis.settings import QUICK_MESH
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import CONTROL_LIMITS_DEG, ControlDeflections
from spaceplane.vehicle.presets import horus_2b
from spaceplane.vehicle.shape import ShapeParameters
from spaceplane.vehicle.surface import Surface

from . import bodies

LIMITS = {
    "lower limits": {name: low for name, (low, _) in CONTROL_LIMITS_DEG.items()},
    "upper limits": {name: high for name, (_, high) in CONTROL_LIMITS_DEG.items()},
    "left up, right down": {
        name: limits[0 if name.endswith("left") else 1] for name, limits in CONTROL_LIMITS_DEG.items()
    },
    "odd angles": {
        "elevon_left": -17.3,
        "elevon_right": 8.1,
        "rudder_left": 3.7,
        "rudder_right": 21.9,
        "body_flap": 5.3,
    },
}


def horus(deflections_deg):
    """HORUS-2B with deflections in degrees."""
    return build(ShapeParameters.create({}), ControlDeflections.from_degrees(deflections_deg))


def check_exact(mesh, surface, allowed=1e-6):
    """Wetted area by part, projected areas in x, y, z by part and side, volume; closure to round-off.

    `allowed` is relative to the whole wetted area and to the volume.
    """
    record = mesh.record
    assert record["volume"] == pytest.approx(surface.volume, rel=allowed)
    for errors in record["errors_by_part"].values():
        assert errors["area"] < allowed
        assert max(errors["projected"]) < allowed
    for part in range(len(surface.part_names)):
        ours = mesh.piece_area[mesh.piece_part == part].sum(axis=0)
        theirs = surface.area_vectors[surface.part == part].sum(axis=0)
        assert np.abs(ours + theirs).max() < allowed * surface.area
    assert np.abs(mesh.closure()).max() < 1e-13 * mesh.cell_size.max() ** 2
    assert (mesh.cell_volume > 0.0).all()
    assert not any("folds" in warning for warning in record["warnings"])


@pytest.mark.parametrize("cell", [0.2, 0.1, pytest.param(0.05, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", LIMITS)
def test_deflected_vehicle_is_meshed_exactly(name, cell):
    surface = horus(LIMITS[name])
    check_exact(generate(surface, MeshSettings(wall_cell=cell, far_field=1.0, growth_layers=1)), surface)


@pytest.mark.slow
@pytest.mark.parametrize("signs", list(itertools.product((0, 1), repeat=3)))
def test_every_corner_of_the_deflections_is_meshed_exactly(signs):
    """Elevons, rudders and body flap at either limit, left and right alike."""
    side = dict(zip(("elevon", "rudder", "body"), signs, strict=True))
    deflections = {name: limits[side[name.split("_")[0]]] for name, limits in CONTROL_LIMITS_DEG.items()}
    surface = horus(deflections)
    check_exact(generate(surface, MeshSettings(wall_cell=0.1, far_field=1.0, growth_layers=1)), surface)


@pytest.mark.parametrize("cell", [0.2, 0.07])
def test_triangles_down_to_microns(cell):
    """A box whose corners are crowded with triangles of a micron."""
    body = trimesh.creation.box((2.0, 1.4, 1.0))
    for face in range(0, 12, 2):
        a, b, c = body.faces[face]
        n = len(body.vertices)
        extra = np.array([1.0 - 2e-6, 1e-6, 1e-6]) @ body.vertices[[a, b, c]]
        faces = np.vstack([np.delete(body.faces, face, axis=0), [[a, b, n], [b, c, n], [c, a, n]]])
        body = trimesh.Trimesh(np.vstack([body.vertices, extra]), faces, process=False)
    surface = bodies.from_trimesh(body)
    assert np.linalg.norm(surface.area_vectors, axis=1).min() < 1e-5
    check_exact(generate(surface, MeshSettings(wall_cell=cell, far_field=1.0)), surface, 1e-10)


@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.5, 0.5), (1e-9, -1e-9)])
def test_faces_in_the_planes_of_the_grid(offset):
    """Sides, top and bottom of a box on grid planes, exactly and by a billionth of a cell beside."""
    surface = bodies.from_trimesh(bodies.box(2.0, 1.6, 0.8))
    check_exact(generate(surface, MeshSettings(wall_cell=0.2, far_field=1.0, offset=offset)), surface, 1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_vehicle_at_odd_angles(seed):
    """No symmetry, no plane along the grid."""
    surface = horus(LIMITS["odd angles"])
    turn = trimesh.transformations.random_rotation_matrix(np.random.default_rng(seed).random(3))[:3, :3]
    turned = Surface(surface.points @ turn.T, surface.triangles, surface.part, surface.part_names)
    check_exact(generate(turned, MeshSettings(wall_cell=0.3, far_field=0.7, growth_layers=1)), turned)


@pytest.mark.parametrize("gap", [0.0, 1e-12, 1e-6, 1e-3])
def test_parts_that_touch(gap):
    """Two boxes side by side: faces that share a plane, and slits of a picometre to a millimetre."""
    left, right = bodies.box(1.0, 1.0, 1.0), bodies.box(1.0, 0.8, 0.6, at=(1.0 + gap, 0.0, 0.0))
    surface = bodies.from_trimesh(left, right, names=("left", "right"))
    check_exact(generate(surface, MeshSettings(wall_cell=0.13, far_field=1.0)), surface, 1e-9)


def test_control_surfaces_and_edges_are_finer_by_default():
    mesh = generate(build(horus_2b().shape), QUICK_MESH)
    size, area = mesh.cell_size[mesh.wall_cell[mesh.piece_wall]], np.linalg.norm(mesh.piece_area, axis=1)
    mean = {}
    for k, name in enumerate(mesh.part_names):
        on = mesh.piece_part == k
        mean[name] = float(size[on] @ area[on] / area[on].sum())
    assert mean["fuselage"] > 0.9 * QUICK_MESH.wall_cell
    for name in (
        "elevon_left",
        "elevon_right",
        "rudder_left",
        "rudder_right",
        "body_flap",
        "wing_left",
        "winglet_left",
    ):
        assert mean[name] < 0.65 * QUICK_MESH.wall_cell
