"""The mesh keeps the body exactly, closes every cell and is graded, connected and symmetric."""

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from spaceplane.errors import InputError
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings, RefinementBox
from spaceplane.vehicle.surface import Surface

from . import bodies

PLATE = 0.05  # half a cell at 0.1 m
CASES = {
    "sphere": (bodies.sphere(), 0.13),
    "cube on the planes": (bodies.from_trimesh(bodies.box(2, 2, 2)), 0.25),
    "cube off the planes": (bodies.from_trimesh(bodies.box(2, 2, 2, at=(0.03, 0.07, 0.011))), 0.21),
    "cone": (bodies.cone(), 0.11),
    "diamond wing": (bodies.diamond_wing(), 0.2),
    "thin plate": (bodies.from_trimesh(bodies.box(3, 4, PLATE)), 0.1),
    "thin plate off the plane": (bodies.from_trimesh(bodies.box(3, 4, PLATE, at=(0, 0.7, 0.031))), 0.1),
    "turned plate": (bodies.rotated(bodies.from_trimesh(bodies.box(3, 2, PLATE)), 3), 0.1),
    "turned cube": (bodies.rotated(bodies.from_trimesh(bodies.box(1, 1, 1)), 1), 0.17),
    "two bodies": (bodies.from_trimesh(bodies.box(1, 1, 1), bodies.box(1, 1, 1, at=(1.013, 0, 0.2))), 0.1),
    "touching boxes": (bodies.from_trimesh(bodies.box(1, 1, 1), bodies.box(1, 1, 1, at=(1.0, 0, 0))), 0.13),
    "body smaller than a cell": (bodies.sphere(0.3, 1), 1.0),
}


def check_body(mesh, surface):
    """Areas, volume, closure, positivity: everything a conservative solver relies on."""
    total = surface.area
    for part in range(len(surface.part_names)):
        ours = mesh.piece_area[mesh.piece_part == part]
        theirs = surface.area_vectors[surface.part == part]
        assert np.abs(ours.sum(axis=0) + theirs.sum(axis=0)).max() < 1e-10 * total
        for sign in (-1.0, 1.0):
            front = ours[sign * ours[:, 0] > 0, 0].sum() + theirs[sign * theirs[:, 0] < 0, 0].sum()
            assert abs(front) < 1e-10 * total
    record = mesh.record
    assert record["area_error"] < 1e-10
    assert record["volume_error"] < 1e-10
    assert record["gauss_error"] < 1e-12
    assert np.abs(mesh.closure()).max() < 1e-13 * mesh.cell_size.max() ** 2
    sums = np.zeros_like(mesh.wall_area)
    np.add.at(sums, mesh.piece_wall, mesh.piece_area)
    assert np.abs(sums - mesh.wall_area).max() < 1e-12 * mesh.cell_size.min() ** 2
    assert len(np.unique(mesh.wall_cell)) == len(mesh.wall_cell)
    assert (mesh.cell_volume > 0).all()


def check_shape(mesh, merge_fraction=0.3):
    """Grading, connection and order."""
    size = mesh.cell_size[mesh.face_cells]
    assert (size.max(axis=1) / size.min(axis=1)).max() < 2.001
    graph = coo_matrix((np.ones(len(mesh.face_cells)), mesh.face_cells.T), shape=(mesh.cells, mesh.cells))
    assert connected_components(graph, directed=False)[0] == 1
    assert (mesh.face_cells[:, 0] < mesh.face_cells[:, 1]).all()
    assert (np.diff(mesh.face_cells[:, 0]) >= 0).all()
    assert len(np.unique(mesh.face_cells, axis=0)) == len(mesh.face_cells)
    fraction = mesh.cell_volume / mesh.cell_size**3
    assert fraction.min() >= merge_fraction
    away = np.abs(mesh.cell_center - mesh.cell_cube_center).max(axis=1) / mesh.cell_size
    assert away.max() < 2.5


@pytest.mark.parametrize("name", CASES)
def test_mesh_keeps_the_body(name):
    surface, cell = CASES[name]
    mesh = generate(surface, MeshSettings(wall_cell=cell, far_field=2.0))
    check_body(mesh, surface)
    check_shape(mesh)


