"""The whole solver: ensembles, symmetry, failure handling, records."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from spaceplane.errors import InputError
from spaceplane.flow.compiled import LANES
from spaceplane.flow.ensemble import Ensemble
from spaceplane.flow.history import History
from spaceplane.flow.march import LEAST_PATIENCE, PATIENCE, converged, finished
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.flow.topology import prepare

from .structured import sphere

MESH = sphere(16, 8, far=6.0)
SMALL = FlowSettings(coarse_levels=1, iterations=60, coarse_iterations=30)


def conditions(mach, alpha_deg=None, beta_deg=None):
    mach = np.array(mach, dtype=float)
    alpha = np.zeros(len(mach)) if alpha_deg is None else np.radians(alpha_deg)
    beta = np.zeros(len(mach)) if beta_deg is None else np.radians(beta_deg)
    return FlowConditions(mach, alpha, beta)


def force(solution):
    """[condition, xyz] pressure force over free-stream dynamic pressure."""
    return solution.wall_cp().T.astype(float) @ solution.mesh.wall_area


@pytest.fixture(scope="module")
def family():
    return solve(MESH, conditions([2.0, 3.0, 1.5], [10.0, 10.0, 0.0], [5.0, -5.0, 5.0]), SMALL)


def test_a_condition_alone_equals_itself_in_an_ensemble(family):
    alone = solve(MESH, conditions([3.0], [10.0], [-5.0]), SMALL)
    assert alone.records[0].iterations == family.records[1].iterations
    # In the lee the pressure is 3 % of the free stream's 1/gamma, which is the measure there.
    np.testing.assert_allclose(alone.wall_pressure[:, 0], family.wall_pressure[:, 1], rtol=2e-4, atol=2e-4 / 1.4)
    np.testing.assert_allclose(force(alone)[0], force(family)[1], rtol=1e-4, atol=1e-4)


def test_conditions_that_wait_for_a_lane_equal_themselves_alone():
    """More conditions than lanes: the last ones begin when others are done, in lanes with another's past."""
    many = LANES + 3
    # Faster flows pass waves on the way that make round-off grow until an iteration more or less is a matter of chance.
    together = solve(MESH, conditions(np.linspace(1.2, 2.0, many), np.linspace(0.0, 12.0, many)), SMALL)
    assert sum(record.good for record in together.records) > 0.9 * many
    c = together.conditions
    for k in (0, many - 2, many - 1):
        assert together.records[k].good
        alone = solve(MESH, FlowConditions(c.mach[[k]], c.alpha[[k]], c.beta[[k]]), SMALL)
        assert alone.records[0].iterations == together.records[k].iterations
        np.testing.assert_allclose(force(alone)[0], force(together)[k], rtol=1e-4, atol=1e-4)


def test_state_shapes_and_precision(family):
    assert family.state.shape == (MESH.cells, 5, 3) and family.state.dtype == np.float32
    assert family.wall_pressure.shape == (len(MESH.wall_cell), 3)
    assert np.isfinite(family.state).all() and (family.state[:, [0, 4]] > 0).all()
    for record in family.records:
        assert len(record.residual_history) == record.iterations + 1 == len(record.force_history)
        assert record.residual_drop == pytest.approx(-record.residual_history[-1])


def test_no_sideslip_means_no_side_force():
    solution = solve(MESH, conditions([2.0, 0.6], [15.0, 15.0]), SMALL)
    assert np.abs(force(solution)[:, 1]).max() < 1e-5


def test_opposite_sideslip_mirrors():
    deep = dataclasses.replace(SMALL, residual_drop=3.5, least_drop=3.0, iterations=150)
    solution = solve(MESH, conditions([2.0, 2.0], [5.0, 5.0], [8.0, -8.0]), deep)
    right, left = force(solution)
    assert right[1] < -0.05
    np.testing.assert_allclose(right * [1, -1, 1], left, rtol=2e-3, atol=2e-3)


def test_double_precision_agrees_with_single(family):
    double = solve(MESH, family.conditions, dataclasses.replace(SMALL, precision="double"))
    assert double.state.dtype == np.float64
    np.testing.assert_allclose(force(double), force(family), rtol=3e-3, atol=3e-3)


def test_a_broken_condition_is_failed_and_the_others_go_on(monkeypatch):
    plain = Ensemble.apply

    def poison(self, largest, calm):
        share = plain(self, largest, calm)
        self.state[0, 0, self.conditions.mach[self.lanes] == 2.5] = np.nan
        return share

    monkeypatch.setattr(Ensemble, "apply", poison)
    solution = solve(MESH, conditions([2.0, 2.5], [5.0, 5.0]), SMALL)
    good, bad = solution.records
    assert good.good and good.reason == ""
    assert bad.verdict == "failed" and not bad.good and "not a number" in bad.reason
    assert np.isnan(solution.state[:, :, 1]).all() and np.isnan(solution.wall_pressure[:, 1]).all()
    assert np.isfinite(solution.state[:, :, 0]).all()
    assert solution.statistics["retried"] == [1]
    assert any("failed" in text for text in solution.statistics["warnings"])


