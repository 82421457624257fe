from dataclasses import dataclass, replace

import numpy as np
import pytest

from spaceplane.aero.conditions import DerivativeSteps, plan
from spaceplane.aero.derivatives import STABILITY, Move, by_symmetry, control_derivatives, differentiate
from spaceplane.aero.integrate import COEFFICIENTS, integrate


@dataclass(frozen=True)
class Point:
    mach: float = 2.0
    alpha: float = 0.2
    beta: float = 0.0


def calm(center, mach, alpha, beta):
    return np.zeros(len(center))


def synthetic(make_solution, box, lengths, made, function, verdicts=None, spread=0.0):
    """Coefficients that are `function(mach, alpha, beta, [p_hat, q_hat, r_hat])` -> {name: value} in total."""
    c = made.conditions
    solution = replace(make_solution(box, calm, c.mach, c.alpha, c.beta, verdicts, spread), conditions=c)
    data = integrate(solution, lengths).copy(deep=True)
    rates = () if c.rates is None else np.stack([data.p_hat, data.q_hat, data.r_hat], axis=1)
    for i in range(len(c)):
        for name, value in function(c.mach[i], c.alpha[i], c.beta[i], *rates[i : i + 1]).items():
            data[name].values[i, 0] = value
    return data


def quadratic(mach, alpha, beta, rates=(0.0, 0.0, 0.0)):
    p, q, r = rates
    return {
        "CL": 0.1 + 2.0 * alpha - 3.0 * alpha**2 - 0.4 * mach + 1.5 * q,
        "CD": 0.05 + 0.7 * alpha**2 + 0.02 * (mach - 2.0) ** 2,
        "Cm": 0.01 - 0.3 * alpha + 0.05 * mach - 0.6 * q - 2.0 * q**2,
        "CY": -0.9 * beta + 0.1 * p + 0.8 * r,
        "Cl": -0.2 * beta - 0.16 * p + 0.3 * r,
        "Cn": 0.1 * beta + 0.05 * p - 0.7 * r,
    }


EXACT = {
    "CL_alpha": 2.0 - 6.0 * 0.2,
    "CD_alpha": 1.4 * 0.2,
    "Cm_alpha": -0.3,
    "CY_beta": -0.9,
    "Cl_beta": -0.2,
    "Cn_beta": 0.1,
    "CD_M": 0.0,
    "CL_M": -0.4,
    "Cm_M": 0.05,
    "CL_q": 1.5,
    "Cm_q": -0.6,
    "CY_p": 0.1,
    "Cl_p": -0.16,
    "Cn_p": 0.05,
    "CY_r": 0.8,
    "Cl_r": 0.3,
    "Cn_r": -0.7,
}


@pytest.mark.parametrize("two", [False, True])
@pytest.mark.parametrize("symmetric", [False, True])
def test_exact_on_quadratic_data(make_solution, box, lengths, two, symmetric):
    made = plan([Point()], DerivativeSteps(two_step_sizes=two), symmetric, reference=lengths)
    slopes = differentiate(synthetic(make_solution, box, lengths, made, quadratic), made)
    assert set(EXACT) == set(STABILITY)
    for name, value in EXACT.items():
        assert float(slopes[name][0, 0]) == pytest.approx(value, abs=1e-12), name
        assert slopes[f"{name}_status"].values[0] == "converged"
        if two:
            assert float(slopes[f"{name}_error"][0]) < 1e-12
    step = DerivativeSteps().alpha
    if not two:
        assert float(slopes.CL_alpha_error[0]) == pytest.approx(3.0 * step)
        assert float(slopes.CY_beta_error[0]) == pytest.approx(0.0, abs=1e-12)
    assert slopes.CL_alpha.attrs["units"] == "1/rad"
    assert slopes.CL_M.attrs["units"] == "1"
    assert float(slopes.CL_alpha_step[0]) == pytest.approx(step)
    assert float(slopes.CL_M_step[0]) == pytest.approx(0.05 * 2.0)
    assert slopes.Cm_q.attrs["units"] == "1"
    assert float(slopes.Cn_r_step[0]) == pytest.approx(DerivativeSteps().rate)


def test_the_error_estimate_covers_the_truth_of_a_curved_function(make_solution, box, lengths):
    def curved(mach, alpha, beta):
        return {"CL": np.sin(5.0 * alpha), "Cm": np.exp(-3.0 * alpha)}

    for two in (False, True):
        made = plan([Point()], DerivativeSteps(alpha=0.05, two_step_sizes=two))
        slopes = differentiate(synthetic(make_solution, box, lengths, made, curved), made)
        for name, exact in (("CL_alpha", 5.0 * np.cos(1.0)), ("Cm_alpha", -3.0 * np.exp(-0.6))):
            error = abs(float(slopes[name][0, 0]) - exact)
            assert 0.0 < error < float(slopes[f"{name}_error"][0]) < 0.2 * abs(exact)


