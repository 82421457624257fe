"""Dead water, the shock sensor, total enthalpy, frozen limits, the end game and steps taken back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from spaceplane.flow.bounds import at_bound, bounded, least_values
from spaceplane.flow.compiled import LANES
from spaceplane.flow.deadwater import dead_water
from spaceplane.flow.freezing import Freezer
from spaceplane.flow.history import History
from spaceplane.flow.march import Caution, Steering, creeps, highest_cfl
from spaceplane.flow.reconstruction import shock_weight, spare_oblique
from spaceplane.flow.residual import guarded
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.flow.topology import Stencils
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies

from .structured import sphere
from .test_topology import ensemble_on

GAMMA = 1.4


def calming(speed, pressure, mach):
    """Dead-water weight where the air has this speed (on V_inf) and Cp."""
    p0 = 1.0 / GAMMA
    weight = getattr(dead_water, "py_func", dead_water)
    values = (speed * mach, 0.0, 0.0, p0 + 0.5 * mach**2 * pressure, p0, 2.0 / mach**2, 1.0)
    return weight(*(np.float64(v) for v in values))


@pytest.mark.parametrize("mach", [0.3, 0.8, 2.5, 10.0])
def test_attached_flow_is_no_dead_water(mach):
    """Stagnation point, free stream and an isentropic expansion to twice the Mach number keep their slopes."""
    ratio = (1 + 0.2 * mach**2) / (1 + 0.8 * mach**2)
    stagnation = ((1 + 0.2 * mach**2) ** 3.5 - 1) / (0.7 * mach**2) if mach < 1 else 1.5
    assert calming(0.0, stagnation, mach) == 0.0
    assert calming(1.0, 0.0, mach) == 0.0
    assert calming(2 * np.sqrt(ratio), (ratio**3.5 - 1) / (0.7 * mach**2), mach) == 0.0


@pytest.mark.parametrize("mach", [0.3, 0.8, 2.5, 10.0])
def test_still_air_at_base_pressure_is_calmed(mach):
    assert calming(0.1, -0.1 / mach, mach) == 1.0
    assert 0.0 < calming(0.6, 0.0, mach) < 1.0


def test_the_shock_sensor_needs_compression_and_has_no_jump():
    weight = getattr(shock_weight, "py_func", shock_weight)
    at = [weight(*(np.float64(v) for v in (4.0, c, 0.0, 1.0))) for c in (-0.5, 0.0, 0.1, 0.2, 1.0)]
    assert at == pytest.approx([0.0, 0.0, 0.5, 1.0, 1.0])
    assert weight(*(np.float64(v) for v in (1.4, 1.0, 0.0, 1.0))) == 0.0


def test_a_step_cannot_heat_air_beyond_the_ceiling_nor_break_it():
    ensemble = ensemble_on(sphere(6, 6))
    before = ensemble.state.copy()
    ensemble.change[:, 4] = 0.5 * before[:, 4]
    ensemble.change[3] = np.nan
    limited = ensemble.apply(0.4, np.zeros(len(ensemble.lanes), dtype=bool))
    r, u, v, w, p = np.moveaxis(ensemble.state, 1, 0)
    enthalpy = GAMMA / (GAMMA - 1) * p / r + 0.5 * (u**2 + v**2 + w**2)
    free = 1 / (GAMMA - 1) + 0.5 * ensemble.conditions.mach[ensemble.lanes] ** 2
    assert (enthalpy <= 1.2 * free * (1 + 1e-12)).all()
    np.testing.assert_array_equal(ensemble.state[3], before[3])
    np.testing.assert_allclose(ensemble.state[:, 0], np.where(np.arange(len(before))[:, None] == 3, before[3, 0], r))
    # The ceiling holds back no step: only the cell that was not a number counts.
    np.testing.assert_allclose(limited, 1 / len(before))


def test_a_cell_held_back_marches_slowly_and_recovers_alone():
    ensemble = ensemble_on(sphere(6, 6))
    calm = np.zeros(len(ensemble.lanes), dtype=bool)
    ensemble.change[5, 4, 1] = -0.9 * ensemble.state[5, 4, 1]
    ensemble.apply(0.4, calm)
    assert ensemble.pace[5, 1] == 0.5
    assert (ensemble.pace == 1.0).sum() == ensemble.pace.size - 1
    ensemble.change[:] = 0.0
    for expected in (0.75, 1.0, 1.0):
        ensemble.apply(0.4, calm)
        assert ensemble.pace[5, 1] == expected


def test_a_base_pulls_no_vacuum():
    ensemble = ensemble_on(sphere(6, 6))
    calm = np.zeros(len(ensemble.lanes), dtype=bool)
    for _ in range(40):
        ensemble.change[:, [0, 4]] = -0.3 * ensemble.state[:, [0, 4]]
        ensemble.apply(0.4, calm)
    density, pressure = least_values(ensemble.conditions.mach[ensemble.lanes], GAMMA)
    np.testing.assert_allclose(ensemble.state[:, 0], np.tile(density, (len(ensemble.state), 1)), rtol=1e-6)
    np.testing.assert_allclose(ensemble.state[:, 4], np.tile(pressure, (len(ensemble.state), 1)), rtol=1e-6)


@pytest.mark.parametrize(("mach_behind", "kept"), [(0.8, 0.0), (1.35, 0.458), (2.0, 1.0)])
def test_slopes_are_kept_in_shocks_with_supersonic_flow_behind(mach_behind, kept):
    """One cell at `mach_behind` among others at Mach 4 keeps this part of its slopes."""
    ensemble = ensemble_on(sphere(6, 6))
    lanes = len(ensemble.lanes)
    ensemble.state[:, 0], ensemble.state[:, 4] = 1.0, 1.0 / GAMMA
    ensemble.state[:, 1:4] = np.array([4.0, 0.0, 0.0])[:, None]
    ensemble.state[7, 1] = mach_behind
    cut = np.ones(lanes)
    spare_oblique(
        ensemble.topology.part(Stencils), ensemble.state.reshape(len(ensemble.state), -1), 7, np.float64(GAMMA), cut
    )
    np.testing.assert_allclose(1 - cut, kept, atol=1e-3)


def test_a_step_taken_back_restores_its_lane_only():
    ensemble = ensemble_on(sphere(6, 6))
    before = ensemble.state.copy()
    ensemble.change[:, 0] = 0.01
    ensemble.apply(0.4, np.zeros(len(ensemble.lanes), dtype=bool))
    after = ensemble.state.copy()
    ensemble.undo(np.arange(len(ensemble.lanes)) == 1)
    np.testing.assert_allclose(ensemble.state[:, :, 1], before[:, :, 1], rtol=1e-12)
    np.testing.assert_array_equal(ensemble.state[:, :, 0], after[:, :, 0])


def test_a_jump_of_the_residual_is_rejected_once_the_cfl_can_fall():
    steering = Steering(np.array([0.8, 0.8]), Caution(25.0, 100.0), impulsive=False)
    first = np.array([1.0, 1.0])
    assert not steering.rejected(first).any()
    steering.advance(first, np.zeros(2))
    cfl = steering.cfl.copy()
    np.testing.assert_array_equal(steering.rejected(np.array([0.9, np.nan])), [False, True])
    np.testing.assert_allclose(steering.cfl, cfl * [1.0, 0.3])


def test_the_guard_of_reconstructed_values_has_no_jump():
    guard = getattr(guarded, "py_func", guarded)
    value = np.float64(2.0)
    steps = [guard(value, np.float64(new)) for new in np.linspace(-1.0, 3.0, 401)]
    assert min(steps) == pytest.approx(0.4)
    assert np.abs(np.diff(steps)).max() < 0.0101


def test_increments_stop_at_the_least_density_and_pressure():
    bound, at = (getattr(function, "py_func", function) for function in (bounded, at_bound))
    thinnest, faintest = least_values(np.array([2.0]), GAMMA)[:, 0]
    thin = np.float64(2 * thinnest)
    dr, dp = bound(thin, thin, -1.0, -1.0, thinnest, faintest)
    assert thin + dr == pytest.approx(thinnest)
    assert thin + dp == pytest.approx(faintest)
    assert at(thin + dr, thin, thinnest, faintest) and at(thin, thin + dp, thinnest, faintest)
    assert not at(thin, thin, thinnest, faintest)
    assert bound(thin, thin, 1.0, 2.0, thinnest, faintest) == (1.0, 2.0)


def test_what_the_least_pressure_adds_is_not_seen_in_cp():
    mach = np.array([0.8, 1.2, 2.0, 2.5, 2.6, 2.75, 3.0, 5.0, 10.0, 25.0])
    density, pressure = least_values(mach, GAMMA)
    assert (GAMMA * pressure / (0.5 * GAMMA * mach**2) < 5e-4).all()
    np.testing.assert_allclose(GAMMA * pressure, 0.5 * density**GAMMA)
    assert (np.diff(density) >= 0.0).all() and density.max() < 0.021


def test_a_velocity_changes_by_no_more_than_the_fastest_signal():
    """A wilder step, brought down to the ceiling of total enthalpy, would leave next to no pressure."""
    ensemble = ensemble_on(sphere(6, 6))
    before = ensemble.state.copy()
    ensemble.change[:, 1] = 1e6
    limited = ensemble.apply(0.4, np.zeros(len(ensemble.lanes), dtype=bool))
    np.testing.assert_allclose(limited, 1.0)
    (_, u, v, w, p), (rho, u_new, v_new, w_new, p_new) = np.moveaxis(before, 1, 0), np.moveaxis(ensemble.state, 1, 0)
    fastest = np.sqrt(u**2 + v**2 + w**2 + GAMMA * p / rho)
    np.testing.assert_allclose(rho, before[:, 0])
    # Brought down to the ceiling at the same density and Mach number.
    mach = np.sqrt(((u + fastest) ** 2 + v**2 + w**2) * rho / (GAMMA * p))
    np.testing.assert_allclose(np.sqrt((u_new**2 + v_new**2 + w_new**2) * rho / (GAMMA * p_new)), mach)


def test_bases_at_high_mach_numbers_have_a_steady_state():
    """Air round the edge of a base expands to near vacuum. While its reconstruction had jumps and sweeps counted on
    falls that the bounds forbid, residuals stood at 2.5 to 2.9 decades."""
    mesh = generate(bodies.cone(np.radians(15.0)), MeshSettings(wall_cell=0.05, far_field=2.0))
    mach = np.array([5.0, 10.0, 20.0])
    patient = FlowSettings(residual_drop=16.0, least_drop=16.0, iterations=80)
    solution = solve(mesh, FlowConditions(mach, np.full(3, np.radians(5.0)), 0.0 * mach), patient)
    assert all(-record.residual_history.min() > 3.5 for record in solution.records)


def test_the_end_game_falls_on_where_bounds_kept_the_residual_up():
    """Cells behind a base that reach their least density and leave it again keep a residual at four decades."""
    mesh = generate(bodies.cone(np.radians(15.0)), MeshSettings(wall_cell=0.05, far_field=2.0))
    mach = np.array([2.8, 3.8, 10.0])
    conditions = FlowConditions(mach, np.full(3, np.radians(5.0)), 0.0 * mach)
    deep = FlowSettings(residual_drop=5.5, precision="double", iterations=120)
    closed, open_ended = solve(mesh, conditions, deep), solve(mesh, conditions, replace(deep, end_game_drop=16.0))
    assert all(record.residual_drop > 5.5 and record.iterations < 90 for record in closed.records)
    for record, other in zip(closed.records, open_ended.records, strict=True):
        assert -other.residual_history.min() < 4.6
        force = other.window_mean
        np.testing.assert_allclose(record.window_mean, force, rtol=0, atol=3e-4 * np.linalg.norm(force))


def test_the_end_game_is_for_runs_that_ask_for_more_than_forces_need():
    def history(residual, force=1.0):
        return History(residual=list(residual), force=[np.array([force, 0.0, 0.1])] * len(residual))

    deep, usual = FlowSettings(residual_drop=5.0), FlowSettings()
    stood = np.concatenate([np.geomspace(1.0, 1e-3, 10), np.full(20, 9e-4)])
    assert creeps(history(stood), deep) and not creeps(history(stood), usual)
    risen = stood * np.r_[np.ones(20), np.full(10, 3.0)]
    assert creeps(history(risen), deep)
    assert not creeps(history(np.maximum(stood, 2e-3)), deep)
    assert not creeps(history(np.geomspace(1.0, 1e-4, 30)), deep)
    assert not creeps(history(stood[:20]), deep)
    swinging = history(stood)
    swinging.force[-5] = np.array([1.01, 0.0, 0.1])
    assert not creeps(swinging, deep)
    assert not creeps(history(stood), replace(deep, end_game_drop=5.0))


def test_a_closing_lane_is_never_let_go_until_another_flow_takes_it():
    freezer, lanes = Freezer(), np.ones(LANES)
    freezer.close([2])
    freezer.update([Standing(gain=1.0, spread=0.1)] * LANES, 100.0 * lanes, lanes, 2.0 * lanes)
    assert freezer.frozen[2] and freezer.held[2] and freezer.frozen.sum() == 1
    freezer.begin(np.array([2]))
    assert not (freezer.frozen | freezer.held | freezer.closing).any()


def test_cells_kept_at_their_bound_stay_and_neighbours_do_not_count_on_them():
    ensemble = ensemble_on(sphere(8, 6))
    rng = np.random.default_rng(6)
    ensemble.state *= 1 + 0.1 * rng.uniform(-1, 1, ensemble.state.shape)
    kept = np.array([3, 40, 41])
    ensemble.state[kept, 0, 1] = ensemble.least[0, 1]
    ensemble.state[kept, 0, 0] = ensemble.least[0, 0]
    marked = np.arange(LANES) == 1
    ensemble.keep_bounded(marked)
    np.testing.assert_array_equal(ensemble.kept[1], kept)
    before = ensemble.state.copy()
    for _ in range(3):
        ensemble.evaluate()
        ensemble.correct(np.full(LANES, 5.0))
        assert not ensemble.change[kept, :, 1].any()
        ensemble.apply(0.4, np.ones(LANES, dtype=bool))
    np.testing.assert_array_equal(ensemble.state[kept, :, 1], before[kept, :, 1])
    assert (ensemble.state[kept, :, 0] != before[kept, :, 0]).any()
    others = np.setdiff1d(np.arange(len(before)), kept)
    assert (ensemble.state[others, :, 1] != before[others, :, 1]).any(axis=1).all()
    ensemble.state[7, 4, 1] = ensemble.least[1, 1]
    ensemble.keep_bounded(marked)
    np.testing.assert_array_equal(ensemble.kept[1], [3, 7, 40, 41])
    ensemble.seat(1, 0, None)
    assert not ensemble.kept


def test_the_largest_cfl_number_falls_with_the_mach_number_and_stays_within_what_is_asked():
    mach = np.array([0.8, 2.0, 3.5, 5.0, 10.0, 25.0])
    np.testing.assert_allclose(highest_cfl(mach, Caution(25.0, 100.0)), [100, 100, 80, 60, 20, 20])
    np.testing.assert_allclose(highest_cfl(mach, Caution(5.0, 5.0)), 5.0)


class Standing:
    """A history whose residual gains `gain` decades over any window while its force wanders by `spread`."""

    def __init__(self, gain=0.0, spread=0.0, age=30):
        self.age, self.gain, self.spread = age, (lambda window: gain), (lambda window: spread)


def test_lanes_freeze_when_nothing_is_gained_and_thaw_when_that_was_wrong():
    freezer, lanes = Freezer(), np.ones(LANES)
    histories = [Standing()] * LANES
    histories[:3] = Standing(gain=0.1), Standing(spread=0.01), Standing(age=20)
    drop = 2.0 * lanes
    drop[3:5] = 1.0, 4.5
    freezer.update(histories, lanes, lanes, drop)
    assert not freezer.frozen.any()
    np.testing.assert_array_equal(np.flatnonzero(~freezer.held), [0, 1, 2])
    freezer.update(histories, lanes, lanes, drop)
    np.testing.assert_array_equal(np.flatnonzero(~freezer.frozen), [0, 1, 2, 3, 4])
    norms = lanes.copy()
    norms[6] = 2.1
    freezer.update(histories, norms, lanes, drop)
    for _ in range(20):
        assert not freezer.frozen[6] and freezer.frozen[7]
        freezer.update(histories, lanes, lanes, drop)
    assert freezer.frozen[6]
    freezer.begin(np.array([6]))
    assert not freezer.frozen[6] and not freezer.held[6]


def test_flows_that_settle_late_have_their_sensor_held_near_their_best():
    freezer, lanes = Freezer(), np.ones(LANES)
    histories = [Standing(gain=0.1, spread=0.1, age=50)] * LANES
    histories[0] = Standing(gain=0.1, spread=0.1, age=49)
    norms = lanes.copy()
    norms[1] = 2.1
    freezer.update(histories, norms, lanes, 2.0 * lanes)
    np.testing.assert_array_equal(np.flatnonzero(~freezer.held), [0, 1])


def test_frozen_lanes_keep_their_limits_and_others_do_not():
    ensemble = ensemble_on(sphere(8, 6))
    rng = np.random.default_rng(4)
    ensemble.state *= 1 + 0.1 * rng.uniform(-1, 1, ensemble.state.shape)
    ensemble.reconstruct()
    before, sensor, limits = ensemble.gradient.copy(), ensemble.sensor.copy(), ensemble.limits.copy()
    ensemble.frozen[1] = 1
    ensemble.state *= 1 + 0.1 * rng.uniform(-1, 1, ensemble.state.shape)
    ensemble.reconstruct()
    lanes = before.shape[-1] // 5
    by_lane = lambda a: a.reshape(*a.shape[:-1], 5, lanes)  # noqa: E731
    same = (by_lane(ensemble.limits) == by_lane(limits)).all(axis=(0, 1))
    assert same[1] and not same[0]
    np.testing.assert_array_equal(ensemble.sensor[:, 1], sensor[:, 1])
    assert (ensemble.sensor[:, 0] != sensor[:, 0]).any()


def test_freezing_changes_no_gradient_but_by_the_byte_it_is_kept_in():
    ensemble = ensemble_on(sphere(8, 6))
    ensemble.state *= 1 + 0.1 * np.random.default_rng(5).uniform(-1, 1, ensemble.state.shape)
    ensemble.reconstruct()
    before = ensemble.gradient.copy()
    ensemble.frozen[:] = 1
    ensemble.reconstruct()
    unlimited = ensemble_on(sphere(8, 6), limiter="none", flux="hllc", wake_calming=0.0)
    unlimited.state[:] = ensemble.state
    unlimited.reconstruct()
    assert (np.abs(ensemble.gradient - before) <= 0.51 / 255 * np.abs(unlimited.gradient) + 1e-12).all()


def test_fast_flows_form_with_small_steps():
    """From Mach 2.5 on the CFL number grows by less until the residual has fallen 1.7 decades; slow flows stay bold."""
    steering = Steering(np.array([1.5, 2.5, 5.0]), Caution(25.0, 100.0), impulsive=False)
    np.testing.assert_allclose(steering.cfl, [25.0, 5.0, 5.0])
    for norm in 0.9 ** np.arange(5):
        steering.advance(np.full(3, norm), np.zeros(3))
    np.testing.assert_allclose(steering.cfl, [100.0, 5.0 * 1.3**4, 5.0 * 1.3**4])
    for norm in 0.9 ** np.arange(5, 30):
        steering.advance(np.full(3, norm), np.zeros(3))
    np.testing.assert_allclose(steering.cfl, [100.0, 80.0, 60.0])
    steering.advance(np.full(3, 1e-3), np.full(3, 3.0))
    np.testing.assert_allclose(steering.cfl, [100.0, 100.0 - 40.0 / 6.0, 60.0])
