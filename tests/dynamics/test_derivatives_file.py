"""The TOML file of `spaceplane modes`: what it gives and how it refuses."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spaceplane.dynamics import derivatives_file
from spaceplane.dynamics.linearise import linearise
from spaceplane.errors import InputError
from spaceplane.qualities import analyse_modes

from . import horus

EXAMPLES = Path(__file__).parents[2] / "examples"
EXAMPLE = EXAMPLES / "horus_2b_taem.toml"


def written(tmp_path, old="", new="", extra=""):
    """The example with one text replaced and one added."""
    text = EXAMPLE.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "case.toml"
    path.write_text(text.replace(old, new) + extra, encoding="utf-8")
    return path


def test_example_is_the_thesis_point():
    case = derivatives_file.read(EXAMPLE)
    system = linearise(case.point, case.mass, case.reference, case.derivatives, case.form)
    expected = linearise(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives())
    assert np.allclose(system.A, expected.A, rtol=1e-12)
    assert case.form == "rigid-body"


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda p: p.stem)
def test_every_example_runs(path):
    record = analyse_modes(derivatives_file.read(path))
    assert json.loads(json.dumps(record, allow_nan=False))["schema"] == "spaceplane.modes"
    assert len(record["eigenvalues"]) == 9
    assert sum(2 if m["oscillatory"] else 1 for m in record["modes"]) == 9
    assert record["verdicts"]
    A, states = np.array(record["A"]), record["states"]
    assert len(record["names"]) == len(record["eigenvectors"]) == 9
    for (re, im), entry in zip(record["eigenvalues"], record["eigenvectors"], strict=True):
        z = [entry[s]["magnitude"] * np.exp(1j * np.radians(entry[s]["phase_deg"])) for s in states]
        assert np.abs(A @ z - complex(re, im) * np.array(z)).max() < 1e-9


def test_boeing_747_example_flies_textbook_modes():
    record = analyse_modes(derivatives_file.read(EXAMPLES / "boeing747_cruise.toml"))
    by_kind = {m["kind"]: m for m in record["modes"]}
    assert {"short_period", "phugoid", "dutch_roll", "roll", "spiral"} <= set(by_kind)
    assert by_kind["short_period"]["eigenvalue"] == pytest.approx([-0.372, 0.887], abs=4e-3)
    assert by_kind["phugoid"]["eigenvalue"] == pytest.approx([-0.0033, 0.067], abs=1e-3)
    assert by_kind["dutch_roll"]["eigenvalue"] == pytest.approx([-0.033, 0.947], abs=5e-4)
    assert by_kind["roll"]["eigenvalue"][0] == pytest.approx(-0.563, abs=5e-4)
    assert by_kind["spiral"]["eigenvalue"][0] == pytest.approx(-0.0073, abs=5e-5)
    assert record["vehicle"]["Ixz_kgm2"] == -0.212e7


def test_product_of_inertia_is_that_of_primed_derivatives():
    """Boeing 747: Etkin and Reid's I_zx equals Cl' and Cn' without it wherever nothing turns steadily."""
    case = derivatives_file.read(EXAMPLES / "boeing747_cruise.toml")
    mass, d = case.mass, case.derivatives
    share = 1.0 - mass.Ixz**2 / (mass.Ixx * mass.Izz)
    changed = {}
    for name in ("beta", "p", "r"):
        roll, yaw = getattr(d, f"Cl_{name}"), getattr(d, f"Cn_{name}")
        changed[f"Cl_{name}"] = (roll + mass.Ixz / mass.Izz * yaw) / share
        changed[f"Cn_{name}"] = (yaw + mass.Ixz / mass.Ixx * roll) / share
    assert changed["Cl_beta"] == pytest.approx(-0.28660, abs=5e-6)
    assert changed["Cn_r"] == pytest.approx(-0.30061, abs=5e-6)
    lift = mass.mass * case.point.gravity / (case.point.dynamic_pressure * case.reference.area)
    straight = case.point.with_coefficients(lift, case.point.coefficients()[1])

    def eigenvalues(point, mass, derivatives, gyroscopic):
        system = linearise(point, mass, case.reference, derivatives, density_gradient=False, gyroscopic=gyroscopic)
        return np.sort_complex(np.linalg.eigvals(system.A))

    for point, gyroscopic in ((straight, True), (case.point, False)):
        with_product = eigenvalues(point, mass, d, gyroscopic)
        primed = eigenvalues(point, replace(mass, Ixz=0.0), replace(d, **changed), gyroscopic)
        assert np.abs(with_product - primed).max() < 1e-9
        without = eigenvalues(point, replace(mass, Ixz=0.0), d, gyroscopic)
        assert np.abs(with_product - without).max() > 1e-3