@pytest.mark.parametrize("seed", range(12))
def test_any_grid_offset_and_angle(seed):
    random = np.random.default_rng(seed)
    surface = bodies.rotated(bodies.diamond_wing(2.0, 1.5, 0.07), seed)
    settings = MeshSettings(wall_cell=0.1, far_field=1.5, offset=tuple(random.random(2)), symmetric=False)
    mesh = generate(surface, settings)
    check_body(mesh, surface)
    check_shape(mesh)


def test_gauss_identity_of_every_cell():
    """Volume from the faces: exact where walls are flat, so use a cube."""
    mesh = generate(bodies.from_trimesh(bodies.box(2, 2, 2, at=(0.03, 0.02, 0.01))), MeshSettings(wall_cell=0.3))
    volume = np.zeros(mesh.cells)
    flux = np.einsum("fi,fi->f", mesh.face_center, mesh.face_area) / 3.0
    np.add.at(volume, mesh.face_cells[:, 0], flux)
    np.add.at(volume, mesh.face_cells[:, 1], -flux)
    np.add.at(volume, mesh.far_cell, np.einsum("fi,fi->f", mesh.far_center, mesh.far_area) / 3.0)
    flux = np.einsum("pi,pi->p", mesh.piece_center, mesh.piece_area) / 3.0
    np.add.at(volume, mesh.wall_cell[mesh.piece_wall], flux)
    flat = np.ones(mesh.cells, bool)  # a merged wall round an edge has no single centre that fits the identity
    pieces = np.bincount(mesh.wall_cell[mesh.piece_wall], minlength=mesh.cells)
    norm = np.zeros(mesh.cells)
    np.add.at(norm, mesh.wall_cell[mesh.piece_wall], np.abs(mesh.piece_area).max(axis=1))
    np.add.at(norm, mesh.wall_cell, -np.abs(mesh.wall_area).max(axis=1))
    largest = np.zeros(mesh.cells)
    second = np.zeros(mesh.cells)
    across = np.sort(np.abs(mesh.wall_area), axis=1)
    largest[mesh.wall_cell], second[mesh.wall_cell] = across[:, 2], across[:, 1]
    flat &= (pieces <= 1) & (second < 1e-12)
    assert flat.sum() > 0.9 * mesh.cells
    assert np.abs(volume - mesh.cell_volume)[flat].max() < 1e-10


def test_symmetric_body_gives_exactly_symmetric_mesh():
    left, right = bodies.box(1, 1, 0.1, at=(0, -1.2, 0)), bodies.box(1, 1, 0.1, at=(0, 1.2, 0))
    surface = bodies.from_trimesh(bodies.box(2, 1, 1), left, right, names=("fuselage", "wing_left", "wing_right"))
    mesh = generate(surface, MeshSettings(wall_cell=0.13))
    assert mesh.record["symmetric"]
    flip = np.array([1.0, -1.0, 1.0])

    def table(values):
        rounded = np.round(values, 12) + 0.0
        return rounded[np.lexsort(rounded.T)]

    cells = np.column_stack([mesh.cell_center, mesh.cell_volume])
    assert np.array_equal(table(cells), table(cells * [1, -1, 1, 1]))
    walls = np.column_stack([mesh.wall_center, mesh.wall_area])
    assert np.array_equal(table(walls), table(walls * np.tile(flip, 2)))
    swap = np.array([0, 2, 1])
    pieces = np.column_stack([mesh.piece_center, mesh.piece_area, mesh.piece_part])
    image = np.column_stack([mesh.piece_center * flip, mesh.piece_area * flip, swap[mesh.piece_part]])
    assert np.array_equal(table(pieces), table(image))
    check_body(mesh, surface)


def test_asymmetric_body_is_meshed_whole():
    surface = bodies.from_trimesh(bodies.box(2, 1, 1), bodies.box(0.2, 0.2, 0.2, at=(0, 1, 0)))
    mesh = generate(surface, MeshSettings(wall_cell=0.13))
    assert not mesh.record["symmetric"]
    check_body(mesh, surface)
    with pytest.raises(InputError, match="symmetric"):
        generate(surface, MeshSettings(wall_cell=0.13, symmetric=True))


def test_mirrored_body_without_mirrored_parts_is_meshed_whole():
    """Parts must mirror by name, or forces by part would land on the wrong side."""
    surface = bodies.from_trimesh(
        bodies.box(1, 1, 1, at=(0, -1, 0)), bodies.box(1, 1, 1, at=(0, 1, 0)), names=("a", "b")
    )
    mesh = generate(surface, MeshSettings(wall_cell=0.21))
    assert not mesh.record["symmetric"]
    check_body(mesh, surface)


