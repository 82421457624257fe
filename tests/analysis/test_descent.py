"""A descent flown on the published tables of HORUS-2B."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from spaceplane.aero.model.published import horus_2b_published
from spaceplane.analysis.descent import DescentSettings, descend
from spaceplane.analysis.trimming_center import trimming_center
from spaceplane.dynamics.given_errors import read_errors
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import identify
from spaceplane.dynamics.sensitivity import drivers
from spaceplane.dynamics.trim.longitudinal import HORUS_2B_BODY_FLAP
from spaceplane.errors import InputError
from spaceplane.pipeline import AnalyseSettings, analyse
from spaceplane.qualities.departure import dynamic_directional
from spaceplane.qualities.probability import NORMAL_95
from spaceplane.report import descent as report
from spaceplane.report import descent_likelihood
from spaceplane.vehicle.presets import horus_2b

MASS = horus_2b().mass


@pytest.fixture(scope="module")
def descent():
    return descend(
        horus_2b_published(), MASS, DescentSettings((1.5, 2.0, 2.5, 5.0, 10.0), body_flap=HORUS_2B_BODY_FLAP)
    )


def test_the_trim_at_the_taem_interface(descent):
    """Body flap -20 deg: elevons near -3 deg about the published reference, and the tables' own coefficients."""
    trim = descent.points[2].trim
    assert math.degrees(trim.body_flap) == pytest.approx(-20.0)
    assert math.degrees(trim.elevator) == pytest.approx(-2.8, abs=0.1)
    deflections = {"elevon_left": trim.elevator, "elevon_right": trim.elevator, "body_flap": trim.body_flap}
    found = horus_2b_published().coefficients(2.5, math.radians(16.6), deflections=deflections)
    assert found["Cm"] == pytest.approx(0.0, abs=1e-12)
    assert (found["CL"], found["CD"]) == pytest.approx((trim.CL, trim.CD))


def test_by_default_it_glides_near_to_the_path_and_bank_of_the_thesis(descent):
    """-8.4 and 55 deg at the TAEM interface (thesis Table 6.1); shallow where the air is thin."""
    angles = [(math.degrees(one.point.gamma), math.degrees(one.point.bank)) for one in descent.points]
    assert angles[2] == (pytest.approx(-8.4, abs=1.5), pytest.approx(55.0, abs=6.0))
    assert all(-12.0 < gamma < 0.0 < bank < 65.0 for gamma, bank in angles)
    assert angles[-1][0] > -1.5


def test_each_flight_point_may_be_given():
    given = {"alpha_deg": (12.0, 15.0), "altitude_m": (21e3, 24e3), "gamma_deg": (-5.0, -7.0), "bank_deg": (10.0, 40.0)}
    found = descend(horus_2b_published(), MASS, DescentSettings((2.0, 2.5), **given)).points
    for k, one in enumerate(found):
        assert one.point.altitude == given["altitude_m"][k]
        for name in ("alpha", "gamma", "bank"):
            assert math.degrees(getattr(one.point, name)) == pytest.approx(given[f"{name}_deg"][k])


def test_given_altitudes_bend_the_glide():
    """Twice the height for the same speeds takes a path twice as steep, but for gravity's part in the speed."""

    def gamma(rise):
        settings = DescentSettings((2.0, 2.5), alpha_deg=(14.0, 14.0), altitude_m=(22e3, 22e3 + rise))
        return descend(horus_2b_published(), MASS, settings).points[0].point.gamma

    assert gamma(0.0) == 0.0
    assert 1.6 < gamma(3e3) / gamma(1.5e3) < 2.0


@pytest.mark.parametrize(
    ("given", "naming"),
    [
        ({"alpha_deg": (10.0,)}, "alpha_deg: 1 values for 2 Mach numbers"),
        ({"bank_deg": (10.0, 20.0, 30.0)}, "bank_deg: 3 values for 2"),
        ({"gamma_deg": (math.nan, 0.0)}, "gamma"),
        ({"altitude_m": (1e9, 1e9)}, "altitude"),
    ],
)
def test_bad_flight_points(given, naming):
    with pytest.raises(InputError, match=naming):
        DescentSettings((2.0, 2.5), **given)