def test_product_of_inertia_of_a_file(tmp_path):
    assert derivatives_file.read(EXAMPLE).mass.Ixz == 0.0
    path = written(tmp_path, "Izz_kgm2 = 806000.0", "Izz_kgm2 = 806000.0\nIxz_kgm2 = -6e4")
    case = derivatives_file.read(path)
    assert case.mass == horus.TILTED
    record = analyse_modes(case)
    assert record["eigenvalues"] != analyse_modes(derivatives_file.read(EXAMPLE))["eigenvalues"]
    path.write_text(path.read_text().replace('"rigid-body"', '"thesis"'))
    with pytest.raises(InputError, match=r"Ixz = -60000 kg m2: must be 0 with form = 'thesis'"):
        derivatives_file.read(path)
    with pytest.raises(InputError, match="must be 0 with form = 'thesis'"):
        linearise(case.point, case.mass, case.reference, case.derivatives, "thesis")


def test_random_derivatives_never_break_the_record():
    """Signs and sizes far from any vehicle, zeros among them: nine eigenvalues, plain JSON, no NaN."""
    content = tomllib.loads(EXAMPLE.read_text(encoding="utf-8"))
    names = [name for name in content["derivatives"] if name != "unit"]
    rng = np.random.default_rng(7)
    for case in range(100):
        content["derivatives"] = {"unit": "per_radian"} | {
            name: float(rng.choice([0.0, 1.0, -1.0]) * 10 ** rng.uniform(-5, 1)) for name in names
        }
        content["flight"] |= {
            "mach": float(10 ** rng.uniform(-1, 1.3)),
            "altitude_m": float(rng.uniform(0, 86_000)),
            "gamma_deg": float(rng.uniform(-60, 60)),
            "bank_deg": float(rng.uniform(-80, 80)),
        }
        content["model"] = {"form": ("rigid-body", "thesis")[case % 2]}
        record = json.loads(json.dumps(analyse_modes(derivatives_file.from_tables(content)), allow_nan=False))
        assert len(record["eigenvalues"]) == 9
        for mode in record["modes"]:
            divergence = not mode["oscillatory"] and mode["double_time_s"] is not None
            assert not (divergence and mode["kind"] in ("short_period", "phugoid", "dutch_roll", "roll"))


def test_per_degree_and_per_radian_agree(tmp_path):
    """Only angle derivatives are converted: not those with the Mach number, nor those with rates."""
    factor = 180 / np.pi
    per_degree = written(tmp_path, "Cm_M = 0.01195", "Cm_M = 0.01195\nCm_q = -1.5\nCm_elevator = -0.003")
    a = derivatives_file.read(per_degree).derivatives
    assert a.Cm_alpha == pytest.approx(0.00071 * factor)
    assert a.controls["Cm_elevator"] == pytest.approx(-0.003 * factor)
    assert (a.CD_M, a.Cm_q) == (-0.0415, -1.5)
    per_radian = written(tmp_path, '"per_degree"', '"per_radian"')
    assert derivatives_file.read(per_radian).derivatives.Cm_alpha == 0.00071


def test_pressure_and_temperature_replace_the_standard(tmp_path):
    path = written(tmp_path, "CD = 0.20", "CD = 0.20\npressure_Pa = 2511.02\ntemperature_K = 221.65")
    case = derivatives_file.read(path)
    assert case.point.dynamic_pressure == pytest.approx(0.7 * 2511.02 * 2.5**2)
    assert case.point.altitude == 26_700.0


