"""The analytic Jacobian pieces against finite differences."""

from __future__ import annotations

import numpy as np
import pytest

from spaceplane.flow import implicit, jacobian
from spaceplane.flow.compiled import LANES
from spaceplane.flow.ensemble import Ensemble
from spaceplane.flow.fluxes import blend
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.topology import prepare

from .structured import box

GAMMA = 1.4
HEAT = (GAMMA, GAMMA / (GAMMA - 1), GAMMA - 1, 0.0)
STATE = np.array([1.3, 0.4, -0.7, 0.2, 0.9])
NORMAL = np.array([0.6, -0.48, 0.64])


def conserved(w):
    return np.array([w[0], *(w[0] * w[1:4]), w[4] / (GAMMA - 1) + 0.5 * w[0] * w[1:4] @ w[1:4]])


def physical(w, n):
    un = w[1:4] @ n
    return np.array([w[0] * un, *(w[0] * un * w[1:4] + w[4] * n), un * (conserved(w)[4] + w[4])])


def columns(function):
    """Matrix of a function linear in primitive increments."""
    return np.stack([np.array(function(*e)) for e in np.eye(5)], axis=1)


def differences(function, w, step=1e-6):
    return np.stack([(function(w + step * e) - function(w - step * e)) / (2 * step) for e in np.eye(5)], axis=1)


def test_flux_increment_is_the_derivative_of_the_flux():
    analytic = columns(lambda *d: jacobian.flux_increment.py_func(*STATE, *d, *NORMAL, HEAT))
    np.testing.assert_allclose(analytic, differences(lambda w: physical(w, NORMAL), STATE), atol=1e-8)


def test_dissipation_is_the_absolute_value_of_the_jacobian_but_for_total_enthalpy():
    r, u, v, w, p = STATE
    a = np.sqrt(GAMMA * p / r)
    un = STATE[1:4] @ NORMAL
    mass = differences(conserved, STATE)
    flux = columns(lambda *d: jacobian.flux_increment.py_func(*STATE, *d, *NORMAL, HEAT)) @ np.linalg.inv(mass)
    values, vectors = np.linalg.eig(flux)
    absolute = (vectors * np.abs(values)) @ np.linalg.inv(vectors)
    d = (abs(un), abs(un + a), abs(un - a))
    analytic = columns(lambda *x: jacobian.dissipation_increment.py_func(r, u, v, w, a, *d, *x, *NORMAL, HEAT))
    np.testing.assert_allclose(analytic[:4], (np.real(absolute) @ mass)[:4], atol=1e-8)
    # Energy: the jump of total enthalpy is carried by |un|, the rest by the mass.
    enthalpy = differences(lambda q: np.array([GAMMA / (GAMMA - 1) * q[4] / q[0] + 0.5 * q[1:4] @ q[1:4]]), STATE)[0]
    value = GAMMA / (GAMMA - 1) * p / r + 0.5 * (u * u + v * v + w * w)
    np.testing.assert_allclose(analytic[4], value * analytic[0] + abs(un) * r * enthalpy, atol=1e-8)


@pytest.mark.parametrize("theta", [0.0, 1.0])
def test_linearised_first_order_flux_matches_the_flux(theta):
    """For a weak jump the flux is the mean of both sides less half the dissipation of the jump."""
    jump = 1e-5 * np.array([0.3, -0.8, 0.5, 0.9, -0.4])
    left, right = STATE - jump / 2, STATE + jump / 2
    flux = np.array(blend.py_func(*left, *right, *NORMAL, GAMMA, GAMMA, 0.0, theta))
    a = np.sqrt(GAMMA * STATE[4] / STATE[0])
    un = STATE[1:4] @ NORMAL
    d = jacobian.wave_dissipation.py_func(un, a, theta)
    spread = jacobian.dissipation_increment.py_func(*STATE[:4], a, *d, *jump, *NORMAL, HEAT)
    predicted = 0.5 * (physical(left, NORMAL) + physical(right, NORMAL)) - 0.5 * np.array(spread)
    np.testing.assert_allclose(flux, predicted, atol=2e-9)


