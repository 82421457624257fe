"""Two results side by side."""

import json

import fake
import pytest

from spaceplane.errors import InputError
from spaceplane.study import compare, compare_page, thesis


@pytest.fixture
def both():
    return fake.evaluate({}), fake.evaluate({"shape": {"wing_width_m": 3.9, "winglet_length_m": 4.0}})


def test_what_differs_is_found(both):
    comparison = compare.compare(*both)
    assert comparison["labels"] == ["fake (first)", "fake (second)"]
    assert {row["name"]: row["values"] for row in comparison["shape"]} == {
        "wing_width_m": [3.1, 3.9],
        "winglet_length_m": [3.2, 4.0],
    }
    for point, a, b in zip(
        comparison["flight_points"], both[0]["flight_points"], both[1]["flight_points"], strict=True
    ):
        assert [row["name"] for row in point["derivatives"]] == list(thesis.DERIVATIVES)
        for row in point["derivatives"]:
            one, two = a["derivatives"][row["name"]]["value"], b["derivatives"][row["name"]]["value"]
            assert row["values"] == [one, two] and row["difference"] == pytest.approx(two - one)
            assert row["resolved"] == (abs(two - one) > 0.01 * max(abs(one), abs(two)))


def test_a_result_against_itself_differs_in_nothing(both):
    comparison = compare.compare(both[0], both[0])
    assert comparison["shape"] == [] and comparison["warnings"] == []
    for point in comparison["flight_points"]:
        assert all(row["difference"] == 0 for row in point["derivatives"])
        assert all(row["difference"] == [0, 0] and row["similarity"] == pytest.approx(1) for row in point["modes"])
        assert all(row["change"] == "same" for row in point["levels"])


def test_modes_are_paired_whatever_their_order(both):
    one, two = both
    for point in two["flight_points"]:
        point["modes"].reverse()
    comparison = compare.compare(one, two)
    for row in comparison["flight_points"][0]["modes"]:
        assert row["modes"][0]["name"] == row["modes"][1]["name"]


def test_levels_say_which_way_they_went(both):
    one, two = both
    for point, level in zip(two["flight_points"], (2, "below 3", None), strict=True):
        point["verdicts"][0]["level"] = level
    changes = [point["levels"][0]["change"] for point in compare.compare(one, two)["flight_points"]]
    assert changes == ["better", "worse", "not comparable"]
    two["flight_points"][0]["verdicts"] = []
    (row,) = compare.compare(one, two)["flight_points"][0]["levels"]
    assert row["levels"] == [3, None] and row["notes"][1] == "no such mode"


def test_doubts_are_said(both):
    one, two = both
    two["flight_points"][0]["alpha_deg"] = 12.0
    two["flight_points"][1]["convergence"][0]["verdict"] = "failed"
    warnings = compare.compare(one, two)["warnings"]
    assert any("Mach 0.8" in line and "angles of attack" in line for line in warnings)
    assert any("Mach 1.5" in line and "failed" in line for line in warnings)


def test_nothing_in_common_is_an_input_error(both):
    other = fake.evaluate({"mach": [5.0]})
    with pytest.raises(InputError, match="no Mach number in common"):
        compare.compare(both[0], other)


def test_pages_hold_the_numbers(both, tmp_path):
    comparison = compare.compare(*both, labels=("default", "wide"))
    paths = compare_page.write(comparison, tmp_path / "new")
    assert json.loads(paths["json"].read_text()) == comparison
    text, markdown, page = compare_page.as_text(comparison), paths["md"].read_text(), paths["html"].read_text()
    lift = comparison["flight_points"][0]["derivatives"][1]
    shown = f"{lift['values'][1]:.3f}"
    for content in (text, markdown, page):
        assert shown in content and "Dutch roll" in content and "Mach 2.5: modes" in content
    assert page.startswith("<!doctype html>") and "http" not in page.replace("http://www.w3.org", "")
    assert "data:image/svg+xml" in page
    assert paths["png"].stat().st_size < 200_000


def test_unwritable_folder(both, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot be written"):
        compare_page.write(compare.compare(*both), tmp_path / "file")


def test_default_against_optimised_through_the_store(tmp_path, monkeypatch):
    monkeypatch.setattr(
        compare, "case_inputs", lambda vehicle, changes, mach, settings: {"shape": changes, "mach": list(mach)}
    )
    monkeypatch.setattr(compare, "with_one_wall_cell", lambda vehicle, changes, settings: settings)
    store = tmp_path / "s.sqlite"
    comparison = compare.default_against_optimised(store, evaluate=fake.evaluate)
    assert [point["mach"] for point in comparison["flight_points"]] == [0.8, 1.5, 2.5, 5.0, 10.0]
    assert len(comparison["shape"]) == 5
    point = comparison["flight_points"][3]
    lift = next(row for row in point["derivatives"] if row["name"] == "CL_alpha")
    assert lift["thesis"] == [None, pytest.approx(thesis.derivatives("optimised")[5.0]["CL_alpha"])]
    assert "thesis optimised" in compare_page.as_text(comparison)
    again = compare.default_against_optimised(store, evaluate=_never)
    assert again["flight_points"] == comparison["flight_points"]


def _never(inputs):
    raise AssertionError("was in the store")