def test_too_few_iterations_are_never_called_converged():
    solution = solve(MESH, conditions([0.8]), dataclasses.replace(SMALL, iterations=3, coarse_levels=0))
    assert not solution.records[0].good and solution.records[0].reason


def test_progress_tells_phases():
    heard = []
    solve(MESH, conditions([2.0]), SMALL, lambda phase, done, total, text: heard.append((phase, done, total, text)))
    assert {"fine"} <= {phase for phase, *_ in heard}
    assert all(0 <= done <= total for _, done, total, _ in heard)


def test_mach_zero_is_refused():
    with pytest.raises(InputError, match="mach"):
        solve(MESH, conditions([0.0]), SMALL)


def test_more_conditions_than_lanes():
    mach = np.linspace(2.0, 3.0, 35)
    solution = solve(
        sphere(8, 4, far=4.0), conditions(mach), dataclasses.replace(SMALL, coarse_levels=0, iterations=30)
    )
    drag = force(solution)[:, 0]
    assert np.isfinite(drag).all() and len(solution.records) == 35
    assert np.abs(np.diff(drag)).max() < 0.05 * drag.mean()


def test_the_free_stream_s_residual_is_known_without_solving():
    """It bounds the residual by which falls are measured: a coarse level gone astray gains no decades."""
    streams = conditions([2.0, 0.6], [15.0, 5.0], [3.0, 0.0])
    ensemble = Ensemble(MESH, prepare(MESH, np.float64), streams, FlowSettings(precision="double"), 2)
    np.testing.assert_allclose(ensemble.evaluate()[:2], ensemble.impulsive_norms(), rtol=1e-12)
    astray = History(impulsive=1.0, residual=[1e9, 1e-1])
    assert astray.drop() == pytest.approx(1.0)
    assert History(impulsive=1.0, residual=[1e-1, 1e-3]).drop() == pytest.approx(2.0)


def test_next_to_no_force_may_stand_still():
    """Below Mach 1 a sphere has no drag but error: wandering by 0.2 % of that is no unsteadiness."""
    settings = FlowSettings()
    residual = [10.0**-d for d in np.linspace(0.0, 3.5, 60)]
    for size, good in ((4e-4, True), (4e-2, False)):
        force = [np.array([size * (1.0 + 2e-4 * k), 0.0, 0.0]) for k in range(60)]
        force[50:] = [force[50]] * 10
        assert converged(History(residual=list(residual), force=force), settings) is good


@pytest.mark.parametrize(
    ("slope", "at_a_plateau", "at_three_decades"), [(3.1e-5, False, False), (2.5e-5, False, True), (1.3e-5, True, True)]
)
def test_a_force_that_creeps_is_not_standing(slope, at_a_plateau, at_three_decades):
    """What passes for standing over thirty iterations does not over eighty; below three decades it may creep less."""
    settings = FlowSettings()
    residual = [10.0 ** -min(d, 2.6) for d in np.linspace(0.0, 5.2, 200)]
    force = [np.array([1.0, 0.0, 2.0]) * (1.0 + slope * k) for k in range(200)]
    history = History(residual=list(residual), force=force)
    assert history.spread(3 * settings.window) < settings.force_tolerance
    assert converged(history, settings) is at_a_plateau
    assert converged(History(residual=[*residual[:-1], 1e-4], force=force), settings) is at_three_decades


def test_limiters_agree_on_a_bow_shock_and_converge():
    forces = []
    for limiter in ("venkatakrishnan", "barth_jespersen"):
        solution = solve(MESH, conditions([1.5, 2.0], [5.0, 5.0]), FlowSettings(limiter=limiter))
        assert all(record.good and record.residual_drop > 2.5 for record in solution.records)
        forces.append(force(solution))
    np.testing.assert_allclose(*forces, atol=0.03)
    assert not np.array_equal(*forces)


def test_a_residual_that_stands_still_is_waited_for():
    """Standing forces and a plateau at 2.4 decades: done after eight windows; two will do where iterations end."""
    settings, force = FlowSettings(), np.array([1.0, 0.0, 2.0])
    residual = [10.0**-d for d in np.linspace(0.0, 2.4, 25)]
    history = History(residual=list(residual), force=[force] * len(residual))
    good = []
    while not finished(history, settings) and history.age < 150:
        good.append(converged(history, settings))
        history.residual.append(residual[-1])
        history.force.append(force)
    assert len(good) == PATIENCE * settings.window
    assert good.index(True) == LEAST_PATIENCE * settings.window and all(good[good.index(True) :])
