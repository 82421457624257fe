"""A flight point of an analysis as a linear aerodynamic model: its own coefficients and slopes, and what is refused."""

import copy
import json
import math

import pytest

from spaceplane import cli
from spaceplane.errors import InputError
from spaceplane.report.local_model import local_model
from spaceplane.report.read import read_result


@pytest.fixture
def result(out_dir):
    return copy.deepcopy(read_result(out_dir))


def at(result, name):
    return next(point for point in result["flight_points"] if point["name"] == name)


def test_it_gives_back_coefficients_and_derivatives_of_the_flight_point(result):
    result["vehicle"]["deflections_deg"] = {"elevon_left": -17.5, "elevon_right": -17.5, "body_flap": -20.0}
    names = [point["name"] for point in result["flight_points"]]
    for name in names:
        point, source = at(result, name), local_model(result, name)
        model, alpha = source.model, math.radians(point["alpha_deg"])
        deflections = {k: math.radians(v) for k, v in result["vehicle"]["deflections_deg"].items()}
        found = model.coefficients(point["mach"], alpha, deflections=deflections)
        for coefficient in ("CL", "CD", "Cm"):
            assert found[coefficient] == pytest.approx(point["coefficients"][coefficient], abs=1e-12)
        slopes = model.derivatives(point["mach"], alpha, deflections)
        for derivative in ("CL_alpha", "Cm_alpha", "CD_M", "Cn_beta", "Cl_beta"):
            value = point["derivatives"][derivative]["value"]
            assert getattr(slopes, derivative) == pytest.approx(value, rel=1e-9), derivative
        for derivative in (d for d in point["derivatives"] if d.endswith("_elevon_left")):
            value = point["derivatives"][derivative]["value"]
            assert slopes.controls[derivative] == pytest.approx(value, rel=1e-9), derivative
        assert source.mass.mass == result["vehicle"]["mass"]["mass_kg"] and name in model.source
        assert "extrapolated to no deflection" in model.source


def test_product_of_inertia_is_kept_and_may_be_missing(result):
    assert local_model(result, "2.5").mass.Ixz == 0.0
    result["vehicle"]["mass"]["Ixz_kgm2"] = -6e4
    assert local_model(result, "2.5").mass.Ixz == -6e4


def test_errors_of_the_analysis_go_along(result):
    point = at(result, "Mach 2.5")
    point["derivatives"]["Cn_beta"]["error"] = 0.02
    point["derivatives"]["Cl_beta"]["error"] = None
    point["coefficient_errors"]["CL"] = 0.003
    errors = local_model(result, "2.5").errors
    assert errors["Cn_beta"].half_width(-0.3) == 0.02
    assert errors["CL"].half_width(0.2) == 0.003
    assert "Cl_beta" not in errors and "CA" not in errors


def test_the_flight_point_must_be_one_of_the_analysis(result):
    with pytest.raises(InputError, match=r"--point: needed, the analysis has Mach 0\.8, "):
        local_model(result)
    with pytest.raises(InputError, match="--point: '7' names 0 flight points"):
        local_model(result, "7")
    assert local_model(result, "2.5").model.name == local_model(result, "Mach 2.5").model.name
    one = result | {"flight_points": result["flight_points"][:1]}
    assert local_model(one).model.mach.mean() == pytest.approx(one["flight_points"][0]["mach"])


def test_a_failed_flow_is_not_filled_in(result):
    at(result, "Mach 2.5")["derivatives"]["Cn_beta"]["value"] = None
    with pytest.raises(InputError, match=r"Mach 2\.5: Cn_beta is missing"):
        local_model(result, "2.5")
    at(result, "Mach 0.8")["coefficients"]["CL"] = None
    with pytest.raises(InputError, match="CL is missing"):
        local_model(result, "0.8")


