"""Stretched meshes: those of the squeezed body, with the body's own wall again."""

import math

import numpy as np
import pytest

from spaceplane.aero.exact.conical import taylor_maccoll
from spaceplane.errors import InputError
from spaceplane.flow.coarsen import Sequence, sequence
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.mesh.sizing import sizes_of
from spaceplane.mesh.stretch import squeezed, stretched
from spaceplane.validation import bodies

CONE = bodies.cone(math.radians(15.0))


@pytest.fixture(scope="module")
def levels():
    """Three levels about a cone, of cells 2.5 times as long as wide."""
    flat = sequence(generate(squeezed(CONE, 2.5), MeshSettings(wall_cell=0.03, far_field=1.0)), 2)
    return Sequence(tuple(stretched(mesh, 2.5) for mesh in flat.meshes), flat.parents)


def test_the_wall_is_the_bodys(levels):
    """Projected areas by part, in all three directions."""
    mesh = levels.meshes[0]
    for part in range(2):
        mine = mesh.piece_area[mesh.piece_part == part].sum(axis=0)
        assert mine == pytest.approx(-CONE.area_vectors[CONE.part == part].sum(axis=0), abs=1e-12)
    right = mesh.piece_center[:, 1] > 0.0
    theirs = CONE.area_vectors[CONE.centroids[:, 1] > 0.0].sum(axis=0)
    assert mesh.piece_area[right].sum(axis=0) == pytest.approx(-theirs, abs=1e-12)


def test_cells_are_closed_and_fill_the_domain(levels):
    box = np.prod(np.ptp(levels.meshes[0].far_center, axis=0))
    for mesh in levels.meshes:
        assert np.abs(mesh.closure()).max() < 1e-12
        assert mesh.cell_volume.sum() + CONE.volume == pytest.approx(box, rel=1e-9)


def test_stretching_back_gives_the_mesh_again():
    mesh = generate(CONE, MeshSettings(wall_cell=0.1, far_field=1.0))
    again = stretched(stretched(mesh, 4.0), 0.25)
    for name in ("cell_volume", "cell_center", "cell_size", "face_area", "wall_area", "far_center", "piece_center"):
        assert getattr(again, name) == pytest.approx(getattr(mesh, name), rel=1e-12, abs=1e-15)


def test_a_stretched_mesh_is_solved_on_and_is_no_octree(levels):
    """Pressure on a cone at Mach 3 near the exact one."""
    zero = np.zeros(1)
    solution = solve(levels, FlowConditions(np.full(1, 3.0), zero, zero))
    assert solution.records[0].good
    wall = solution.mesh.wall_center
    chosen = (wall[:, 0] > 0.5) & (wall[:, 0] < 0.9)
    cp = np.average(solution.wall_cp()[chosen, 0], weights=np.linalg.norm(solution.mesh.wall_area[chosen], axis=1))
    assert cp == pytest.approx(taylor_maccoll(3.0, math.radians(15.0)).surface_cp, rel=0.05)
    with pytest.raises(InputError, match="octree"):
        sizes_of(solution.mesh)


@pytest.mark.parametrize("factor", [0.0, -1.0, math.nan, math.inf])
def test_factors_that_no_map_can_have(factor):
    mesh = generate(CONE, MeshSettings(wall_cell=0.2, far_field=1.0))
    for refused in (lambda: squeezed(CONE, factor), lambda: stretched(mesh, factor)):
        with pytest.raises(InputError, match="factor"):
            refused()
