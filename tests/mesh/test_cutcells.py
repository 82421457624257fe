"""Control volumes of cut cells against an independent solid modeller, and under forced and soup-like input."""

from itertools import pairwise

import manifold3d
import numpy as np
import pytest
import trimesh

from spaceplane.errors import InputError
from spaceplane.mesh import subdivide
from spaceplane.mesh.cutcells import CutCells, cut_cells

from . import bodies


def cut(points, triangles) -> tuple[CutCells, np.ndarray]:
    """Cut a body given in wall cells; also the integer shift of the window."""
    low = np.floor(points.min(axis=0)) - 2
    shape = tuple((np.floor(points.max(axis=0)) - low + 4).astype(int))
    return cut_cells(points - low, np.asarray(triangles, np.int64), shape), low


def check(result: CutCells, body_volume: float, body_area: float):
    """Total volume and area, closure of every control volume, regions on both sides of every face."""
    inside = (~result.cut & ~result.fluid).sum()
    assert result.cut.sum() - result.volume.sum() + inside == pytest.approx(body_volume, abs=1e-9 * max(body_volume, 1))
    assert result.polygon_size.sum() == pytest.approx(body_area, rel=1e-10)
    assert result.gauss_error < 1e-11
    assert result.folded_edges == 0
    total = np.zeros((len(result.volume), 3))
    rows = np.arange(len(result.face_area))
    vectors = np.zeros((len(rows), 3))
    vectors[rows, result.face_axis] = result.face_area
    for side, sign in ((0, 1.0), (1, -1.0)):
        on = result.face_sides[:, side] >= 0
        np.add.at(total, result.face_sides[on, side], sign * vectors[on])
    np.add.at(total, result.polygon_volume, result.polygon_area)
    assert np.abs(total).max() < 1e-11


def soup(seed: int) -> manifold3d.Manifold:
    """Union of thin plates and rods in all directions."""
    random = np.random.default_rng(seed)
    solids = []
    for _ in range(12):
        plate = random.random() < 0.5
        size = (3.0, 2.0, 0.2) if plate else (0.3, 0.25, 4.0)
        solid = (
            manifold3d.Manifold.cube(size, True).rotate(random.uniform(0, 360, 3)).translate(random.uniform(-2, 2, 3))
        )
        solids.append(solid)
    return manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add)


def as_arrays(solid: manifold3d.Manifold):
    mesh = solid.to_mesh64()
    points, triangles = np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts, np.int64)
    number = np.arange(len(points))
    number[np.asarray(mesh.merge_from_vert, np.int64)] = np.asarray(mesh.merge_to_vert, np.int64)
    return points, number[triangles]


@pytest.mark.parametrize("seed", range(4))
def test_control_volumes_agree_with_a_solid_modeller(seed):
    """Box minus body, decomposed: the same number of pieces with the same volumes in every cell."""
    solid = soup(seed)
    points, triangles = as_arrays(solid)
    result, low = cut(points, triangles)
    check(result, solid.volume(), solid.surface_area())
    assert result.split_cells > 5
    per_cell = {}
    for place, volume in zip(result.cell, result.volume, strict=True):
        per_cell.setdefault(tuple(place), []).append(volume)
    compared = 0
    for place, volumes in per_cell.items():
        cube = manifold3d.Manifold.cube((1, 1, 1)).translate(np.array(place) + low)
        theirs = sorted(piece.volume() for piece in (cube - solid).decompose())
        ours = sorted(v for v in volumes if v > 1e-9)
        theirs = [v for v in theirs if v > 1e-9]
        assert ours == pytest.approx(theirs, abs=1e-8), place
        compared += len(ours) > 1
    assert compared > 5


