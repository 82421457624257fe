"""The terminal summary and the flat tables."""

from __future__ import annotations

import csv
import io
import math

import numpy as np
import pytest
from rich.console import Console

from spaceplane.report.summary import print_flow, print_summary, shortcomings
from spaceplane.report.tables import write_csv, write_netcdf

from .example_result import convergence, example_result


def printed(function, *arguments, width: int = 120) -> str:
    stream = io.StringIO()
    function(*arguments, console=Console(file=stream, width=width, color_system=None))
    return stream.getvalue()


def test_summary_shows_the_findings(tmp_path):
    text = printed(print_summary, example_result(), tmp_path / "report.html")
    assert "1.405 ± 0.018" in text
    assert "0.3600 ± 0.0004" in text  # C_L
    assert "aperiodic pitch divergence" in text
    assert "below 3" in text
    assert "all 18 flow conditions converged" in text
    assert str(tmp_path / "report.html") in text.replace("\n", "")


@pytest.mark.parametrize("width", [80, 200])
def test_no_line_is_wider_than_the_terminal(width):
    assert max(map(len, printed(print_summary, example_result(), width=width).splitlines())) <= width


def test_unconverged_conditions_are_never_called_good():
    result = example_result()
    assert shortcomings(result) == []
    result["flight_points"][2]["convergence"][5] = convergence("beta", 2.5, 16.6, 2.0, "failed")
    assert shortcomings(result) == ["Mach 2.5, condition beta: failed"]
    text = printed(print_summary, result)
    assert "1 of 18 flow conditions NOT converged" in text
    assert "all 18" not in text


def test_a_flight_point_without_modes_is_not_good():
    result = example_result()
    result["flight_points"][0]["modes"] = []
    assert shortcomings(result) == ["Mach 0.8: no modes"]
    assert shortcomings(result | {"flight_points": []}) == ["no flight point"]


def test_an_accuracy_that_was_not_met_is_not_good():
    asked = {"target": 0.05, "reached": 0.062, "met": False}
    result = example_result() | {"accuracy": asked}
    assert shortcomings(result) == ["accuracy: 5 % asked, 6.2 % reached"]
    assert "accuracy: 5 % NOT met: C_L, C_D and C_m within 6.2 % of the force" in printed(print_summary, result)
    met = example_result() | {"accuracy": asked | {"reached": 0.049, "met": True}}
    assert shortcomings(met) == []
    assert "accuracy: 5 % met" in printed(print_summary, met)


def test_flow_table():
    record = {
        "mach": 2.0,
        "alpha_deg": 5.0,
        "beta_deg": 0.0,
        "CL": 0.123456,
        "CD": None,
        "converged": False,
        "verdict": "failed",
    }
    text = printed(print_flow, [record])
    assert "0.12346" in text and "failed" in text and "–" in text


@pytest.mark.parametrize("width", [40, 80, 120, 160])
def test_flow_table_cuts_nothing_on_any_terminal(width):
    names = ("CL", "CD", "CY", "Cl", "Cm", "Cn", "CA", "CN")
    values = {name: -1.02034 - 0.1 * n for n, name in enumerate(names)}
    record = {"mach": 12.5, "alpha_deg": -30.25, "beta_deg": -10.5, "converged": False, "verdict": "oscillating"}
    errors = dict.fromkeys(names, 0.00123)
    stated = {"coefficient_errors": errors, "coefficient_errors_by_source": {"mesh": errors}}
    text = printed(print_flow, [record | values | stated], width=width)
    assert "…" not in text and "oscillating" in text and text.count("±0.00123") == len(names)
    assert all(f"−{-value:.5f}" in text for value in values.values())


def test_csv_holds_every_number(tmp_path):
    result = example_result()
    paths = {p.name: list(csv.DictReader(p.open())) for p in write_csv(result, tmp_path)}
    point = result["flight_points"][2]
    row = next(r for r in paths["derivatives.csv"] if r["flight_point"] == "Mach 2.5" and r["derivative"] == "Cm_alpha")
    assert float(row["value"]) == point["derivatives"]["Cm_alpha"]["value"]
    assert float(row["error"]) == point["derivatives"]["Cm_alpha"]["error"]
    assert row["unit"] == "1/rad"
    totals = [r for r in paths["coefficients.csv"] if r["part"] == "total"]
    assert [float(r["CL"]) for r in totals] == [p["coefficients"]["CL"] for p in result["flight_points"]]
    assert [float(r["CL_error"]) for r in totals] == [p["coefficient_errors"]["CL"] for p in result["flight_points"]]
    assert next(r for r in paths["coefficients.csv"] if r["part"] == "nose")["CL_error"] == ""
    assert len(paths["modes.csv"]) == 18
    linear = {(r["of"], r["with"]): r for r in paths["linear_models.csv"] if r["flight_point"] == "Mach 2.5"}
    assert float(linear["alpha", "alpha"]["value"]) == point["A"][6][6] and linear["R", "V"]["unit"] == "(m)/s per m/s"
    missing = next(r for r in paths["verdicts.csv"] if r["mode"] == "short period")
    assert missing["level"] == "" and missing["value"] == ""


