"""Meshes that follow the flow: where cells are split, and that it pays."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from spaceplane.aero.integrate import integrate
from spaceplane.errors import InputError
from spaceplane.flow.adapt import refined_mesh, solve_adapted
from spaceplane.flow.adaptation import error_indicator, influence, largest_errors
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import ConvergenceRecord, FlowConditions, Solution
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.mesh.sizing import sizes_of
from spaceplane.validation import bodies
from spaceplane.validation.flowcase import reference_of

TWENTY = math.radians(20.0)
SMALL = MeshSettings(wall_cell=0.25, far_field=2.0)


def made_up(mesh, states, machs, verdicts=None):
    """A solution with given states [cell, 5] of each condition."""
    zero = np.zeros(len(machs))
    records = tuple(
        ConvergenceRecord(v, 3.0, 9, zero, zero, zero, zero) for v in verdicts or ["converged"] * len(machs)
    )
    state = np.stack(states, axis=2)
    return Solution(mesh, FlowConditions(np.array(machs), zero, zero), state, zero, records)


def uniform(mesh, mach):
    """[cell, 5] free stream."""
    return np.tile([1.0, mach, 0.0, 0.0, 1.0 / 1.4], (mesh.cells, 1))


@pytest.fixture(scope="module")
def mesh():
    return generate(bodies.sphere(), SMALL)


def stepped(mesh, mach, where):
    """Free stream with the pressure doubled in the cells `where`."""
    state = uniform(mesh, mach)
    state[where, 4] *= 2.0
    return state


def test_uniform_flow_has_no_error_and_splits_nothing(mesh):
    error = error_indicator(made_up(mesh, [uniform(mesh, 2.0)], [2.0]))
    assert (error == 0.0).all()
    assert not largest_errors(error, 10).any()


def test_error_lies_where_the_flow_changes(mesh):
    step = np.flatnonzero(mesh.cell_center[:, 0] > -0.5)
    error = error_indicator(made_up(mesh, [stepped(mesh, 2.0, step)], [2.0]))
    at = mesh.cell_center[error > 0.0, 0]
    assert np.abs(at + 0.5).max() < mesh.cell_size.max()
    assert error.sum() == pytest.approx(1.0)


def test_every_condition_counts_the_same(mesh):
    """A weak jump below Mach 1 is not starved by a strong one at Mach 10; a failed condition does not count."""
    ahead, above = mesh.cell_center[:, 0] < -0.4, mesh.cell_center[:, 2] > 1.3
    states = [stepped(mesh, 10.0, ahead), uniform(mesh, 0.8)]
    states[1][above, 4] *= 1.01
    both = error_indicator(made_up(mesh, states, [10.0, 0.8]))
    alone = error_indicator(made_up(mesh, states[1:], [0.8]))
    assert (both >= alone).all() and both.sum() > 1.5
    failed = error_indicator(made_up(mesh, states, [10.0, 0.8], ["failed", "converged"]))
    assert np.array_equal(failed, alone)


def test_what_cannot_reach_the_body_does_not_count(mesh):
    """Mach 3: none behind the Mach lines that meet the body's end, some ahead of them; some everywhere at Mach 0.5."""
    x, radius = mesh.cell_center[:, 0], np.hypot(mesh.cell_center[:, 1], mesh.cell_center[:, 2])
    distance = np.maximum(np.hypot(x - 1.0, radius) - 1.0, 0.0)
    fast = influence(made_up(mesh, [uniform(mesh, 3.0)], [3.0]), 0, distance)
    slow = influence(made_up(mesh, [uniform(mesh, 0.5)], [0.5]), 0, distance)
    behind = x + distance * math.sqrt(8.0) > 2.5 + mesh.cell_size
    ahead = x + distance * math.sqrt(8.0) < 1.9
    assert behind.sum() > 100 and (fast[behind] == 0.0).all()
    assert ahead.sum() > 100 and (fast[ahead] > 0.0).all()
    assert (slow > 0.0).all()
    assert fast.max() <= 1.0 and slow.max() <= 1.0