def test_model_keys_act(tmp_path):
    plain = analyse_modes(derivatives_file.read(EXAMPLE))
    for line in ("density_gradient = false", "gyroscopic = false"):
        changed = analyse_modes(derivatives_file.read(written(tmp_path, extra=line)))
        assert changed["eigenvalues"] != plain["eigenvalues"]
    thesis = analyse_modes(derivatives_file.read(written(tmp_path, '"rigid-body"', '"thesis"')))
    assert thesis["form"] == "thesis"
    category = analyse_modes(derivatives_file.read(written(tmp_path, extra='category = "C"\nvehicle_class = "IV"')))
    assert category["verdicts"][0]["category"] == "C" and category["verdicts"][0]["vehicle_class"] == "IV"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("Cm_alpha = 0.00071", "Cm_alfa = 0.00071", "unknown key 'Cm_alfa': did you mean 'Cm_alpha'"),
        ("Cm_alpha = 0.00071", "", "Cm_alpha: missing"),
        ("mass_kg", "mass", "unknown key 'mass': did you mean 'mass_kg'"),
        ("[vehicle]", "[vehicel]", "unknown table 'vehicel': did you mean 'vehicle'"),
        ("mach = 2.5", "mach = 0.0", "mach = 0"),
        ("mach = 2.5", "mach = -1.0", "mach = -1"),
        ("mach = 2.5", "mach = nan", "mach = nan: must be a finite number"),
        ("mach = 2.5", 'mach = "fast"', "mach = 'fast': must be a finite number"),
        ("mach = 2.5", "mach = true", "mach = True: must be a finite number"),
        ("mass_kg = 26000.0", "mass_kg = 0", "mass_kg = 0: must be above 0"),
        ("Iyy_kgm2 = 769000.0", "Iyy_kgm2 = -1", "Iyy_kgm2 = -1: must be above 0"),
        ("Izz_kgm2 = 806000.0", "Izz_kgm2 = 806000.0\nIxz_kgm2 = 2e5", "Ixz = 200000 kg m2: allowed .* 172766 kg m2"),
        ("altitude_m = 26700.0", "altitude_m = 90000", "altitude_m = 90000"),
        ("CL = 0.36", "CL = inf", "CL = inf"),
        ('unit = "per_degree"', 'unit = "degrees"', "unit = 'degrees'.*per_degree, per_radian"),
        ('unit = "per_degree"', "", "unit: missing"),
        ('form = "rigid-body"', 'form = "appendix"', "form = 'appendix'"),
        ('form = "rigid-body"', "gyroscopic = 1", "gyroscopic = 1: must be true or false"),
        ("gamma_deg = -8.4", "gamma_deg = -90", "gamma_deg = -90"),
        ("[vehicle]", "[vehicle", "not a TOML file"),
    ],
)
def test_refuses(tmp_path, old, new, message):
    with pytest.raises(InputError, match=message) as caught:
        derivatives_file.read(written(tmp_path, old, new))
    assert "\n" not in str(caught.value)


def test_unknown_class_is_refused(tmp_path):
    with pytest.raises(InputError, match="vehicle_class"):
        analyse_modes(derivatives_file.read(written(tmp_path, extra='vehicle_class = "V"')))


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        derivatives_file.read(tmp_path / "none.toml")
    with pytest.raises(InputError, match="cannot be read"):
        derivatives_file.read(tmp_path)


EXAMPLE_CONTENT = tomllib.loads(EXAMPLE.read_text(encoding="utf-8"))
UNCERTAIN = {"Cn_beta": 0.0005, "Cl_beta": 0.0003, "Cm_M": 0.001, "CL": 0.02}


def uncertain(**table):
    return {**EXAMPLE_CONTENT, "uncertainty": {**UNCERTAIN, **table}}