def test_netcdf_gives_the_same_numbers(tmp_path):
    import xarray as xr

    result = example_result()
    path, linear = write_netcdf(result, tmp_path)
    with xr.open_dataset(path) as data:
        record = result["flight_points"][1]["derivatives"]["Cm_alpha"]
        assert float(data.Cm_alpha.sel(flight_point="Mach 1.5", part="total")) == record["value"]
        assert float(data.Cm_alpha_error.sel(flight_point="Mach 1.5", part="total")) == record["error"]
        assert float(data.Cm_alpha.sel(flight_point="Mach 1.5", part="nose")) == record["by_part"]["nose"]
        assert data.Cm_alpha.attrs["units"] == "1/rad"
        error = result["flight_points"][1]["coefficient_errors"]["Cm"]
        assert float(data.Cm_error.sel(flight_point="Mach 1.5", part="total")) == error
        assert data.mach.values == pytest.approx([0.8, 1.5, 2.5])
    point = result["flight_points"][2]
    with xr.open_dataset(linear) as data:
        own = data.sel(flight_point=point["name"])
        assert np.array_equal(own["A"].sel(state=point["states"]), point["A"])
        assert np.array_equal(own["B"].sel(input=point["inputs"]), point["B"])
        assert float(own["reference_state"].sel(state="V")) == point["velocity_ms"]
        assert float(own["reference_state"].sel(state="alpha")) == pytest.approx(math.radians(point["alpha_deg"]))


def test_an_analysis_without_linear_models_has_no_file_of_them(tmp_path):
    result = example_result()
    for point in result["flight_points"]:
        point.update(A=None, B=None, states=[], inputs=[])
    assert "linear_models.csv" not in {path.name for path in write_csv(result, tmp_path)}
    assert len(write_netcdf(result, tmp_path)) == 1


def with_sources() -> dict:
    result = example_result()
    for p in result["flight_points"]:
        zero = dict.fromkeys(("CL", "CD", "CY", "Cl", "Cm", "Cn", "CA", "CN"), 0.0)
        p["coefficients_by_source"] = {
            "inviscid": zero | {"CD": 0.19, "CA": 0.08},
            "friction": zero | {"CD": 0.01, "CA": 0.01},
        }
    result["settings"]["increments"] = {"friction": "turbulent", "base": "inviscid", "transition_reynolds": 1e6}
    return result


def test_sources_of_coefficients_are_columns_of_the_total(tmp_path):
    paths = {path.name: path for path in write_csv(with_sources(), tmp_path)}
    with paths["coefficients.csv"].open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["CD_from_friction"] for row in rows if row["part"] == "total"] == ["0.01"] * 3
    assert {row["CD_from_friction"] for row in rows if row["part"] != "total"} == {""}
    write_csv(example_result(), tmp_path)
    assert "_from_" not in paths["coefficients.csv"].read_text(encoding="utf-8")


def test_sources_of_coefficients_stand_below_their_sum():
    from spaceplane.report.sections import increments_text, whole

    shown = [(str(row["symbol"]), row["what"]) for row in whole(with_sources())["coefficient_rows"]]
    drag = next(n for n, (_, what) in enumerate(shown) if what.startswith("drag"))
    assert [what for _, what in shown[drag + 1 : drag + 3]] == ["… of the inviscid flow", "… of skin friction"]
    assert shown[drag + 3][1].startswith("side force")  # zero by symmetry: no sources of it
    said = increments_text(with_sources())
    assert "turbulent skin friction (adiabatic wall, laminar below a Reynolds number of" in said
    assert increments_text(example_result()) == ""
    assert not any("of skin friction" in row["what"] for row in whole(example_result())["coefficient_rows"])
