"""Walls in planes of the grid belong to the cells of the air beside them."""

from __future__ import annotations

import numpy as np
import pytest

from spaceplane.mesh.coplanar import beside_planes
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings

from . import bodies


@pytest.mark.parametrize("noise", [0.0, 2e-15])
def test_faces_in_planes_lie_in_the_slabs_of_the_air(noise):
    box = bodies.from_trimesh(bodies.box(2.0, 4.0, 6.0))
    points = box.points + 10.0
    moved = beside_planes(points + noise * np.sign(10.0 - points), box.triangles)
    slab = np.floor(moved).astype(int)
    expected = np.where(points < 10.0, np.round(points) - 1, np.round(points)).astype(int)
    np.testing.assert_array_equal(slab, expected)
    assert np.abs(moved - points).max() < 1e-13


def test_nothing_else_moves():
    """Neither faces beside planes, nor those in a plane of symmetry, nor corners that two faces pull apart."""
    box = bodies.from_trimesh(bodies.box(2.0, 4.0, 6.0))
    beside = box.points + 10.1
    np.testing.assert_array_equal(beside_planes(beside, box.triangles), beside)
    inside = box.points + 10.0
    mirror = inside[:, 1].min()
    np.testing.assert_array_equal(beside_planes(inside, box.triangles, mirror)[:, 1], inside[:, 1])
    sheet = np.vstack([box.triangles, box.triangles[:, ::-1]])
    np.testing.assert_array_equal(beside_planes(inside, sheet), inside)


@pytest.mark.parametrize("size", [0.4, 0.8])
def test_walls_in_planes_stay_with_their_own_cells(size):
    """No cell holds wall or faces from the other side of an edge, as merged volumes of nothing would."""
    plate = bodies.from_trimesh(bodies.box(5.0, 6.0, 0.4))
    mesh = generate(plate, MeshSettings(wall_cell=size, far_field=1.5, symmetric=False, offset=(0.0, 0.0)))
    assert max(mesh.record["area_error"], mesh.record["projected_area_error"], mesh.record["volume_error"]) < 1e-12
    away = np.abs(mesh.piece_center - mesh.cell_center[mesh.wall_cell[mesh.piece_wall]]).max(axis=1)
    assert (away / mesh.cell_size[mesh.wall_cell[mesh.piece_wall]]).max() < 0.51
    between = np.abs(mesh.face_center[:, None] - mesh.cell_center[mesh.face_cells]).max(axis=2)
    assert (between / mesh.cell_size[mesh.face_cells]).max() < 0.7
