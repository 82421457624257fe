"""Invariants of every registered flux: consistency, rotation, conservation, upwinding."""

from __future__ import annotations

import numpy as np
import pytest

from spaceplane.flow.fluxes import FLUXES, blend, hllc, hlle, shrink_normal_jump

GAMMA = 1.4


def flux_of(name):
    """Python function of the named flux: two states, a normal, the pressure taken off."""
    theta = {"hllc": 0.0, "hlle": 1.0, "blend": 0.4}[name]
    return lambda left, right, n, p0=0.0: np.array(blend.py_func(*left, *right, *n, GAMMA, GAMMA, p0, theta))


def random_state(rng, speed=1.0):
    return np.array([rng.uniform(0.3, 3.0), *(speed * rng.normal(size=3)), rng.uniform(0.3, 3.0)])


def random_normal(rng):
    n = rng.normal(size=3)
    return n / np.linalg.norm(n)


def physical(state, n):
    """Exact flux of one state through a unit area."""
    r, u, p = state[0], state[1:4], state[4]
    un = u @ n
    return np.array([r * un, *(r * un * u + p * n), un * (p * GAMMA / (GAMMA - 1) + 0.5 * r * u @ u)])


@pytest.mark.parametrize("name", FLUXES)
def test_flux_of_equal_states_is_the_physical_flux(name):
    rng = np.random.default_rng(1)
    for _ in range(50):
        state, n = random_state(rng), random_normal(rng)
        np.testing.assert_allclose(flux_of(name)(state, state, n), physical(state, n), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", FLUXES)
def test_flux_turns_with_the_axes(name):
    rng = np.random.default_rng(2)
    for _ in range(50):
        left, right, n = random_state(rng), random_state(rng), random_normal(rng)
        q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        turn = lambda s, q=q: np.array([s[0], *(q @ s[1:4]), s[4]])  # noqa: E731
        turned = flux_of(name)(turn(left), turn(right), q @ n)
        np.testing.assert_allclose(turned, turn(flux_of(name)(left, right, n)), rtol=1e-10, atol=1e-11)


@pytest.mark.parametrize("name", FLUXES)
def test_what_leaves_one_cell_enters_the_other(name):
    rng = np.random.default_rng(3)
    for _ in range(50):
        left, right, n = random_state(rng), random_state(rng), random_normal(rng)
        np.testing.assert_allclose(
            flux_of(name)(left, right, n), -flux_of(name)(right, left, -n), rtol=1e-10, atol=1e-11
        )


@pytest.mark.parametrize("name", FLUXES)
def test_supersonic_flux_is_upwind(name):
    rng = np.random.default_rng(4)
    n = np.array([1.0, 0.0, 0.0])
    for _ in range(20):
        left, right = random_state(rng, 0.2), random_state(rng, 0.2)
        left[1] += 12.0
        right[1] += 12.0
        np.testing.assert_allclose(flux_of(name)(left, right, n), physical(left, n), rtol=1e-11)


def test_hllc_keeps_a_contact_and_hlle_does_not():
    n = (1.0, 0.0, 0.0)
    left, right = (1.0, 0.0, 0.3, 0.0, 1.0), (0.2, 0.0, -0.7, 0.0, 1.0)
    kept = np.array(hllc.py_func(*left, *right, *n, GAMMA, GAMMA, 0.0))
    np.testing.assert_allclose(kept, [0, 1, 0, 0, 0], atol=1e-14)
    assert abs(hlle.py_func(*left, *right, *n, GAMMA, GAMMA, 0.0)[0]) > 0.1


def test_pressure_taken_off_changes_the_momentum_flux_by_it():
    rng = np.random.default_rng(5)
    for name in FLUXES:
        left, right, n = random_state(rng), random_state(rng), random_normal(rng)
        difference = flux_of(name)(left, right, n) - flux_of(name)(left, right, n, 0.7)
        np.testing.assert_allclose(difference, [0, *(0.7 * n), 0], atol=1e-12)


def test_low_mach_correction_shrinks_the_normal_jump_only():
    rng = np.random.default_rng(6)
    n = random_normal(rng)
    left, right = rng.normal(size=3), rng.normal(size=3)
    out = np.array(shrink_normal_jump.py_func(*left, *right, *n, 0.25))
    jump = out[3:] - out[:3]
    assert jump @ n == pytest.approx(0.25 * (right - left) @ n)
    tangential = np.eye(3) - np.outer(n, n)
    np.testing.assert_allclose(tangential @ jump, tangential @ (right - left), atol=1e-14)
    np.testing.assert_allclose(out[:3] + out[3:], left + right, atol=1e-14)
