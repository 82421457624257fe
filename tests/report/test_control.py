"""Control in the report, the descent's tables and on the terminal."""

from __future__ import annotations

import io
import json

import pytest
from rich.console import Console

from spaceplane.report import write_report
from spaceplane.report.control_figures import motions, roots
from spaceplane.report.control_plots import response_plot
from spaceplane.report.control_summary import print_control
from spaceplane.report.control_tables import (
    asked,
    held_text,
    range_text,
    supplied,
    supplied_text,
    within_text,
    worst_text,
)
from spaceplane.report.flight_control import control

from .example_result import control_of, example_result, verdict, write_example
from .test_page import Page


def text_of(folder) -> str:
    return " ".join(Page(write_report(folder).read_text(encoding="utf-8")).text.split())


def test_every_flight_point_says_what_its_controls_can_do(out_dir):
    html = write_report(out_dir).read_text(encoding="utf-8")
    text = " ".join(Page(html).text.split())
    assert 'href="#control"' in html and html.count("What the feedback asks") == 3
    assert "The feedback uses elevator, aileron, rudder." in text
    for piece in (
        "offset of 1 deg in sideslip",
        "gust of 9 m/s from below",
        "Levels with the feedback",
        "elevons, deg",
    ):
        assert piece in text
    assert "Unknown and zero" not in text  # every damping derivative is given
    assert html.count('class="curve open"') == 3 * sum(len(one["states"]) for one in control_of()["responses"])


def test_a_result_without_control_is_still_read(tmp_path):
    points = example_result()["flight_points"]
    for point, record in zip(points, (None, "none at all", control_of() | {"reason": "so"}), strict=True):
        point["control"] = record
        if record == "none at all":
            del point["control"]
    bare = {key: value for key, value in control_of().items() if key != "responses"}
    points[2]["control"] = bare | {"reason": "elevator: cannot reach the spiral"}
    text = text_of(write_example(tmp_path, flight_points=points))
    assert "Mach 0.8: no linear model, or a result of an earlier version." in text
    assert "Mach 1.5: no linear model" in text and "No feedback: elevator: cannot reach the spiral." in text


def test_what_is_unknown_is_said_not_shown_as_zero():
    record = control_of() | {"unknown": ["Cm_q"], "thrusters": {"moment_z": "no yawing moment of the rudder is known"}}
    shown = control({"control": record, "verdicts": []})
    assert shown["unknown"] == "Unknown and zero in the model: the damping Cm_q."
    assert "thrusters stand in about yaw (no yawing moment of the rudder is known)" in shown["inputs"]


def effort(name, least, greatest, margin, rate):
    limits = {"low": -40.0, "high": 40.0, "rate_limit": 20.0, "margin": margin, "within": margin >= 0}
    return {"name": name, "unit": "deg", "least": least, "greatest": greatest, "rate": rate, "jump": 0.0, **limits}


def test_peaks_are_those_of_the_worst_surface_and_disturbance():
    first = {"efforts": [effort("elevon_left", -3.0, 2.0, 37.0, 4.0), effort("elevon_right", -5.0, 1.0, 35.0, 2.0)]}
    second = {"efforts": [effort("elevon_left", -1.0, 41.0, -1.0, 9.0)]}
    second["efforts"].append(
        {"name": "moment_z", "unit": "N m", "least": -500.0, "greatest": 20.0, "rate": 1.0, "jump": 0.0}
    )
    elevons, yaw = asked([first | {"thrusters_Nm": {}}, second | {"thrusters_Nm": {}}])
    assert (elevons.name, elevons.least, elevons.greatest, elevons.margin, elevons.rate) == ("elevons", -5, 41, -1, 9)
    rudder = effort("rudder_left", 0.0, 12.0, 0.0, 1.0) | {"low": 0.0}
    assert asked([{"efforts": [rudder]}])[0].margin == 28.0  # it stands at its inboard stop
    assert (range_text(elevons), range_text(asked([{"efforts": [rudder | {"greatest": 0.01}]}])[0])) == (
        "−5.0 to 41.0",
        "0.0",
    )
    assert yaw.thruster and (yaw.name, yaw.least, yaw.margin) == ("yaw thruster", -0.5, None)


def test_words_for_limits_and_saturation():
    events = [
        {"thrusters_Nm": {"moment_y": 2500.0}, "lost": False},
        {"thrusters_Nm": {"moment_y": 900.0}, "lost": True},
    ]
    assert supplied(events) == {"pitch thruster": 2.5}
    assert supplied_text({"disturbances": events}) == "pitch 2.5 kN m; lost"
    assert supplied_text({"disturbances": [{"thrusters_Nm": {}, "lost": False}]}) == "none"
    assert [within_text({"within": value}) for value in (True, False, None)] == ["yes", "no", "–"]
    held = {"held_deg": {"alpha": [-12.34, None], "beta": [-400.0, 95.0]}}
    assert [held_text(held, axis) for axis in ("alpha", "beta", "psi")] == ["−12.3 to any", "any", "–"]
    levels = [
        verdict("a", "roll mode", "x", "3.3.1.2", 1.0, 2, {}),
        verdict("b", "spiral", "x", "3.3.1.3", 1.0, "below 3", {}),
    ]
    assert worst_text(levels) == "below 3 (spiral)" and worst_text([]) == "–"
    both = [*levels, verdict("c", "phugoid", "x", "3.2.1.2", 1.0, "below 3", {})]
    assert worst_text(both) == "below 3 (spiral, phugoid)"


def test_drawings_show_both_loops():
    record = control_of()["responses"]
    svg = response_plot(record[1])
    assert svg.count('class="curve open"') == len(record[1]["states"])
    assert "aileron (orange: rudder), deg from trim" in svg
    assert motions(record)[:4] == b"\x89PNG"
    assert roots([("Mach 2.5", [1.0 + 0j, 0.1 + 1j], [-1.0 + 0j, -0.1 + 1j])])[:4] == b"\x89PNG"


@pytest.mark.parametrize("reason", ["", "elevator: cannot reach the spiral"])
def test_the_terminal_says_it_in_lines(reason):
    console = Console(file=io.StringIO(), width=160)
    print_control(control_of() | {"reason": reason}, [], console)
    text = console.file.getvalue()
    assert "The feedback uses elevator, aileron, rudder." in text
    assert ("no feedback: elevator" in text) == bool(reason)
    assert ("gust of 9 m/s from the right" in text) != bool(reason)
    json.dumps(control_of(), allow_nan=False)
