"""Probabilities of levels against normal distributions in closed form, first order against sampling, and bad input."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import chi2, norm

from dynamics import horus
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import identify
from spaceplane.dynamics.sensitivity import (
    PARAMETERS,
    eigenvalue_error,
    matrix_slopes,
    moved_by,
    sensitivities,
    value_of,
)
from spaceplane.errors import InputError
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.assess import assess
from spaceplane.qualities.departure import dynamic_directional
from spaceplane.qualities.probability import (
    NORMAL_95,
    Uncertainty,
    assess_all,
    mirror_correlation,
    outcome,
    outlooks,
    wilson_half_width,
)

STABLE = {
    "Cm_alpha": -0.06,
    "Cm_q": -2.0,
    "CL_q": 0.9,
    "Cl_p": -0.3,
    "Cn_r": -0.5,
    "Cn_beta": 0.05,
    "Cl_beta": -0.05,
    "CY_beta": -0.9,
}


def airframe(**changes):
    point = horus.point(bank_deg=0.0, gamma_deg=-5.0, alpha_deg=5.0)
    return Airframe(point, horus.MASS, horus.REFERENCE, horus.derivatives(**{**STABLE, **changes}))


def of(found, paragraph, quantity=""):
    match = [o for o in found if o.verdict.paragraph.startswith(paragraph) and quantity in ("", o.verdict.quantity)]
    assert len(match) == 1, [o.verdict for o in match]
    return match[0]


def test_probability_of_a_linear_criterion_is_that_of_the_normal_distribution():
    a = airframe(Cn_beta=0.01)
    value = dynamic_directional(a.derivatives, a.mass, a.point.alpha)
    half = 2.5 * value
    sigma = math.cos(a.point.alpha) * half / NORMAL_95
    found = of(outlooks(a, Uncertainty({"Cn_beta": half}), samples=600, seed=3), "Moul", "C_n_beta,dyn")
    assert found.probabilities["met"] == pytest.approx(norm.cdf(value / sigma), abs=2 * found.error)
    assert sum(found.probabilities.values()) == pytest.approx(1.0)
    assert 0.7 < norm.cdf(value / sigma) < 0.9


def test_levels_of_the_dutch_roll_by_chi_square():
    """Its damping ratio is monotonic in Cn_r: the levels' bounds, found by root finding, give exact probabilities."""
    a, half = airframe(), 1.5

    def damping(change):
        point, derivatives = moved_by({"Cn_r": change}, a.point, a.derivatives)
        modes = identify(linearise(point, a.mass, a.reference, derivatives))
        return next(v for v in assess(modes) if v.paragraph == "3.3.1.1").value

    sigma = half / NORMAL_95
    edges = [brentq(lambda x, z=z: damping(x) - z, -3.0, 3.0) for z in (0.08, 0.02, 0.0)]
    assert edges == sorted(edges)  # less yaw damping, less damping ratio
    cumulative = [0.0, *norm.cdf(np.array(edges) / sigma), 1.0]
    exact = np.diff(cumulative)
    found = of(outlooks(a, Uncertainty({"Cn_r": half}), samples=600, with_airframe=False), "3.3.1.1", "damping ratio")
    counts = np.array([600 * found.probabilities.get(k, 0.0) for k in ("1", "2", "3", "below 3")])
    kept = 600 * exact >= 5
    statistic = float(((counts - 600 * exact)[kept] ** 2 / (600 * exact)[kept]).sum())
    assert kept.sum() >= 3 and statistic < chi2.ppf(0.999, kept.sum())


