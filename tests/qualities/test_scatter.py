"""Scatter of eigenvalues: against first order where errors are small, and where modes change their kind."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import norm

from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.sensitivity import eigenvalue_error, of_model, value_of
from spaceplane.dynamics.statespace import STATES
from spaceplane.qualities.probability import NORMAL_95, Uncertainty, assess_all, wilson_half_width
from spaceplane.qualities.scatter import eigenvalue_cloud, spreads

from .test_probability import airframe

LATERAL = [STATES.index(name) for name in ("p", "r", "beta", "sigma")]


def found(a, half, samples=600):
    uncertainty = Uncertainty(half)
    modes = assess_all(a, with_airframe=False).modes
    return modes, uncertainty, spreads(eigenvalue_cloud(a, uncertainty, samples), modes)


def test_small_errors_scatter_as_the_derivatives_of_the_eigenvalues_say():
    a = airframe()
    half = {name: 0.02 * abs(value_of(name, a.point, a.derivatives)) for name in ("Cm_alpha", "Cn_beta", "CL", "CD")}
    modes, uncertainty, spread = found(a, half)
    system = assess_all(a, with_airframe=False).system
    slopes = of_model(a.point, a.mass, a.reference, a.derivatives, system.A, modes)
    checked = 0
    for one, slope in zip(spread, slopes, strict=True):
        real, imaginary = eigenvalue_error(slope, uncertainty.covariance(slope.parameters))
        if abs(slope.eigenvalue) < 0.05:  # the slow ones are near their neighbours
            continue
        checked += 1
        assert one.same_kind == 1.0
        assert one.real == pytest.approx(real, rel=0.12, abs=1e-6)  # 600 draws: 3 % standard error
        assert one.imaginary == pytest.approx(imaginary, rel=0.12, abs=1e-6)
    assert checked >= 3


def test_a_dutch_roll_of_uncertain_yaw_stiffness_oscillates_as_often_as_the_normal_distribution_says():
    """The pair splits at one C_n_beta, found on the discriminant; strong roll damping keeps all others away."""
    nominal, half = 0.004, 0.02
    own = {"Cl_beta": -1e-4, "Cl_p": -3.0}

    def discriminant(stiffness):
        a = airframe(Cn_beta=stiffness, **own)
        values = np.linalg.eigvals(linearise(a.point, a.mass, a.reference, a.derivatives).A[np.ix_(LATERAL, LATERAL)])
        first, second = sorted(values, key=lambda z: abs(z - np.mean(values[np.argsort(abs(values))[1:3]])))[:2]
        return (((first - second) / 2) ** 2).real

    split = brentq(discriminant, -0.001, 0.003)
    modes, _, spread = found(airframe(Cn_beta=nominal, **own), {"Cn_beta": half}, 1000)
    k = next(k for k, mode in enumerate(modes) if mode.kind in ("dutch_roll", "lateral_oscillation"))
    exact = norm.sf((split - nominal) / (half / NORMAL_95))
    assert spread[k].same_kind == pytest.approx(exact, abs=1.5 * wilson_half_width(exact, 1000))
    assert 0.5 < exact < 0.8


def test_without_error_nothing_scatters():
    _, _, spread = found(airframe(), {"Cm_alpha": 0.0}, 5)
    assert all((one.real, one.imaginary) == (pytest.approx(0.0, abs=1e-12),) * 2 for one in spread)
    assert all(one.same_kind == 1.0 for one in spread)


def test_the_cloud_is_that_of_the_first_draws():
    """Common random numbers: fewer draws are the first of many."""
    a, uncertainty = airframe(), Uncertainty({"Cm_alpha": 0.01, "Cn_beta": 0.01})
    few, many = (eigenvalue_cloud(a, uncertainty, n, seed=3) for n in (4, 9))
    assert np.array_equal(few, many[:4])
    assert many.shape == (9, 9)
    assert not np.array_equal(few, eigenvalue_cloud(a, uncertainty, 4, seed=4))
    assert math.isfinite(abs(many).max())
