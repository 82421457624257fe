"""Coarser companions are nested, closed and keep the wall."""

import numpy as np
import pytest

from spaceplane.errors import InputError
from spaceplane.mesh.coarsen import coarsen
from spaceplane.mesh.generate import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings

from . import bodies


def test_coarse_meshes_are_nested_and_conserve():
    surface = bodies.diamond_wing(2.0, 2.0, 0.06)
    coarse = generate(surface, MeshSettings(wall_cell=0.05))
    for _ in range(2):
        fine = coarse
        coarse, holder = coarsen(fine)
        assert coarse.cells < 0.6 * fine.cells
        assert np.allclose(np.bincount(holder, fine.cell_volume), coarse.cell_volume, rtol=1e-12)
        assert np.abs(coarse.closure()).max() < 1e-12
        assert np.abs(coarse.piece_area.sum(axis=0)).max() < 1e-12
        for part in range(len(surface.part_names)):
            a = coarse.piece_area[coarse.piece_part == part].sum(axis=0)
            b = fine.piece_area[fine.piece_part == part].sum(axis=0)
            assert np.allclose(a, b, atol=1e-12)
        away = np.abs(fine.cell_center - coarse.cell_cube_center[holder]).max(axis=1) / coarse.cell_size[holder]
        assert np.quantile(away, 0.99) < 0.51
        moments = [np.bincount(holder, fine.cell_volume * x) for x in fine.cell_center.T]
        assert np.allclose(np.stack(moments, 1) / coarse.cell_volume[:, None], coarse.cell_center, atol=1e-10)


def test_walls_of_a_thin_plate_stay_apart():
    """The two sides of a plate lie in one coarse cube, but in two control volumes."""
    surface = bodies.from_trimesh(bodies.box(4, 4, 0.05, at=(0, 1, 0.031)))
    coarse, _ = coarsen(generate(surface, MeshSettings(wall_cell=0.1)))
    wall = coarse.wall_area
    inner = np.abs(coarse.wall_center[:, :2] - [0, 1]).max(axis=1) < 1.5
    assert np.abs(wall[inner, 2]).min() > 0.01


def test_imported_mesh_cannot_be_coarsened():
    mesh = generate(bodies.sphere(1.0, 1), MeshSettings(wall_cell=0.5))
    plain = Mesh(**{**vars(mesh), "record": {}, "cell_cube_center": None})
    with pytest.raises(InputError, match="octree"):
        coarsen(plain)