def test_a_single_altitude_says_nothing_of_the_path():
    with pytest.raises(InputError, match="gamma_deg: is needed"):
        DescentSettings((2.0,), altitude_m=(22e3,))


def test_modes_follow_from_the_sign_of_the_pitch_stiffness(descent):
    """Stable in pitch at Mach 1.5 and 10, where a short period is; a divergence between, as the literature has it."""
    for one in descent.points:
        kinds = {mode.kind for mode in one.modes}
        stiff = one.trim.static.Cm_alpha < 0.0
        assert ("short_period" in kinds) == stiff
        assert (
            any(m.group == "longitudinal" and not m.oscillatory and m.eigenvalue.real > 0.2 for m in one.modes) != stiff
        )
    divergence = max(mode.eigenvalue.real for mode in descent.points[2].modes)
    assert divergence == pytest.approx(0.9518, rel=0.07)  # thesis Table 6.2, with other lift and drag


def test_branches_pass_from_one_to_the_other_by_events(descent):
    kinds = [event.kind for event in descent.branches.events]
    assert "split" in kinds and "merge" in kinds
    assert descent.branches.dataset["mach"].values[[0, -1]].tolist() == [1.5, 10.0]


def test_modes_between_flight_points_are_those_of_flight_points_there(descent):
    """A is not taken linear from Mach 5 to 10, which would be far off in the middle."""
    data = descent.branches.dataset
    mach = data["mach"].values
    assert np.diff(np.log(mach)).max() < 0.021
    k = int(np.argmin(np.abs(mach - 7.5)))
    settings = DescentSettings((5.0, mach[k], 10.0), body_flap=HORUS_2B_BODY_FLAP, feedback=None)
    there = descend(horus_2b_published(), MASS, settings).points[1].modes
    for mode in there:
        assert np.abs(descent.branches.eigenvalues()[k] - mode.eigenvalue).min() < 1e-9
    straight = np.linalg.eigvals(sum(one.system.A for one in descent.points[3:5]) / 2)
    assert max(np.abs(straight - mode.eigenvalue).min() for mode in there) > 0.1


def test_where_the_center_of_mass_would_have_to_be():
    """Two metres aft the published tables have no trim at Mach 2.5; the search leads back to their own centre."""
    model, settings = horus_2b_published(), DescentSettings((2.5, 5.0, 10.0))
    x = model.reference.moment_center[0]
    aft = model.moved((x + 2.0, 0.0, 0.0))
    assert sum(one.trim is None for one in descend(aft, MASS, settings).points) >= 2
    found = trimming_center(aft, settings)
    assert found.count == 3 and found.lower - 0.3 < x < found.upper + 0.3


def test_no_center_is_looked_for_where_moments_cannot_be_moved():
    """Of a derivatives file: where its moment centre lies is not known."""
    model = replace(horus_2b_published(), center_known=False)
    assert not model.movable and trimming_center(model, DescentSettings((2.5, 5.0))) is None
    assert not replace(horus_2b_published(), lag=(0.0, -0.5)).movable


def test_nothing_is_extrapolated():
    found = descend(horus_2b_published(), MASS, DescentSettings((1.2, 2.0)))
    outside, inside = found.points
    assert outside.trim is None and "mach" in outside.reason and not outside.modes
    assert inside.trim is not None and found.branches is None


def test_the_map_holds_the_flown_trims(descent):
    here = descent.trim_map.sel(mach=2.5).interp(alpha=math.radians(16.6))
    assert float(here.elevator) == pytest.approx(descent.points[2].trim.elevator, abs=math.radians(0.2))
    assert bool(descent.trim_map.trimmable.sel(mach=2.5).all())


def test_a_flap_held_elsewhere_moves_the_elevator_the_other_way():
    settings = [DescentSettings((2.5,), body_flap=math.radians(flap)) for flap in (-20.0, 0.0)]
    up, neutral = (descend(horus_2b_published(), MASS, one).points[0].trim.elevator for one in settings)
    assert up > neutral


