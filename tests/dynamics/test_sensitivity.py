"""Sensitivities of eigenvalues: closed forms, and finite differences of the whole chain to second order."""

import math

import numpy as np
import pytest

from dynamics import horus
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import identify
from spaceplane.dynamics.sensitivity import (
    PARAMETERS,
    drivers,
    eigenvalue_error,
    eigenvalue_slopes,
    matrix_slopes,
    moved_by,
    sensitivities,
    value_of,
)
from spaceplane.errors import InputError

POINT, FULL = horus.point(), horus.derivatives(**horus.EXTRA)


def model(changes=None, form="rigid-body"):
    point, derivatives = moved_by(changes or {}, POINT, FULL)
    return linearise(point, horus.MASS, horus.REFERENCE, derivatives, form).A


def of_modes(form="rigid-body"):
    system = linearise(POINT, horus.MASS, horus.REFERENCE, FULL, form)
    slopes = matrix_slopes(POINT, horus.MASS, horus.REFERENCE, FULL, form=form)
    values = [value_of(name, POINT, FULL) for name in PARAMETERS]
    return sensitivities(system.A, identify(system), slopes, PARAMETERS, values)


@pytest.mark.parametrize("form", ["rigid-body", "thesis"])
def test_matrix_slopes_are_those_of_the_linear_model(form):
    """Against central differences with a small step: A is smooth, so they agree to the step squared and round-off."""
    slopes = matrix_slopes(POINT, horus.MASS, horus.REFERENCE, FULL, form=form)
    for name, slope in zip(PARAMETERS, slopes, strict=True):
        h = 1e-4
        quotient = (model({name: h}, form) - model({name: -h}, form)) / (2 * h)
        scale = np.abs(slope).max()
        assert np.abs(slope - quotient).max() <= 1e-7 * max(scale, 1e-3), name
        if form == "rigid-body":
            assert scale > 0, f"{name} moves nothing"


def test_oscillator_in_closed_form():
    """x'' + c x' + k x = 0: d lambda/dc = -lambda/(2 lambda + c), d lambda/dk = -1/(2 lambda + c)."""
    c, k = 0.3, 4.0
    A = np.array([[0.0, 1.0], [-k, -c]])
    slopes = np.array([[[0.0, 0.0], [0.0, -1.0]], [[0.0, 0.0], [-1.0, 0.0]]])
    value = complex(-c / 2, math.sqrt(k - c**2 / 4))
    found = eigenvalue_slopes(A, slopes, value)
    assert found == pytest.approx([-value / (2 * value + c), -1 / (2 * value + c)], rel=1e-12)


def test_double_eigenvalue_has_no_derivative():
    A = np.array([[0.0, 1.0], [-1.0, -2.0]])
    assert np.isnan(eigenvalue_slopes(A, np.ones((1, 2, 2)), -1.0)).all()


def test_eigenvalues_move_as_the_slopes_say():
    """Change by h and by h/2: the departure from first order falls fourfold."""
    for one in of_modes():
        for k, name in enumerate(one.parameters):
            if abs(one.slopes[k] * one.values[k]) < 1e-4 * abs(one.eigenvalue):
                continue
            h = 0.01 * abs(one.values[k])
            departures = []
            for step in (h, h / 2):
                moved = np.linalg.eigvals(model({name: step}))
                first = one.eigenvalue + one.slopes[k] * step
                departures.append(np.abs(moved - first).min())
            assert departures[0] < 0.05 * abs(one.slopes[k]) * h + 1e-10
            assert departures[1] < 0.3 * departures[0] + 1e-11


def test_frequency_and_damping_slopes():
    one = next(m for m in of_modes() if abs(m.eigenvalue.imag) > 0.5)
    h = 1e-5
    for k, name in enumerate(one.parameters):
        pair = []
        for sign in (1, -1):
            values = np.linalg.eigvals(model({name: sign * h}))
            value = values[np.argmin(np.abs(values - one.eigenvalue))]
            pair.append((abs(value), -value.real / abs(value)))
        frequency, damping = ((a - b) / (2 * h) for a, b in zip(*pair, strict=True))
        assert one.frequency_slopes()[k] == pytest.approx(frequency, rel=1e-3, abs=1e-5)
        assert one.damping_slopes()[k] == pytest.approx(damping, rel=1e-3, abs=1e-5)


def test_pitch_stiffness_drives_the_pitch_modes_and_roll_damping_the_roll_mode():
    """HORUS-2B with the damping of the tests: the textbook's driver comes first."""
    found = {one.mode: one for one in of_modes()}
    pitch = next(one for name, one in found.items() if "pitch divergence" in name)
    assert drivers(pitch)[0].parameter == "Cm_alpha"
    lateral = next(one for one in found.values() if one.eigenvalue.imag > 0.5)
    assert (
        drivers(lateral)[0].parameter == "Cl_beta"
    )  # at 16.6 deg its part in C_n_beta,dyn is six times that of C_n_beta
    assert sum(d.share for d in drivers(lateral)) == pytest.approx(1.0)
    assert drivers(lateral, {"Cn_beta": 0.01})[0].parameter == "Cn_beta"


def test_error_by_the_covariance():
    one = next(m for m in of_modes() if m.eigenvalue.imag > 0.5)
    k, j = one.parameters.index("Cl_beta"), one.parameters.index("Cn_beta")
    covariance = np.zeros((len(PARAMETERS),) * 2)
    covariance[k, k] = 0.01**2
    assert eigenvalue_error(one, covariance)[1] == pytest.approx(0.01 * abs(one.slopes[k].imag))
    covariance[j, j] = 0.02**2
    covariance[k, j] = covariance[j, k] = 0.01 * 0.02  # fully correlated: errors add up with their signs
    together = abs(0.01 * one.slopes[k].imag + 0.02 * one.slopes[j].imag)
    assert eigenvalue_error(one, covariance)[1] == pytest.approx(together, rel=1e-6)


def test_unknown_parameter():
    with pytest.raises(InputError, match="Cm_alpha"):
        matrix_slopes(POINT, horus.MASS, horus.REFERENCE, FULL, ["Cm_alpa"])