def test_uncertainty_is_read_in_the_unit_of_the_derivatives():
    case = derivatives_file.from_tables(uncertain(correlation=[["Cn_beta", "Cl_beta", -0.5]], samples=150, seed=4))
    assert case.uncertainty["Cn_beta"] == pytest.approx(0.0005 * 180 / np.pi)
    assert (case.uncertainty["Cm_M"], case.uncertainty["CL"]) == (0.001, 0.02)  # no angles
    assert (case.correlation, case.samples, case.seed) == ({("Cn_beta", "Cl_beta"): -0.5}, 150, 4)
    record = analyse_modes(case)
    json.dumps(record, allow_nan=False)
    for verdict in (*record["verdicts"], *record["airframe_verdicts"]):
        assert sum(verdict["probabilities"].values()) == pytest.approx(1.0)
        assert verdict["samples"] == 150 and " with " in verdict["probability_text"]
    lateral = next(m for m in record["modes"] if m["eigenvalue"][1] > 0.5)
    assert lateral["eigenvalue_error"][1] > 0 and lateral["drivers"][0]["parameter"] in ("Cl_beta", "Cn_beta")
    plain = analyse_modes(derivatives_file.from_tables(EXAMPLE_CONTENT))
    assert all(v["probabilities"] is None for v in plain["verdicts"]) and plain["modes"][0]["drivers"]


@pytest.mark.parametrize(
    ("table", "match"),
    [
        ({"Cn_beta": -1.0}, r"\[uncertainty\] Cn_beta"),
        ({"Cn_betta": 1.0}, "Cn_beta"),
        ({"Cl_aileron": 0.1}, "has no Cl_aileron"),
        ({"samples": 0}, "samples"),
        ({"seed": 1.5}, "seed"),
        ({"correlation": [["Cn_beta", "Cl_r", 0.5]]}, "correlation"),
        ({"correlation": [["Cn_beta", "Cl_beta", 2.0]]}, "correlation"),
    ],
)
def test_bad_uncertainty_is_refused(table, match):
    with pytest.raises(InputError, match=match):
        derivatives_file.from_tables(uncertain(**table))


def test_what_criteria_on_the_airframe_take_beside():
    """Each of the table's keys moves a verdict."""
    controls = {
        "Cm_elevator": -0.002,
        "CL_elevator": 0.004,
        "Cl_aileron": 0.001,
        "Cn_aileron": -0.0002,
        "Cn_rudder": -0.001,
    }
    content = {**EXAMPLE_CONTENT, "derivatives": {**EXAMPLE_CONTENT["derivatives"], **controls}}

    def verdicts(**table):
        record = analyse_modes(derivatives_file.from_tables({**content, "airframe": table}))
        return {(v["paragraph"], v["quantity"]): v for v in record["airframe_verdicts"]}

    plain = verdicts()
    trim = verdicts(Cm=0.01, elevator_deg=-3.0)["3.2.3.1", "elevator for trim"]
    assert (
        trim["value"] == pytest.approx(-3.0 + 0.01 / 0.002) and not plain["3.2.3.1", "elevator for trim"]["applicable"]
    )
    reach = verdicts(load_factors=[0.0, 2.5])["3.2.3.2", "greatest load factor"]
    assert reach["applicable"] and not plain["3.2.3.2", "greatest load factor"]["applicable"]
    bank = ("3.3.4", "time to bank by 30 deg")
    assert verdicts(speed_range="L")[bank]["limits"] != plain[bank]["limits"]
    lcdp = next(key for key in plain if key[1] == "LCDP")
    assert verdicts(rudder_per_aileron=0.5)[lcdp]["value"] != plain[lcdp]["value"]


@pytest.mark.parametrize(
    ("table", "match"),
    [
        ({"load_factors": [1.0]}, "load_factors"),
        ({"Cm": "x"}, "Cm"),
        ({"elevator": 1.0}, "elevator_deg"),
        ({"speed_range": "X"}, "speed_range"),
    ],
)
def test_bad_airframe_is_refused(table, match):
    with pytest.raises(InputError, match=match):
        analyse_modes(derivatives_file.from_tables({**EXAMPLE_CONTENT, "airframe": table}))