def test_the_page_and_the_record_are_written_whole(descent, tmp_path):
    paths = report.write(descent, tmp_path)
    record = json.loads(paths["json"].read_text())
    assert [point["mach"] for point in record["points"]] == [1.5, 2.0, 2.5, 5.0, 10.0]
    page = paths["html"].read_text()
    for text in ("Trim", "Modes", "Events along the descent", "Levels of MIL-F-8785C", "data:image/png"):
        assert text in page
    assert ">nan<" not in page
    for name in ("trim-map", "root-locus", "modes-by-mach", "eigenvectors", "control-roots", "control-responses"):
        assert paths[name].read_bytes()[:4] == b"\x89PNG"


@pytest.fixture(scope="module")
def uncertain():
    """C_n_beta so uncertain that the sign of C_n_beta,dyn is open, C_l_beta exact, the rest by shares."""
    errors = read_errors("--uncertainty", "Cn_beta=0.4,Cm_alpha=30%,CL=5%")
    settings = DescentSettings((2.0, 2.5), body_flap=HORUS_2B_BODY_FLAP, uncertainty=errors, samples=400)
    return descend(horus_2b_published(), MASS, settings)


def test_probabilities_along_a_descent_are_those_of_the_normal_distribution(uncertain):
    """C_n_beta,dyn is linear in C_n_beta: the chance that it is positive is known in closed form."""
    for one in uncertain.points:
        derivatives = horus_2b_published().derivatives(
            one.point.mach,
            one.point.alpha,
            {"elevon_left": one.trim.elevator, "elevon_right": one.trim.elevator, "body_flap": one.trim.body_flap},
        )
        value = dynamic_directional(derivatives, MASS, one.point.alpha)
        sigma = math.cos(one.point.alpha) * 0.4 / NORMAL_95
        outlook = next(
            o for o in one.likelihood.outlooks if o.verdict.criterion.endswith("dynamic directional stability")
        )
        assert outlook.verdict.met == (value > 0.0)
        assert outlook.probabilities["met"] == pytest.approx(norm.cdf(value / sigma), abs=1.5 * outlook.error)
        assert outlook.probabilities["met"] < 0.95


def test_what_drives_a_mode_moves_it(uncertain):
    """The pitch divergence by C_m_alpha: its first-order change by one per cent against that of the model itself."""
    one = uncertain.points[1]
    k = next(k for k, mode in enumerate(one.modes) if mode.eigenvalue.real > 0.5)
    driver = drivers(one.likelihood.sensitivities[k])[0]
    assert driver.parameter == "Cm_alpha" and driver.share > 0.9
    model = horus_2b_published()
    deflections = {"elevon_left": one.trim.elevator, "elevon_right": one.trim.elevator, "body_flap": one.trim.body_flap}
    derivatives = model.derivatives(2.5, one.point.alpha, deflections)
    moved = replace(derivatives, Cm_alpha=1.01 * derivatives.Cm_alpha)
    changed = identify(linearise(one.point, MASS, model.reference, moved))
    nearest = min((m.eigenvalue for m in changed), key=lambda z: abs(z - one.modes[k].eigenvalue))
    assert nearest - one.modes[k].eigenvalue == pytest.approx(driver.per_percent, rel=0.02)


def test_the_page_says_how_likely_levels_are(uncertain, descent, tmp_path, capsys):
    paths = report.write(uncertain, tmp_path)
    page, record = paths["html"].read_text(), json.loads(paths["json"].read_text())
    for text in ("How likely the levels are", "How far eigenvalues scatter", "What drives each mode", "Cm_alpha 30 %"):
        assert text in page
    assert re.search(r"(level \d|below 3|met) with \d+ %", page)
    assert paths["eigenvalue-scatter"].read_bytes()[:4] == b"\x89PNG"
    assert record["uncertainty"]["Cn_beta"] == {"half_width": 0.4}
    point = record["points"][1]
    mode = next(m for m in point["modes"] if m["eigenvalue"][0] > 0.5)
    assert mode["eigenvalue_error"][0] == pytest.approx(NORMAL_95 * mode["scatter"]["real"], rel=0.25)
    assert mode["drivers"][0]["parameter"] == "Cm_alpha"
    assert sum(point["verdicts"][0]["probabilities"].values()) == pytest.approx(1.0)
    descent_likelihood.print_levels(uncertain)
    assert re.search(r"Mach 2(\.5)?: .* with \d+ %", capsys.readouterr().out)
    plain = report.page(descent, {})
    assert "What drives each mode" in plain and "How likely" not in plain
    descent_likelihood.print_levels(descent)
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Cm_elevator=10%", "Cm_elevon"),
        ("Cm_rudder_left=0.1", "Cm_rudder_left"),
        ("Cl_p=10%", "Cl_p: the model takes it as zero"),
        ("Cm_alphadot=10%", "Cm_alphadot"),
    ],
)
def test_errors_of_what_the_model_does_not_know(text, message):
    settings = DescentSettings((2.5,), uncertainty=read_errors("--uncertainty", text))
    with pytest.raises(InputError, match=message):
        descend(horus_2b_published(), MASS, settings)


