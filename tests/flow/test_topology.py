"""The kernels' view of a mesh: free stream, exact gradients, colours, coarse levels."""

from __future__ import annotations

import numpy as np
import pytest

from spaceplane.flow.coarsen import sequence
from spaceplane.flow.ensemble import Ensemble
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.topology import prepare

from .structured import box, sphere

THREE = FlowConditions(np.array([0.3, 2.0, 10.0]), np.array([0.1, -0.2, 0.4]), np.array([0.0, 0.1, -0.05]))


def ensemble_on(mesh, precision="double", conditions=THREE, **settings):
    settings = FlowSettings(precision=precision, **settings)
    return Ensemble(mesh, prepare(mesh, settings.dtype), conditions, settings, settings.order)


@pytest.mark.parametrize(("precision", "bound"), [("double", 1e-14), ("single", 2e-6)])
def test_free_stream_stays_on_a_distorted_mesh(precision, bound):
    ensemble = ensemble_on(box(8, 0.25), precision)
    ensemble.evaluate()
    scale = THREE.mach.max() ** 3 * ensemble.topology.face_area.max()
    assert np.abs(ensemble.residual).max() < bound * scale


@pytest.mark.parametrize("mesh", [box(7, 0.25), sphere(6, 6)], ids=["box", "sphere"])
def test_gradients_of_linear_fields_are_exact(mesh):
    ensemble = ensemble_on(mesh, limiter="none", flux="hllc", wake_calming=0.0)
    slopes = np.random.default_rng(1).uniform(-0.02, 0.02, (5, 3))
    center = mesh.cell_center[ensemble.topology.order]
    ensemble.state += (center @ slopes.T)[:, :, None]
    ensemble.reconstruct()
    found = ensemble.gradient.reshape(mesh.cells, 3, 5, -1)
    np.testing.assert_allclose(found, np.broadcast_to(slopes.T[None, :, :, None], found.shape), atol=1e-10)


def test_conservation_interior_fluxes_cancel():
    """The sum of all residuals is the flux through the boundary alone: here it equals that of a field constant near
    it."""
    mesh = box(8, 0.2)
    ensemble = ensemble_on(mesh)
    middle = np.linalg.norm(mesh.cell_center[ensemble.topology.order] - 0.5, axis=1) < 0.2
    ensemble.state[middle] *= np.array([1.3, 0.8, 1.1, 0.7, 1.6])[None, :, None]
    ensemble.evaluate()
    assert np.abs(ensemble.residual).max() > 1e-3
    np.testing.assert_allclose(ensemble.residual.sum(axis=0), 0.0, atol=1e-11)


def test_blocks_of_one_colour_do_not_touch():
    topology = prepare(box(16), np.float64)
    block = np.repeat(np.arange(len(topology.block_cells) - 1), np.diff(topology.block_cells))
    color = np.empty(len(topology.block_cells) - 1, dtype=int)
    for c in range(len(topology.color_start) - 1):
        color[topology.color_blocks[topology.color_start[c] : topology.color_start[c + 1]]] = c
    a, b = block[topology.face_cells].T
    assert (color[a] != color[b])[a != b].all()
    assert np.array_equal(np.sort(topology.color_blocks), np.arange(len(color)))


def test_coarse_levels_keep_volume_walls_and_closure():
    mesh = sphere(16, 12)
    levels = sequence(mesh, 2, fewest=50)
    assert len(levels.meshes) > 1
    for k, parent in enumerate(levels.parents):
        fine, coarse = levels.meshes[k], levels.meshes[k + 1]
        assert coarse.cells < 0.8 * fine.cells
        np.testing.assert_allclose(np.bincount(parent, fine.cell_volume), coarse.cell_volume)
        np.testing.assert_allclose(coarse.wall_area.sum(axis=0), fine.wall_area.sum(axis=0), atol=1e-12)
        assert np.abs(coarse.closure()).max() < 1e-12