def test_the_force_window_enters_the_error(make_solution, box, lengths):
    made = plan([Point()], DerivativeSteps())
    data = synthetic(make_solution, box, lengths, made, lambda m, a, b: {"CL": a}, spread=1e-4)
    slopes = differentiate(data, made)
    expected = float(data.CL_spread[1] + data.CL_spread[2]) / (2.0 * DerivativeSteps().alpha)
    assert float(slopes.CL_alpha_error[0]) == pytest.approx(expected)


def test_bad_conditions_poison_only_what_rests_on_them(make_solution, box, lengths):
    made = plan([Point()], DerivativeSteps())
    verdicts = ["converged", "failed", "converged", "oscillating", "converged", "converged"]  # alpha+, mach+
    slopes = differentiate(synthetic(make_solution, box, lengths, made, quadratic, verdicts), made)
    # `synthetic` wrote numbers over the NaN of the failed condition: the status alone must remove them.
    assert slopes.CL_alpha_status.values[0] == "failed"
    assert np.isnan(slopes.CL_alpha).all() and np.isnan(slopes.CL_alpha_error[0])
    assert slopes.CL_M_status.values[0] == "oscillating"
    assert float(slopes.CL_M[0, 0]) == pytest.approx(-0.4)
    assert slopes.CY_beta_status.values[0] == "converged"


def pressure(center, mach, alpha, beta):
    """Symmetric left to right at beta = 0, and the mirror image of itself when beta changes sign."""
    x, y, z = center.T
    return 0.3 * np.cos(x) - (0.5 + alpha) * z + (1.0 - 0.2 * x) * beta * np.sin(y) + 0.1 * z * y * y


def test_mirroring_one_side_equals_solving_both_sides_by_part(make_solution, box, lengths):
    results = []
    for symmetric in (True, False):
        made = plan([Point()], DerivativeSteps(), symmetric)
        c = made.conditions
        results.append(differentiate(integrate(make_solution(box, pressure, c.mach, c.alpha, c.beta), lengths), made))
    for name in (name for name in STABILITY if name.endswith(("_alpha", "_beta", "_M"))):
        np.testing.assert_allclose(results[0][name], results[1][name], atol=1e-11)
    parts = results[0].CY_beta.drop_sel(part="total").sum("part")
    np.testing.assert_allclose(parts, results[0].CY_beta.sel(part="total"), atol=1e-12)
    assert abs(float(results[0].CY_beta[0, 0])) > 0.1


def flapped(step):
    """Left-hand flap: pressure under the left rear corner in proportion to the step, with some curvature."""

    def deflected(center, mach, alpha, beta):
        left = (center[:, 1] < 0) & (center[:, 0] > 0) & (center[:, 2] < -0.49)
        return pressure(center, mach, alpha, beta) + np.where(left, 2.0 * step + 5.0 * step**2, 0.0)

    return deflected


def control_data(make_solution, box, lengths, steps):
    base = integrate(make_solution(box, pressure, 2.0, 0.2, 0.0), lengths)
    runs = [Move(d, base, integrate(make_solution(box, flapped(d), 2.0, 0.2, 0.0), lengths)) for d in steps]
    return base, control_derivatives(by_symmetry({"elevon_left": runs}))


def test_control_derivatives_have_the_sign_of_a_flap_down_on_the_left(make_solution, box, lengths):
    _, slopes = control_data(make_solution, box, lengths, [1e-3])
    area = 2.0 * 1.0 / 8.0
    assert float(slopes.CL_elevon_left[0, 0]) == pytest.approx(2.005 * area * np.cos(0.2))
    assert float(slopes.Cl_elevon_left[0, 0]) == pytest.approx(2.005 * area * 0.5 / 2.0)
    assert float(slopes.Cm_elevon_left[0, 0]) == pytest.approx(-2.005 * area * 1.0 / 4.0)
    assert float(slopes.CL_elevon_left_step[0]) == 1e-3


def test_the_other_side_follows_by_symmetry(make_solution, box, lengths):
    _, slopes = control_data(make_solution, box, lengths, [1e-3])
    for name in COEFFICIENTS[:6]:
        sign = -1.0 if name in ("CY", "Cl", "Cn") else 1.0
        left, right = slopes[f"{name}_elevon_left"], slopes[f"{name}_elevon_right"]
        np.testing.assert_allclose(right[0, 0], sign * left[0, 0], atol=1e-13)
        np.testing.assert_allclose(right.sel(part="wing_right"), sign * left.sel(part="wing_left"), atol=1e-13)


def test_two_deflection_steps_remove_the_curvature_and_show_it(make_solution, box, lengths):
    _, slopes = control_data(make_solution, box, lengths, [0.1, 0.05])
    exact = 2.0 * 0.25 * np.cos(0.2)
    assert float(slopes.CL_elevon_left[0, 0]) == pytest.approx(exact, rel=1e-12)
    assert float(slopes.CL_elevon_left_error[0]) == pytest.approx(5.0 * 0.05 * 0.25 * np.cos(0.2))