@pytest.mark.parametrize("seed", range(3))
def test_forced_fans(seed, monkeypatch):
    """Fans replace polygons at random; nothing may change but the polygons."""
    body = trimesh.creation.icosphere(2, 3.3)
    body.apply_transform(trimesh.transformations.random_rotation_matrix(np.random.default_rng(seed).random(3)))
    points = body.vertices + np.array([0.1, 0.2, 0.3])
    plain, _ = cut(points, body.faces)
    random = np.random.default_rng(seed)
    count = 0

    def forced(slab, ends, start, loop):
        nonlocal count
        bad = (np.diff(start) > 3) & (random.random(len(start) - 1) < 0.5)
        count += bad.sum()
        return bad

    monkeypatch.setattr(subdivide, "_folded", forced)
    fanned, _ = cut(points, body.faces)
    assert count > 100
    check(fanned, body.volume, body.area)
    assert np.array_equal(plain.cell, fanned.cell)
    assert np.allclose(plain.volume, fanned.volume, atol=1e-12)
    assert np.allclose(plain.center, fanned.center, atol=1e-7)


def test_slivers_and_micron_triangles():
    """Points packed along the edges of a box down to a millionth of a cell, and triangles without area."""
    body = trimesh.creation.box((4, 4, 4))
    for _ in range(5):
        face = 0
        corners = body.vertices[body.faces[face]]
        weights = np.array([1 - 2e-6, 1e-6, 1e-6])
        extra = weights @ corners
        a, b, c = body.faces[face]
        n = len(body.vertices)
        faces = np.vstack([np.delete(body.faces, face, axis=0), [[a, b, n], [b, c, n], [c, a, n]]])
        body = trimesh.Trimesh(np.vstack([body.vertices, extra]), faces, process=False)
    points = body.vertices + np.array([0.3, 0.0, 1e-7])
    result, _ = cut(points, body.faces)
    check(result, 64.0, 96.0)


@pytest.mark.parametrize("shift", [0.0, 0.5, 1e-13, -1e-13, 1e-6])
def test_faces_in_grid_planes(shift):
    """Coplanar faces, edges on grid lines and vertices on nodes, exactly and nearly."""
    body = trimesh.creation.box((4, 2, 6)).subdivide()
    result, _ = cut(body.vertices + shift, body.faces)
    check(result, 48.0, 88.0)


def test_plate_splits_every_cell_it_crosses():
    body = bodies.box(20, 20, 0.2, at=(0.3, 0.4, 0.5))
    result, _ = cut(body.vertices, body.faces)
    check(result, 80.0, 2 * 400.0 + 4 * 4.0)
    assert result.split_cells == 19 * 19


def test_grid_lines_see_the_same_inside_along_every_axis():
    """Node states summed along z agree with the crossings along x and y: fluid edges have fluid ends."""
    solid = soup(7)
    points, triangles = as_arrays(solid)
    low = np.floor(points.min(axis=0)) - 2
    surface = subdivide.subdivide(points - low, triangles)
    shape = (np.floor(points.max(axis=0)) - low + 4).astype(int)
    states = []
    for axis in range(3):
        on = surface.crossing_axis == axis
        jump = np.zeros(shape, int)
        place = surface.crossing_place[on].copy()
        place[:, axis] += 1
        np.add.at(jump, tuple(place.T), surface.crossing_sign[on])
        states.append(1 + np.cumsum(jump, axis=axis))
    for a, b in pairwise(states):
        assert np.array_equal(a, b)
    assert set(np.unique(states[0])) == {0, 1}


def test_open_surface_is_refused():
    body = trimesh.creation.icosphere(1, 2.0)
    with pytest.raises(InputError, match="watertight"):
        cut(body.vertices, body.faces[:-1])


def test_slight_overlap_is_counted():
    """Two boxes that overlap by a hundredth of a cell, where no grid node sees it."""
    boxes = [bodies.box(4, 4, 4), bodies.box(4, 2, 2, at=(3.99, 0.3, 0.2))]
    points = np.vstack([b.vertices for b in boxes]) + 0.37
    result, _ = cut(points, np.vstack([boxes[0].faces, boxes[1].faces + 8]))
    assert 0 < result.folded_edges < 20


def test_heavily_folded_surface_is_refused():
    """Two copies of a body laid over each other have no clear inside."""
    body = trimesh.creation.icosphere(3, 8.0)
    points = np.vstack([body.vertices, body.vertices + 0.4])
    with pytest.raises(InputError, match="folds"):
        cut(points, np.vstack([body.faces, body.faces + len(body.vertices)]))
