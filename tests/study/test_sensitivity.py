"""A whole study on a stand-in for the pipeline: tables, figures, resumption."""

import csv
import json

import fake
import pytest

from spaceplane.errors import InputError
from spaceplane.study import sensitivity, shapes
from spaceplane.study.cases import load_study
from spaceplane.study.changes import Change, lateral_oscillation, most_unstable, worst_flow

PARAMETERS = {"wing_width_m": (), "winglet_length_m": (), "fuselage_height_m": ()}


@pytest.fixture
def quick(monkeypatch):
    """Cases of the stand-in: the shape's changes, the Mach numbers and the mesh's offset are all it reads."""

    def inputs(vehicle, changes, mach, *_):
        return {"shape": changes, "mach": list(mach), "settings": {"mesh": {"offset": [0.4, 0.2]}}}

    monkeypatch.setattr(sensitivity, "case_inputs", inputs)
    monkeypatch.setattr(sensitivity, "with_one_wall_cell", lambda vehicle, changes, settings, outside: settings)


def run(tmp_path, evaluate=fake.evaluate, **changes):
    study = load_study(**({"parameters": PARAMETERS} | changes))
    return sensitivity.run(study, tmp_path / "s.sqlite", tmp_path / "out", evaluate=evaluate, plots=False)


def test_changes_are_those_of_the_law_behind_them(quick, tmp_path):
    found = run(tmp_path)
    assert (found.computed, found.reused, found.failures) == (9, 0, ())  # 1 default, 2 shifted, 6 changed
    base = fake.evaluate({})["flight_points"][1]["derivatives"]["Cl_beta"]["value"]
    wide = fake.evaluate({"shape": {"wing_width_m": 3.9}})["flight_points"][1]["derivatives"]["Cl_beta"]["value"]
    (row,) = (
        row
        for row in found.rows
        if (row.parameter, row.side, row.mach, row.quantity) == ("wing_width_m", "high", 1.5, "Cl_beta")
    )
    assert row.default == base and row.value == wide and row.unit == "1/rad"
    assert row.change == pytest.approx(wide - base)
    assert row.relative_percent == pytest.approx(100 * (wide - base) / abs(base))
    again = run(tmp_path)
    assert (again.computed, again.reused) == (0, 9) and again.rows == found.rows


def test_tables_hold_every_number_and_no_nan(quick, tmp_path):
    found = run(tmp_path)
    with found.files["sensitivity.csv"].open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(found.rows)
    quantities = {row["quantity"] for row in rows}
    assert {"CL_alpha", "Cm_M", "L_over_D", "lateral oscillation: damping ratio"} <= quantities
    assert {row["mach"] for row in rows} == {"0.8", "1.5", "2.5"}
    for row in rows:
        if row["value"] and row["default"]:
            assert float(row["change"]) == pytest.approx(float(row["value"]) - float(row["default"]))
    document = json.loads(found.files["sensitivity.json"].read_text())
    assert document["schema"] == "spaceplane.sensitivity" and document["cases"]["computed"] == 9
    assert len(document["thesis_agreement"]["rows"]) == 3 * 2 * 3 * 9
    assert "NaN" not in found.files["sensitivity.json"].read_text()


def test_changes_are_held_against_what_a_shift_of_the_mesh_does(quick, tmp_path):
    found = run(tmp_path)
    for row in found.rows:
        if row.kind == "derivative":
            assert row.noise == pytest.approx(0.01 * abs(row.default))  # the stand-in: 2 % of half a cell
            assert row.resolved == (abs(row.change) > row.noise)
    without = run(tmp_path, mesh_shifts=0)
    assert (without.computed, without.reused) == (0, 7)
    assert all(row.noise is None and row.resolved is None for row in without.rows)


def test_relative_percent_difference_is_bounded_and_antisymmetric():
    def change(value, default):
        return Change("p", "low", 1.0, 2.0, 0.8, "derivative", "Cm_alpha", "1/rad", value, default, None, "converged")

    assert change(3.0, 1.0).rpd_percent == pytest.approx(100.0)
    assert change(1.0, 3.0).rpd_percent == pytest.approx(-100.0)
    assert change(1.0, -1e-9).rpd_percent == pytest.approx(200.0)
    assert change(0.0, 0.0).rpd_percent == 0.0 and change(1.0, 0.0).relative_percent is None
    assert change(None, 1.0).change is None


