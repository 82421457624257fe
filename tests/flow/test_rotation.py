"""Steady rotation: uniform air, spheres that spin, and motions described about two centres."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies

from .structured import box, sphere
from .test_topology import THREE, ensemble_on

TURNING = replace(THREE, rates=np.array([[0.02, 0, 0], [0.01, -0.03, 0.02], [0, 0.04, -0.01]]), center=(0.3, -0.2, 0.1))


@pytest.mark.parametrize("mesh", [box(8, 0.0), box(7, 0.25)], ids=["cubes", "warped"])
def test_air_at_rest_stays_seen_from_a_turning_body(mesh):
    ensemble = ensemble_on(mesh, conditions=TURNING)
    ensemble.evaluate()
    scale = THREE.mach.max() ** 3 * ensemble.topology.face_area.max()
    # The moment of a warped face is not that of its mean plane: what is left is of the size of the warp.
    bound = 1e-14 if np.ptp(mesh.cell_volume) < 1e-12 else 1e-4
    assert np.abs(ensemble.residual).max() < bound * scale


def test_swirl_of_a_closed_volume_vanishes_on_cut_cells():
    """Exactly where faces are plane; a piece of curved wall is off by the square of its bend."""
    mesh = generate(bodies.sphere(), MeshSettings(wall_cell=0.25, far_field=1.0))
    topology = ensemble_on(mesh).topology
    total = np.zeros((mesh.cells, 3))
    swirl = topology.face_swirl * topology.face_area[:, None]
    np.add.at(total, topology.face_cells[:, 0], swirl)
    np.add.at(total, topology.face_cells[:, 1], -swirl)
    np.add.at(total, topology.boundary_cell, topology.boundary_swirl * topology.boundary_area[:, None])
    walls = np.zeros(mesh.cells, dtype=bool)
    walls[topology.boundary_cell[: topology.walls]] = True
    assert np.abs(total[~walls]).max() < 1e-12
    assert np.abs(total[walls]).max() < 1e-3 * 0.25**2


def test_conservation_holds_while_turning():
    """Interior fluxes cancel: what is left of all residuals is what turning the axes adds."""
    mesh = box(8, 0.0)
    ensemble = ensemble_on(mesh, conditions=TURNING)
    middle = np.linalg.norm(mesh.cell_center[ensemble.topology.order] - 0.5, axis=1) < 0.2
    ensemble.state[middle] *= np.array([1.3, 0.8, 1.1, 0.7, 1.6])[None, :, None]
    ensemble.evaluate()
    r, u, v, w, _ = np.moveaxis(ensemble.state, 1, 0)
    away = np.stack([u, v, w], axis=-1) - ensemble.free[1:4].T
    spin = TURNING.angular_velocity()[ensemble.lanes]
    force = (ensemble.topology.volume[:, None, None] * r[..., None] * np.cross(spin[None], away)).sum(axis=0)
    power = np.einsum("nx,nx->n", force, ensemble.free[1:4].T)
    expected = np.stack([0 * power, *force.T, power])
    np.testing.assert_allclose(ensemble.residual.sum(axis=0), expected, atol=1e-11)


def test_a_sphere_that_spins_about_the_stream_feels_nothing():
    """Its surface moves along itself and the flow about it is the same all round: no force may change."""
    mach = np.array([2.0, 2.0, 0.5, 0.5])
    rates = np.array([[0, 0, 0], [0.05, 0, 0], [0, 0, 0], [0.05, 0, 0]])
    conditions = FlowConditions(mach, 0 * mach, 0 * mach, rates=rates)
    solution = solve(sphere(24, 10, far=4.0), conditions, FlowSettings(coarse_levels=0, iterations=200))
    assert all(record.good for record in solution.records)
    force = np.array([record.window_mean for record in solution.records])
    still = np.abs(force[0::2]).max()
    np.testing.assert_allclose(force[1::2], force[0::2], atol=1e-3 * still)


def test_one_motion_told_about_two_centres_has_one_pressure():
    """Pitching about the nose of a cone, or about its base with the nose's motion in the free stream."""
    q, arm, mach = 0.05, 1.0, 3.0
    speed = np.array([mach, 0.0, 0.0])
    # The base moves at spin x arm relative to the nose; the air comes the other way.
    seen = speed - np.cross([0.0, q, 0.0], [arm, 0.0, 0.0])
    length = np.linalg.norm(seen)
    body = bodies.cone(np.radians(15.0))
    mesh = generate(body, MeshSettings(wall_cell=0.05, far_field=1.5))
    loads = []
    for m, alpha, center in ((mach, 0.0, 0.0), (length, np.arctan2(seen[2], seen[0]), arm)):
        conditions = FlowConditions(
            np.array([m]), np.array([alpha]), np.zeros(1), rates=np.array([[0.0, q, 0.0]]), center=(center, 0, 0)
        )
        solution = solve(mesh, conditions, FlowSettings())
        assert solution.records[0].good
        loads.append((solution.wall_pressure[:, 0].astype(float) - 1 / 1.4) @ mesh.wall_area)
    still = solve(mesh, FlowConditions(np.array([mach]), np.zeros(1), np.zeros(1)), FlowSettings())
    base = (still.wall_pressure[:, 0].astype(float) - 1 / 1.4) @ mesh.wall_area
    change = loads[0] - base
    assert abs(change[2]) > 0.02 * abs(base[0])
    np.testing.assert_allclose(loads[1] - base, change, atol=0.03 * abs(change[2]))
