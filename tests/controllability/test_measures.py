"""Rank, Gramians and modal controllability against exact results, and without regard to units."""

import math

import numpy as np
import pytest
from scipy.integrate import quad_vec
from scipy.linalg import expm, solve_continuous_are
from tests.dynamics import horus

from spaceplane.control.authority import Authority, authority
from spaceplane.control.gramians import energy_to_rest, finite_horizon, split_gramian
from spaceplane.control.measures import controllable_rank, modal_control
from spaceplane.control.subspaces import stable_part, unstable_part
from spaceplane.dynamics.modes import identify
from spaceplane.errors import InputError

from .systems import UNITS, horus_system, random_system, scaled, system


def unit_limits(m=2):
    return Authority(("elevator", "aileron", "rudder")[:m], -np.ones(m), np.ones(m))


def test_an_uncontrollable_mode_lowers_the_rank():
    """B without a component along one left eigenvector; the rank, the distance and the share say so."""
    rng = np.random.default_rng(5)
    T = rng.normal(size=(4, 4)) + 2 * np.eye(4)
    A = T @ np.diag([0.7, -0.4, -1.0, -2.0]) @ np.linalg.inv(T)
    for lost in range(4):
        modal = rng.normal(size=(4, 2))
        full = system(A, T @ modal)
        modal[lost] = 0.0
        plant = system(A, T @ modal)
        assert controllable_rank(full, unit_limits()) == 4
        assert controllable_rank(plant, unit_limits()) == 3
        value = [0.7, -0.4, -1.0, -2.0][lost]
        for entry in modal_control(plant, unit_limits()):
            missing = abs(entry.mode.eigenvalue - value) < 1e-9
            assert (entry.distance < 1e-12) == missing
            assert (max(entry.reach.values()) < 1e-12) == missing
    assert controllable_rank(system(A, np.zeros((4, 2))), unit_limits()) == 0


def test_two_equal_modes_need_two_inputs():
    A = np.diag([-1.0, -1.0, 0.5])
    assert controllable_rank(system(A, [1.0, 1.0, 1.0]), unit_limits(1)) == 2
    assert controllable_rank(system(A, [[1.0, 0.0], [0.0, 1.0], [1.0, 0.0]]), unit_limits(2)) == 3


def test_chain_of_integrators_is_controllable_from_its_end():
    A = np.diag(np.ones(4), 1)
    for k in range(5):
        b = np.zeros(5)
        b[k] = 1.0
        assert controllable_rank(system(A, b), unit_limits(1)) == k + 1


def test_elevator_of_horus_upright_reaches_the_longitudinal_motion_only():
    """Five of nine states; banked, or with the ailerons and rudders upright, all that can be moved is more."""
    mirrored = {
        f"{c}_elevon_right": sign * horus.EXTRA[f"{c}_elevon_left"]
        for c, sign in (("CL", 1), ("CD", 1), ("Cm", 1), ("CY", -1), ("Cl", -1), ("Cn", -1))
    }
    upright, banked = horus_system(bank_deg=0.0, **mirrored), horus_system(**mirrored)
    assert controllable_rank(upright, authority(["elevator"])) == 5
    assert controllable_rank(upright, authority(["aileron"])) == 4
    assert controllable_rank(upright, authority(["elevator", "aileron"])) == 9
    assert controllable_rank(banked, authority(["elevator"])) == 9
    lateral = [e for e in modal_control(upright, authority(["elevator"])) if e.mode.group == "lateral"]
    assert lateral and all(e.distance < 1e-9 for e in lateral)


def test_finite_horizon_gramian_is_its_integral():
    for seed in range(4):
        plant = random_system(seed)
        found = finite_horizon(plant, unit_limits(), 2.3)
        exact, _ = quad_vec(
            lambda t, s=plant: expm(s.A * t) @ s.B @ s.B.T @ expm(s.A.T * t), 0.0, 2.3, epsabs=1e-11, epsrel=1e-11
        )
        assert np.allclose(found, exact, rtol=1e-8, atol=1e-8 * np.abs(exact).max())


def test_finite_horizon_of_a_stable_system_tends_to_lyapunov():
    plant = random_system(2, unstable=0)
    long = finite_horizon(plant, unit_limits(), 200.0)
    assert np.allclose(plant.A @ long + long @ plant.A.T, -plant.B @ plant.B.T, atol=1e-9 * np.abs(long).max())
    assert np.allclose(long, split_gramian(plant, unit_limits()), rtol=1e-8)