def test_failed_flows_are_marked_and_not_compared_with_the_thesis(quick, tmp_path):
    found = run(tmp_path, evaluate=failing)
    assert {row.flow for row in found.rows} == {"failed"} and found.agreement == ()
    assert found.warnings[0] == "default, Mach 0.8: base failed" and len(found.warnings) == 7 * 3


def test_a_case_that_breaks_is_reported_and_the_others_kept(quick, tmp_path):
    found = run(tmp_path, evaluate=breaks_when_wide)
    (failure,) = found.failures
    assert failure.label == "wing_width_m = 3.9 (high)" and "too wide" in failure.reason
    assert len(found.variations) == 5
    assert json.loads(found.files["sensitivity.json"].read_text())["failures"][0]["case"] == failure.label


def test_a_default_without_result_ends_the_study(quick, tmp_path):
    with pytest.raises(InputError, match=r"default shape has no result.*no flow"):
        run(tmp_path, evaluate=never)


def test_output_folder_that_cannot_be_made(quick, tmp_path):
    (tmp_path / "out").touch()
    with pytest.raises(InputError, match="a folder is needed"):
        run(tmp_path)


def test_plots_are_drawn_for_every_mach_and_group(quick, tmp_path):
    study = load_study(parameters=PARAMETERS, mach=(0.8, 2.5))
    found = sensitivity.run(study, tmp_path / "s.sqlite", tmp_path / "out", evaluate=fake.evaluate)
    names = {path.name for path in (tmp_path / "out").glob("*.png")}
    assert {
        f"{kind}_mach_{mach}.png" for kind in ("greatest_real_part", "lateral_oscillation") for mach in ("0.8", "2.5")
    } <= names
    assert {"eigenvalues_default.png", "derivatives_mach_2.5_part_1.png", "derivatives_mach_0.8_part_2.png"} <= names
    for name in names:
        picture = tmp_path / "out" / name
        assert picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n" and 3_000 < picture.stat().st_size < 200_000
        assert "<svg" in picture.with_suffix(".svg").read_text()[:1000]
    assert set(found.files) >= {"sensitivity.csv", "eigenvalues_default"}


def test_lateral_oscillation_is_the_one_in_which_sideslip_and_roll_move():
    modes = fake.evaluate({})["flight_points"][0]["modes"]
    assert lateral_oscillation(modes)["name"] == "Dutch roll"
    assert most_unstable(modes)["name"] == "pitch divergence"
    rolling = [mode | {"kind": "roll_spiral_oscillation"} if mode["kind"] == "dutch_roll" else mode for mode in modes]
    assert lateral_oscillation(rolling) is None  # sideslip hardly moves
    assert lateral_oscillation([]) is None and most_unstable([]) is None


def test_worst_flow():
    converged, failed = ({"convergence": [{"verdict": verdict}]} for verdict in ("converged", "failed"))
    assert worst_flow(converged) == "converged" and worst_flow(converged, failed) == "failed"
    assert worst_flow({"convergence": []}) == "failed"  # nothing was computed: not good


def test_inputs_resolve_the_vehicle_and_settings():
    default = shapes.case_inputs("horus-2b", {}, (0.8,), {})
    wide = shapes.case_inputs("horus-2b", {"wing_width_m": 3.9}, (0.8,), {})
    assert default["vehicle"]["shape"]["wing_width_m"] == 3.1 and wide["vehicle"]["shape"]["wing_width_m"] == 3.9
    assert default["settings"]["controls"] is False and list(default["settings"]["mach"]) == [0.8]
    finer = shapes.case_inputs("horus-2b", {}, (0.8,), {"mesh": {"target_cells": 12345}})
    assert finer["settings"]["mesh"]["target_cells"] == 12345 and finer["settings"] != default["settings"]
    with pytest.raises(InputError):
        shapes.case_inputs("horus-2b", {"wing_widht_m": 3.9}, (0.8,), {})
    moved = shapes.shifted(default, (0.5, 0.75))
    before, after = default["settings"]["mesh"].pop("offset"), moved["settings"]["mesh"].pop("offset")
    assert after == [pytest.approx((before[0] + 0.5) % 1), pytest.approx((before[1] + 0.75) % 1)] and moved == default
    with pytest.raises(InputError, match="field of the study"):
        shapes.case_inputs("horus-2b", {}, (0.8,), {"mach": [2.0]})


def failing(inputs):
    return fake.evaluate(inputs | {"verdict": "failed"})


def breaks_when_wide(inputs):
    if inputs["shape"].get("wing_width_m", 0.0) > 3.5:
        raise InputError("too wide")
    return fake.evaluate(inputs)


def never(inputs):
    raise InputError("no flow")