def test_thin_plate_keeps_its_planform_and_is_warned_about():
    surface = bodies.from_trimesh(bodies.box(3, 4, PLATE))
    mesh = generate(surface, MeshSettings(wall_cell=0.1))
    up = mesh.piece_area[mesh.piece_area[:, 2] > 0, 2].sum()
    assert up > 0.0
    whole = np.abs(mesh.piece_area[:, 2]).sum()
    assert whole <= 24.0 + 1e-9
    (thin,) = mesh.record["thin_walls"]
    assert thin["part"] == "part0" and thin["share"] > 0.8
    assert thin["thickness_m"] == pytest.approx(PLATE, rel=1e-6) and thin["cell_m"] == pytest.approx(0.1)
    assert np.abs(thin["at_m"])[2] < PLATE and np.abs(thin["at_m"])[0] < 1.5
    (warning,) = mesh.record["warnings"]
    assert "part0" in warning and "thinner than two cells" in warning and "x=" in warning
    thick = generate(bodies.from_trimesh(bodies.box(3, 4, 1)), MeshSettings(wall_cell=0.2))
    assert not thick.record["warnings"] and not thick.record["thin_walls"]


def test_thin_walls_of_several_parts_are_one_warning():
    """Left and right count once; the numbers of each part stay in the record."""
    wings = [bodies.box(1, 1, 0.1, at=(0, y, 0)) for y in (-1.2, 1.2)]
    fin = bodies.box(1, 0.05, 0.8, at=(0, 0, 1.0))
    names = ("fuselage", "wing_left", "wing_right", "fin")
    surface = bodies.from_trimesh(bodies.box(2, 1, 1), *wings, fin, names=names)
    mesh = generate(surface, MeshSettings(wall_cell=0.13, symmetric=False))
    found = {one["part"]: one for one in mesh.record["thin_walls"]}
    assert set(found) == {"wing_left", "wing_right", "fin"}
    assert found["fin"]["thickness_m"] == pytest.approx(0.05, rel=1e-6)
    assert found["wing_left"]["thickness_m"] == pytest.approx(0.1, rel=1e-6)
    (warning,) = mesh.record["warnings"]
    assert warning.count("wing") == 1 and warning.count("fin over") == 1 and "--cell" in warning


def test_cavity_is_left_out_and_reported():
    inner = bodies.box(0.6, 0.6, 0.6)
    inner.invert()
    mesh = generate(bodies.from_trimesh(bodies.box(2, 2, 2), inner), MeshSettings(wall_cell=0.2))
    assert any("enclosed" in w for w in mesh.record["warnings"])
    assert mesh.record["enclosed_volume"] == pytest.approx(0.216, rel=1e-9)
    assert (np.abs(mesh.cell_center).max(axis=1) > 0.9).all()


def test_target_cells():
    mesh = generate(bodies.sphere(), MeshSettings(target_cells=40_000))
    assert abs(mesh.cells / 40_000 - 1) < 0.15


def test_refinement_box():
    plain = generate(bodies.sphere(), MeshSettings(wall_cell=0.2))
    box = RefinementBox((2.0, -1.0, -1.0), (5.0, 1.0, 1.0), 0.4)
    mesh = generate(bodies.sphere(), MeshSettings(wall_cell=0.2, boxes=(box,)))
    inside = ((mesh.cell_cube_center > box.lower) & (mesh.cell_cube_center < box.upper)).all(axis=1)
    assert mesh.cell_size[inside].max() <= 0.4
    assert mesh.cells > plain.cells
    check_shape(mesh)


@pytest.mark.parametrize(
    ("box", "word"),
    [
        (RefinementBox((50.0, 0.0, 0.0), (51.0, 1.0, 1.0), 0.1), "outside the air"),
        (RefinementBox((-3.0, -3.0, -3.0), (3.0, 3.0, 3.0), 0.01), "cells of 0.01 m .* are .*, at most 6000000"),
    ],
)
def test_boxes_that_no_mesh_can_have(box, word):
    with pytest.raises(InputError, match=f"boxes: .*{word}"):
        generate(bodies.sphere(), MeshSettings(wall_cell=0.2, far_field=2.0, boxes=(box,)))