def test_an_analysis_flies_and_becomes_an_aircraft(capfd, out_dir, tmp_path):
    deck = ["export", "jsbsim", str(out_dir), "--point", "2.5", "--out", str(tmp_path / "deck")]
    assert cli.run(deck) == 0 and len(list((tmp_path / "deck").rglob("*.xml"))) == 2
    fly = ["fly", str(out_dir), "--point", "2.5", "--json", str(tmp_path / "fly.json"), "--out", str(tmp_path / "fly")]
    assert cli.run(fly) in (0, 1)
    [flown] = json.loads((tmp_path / "fly.json").read_text())["points"]
    analysed = at(read_result(out_dir), "Mach 2.5")
    for key in ("mach", "altitude_m", "alpha_deg", "gamma_deg", "bank_deg"):
        assert flown[key] == pytest.approx(analysed[key]), key
    for wrong, naming in (
        (["fly", str(out_dir)], "--point: needed"),
        (["fly", "horus-2b-published", "--point", "2.5"], "--point: 2.5, goes with a folder of `spaceplane analyse`"),
        (["fly", str(out_dir), "--vehicle", "horus-2b"], "--vehicle: an analysis has its own vehicle"),
        (["export", "csv", str(out_dir), "--point", "2.5"], "--point: 2.5, has no effect"),
    ):
        capfd.readouterr()
        assert cli.run([*wrong, "--out", str(tmp_path / "no")]) == 2
        assert naming in capfd.readouterr().err


def test_errors_of_an_analysis_stay_behind_when_the_centre_of_mass_is_moved(capfd, out_dir, tmp_path):
    fly = ["fly", str(out_dir), "--point", "2.5", "--no-control"]
    assert cli.run([*fly, "--center-of-mass", "13.1,0,0", "--out", str(tmp_path / "moved")]) in (0, 1)
    moved = capfd.readouterr().err
    assert cli.run([*fly, "--out", str(tmp_path / "as-it-is")]) in (0, 1)
    said = "errors of the source hold about its own moment centre and are left out"
    assert said in moved and said not in capfd.readouterr().err


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda p: p.pop("derivatives"), r"flight point 2 (Mach 1.5) lacks 'derivatives'"),
        (lambda p: p.pop("mach"), "flight point 2 (Mach 1.5) lacks 'mach'"),
        (lambda p: p.pop("coefficient_errors"), "flight point 2 (Mach 1.5) lacks 'coefficient_errors'"),
        (lambda p: p.pop("name"), "flight point 2 lacks 'name'"),
        (lambda p: p["coefficients"].pop("Cm"), "flight point 2 (Mach 1.5), coefficients lacks 'Cm'"),
        (lambda p: p["derivatives"]["Cn_beta"].pop("value"), "(Mach 1.5), derivatives Cn_beta lacks 'value'"),
        (lambda p: p["modes"][0].pop("eigenvalue"), "(Mach 1.5), modes 1 lacks 'eigenvalue'"),
        (lambda p: p.update(verdicts=[3]), "(Mach 1.5), verdicts 1 is no mapping"),
        (lambda p: p.update(mach="fast"), "(Mach 1.5): mach = 'fast' is not as an analysis writes it"),
        (lambda p: p.update(modes=None), "(Mach 1.5): modes = 'None' is not as an analysis writes it"),
    ],
)
def test_a_flight_point_that_lacks_something_is_one_line(capfd, result, tmp_path, change, message):
    change(result["flight_points"][1])
    path = tmp_path / "result.json"
    path.write_text(json.dumps(result))
    out = ["--out", str(tmp_path / "out")]
    for command in (
        ["fly", str(tmp_path), "--point", "2.5", *out],
        ["export", "jsbsim", str(tmp_path), "--point", "2.5", *out],
        ["compare", str(path), str(path)],
        ["report", str(tmp_path)],
    ):
        assert cli.run(command) == 2
        error = capfd.readouterr().err
        assert error.startswith(f"error: {path}: damaged, ") and error.count("\n") == 1 and message in error, error
    result["flight_points"][1] = 7
    path.write_text(json.dumps(result))
    with pytest.raises(InputError, match="flight point 2 is no mapping"):
        read_result(tmp_path)


def test_a_vehicle_without_reference_is_one_line(result, tmp_path):
    del result["vehicle"]["reference"]
    (tmp_path / "result.json").write_text(json.dumps(result))
    with pytest.raises(InputError, match="vehicle lacks 'reference'"):
        read_result(tmp_path)