def test_first_order_agrees_with_sampling_where_errors_are_small():
    a = airframe()
    names = (*STABLE, "CL", "CL_alpha", "CD_alpha")
    half = {name: 0.03 * abs(value_of(name, a.point, a.derivatives)) for name in names}
    uncertainty = Uncertainty(half, {("Cl_beta", "Cn_beta"): -0.6})
    system = linearise(a.point, a.mass, a.reference, a.derivatives)
    modes = identify(system)
    slopes = matrix_slopes(a.point, a.mass, a.reference, a.derivatives)
    values = [value_of(name, a.point, a.derivatives) for name in PARAMETERS]
    covariance = uncertainty.covariance(PARAMETERS)
    draws = uncertainty.draw(400, 1)
    spectra = []
    for deviation in draws:
        changes = dict(zip(uncertainty.names, deviation, strict=True))
        point, derivatives = moved_by(changes, a.point, a.derivatives)
        spectra.append(np.linalg.eigvals(linearise(point, a.mass, a.reference, derivatives).A))
    for one in sensitivities(system.A, modes, slopes, PARAMETERS, values):
        if one.eigenvalue.imag < 0.2:
            continue
        sampled = np.array([s[np.argmin(np.abs(s - one.eigenvalue))] for s in spectra])
        real, imaginary = eigenvalue_error(one, covariance)
        assert sampled.real.std() == pytest.approx(real, rel=0.12)  # 400 draws: 3.5 % standard error
        assert sampled.imag.std() == pytest.approx(imaginary, rel=0.12)


def test_both_methods_give_the_same_probabilities_near_a_bound():
    """Damping ratio a little above 0.08 by the choice of Cn_r; the same draws, so they differ by curvature only."""
    a = airframe()

    def ratio(change):
        point, derivatives = moved_by({"Cn_r": change}, a.point, a.derivatives)
        verdicts = assess(identify(linearise(point, a.mass, a.reference, derivatives)))
        return next(v for v in verdicts if v.paragraph == "3.3.1.1").value

    shift = brentq(lambda x: ratio(x) - 0.082, -3.0, 3.0)
    near = replace(a, derivatives=moved_by({"Cn_r": shift}, a.point, a.derivatives)[1])
    uncertainty = Uncertainty({"Cn_r": 0.05, "Cn_beta": 0.002, "Cl_beta": 0.002})
    shares = [
        of(
            outlooks(near, uncertainty, method=method, samples=400, with_airframe=False), "3.3.1.1", "damping ratio"
        ).probabilities["1"]
        for method in ("sampling", "first-order")
    ]
    assert 0.6 < shares[0] < 0.99
    assert shares[0] == pytest.approx(shares[1], abs=0.02)


def test_dutch_roll_says_when_the_sign_of_yaw_stiffness_is_uncertain():
    a = airframe(Cn_beta=0.004, Cl_beta=-1e-4)
    found = outlooks(a, Uncertainty({"Cn_beta": 0.02}), samples=300, with_airframe=False)
    roll = of(found, "3.3.1.1", "overall")
    share = roll.probabilities["not applicable"]
    assert 0.15 < share < 0.6  # about the share of draws with a negative C_n_beta,dyn
    assert any("divergence" in name for name in roll.instead)
    assert sum(roll.instead.values()) >= 0.9 * share
    assert "not applicable" in roll.text and "instead" in roll.text and "divergence" in roll.text


def test_without_uncertainty_every_outcome_is_certain_and_nominal():
    a = airframe()
    nominal = assess_all(a).verdicts
    found = outlooks(a, Uncertainty({}), samples=3)
    assert [o.verdict for o in found] == list(nominal)
    for one in found:
        assert dict(one.probabilities) == {outcome(one.verdict): 1.0}
    assert of(found, "3.3.1.1", "overall").text.endswith("with 100 %")


def test_a_criterion_that_arises_in_some_draws_only_is_told():
    """Short period at rest's edge: in some draws it splits and diverges, which paragraph 3.2.1.1 then judges."""
    a = airframe(Cm_alpha=-0.004, Cm_q=-0.05)
    found = outlooks(a, Uncertainty({"Cm_alpha": 0.03}), samples=200, with_airframe=False)
    divergence = next(o for o in found if o.verdict.paragraph == "3.2.1.1")
    assert not divergence.verdict.applicable and "within their uncertainty" in divergence.verdict.note
    assert divergence.probabilities.get("below 3", 0.0) > 0.1