def test_fine_parts_have_half_sized_cells():
    left, right = bodies.box(1, 1, 0.3, at=(0, -1.2, 0)), bodies.box(1, 1, 0.3, at=(0, 1.2, 0))
    surface = bodies.from_trimesh(bodies.box(2, 1, 1), left, right, names=("fuselage", "wing_left", "wing_right"))
    mesh = generate(surface, MeshSettings(wall_cell=0.2, fine_parts=("wing",)))
    size = mesh.cell_size[mesh.wall_cell[mesh.piece_wall]]
    assert np.allclose(size[mesh.piece_part > 0], 0.1)
    assert np.isclose(size[mesh.piece_part == 0], 0.2).mean() > 0.3
    check_body(mesh, surface)
    check_shape(mesh)
    with pytest.raises(InputError, match="unknown part 'wing_lefd', the body has fuselage, wing_left, wing_right"):
        generate(surface, MeshSettings(fine_parts=("wing_lefd",)))


@pytest.mark.parametrize("seed", range(3))
def test_fine_edges_have_half_sized_cells(seed):
    surface = bodies.rotated(bodies.diamond_wing(3.0, 2.0, 1.2), seed)
    mesh = generate(surface, MeshSettings(wall_cell=0.2, fine_edges=True, far_field=2.0))
    turn = np.linalg.norm(mesh.wall_area, axis=1)
    whole = np.bincount(mesh.piece_wall, np.linalg.norm(mesh.piece_area, axis=1))
    size = mesh.cell_size[mesh.wall_cell]
    assert np.isclose(size[turn < 0.8 * whole], 0.1).all()
    assert np.isclose(size, 0.2).sum() > 50
    check_body(mesh, surface)
    check_shape(mesh)


@pytest.mark.parametrize(
    ("settings", "word"),
    [
        ({"wall_cell": 0.0}, "wall_cell"),
        ({"wall_cell": float("nan")}, "wall_cell"),
        ({"wall_cell": 1e-4}, "wall_cell"),
        ({"far_field": 0.0}, "far_field"),
        ({"target_cells": 3}, "target_cells"),
        ({"wall_layers": 0}, "wall_layers"),
        ({"wall_cell": "a"}, "wall_cell: 'a'"),
        ({"wall_cell": True}, "wall_cell: True"),
        ({"target_cells": "many"}, "target_cells: 'many'"),
        ({"far_field": None}, "far_field: None"),
        ({"boxes": 3}, "boxes: 3"),
        ({"boxes": ((0, 0, 0, 1, 1, 1, 0.1),)}, "boxes: .*RefinementBox"),
        ({"boxes": (RefinementBox((0, 0, 0), (1, 1), 0.1),)}, r"boxes: lower \(0, 0, 0\), upper \(1, 1\)"),
        ({"boxes": (RefinementBox((0, 0, 0), (1, 1, 1), "s"),)}, "boxes: cell 's'"),
        ({"fine_parts": "wing"}, "fine_parts: 'wing'"),
        ({"frustums": 3}, "frustums: 3"),
        ({"domain": 3}, "domain: 3"),
    ],
)
def test_bad_settings_name_the_field(settings, word):
    with pytest.raises(InputError, match=word):
        generate(bodies.sphere(), MeshSettings(**settings))


def test_bad_surfaces_are_refused():
    good = bodies.sphere(1.0, 1)
    empty = Surface(np.zeros((0, 3)), np.zeros((0, 3), np.int64), np.zeros(0, np.int32), ("body",))
    with pytest.raises(InputError, match="triangles"):
        generate(empty, MeshSettings(wall_cell=0.3))
    open_one = Surface(good.points, good.triangles[1:], good.part[1:], good.part_names)
    with pytest.raises(InputError, match="watertight"):
        generate(open_one, MeshSettings(wall_cell=0.3))
    inside_out = Surface(good.points, good.triangles[:, ::-1], good.part, good.part_names)
    with pytest.raises(InputError, match="volume"):
        generate(inside_out, MeshSettings(wall_cell=0.3))


def test_body_larger_than_the_domain():
    with pytest.raises(InputError, match="larger than the domain"):
        generate(bodies.sphere(), MeshSettings(wall_cell=0.2, domain=((-3, -3, -3), (3, 3, 0.5))))
    mesh = generate(bodies.sphere(), MeshSettings(wall_cell=0.2, domain=((-3, -3, -3), (4, 3, 3))))
    assert (mesh.far_center.min(axis=0) <= [-3, -3, -3]).all() and (mesh.far_center.max(axis=0) >= [4, 3, 3]).all()
