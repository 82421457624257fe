"""The picture of the departure plane is written, and refuses what it cannot draw."""

import math

import pytest

from spaceplane.errors import InputError
from spaceplane.report.departure_plot import DeparturePoint, write_departure_plot


def test_it_draws_points_outside_the_usual_window(tmp_path):
    points = {"here": DeparturePoint(-0.06, 0.13, 0.02, 0.05), "far": DeparturePoint(1.2, -0.7)}
    path = write_departure_plot(points, tmp_path / "plane.svg")
    text = path.read_text(encoding="utf-8")
    assert text.startswith("<?xml") and text.count("<path") > 20
    assert write_departure_plot(points, tmp_path / "plane.png").stat().st_size > 5000


def test_bad_input(tmp_path):
    with pytest.raises(InputError, match="points"):
        write_departure_plot({}, tmp_path / "plane.svg")
    with pytest.raises(InputError, match="svg"):
        write_departure_plot({"a": DeparturePoint(0.0, 0.0)}, tmp_path / "plane.pdf")
    with pytest.raises(InputError, match="directional"):
        DeparturePoint(0.0, math.nan)