def test_refined_mesh_meets_its_number_of_cells(mesh):
    step = np.flatnonzero(mesh.cell_center[:, 0] > -0.5)
    solution = made_up(mesh, [stepped(mesh, 2.0, step)], [2.0])
    target = 1.6 * mesh.cells
    finer = refined_mesh(bodies.sphere(), SMALL, solution, target)
    assert finer.cells == pytest.approx(target, rel=0.12)
    center = finer.cell_center[finer.cell_size < 0.2]
    assert np.abs(center[:, 0] + 0.5).max() < 0.8


def test_a_cone_is_as_good_with_a_third_of_the_cells():
    """Taylor-Maccoll at Mach 3: surface Cp 0.28427. Uniform refinement: 7.1 % low at 21 000 cells, 3.9 % at 56 000."""
    cone, wind = bodies.cone(TWENTY), FlowConditions(np.array([3.0]), np.zeros(1), np.zeros(1))
    reference = reference_of(math.pi * math.tan(TWENTY) ** 2, 1.0)

    def error(passes):
        settings = MeshSettings(target_cells=20_000, far_field=3.0)
        solution = solve_adapted(cone, settings, wind, FlowSettings(), passes)
        assert solution.records[0].good
        assert solution.mesh.cells == pytest.approx(20_000, rel=0.15)
        axial = integrate(solution, reference).sel(part="total").CA_forebody
        return abs(float(axial[0]) / 0.28427 - 1.0), solution

    plain, _ = error(0)
    adapted, solution = error(1)
    assert plain > 0.06
    assert adapted < 0.6 * plain
    assert solution.statistics["adaptation"][-1] == solution.mesh.cells > 2 * solution.statistics["adaptation"][0]
    assert solution.mesh.record["volume_error"] < 1e-10 and solution.mesh.record["area_error"] < 1e-10


@pytest.mark.parametrize(
    ("passes", "settings", "word"),
    [
        (4, MeshSettings(target_cells=20_000), "adapt: 4"),
        (-1, MeshSettings(target_cells=20_000), "adapt: -1"),
        (1, MeshSettings(wall_cell=0.3), "target_cells"),
    ],
)
def test_bad_passes_are_refused(passes, settings, word):
    wind = FlowConditions(np.array([3.0]), np.zeros(1), np.zeros(1))
    with pytest.raises(InputError, match=word):
        solve_adapted(bodies.sphere(), settings, wind, FlowSettings(), passes)


def test_cells_are_joined_where_the_error_went(mesh):
    """A step that moves: cells split about its old place are joined again, within the same number of cells."""
    first = np.flatnonzero(mesh.cell_center[:, 0] > -0.5)
    solution = made_up(mesh, [stepped(mesh, 2.0, first)], [2.0])
    fine = refined_mesh(bodies.sphere(), SMALL, solution, 2.0 * mesh.cells)
    moved = fine.cell_center[:, 2] > 1.3
    target = 1.2 * fine.cells
    again = refined_mesh(bodies.sphere(), SMALL, made_up(fine, [stepped(fine, 2.0, moved)], [2.0]), target)
    assert again.cells == pytest.approx(target, rel=0.12)
    smallest = fine.cell_size.min()

    def small_at_first_step(which):
        at = np.abs(which.cell_center[:, 0] + 0.5) < 0.3
        far = at & (which.cell_center[:, 2] < 0.5)
        return int((which.cell_size[far] <= 1.01 * smallest).sum())

    assert small_at_first_step(fine) > 500
    assert small_at_first_step(again) < 0.1 * small_at_first_step(fine)


def test_sizes_of_a_mesh_make_it_again(mesh):
    step = np.flatnonzero(mesh.cell_center[:, 0] > -0.5)
    fine = refined_mesh(bodies.sphere(), SMALL, made_up(mesh, [stepped(mesh, 2.0, step)], [2.0]), 1.6 * mesh.cells)
    again = generate(bodies.sphere(), SMALL, sizing=sizes_of(fine))
    assert again.cells == fine.cells
    assert np.array_equal(again.cell_volume, fine.cell_volume)
    coarse = generate(bodies.sphere(), replace(SMALL, wall_cell=0.5), sizing=sizes_of(fine, 2.0))
    assert coarse.cells < 0.4 * fine.cells
    assert coarse.cell_size.min() == pytest.approx(2.0 * fine.cell_size.min())