def test_common_random_numbers():
    few, many = Uncertainty({"Cn_beta": 0.01}), Uncertainty({"Cn_beta": 0.01, "Cl_beta": 0.02, "CL": 0.1})
    column = many.names.index("Cn_beta")
    assert np.array_equal(few.draw(50, 7)[:, 0], many.draw(50, 7)[:, column])
    tied = Uncertainty(many.half_width, {("Cl_beta", "CL"): 0.8})
    assert np.allclose(tied.draw(50, 7)[:, column], few.draw(50, 7)[:, 0], rtol=1e-12)
    assert not np.array_equal(few.draw(50, 7), few.draw(50, 8))


def test_draws_have_the_moments_asked_for():
    u = Uncertainty({"Cn_beta": 0.01, "Cl_beta": 0.02}, {("Cn_beta", "Cl_beta"): -0.7})
    draws = u.draw(20_000, 0)
    place = {name: k for k, name in enumerate(u.names)}
    inside = np.abs(draws[:, place["Cl_beta"]]) <= 0.02
    assert inside.mean() == pytest.approx(0.95, abs=4 * math.sqrt(0.95 * 0.05 / 20_000))
    assert np.corrcoef(draws.T)[0, 1] == pytest.approx(-0.7, abs=0.02)
    assert np.allclose(np.cov(draws.T), u.covariance(u.names), rtol=0.05)


def test_wilson_interval():
    """Newcombe (1998), 81 of 263: 0.2553 to 0.3662."""
    assert wilson_half_width(81 / 263, 263) == pytest.approx((0.3662 - 0.2553) / 2, abs=1e-4)
    assert 0 < wilson_half_width(1.0, 100) < 0.02


@pytest.mark.parametrize(
    ("half_width", "correlation", "match"),
    [
        ({"Cn_beta": -1.0}, {}, "Cn_beta"),
        ({"Cn_beta": math.nan}, {}, "Cn_beta"),
        ({"Cn_beta": 1.0}, {("Cn_beta", "Cl_beta"): 0.5}, "correlation"),
        ({"Cn_beta": 1.0, "Cl_beta": 1.0}, {("Cn_beta", "Cl_beta"): 1.5}, "between -1 and 1"),
        (
            {"CL": 1.0, "CD": 1.0, "Cn_r": 1.0},
            {("CL", "CD"): 0.9, ("CD", "Cn_r"): 0.9, ("CL", "Cn_r"): -0.9},
            "no distribution",
        ),
    ],
)
def test_bad_uncertainty(half_width, correlation, match):
    with pytest.raises(InputError, match=match):
        Uncertainty(half_width, correlation)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"method": "guess"}, "method"),
        ({"samples": 0}, "samples"),
        ({"seed": -1}, "seed"),
        ({"form": "x"}, "form"),
        ({"vehicle_class": "V"}, "vehicle_class"),
        ({"uncertainty": Uncertainty({"Cn_betta": 0.1})}, "Cn_beta"),
    ],
)
def test_bad_input(change, match):
    with pytest.raises(InputError, match=match):
        outlooks(airframe(), **{"uncertainty": Uncertainty({"Cn_beta": 0.1}), **change})


def test_errors_of_mirrored_surfaces_are_one_error():
    """The elevator of two mirrored elevons is then as uncertain as both together; the aileron's C_m not at all."""
    pair = {"Cm_elevon_left": -0.05, "Cm_elevon_right": -0.05, "Cl_elevon_left": 0.02, "Cl_elevon_right": -0.02}
    derivatives, half = horus.derivatives(**pair), dict.fromkeys(pair, 0.01)
    found = mirror_correlation(derivatives, half)
    assert found == {("Cl_elevon_left", "Cl_elevon_right"): -1.0, ("Cm_elevon_left", "Cm_elevon_right"): 1.0}
    u = Uncertainty(half, found)
    draws = dict(zip(u.names, u.draw(300, 0).T, strict=True))
    assert np.allclose(draws["Cm_elevon_left"], draws["Cm_elevon_right"], atol=1e-12)
    assert np.allclose(draws["Cl_elevon_left"], -draws["Cl_elevon_right"], atol=1e-12)
    half["Cl_elevon_right"] = 0.02
    assert ("Cl_elevon_left", "Cl_elevon_right") not in mirror_correlation(derivatives, half)
