"""Cells split where a sizing asks for it: the wall stays exact over several levels, the grading 2:1."""

import numpy as np
import pytest

from spaceplane.errors import InputError
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings, RefinementBox
from spaceplane.mesh.sizing import Sizing, round_edges, split
from spaceplane.mesh.thickness import THIN, Thickness, cells_on_thin_walls

from . import bodies
from .test_generate import check_body, check_shape

CASES = {
    "diamond wing": (bodies.diamond_wing(3.0, 2.0, 0.2), {"wall_cell": 0.4}),
    "turned wing": (bodies.rotated(bodies.diamond_wing(2.0, 1.5, 0.07), 3), {"wall_cell": 0.2}),
    "sphere, fine edges": (bodies.sphere(), {"wall_cell": 0.3, "fine_edges": True}),
    "thin plate, one layer": (
        bodies.from_trimesh(bodies.box(3, 4, 0.05)),
        {"wall_cell": 0.4, "wall_layers": 1, "growth_layers": 1},
    ),
}


def walls_of(mesh):
    """[cell] whether a cell has a wall."""
    found = np.zeros(mesh.cells, bool)
    found[mesh.wall_cell] = True
    return found


def largest_at(mesh, points):
    """Largest size of the cells whose cube holds each point, 0 where none does; points clear of cube faces."""
    found = np.zeros(len(points))
    for n, point in enumerate(points):
        inside = (np.abs(mesh.cell_cube_center - point) < 0.5 * mesh.cell_size[:, None]).all(axis=1)
        found[n] = mesh.cell_size[inside].max(initial=0.0)
    return found


@pytest.mark.parametrize("name", CASES)
def test_walls_of_several_levels_keep_the_body(name):
    surface, kind = CASES[name]
    settings = MeshSettings(**kind, far_field=1.5)
    random = np.random.default_rng(0)
    mesh = generate(surface, settings)
    for _ in range(3):
        marked = (random.random(mesh.cells) < np.where(walls_of(mesh), 0.3, 0.01)) & (mesh.cell_center[:, 0] < 0.4)
        finer = generate(surface, settings, sizing=split(mesh, marked))
        check_body(finer, surface)
        check_shape(finer)
        assert finer.record["symmetric"] == mesh.record["symmetric"]
        asked = np.flatnonzero(marked & (mesh.cell_volume > 0.9 * mesh.cell_size**3))[:50]
        nudge = 0.01 * mesh.cell_size[asked, None]
        assert (largest_at(finer, mesh.cell_cube_center[asked] + nudge) < 0.51 * mesh.cell_size[asked]).all()
        mesh = finer
    assert len(np.unique(mesh.cell_size[mesh.wall_cell])) == 4


def test_nothing_marked_gives_the_same_mesh():
    settings = MeshSettings(wall_cell=0.2, far_field=1.5)
    mesh = generate(bodies.sphere(), settings)
    marked = walls_of(mesh) & (mesh.cell_center[:, 2] > 0.5)
    once = generate(bodies.sphere(), settings, sizing=split(mesh, marked))
    again = generate(bodies.sphere(), settings, sizing=split(once, np.zeros(once.cells, bool)))
    assert once.cells > mesh.cells
    assert np.array_equal(once.cell_center, again.cell_center)
    assert np.array_equal(once.face_area, again.face_area)


def test_a_point_in_the_air_is_graded_for():
    """One point far from the body: a small cell there, neighbours at most twice as large all the way out."""
    settings = MeshSettings(wall_cell=0.4, far_field=2.0)
    point = np.array([[2.31, 0.57, 0.43]])
    mesh = generate(bodies.sphere(), settings, sizing=Sizing(point, np.array([0.1])))
    assert largest_at(mesh, point) == pytest.approx(0.1)
    check_body(mesh, bodies.sphere())
    check_shape(mesh)


def test_a_box_refines_the_wall_inside_it():
    box = RefinementBox((-1.3, -0.4, -0.4), (-0.7, 0.4, 0.4), 0.05)
    mesh = generate(bodies.sphere(), MeshSettings(wall_cell=0.2, far_field=1.5, boxes=(box,)))
    wall = mesh.cell_cube_center[mesh.wall_cell]
    inside = ((wall > box.lower) & (wall < box.upper)).all(axis=1)
    size = mesh.cell_size[mesh.wall_cell]
    assert np.allclose(size[inside], 0.05) and inside.sum() > 100
    assert np.isclose(size, 0.2).sum() > 100
    check_body(mesh, bodies.sphere())
    check_shape(mesh)


def test_marks_on_one_side_split_both():
    mesh = generate(bodies.sphere(), MeshSettings(wall_cell=0.3, far_field=1.5))
    one = walls_of(mesh) & (mesh.cell_center[:, 1] > 0.7)
    finer = generate(bodies.sphere(), MeshSettings(wall_cell=0.3, far_field=1.5), sizing=split(mesh, one))
    small = finer.cell_size < 0.2
    assert small.any() and (finer.cell_center[small, 1] > 0).sum() == (finer.cell_center[small, 1] < 0).sum()


