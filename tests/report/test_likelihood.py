"""Probabilities, errors of eigenvalues and drivers in report, tables and on the terminal."""

import json

import pytest
from rich.console import Console

from spaceplane.report import likelihood
from spaceplane.report.page import render
from spaceplane.report.summary import print_modes, print_summary
from spaceplane.report.tables import verdict_rows

from .example_result import example_result, with_uncertainty
from .test_page import Page, words


@pytest.fixture(scope="module")
def uncertain() -> dict:
    result = json.loads(json.dumps(example_result()))
    result["flight_points"] = [with_uncertainty(p) for p in result["flight_points"]]
    return result


def test_the_page_shows_what_is_likely(uncertain):
    html = render(uncertain, None)
    text = words(html)
    assert Page(html).open == []
    assert "level 2 with 87 ± 2 %" in text
    assert "± 0.0060 ± 0.021i" in text
    assert "uncertain by Clβ 90 %, Cnβ 10 %" in text
    assert "taken as normal distributions" in text
    assert html.count('<div class="chances"') == 6  # two uncertain verdicts at each of three points


def test_without_errors_there_is_nothing_of_it():
    html = render(example_result(), None)
    assert '<div class="chances"' not in html and "taken as normal distributions" not in words(html)
    assert "Airframe, controls and departure" in words(html)
    older = example_result()
    for point in older["flight_points"]:
        del point["airframe_verdicts"]  # a result from before there were any
    assert "Airframe, controls and departure" not in words(render(older, None))


def test_bars_add_up_and_know_their_colours():
    found = likelihood.chances({"probabilities": {"2": 0.87, "1": 0.11, "not applicable": 0.02}})
    assert [c["css"] for c in found] == ["good", "fair", "none"]
    assert sum(float(c["width"]) for c in found) == pytest.approx(100.0)
    assert likelihood.chances({"probabilities": {"1": 1.0}}) == [] == likelihood.chances({})


@pytest.mark.parametrize(
    ("verdict", "text"),
    [
        ({"level": 2}, "level 2"),
        ({"level": None, "met": False}, "not met"),
        ({"level": None, "met": True}, "met"),
        ({"level": None, "met": None, "applicable": False}, "not applicable"),
    ],
)
def test_chips(verdict, text):
    assert likelihood.outcome_chip(verdict)["text"] == text


def test_terminal_and_tables(uncertain):
    console = Console(width=120, record=True, file=open("/dev/null", "w"))  # noqa: SIM115
    print_summary(uncertain, console=console)
    print_modes(uncertain["flight_points"][0], console=console)
    text = console.export_text()
    assert "level 2, 87 %" in text and "met, 80 %" in text
    rows = verdict_rows(uncertain)
    assert {"C_n_beta,dyn"} <= {row["criterion"] for row in rows}
    assert any(row["probability_text"] == "level 2 with 87 %" for row in rows)