def test_split_gramian_against_frequencies_and_riccati():
    """Zhou's Gramian is the integral over frequency, and that of the minimum-energy loop, A - B B' X."""
    for seed in range(4):
        plant = random_system(seed)
        found = split_gramian(plant, unit_limits())

        def density(u, s=plant):
            # w = tan(u) maps all frequencies on a finite interval
            G = np.linalg.solve(1j * math.tan(u) * np.eye(5) - s.A, s.B)
            return (G @ G.conj().T).real / math.cos(u) ** 2 / (2 * math.pi)

        exact, _ = quad_vec(density, -math.pi / 2, math.pi / 2, epsabs=1e-10, epsrel=1e-10)
        assert np.allclose(found, exact, atol=1e-6 * np.abs(exact).max())
        X = solve_continuous_are(plant.A, plant.B, 1e-12 * np.eye(5), np.eye(2))
        F = plant.A - plant.B @ plant.B.T @ X
        residual = F @ found + found @ F.T + plant.B @ plant.B.T
        assert np.abs(residual).max() < 1e-5 * np.abs(found).max()


def test_gramian_refuses_what_it_cannot_say():
    plant = system(np.diag([0.0, -1.0]), [1.0, 1.0])
    with pytest.raises(InputError, match="neutral"):
        split_gramian(plant, unit_limits(1))
    for horizon in (0.0, -1.0, math.inf):
        with pytest.raises(InputError, match="horizon"):
            finite_horizon(plant, unit_limits(1), horizon)


def test_parts_take_the_spectrum_apart():
    for seed in range(6):
        plant = random_system(seed, n=6, unstable=2)
        grow, decay = unstable_part(plant), stable_part(plant)
        assert len(grow.A) == 2 and len(decay.A) == 4
        for part in (grow, decay):
            assert np.allclose(part.rows @ plant.A, part.A @ part.rows, atol=1e-10)
            assert np.allclose(part.B, part.rows @ plant.B)
        both = np.concatenate([np.linalg.eigvals(grow.A), np.linalg.eigvals(decay.A)])
        assert np.allclose(np.sort_complex(both), np.sort_complex(np.linalg.eigvals(plant.A)), atol=1e-9)
    assert len(unstable_part(plant, 10.0).A) == 0
    with pytest.raises(InputError, match="floor"):
        unstable_part(plant, math.nan)


def test_energy_of_one_unstable_root_is_known():
    """x' = l x + b u: the least integral of u^2 that brings x0 to rest is 2 l x0^2 / b^2, u in units of its limit."""
    plant = system([[0.8]], [[2.5]])
    limits = Authority(("elevator",), np.array([-0.3]), np.array([0.3]))
    assert energy_to_rest(plant, limits, {"alpha": 0.1}) == pytest.approx(2 * 0.8 * 0.1**2 / (2.5 * 0.3) ** 2)
    assert energy_to_rest(system([[-0.8]], [[2.5]]), limits, {"alpha": 0.1}) == 0.0
    unreached = system(np.diag([0.8, 0.5]), [1.0, 0.0])
    assert energy_to_rest(unreached, limits, {"q": 0.1}) == math.inf


def test_units_of_the_states_do_not_matter():
    plant = horus_system()
    other = scaled(plant, list(UNITS.values()))
    limits = authority(["elevator", "aileron", "rudder"])
    assert controllable_rank(plant, limits) == controllable_rank(other, limits)
    for a, b in zip(modal_control(plant, limits), modal_control(other, limits), strict=True):
        assert a.state == b.state
        for name in limits.inputs:
            assert b.reach[name] == pytest.approx(UNITS[a.state] * a.reach[name], rel=1e-6)
            assert b.share[name] == pytest.approx(a.share[name], abs=1e-7)
    x = {"alpha": 0.02, "beta": -0.01}
    y = {name: value * UNITS[name] for name, value in x.items()}
    assert energy_to_rest(other, limits, y) == pytest.approx(energy_to_rest(plant, limits, x), rel=1e-6)


def test_reach_is_what_a_constant_input_balances():
    """One input at its limit, the state on the balance point along the mode: the motion stands still in this mode."""
    plant = horus_system()
    limits = authority(["elevator", "aileron"])
    values, left = np.linalg.eig(plant.A.T)
    for entry in modal_control(plant, limits):
        if entry.mode.oscillatory:
            continue
        y = left[:, np.argmin(np.abs(values - entry.mode.eigenvalue))].real
        x = entry.mode.eigenvector.real
        lead = plant.index(entry.state)
        for k, name in enumerate(limits.inputs):
            b = plant.B[:, plant.inputs.index(name)] * limits.scale()[k]
            offset = x * entry.reach[name] / abs(x[lead])
            force = abs(y @ b)
            assert abs(y @ plant.A @ offset) == pytest.approx(force, rel=1e-6)


def test_reach_moves_with_limit_and_effectiveness():
    plant = horus_system()
    half = authority(["elevator"], {"elevon_left": math.radians(20), "elevon_right": math.radians(20)})
    for a, b in zip(modal_control(plant, authority(["elevator"])), modal_control(plant, half), strict=True):
        assert b.reach["elevator"] == pytest.approx(a.reach["elevator"] / 2)
    assert {e.mode.name for e in modal_control(plant, half)} == {m.name for m in identify(plant)}