def test_a_lag_that_the_model_has_may_be_uncertain():
    errors = read_errors("--uncertainty", "Cm_alphadot=10%")
    settings = DescentSettings((2.5,), uncertainty=errors, samples=20, feedback=None)
    [point] = descend(replace(horus_2b_published(), lag=(0.0, -0.5)), MASS, settings).points
    assert point.likelihood.uncertainty.half_width["Cm_alphadot"] == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"machs": (2.0, 2.0)}, "mach"),
        ({"form": "other"}, "form"),
        ({"category": "D"}, "category"),
        ({"machs": (30.0,)}, "mach"),
    ],
)
def test_what_is_wrong_is_named(wrong, message):
    with pytest.raises(InputError, match=message):
        descend(horus_2b_published(), MASS, replace(DescentSettings((2.0,)), **wrong))


def test_bank_couples_and_level_flight_does_not():
    groups = []
    for bank in (0.0, 55.0):
        point = descend(horus_2b_published(), MASS, DescentSettings((10.0,), bank_deg=(bank,))).points[0]
        states = point.system.states
        rows = [states.index(name) for name in ("V", "gamma", "R", "q", "alpha")]
        columns = [states.index(name) for name in ("p", "r", "beta", "sigma")]
        groups.append(np.abs(point.system.A[np.ix_(rows, columns)]).max())
    assert groups[0] < 1e-12 < groups[1]


def test_the_page_says_what_the_controls_can_do(descent, tmp_path):
    """Elevator alone is published: thrusters stand in for roll and yaw; nothing grows fast at Mach 10."""
    paths = report.write(descent, tmp_path)
    page = paths["html"].read_text()
    for text in ("Control power", "Controllability", "What the feedback asks", "Levels with the feedback"):
        assert f"<h3>{text}</h3>" in page
    for text in ("The feedback uses elevator", "no yawing moment of the rudder is known", "the damping CL_q, Cm_q"):
        assert text in page
    assert "−34.9 to 40.2" in page  # alpha held at Mach 2.5
    control = [point["control"] for point in json.loads(paths["json"].read_text())["points"]]
    fastest = [max(mode["eigenvalue"][0] for mode in one["modes"]) for one in control]
    asked = [max(abs(e["jump"]) for e in one["disturbances"][0]["efforts"] if e["unit"] == "deg") for one in control]
    assert np.argmax(asked) == np.argmax(fastest) == 2
    assert asked[-1] < 1e-3 and control[-1]["held_deg"]["alpha"] == [None, None]


def test_control_is_left_out_where_nobody_asks(tmp_path):
    found = descend(horus_2b_published(), MASS, DescentSettings((2.5,), feedback=None))
    paths = report.write(found, tmp_path)
    assert "Control power" not in paths["html"].read_text() and "control-roots" not in paths
    assert json.loads(paths["json"].read_text())["points"][0]["control"] is None


def test_thesis_form_with_a_product_of_inertia_is_refused_before_anything_is_computed():
    tilted = replace(MASS, Ixz=-6e4)
    with pytest.raises(InputError, match="Ixz = -60000 kg m2: must be 0 with form = 'thesis'"):
        descend(horus_2b_published(), tilted, DescentSettings((2.5,), form="thesis"))
    with pytest.raises(InputError, match="Ixz = -60000 kg m2: must be 0 with form = 'thesis'"):
        analyse(replace(horus_2b(), mass=tilted), AnalyseSettings(form="thesis"))