def test_edges_of_thin_wings_get_smaller_cells():
    """A wing within one layer of cells: air connects its sides at the edges only, and there cells are halved."""
    wing = bodies.diamond_wing(5.0, 6.0, 0.4)
    settings = {"wall_cell": 0.8, "far_field": 1.5, "symmetric": False, "offset": (0.382, 0.5)}
    plain = generate(wing, MeshSettings(**settings))
    rim = round_edges(plain)
    low, high = wing.bounds
    away = np.minimum(plain.cell_center - low, high - plain.cell_center)[:, :2].min(axis=1)
    assert rim.sum() > 20 and away[rim].max() < 0.8
    mesh = generate(wing, MeshSettings(**settings, edge_levels=2))
    assert plain.cells < mesh.cells < 2 * plain.cells
    assert round_edges(mesh).sum() < rim.sum() or mesh.cell_size[round_edges(mesh)].max() < 0.5
    check_body(mesh, wing)
    check_shape(mesh)


@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.25, 0.25), (0.382, 0.5), (0.7, 0.3)])
@pytest.mark.parametrize("symmetric", [None, False])
def test_cells_follow_the_thickness_of_a_bevel(offset, symmetric):
    """No cell beside the bevels is larger than the body there allows, in whatever plane of the grid the edges lie."""
    plate = bodies.flat_plate(5.0, 6.0, 0.4, bevel=1.0)
    wall_cell, levels = 0.8, 2
    settings = MeshSettings(
        wall_cell=wall_cell, far_field=1.5, fine_edges=True, edge_levels=levels, offset=offset, symmetric=symmetric
    )
    mesh = generate(plate, settings)
    x = np.minimum(mesh.piece_center[:, 0], 5.0 - mesh.piece_center[:, 0])
    bevel = (np.abs(mesh.piece_area[:, 2]) > 0.0) & (x < 1.0) & (np.abs(mesh.piece_center[:, 1]) < 2.0)
    size = mesh.cell_size[mesh.wall_cell[mesh.piece_wall[bevel]]]
    smallest = wall_cell / 2 / 2**levels
    assert np.isclose(size.min(), smallest) and bevel.sum() > 100
    # thickness 0.4 x; the larger thickness within a cell's length counts, as grid lines bound the cells
    allowed = np.maximum(0.4 * (x[bevel] + size) / THIN, 2.0 * smallest)
    assert (size <= allowed + 1e-9).all()
    assert (size[x[bevel] < 0.1] < 0.25 * wall_cell + 1e-9).all()
    check_body(mesh, plate)
    check_shape(mesh)


def test_edges_in_a_plane_of_the_grid_get_smaller_cells():
    """Cells above and below the plane hold one side of the wing each: the wall turns in none of them."""
    wing = bodies.diamond_wing(5.0, 6.0, 0.4)
    settings = {"wall_cell": 0.8, "far_field": 1.5}
    plain = generate(wing, MeshSettings(**settings))
    leading = np.abs(plain.cell_center - [0.0, 0.0, 0.0]).max(axis=1) < 1.0
    assert plain.record["symmetric"] and not round_edges(plain)[leading].any()
    mesh = generate(wing, MeshSettings(**settings, edge_levels=2))
    first = mesh.piece_center[:, 0] < 0.1
    assert first.any() and mesh.cell_size[mesh.wall_cell[mesh.piece_wall[first]]].max() < 0.25 * 0.8 + 1e-9


def test_cells_wanted_on_thin_walls():
    """As large as the body is thick on `THIN`, but no smaller than allowed: on both its sides, on four of the line."""
    point = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]])
    walls = Thickness(point, np.array([2, 0, 1]), np.array([0.18, 0.01, 5.0]), spacing=0.5)
    found = cells_on_thin_walls(walls, smallest=0.1, largest=0.8)
    assert found.point.shape == (16, 3)
    near = np.linalg.norm(found.point[:, None] - point, axis=2)
    assert (near.min(axis=1) < 0.2).all() and (near[:, 2] > 1.0).all()
    assert np.allclose(found.cell[near[:, 0] < 0.2], 0.18 / THIN) and np.allclose(found.cell[near[:, 1] < 0.2], 0.1)
    above = found.point[(near[:, 0] < 0.2) & (found.point[:, 2] > 3.1)]
    assert np.allclose(above[:, 2], 3.18) and np.unique(np.sign(above[:, :2] - point[0, :2]), axis=0).shape == (4, 2)
    assert not len(cells_on_thin_walls(walls, smallest=0.1, largest=0.1).cell)


def test_thin_walls_are_judged_by_their_own_cells():
    """A plate of 0.3 m: thinner than two cells of 0.2 m, not than two of 0.1 m."""
    plate = bodies.from_trimesh(bodies.box(3, 2, 0.3))
    settings = MeshSettings(wall_cell=0.2, far_field=1.5)
    mesh = generate(plate, settings)
    assert mesh.record["warnings"]
    assert not generate(plate, settings, sizing=split(mesh, walls_of(mesh))).record["warnings"]


@pytest.mark.parametrize(
    ("sizing", "settings", "word"),
    [
        (([[0.0, 0.0, 0.0]], [0.0]), {"wall_cell": 0.2}, "above 0"),
        (([[0.0, 0.0]], [0.1]), {"wall_cell": 0.2}, "do not fit"),
        (([[0.0, 0.0, 0.0]], [0.001]), {"wall_cell": 0.2}, "levels below"),
        (([[0.0, 0.0, 0.0]], [0.1]), {"target_cells": 5000}, "target_cells"),
    ],
)
def test_bad_sizings_are_refused(sizing, settings, word):
    with pytest.raises(InputError, match=word):
        generate(bodies.sphere(), MeshSettings(**settings), sizing=Sizing(*(np.array(a) for a in sizing)))