def test_blocks_hold_the_same_matrices_as_the_products():
    r, u, v, w, p = STATE
    a, un = np.sqrt(GAMMA * p / r), STATE[1:4] @ NORMAL
    d = jacobian.wave_dissipation.py_func(un, a, 0.3)
    lane = 3
    block = np.zeros((25, LANES))
    implicit.add_dissipation.py_func(block.reshape(-1), lane, 1.7, r, u, v, w, a, *d, *NORMAL, HEAT)
    product = columns(lambda *x: jacobian.dissipation_increment.py_func(r, u, v, w, a, *d, *x, *NORMAL, HEAT))
    np.testing.assert_allclose(block[:, lane].reshape(5, 5), 1.7 * product, atol=1e-12)
    block[:] = 0.0
    implicit.add_flux.py_func(block.reshape(-1), lane, -0.6, r, u, v, w, p, *NORMAL, HEAT)
    product = columns(lambda *x: jacobian.flux_increment.py_func(*STATE, *x, *NORMAL, HEAT))
    np.testing.assert_allclose(block[:, lane].reshape(5, 5), -0.6 * product, atol=1e-12)
    block[:] = 0.0
    implicit.add_mass.py_func(block.reshape(-1), lane, 2.0, r, u, v, w, HEAT)
    np.testing.assert_allclose(block[:, lane].reshape(5, 5), 2.0 * differences(conserved, STATE), atol=1e-8)
    assert not np.delete(block, lane, axis=1).any()


def test_inverse_blocks():
    rng = np.random.default_rng(3)
    block = rng.normal(size=(25, LANES)) + 4.0 * np.eye(5).reshape(25, 1)
    inverse = block.copy()
    implicit.invert(inverse.reshape(-1))
    product = np.einsum("ikn,kjn->ijn", block.reshape(5, 5, -1), inverse.reshape(5, 5, -1))
    np.testing.assert_allclose(product, np.repeat(np.eye(5)[:, :, None], LANES, axis=2), atol=1e-12)


def test_sweeps_are_symmetric_gauss_seidel():
    """Two passes that share their products against two plain ones, from a matrix put together entry by entry."""
    mesh = box((4, 3, 3), 0.2)
    conditions = FlowConditions(np.array([0.7]), np.array([0.2]), np.array([0.1]))
    settings = FlowSettings(precision="double", sweeps=2)
    ensemble = Ensemble(mesh, prepare(mesh, np.float64), conditions, settings, 2)
    ensemble.state *= np.random.default_rng(4).uniform(0.9, 1.1, ensemble.state.shape)
    ensemble.evaluate()
    ensemble.sensor[:] = 0.3
    ensemble.correct(np.full(LANES, 10.0))

    t, lane = ensemble.topology, 0
    state, right = ensemble.state[:, :, lane], -ensemble.residual[:, :, lane]
    inverse = ensemble.inverse.reshape(mesh.cells, 5, 5, LANES)[..., lane]
    rows = [{} for _ in range(mesh.cells)]
    for i in range(mesh.cells):
        for e in range(t.start[i], t.start[i + 1]):
            j, n = t.other[e], t.normal[e]
            *middle, _ = mean = jacobian.face_average.py_func(*state[i], *state[j], *n, GAMMA)
            waves = jacobian.wave_dissipation.py_func(mean[5], mean[4], 0.3)
            flux = columns(lambda *x, j=j, n=n: jacobian.flux_increment.py_func(*state[j], *x, *n, HEAT))
            spread = columns(
                lambda *x, m=middle, w=waves, n=n: jacobian.dissipation_increment.py_func(*m, *w, *x, *n, HEAT)
            )
            rows[i][j] = 0.5 * t.area[e] * (flux - spread)
    visited = np.concatenate([np.arange(t.block_cells[b], t.block_cells[b + 1]) for b in t.color_blocks])
    change = np.zeros((mesh.cells, 5))
    for order in (visited, visited[::-1]) * settings.sweeps:
        for i in order:
            change[i] = inverse[i] @ (right[i] - sum(block @ change[j] for j, block in rows[i].items()))
    np.testing.assert_allclose(ensemble.change[:, :, lane], change, rtol=1e-9, atol=1e-13)
