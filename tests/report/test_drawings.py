"""Scales, ticks and the places of marks."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree

import pytest

from spaceplane.report import plots
from spaceplane.report.svg import Frame, Scale, linear_ticks

from .example_result import convergence, flight_point


def test_symlog_scale_is_odd_and_rises():
    scale = Scale(-10.0, 10.0, 1e-3)
    places = [scale(x) for x in (-10, -1, -1e-3, 0, 1e-3, 1, 10)]
    assert places == sorted(places)
    assert scale(0.0) == pytest.approx(0.5)
    assert scale(0.7) + scale(-0.7) == pytest.approx(1.0)


def test_symlog_ticks_are_zero_and_decades():
    assert Scale(-1.0, 0.1, 1e-2).ticks() == pytest.approx([-1.0, -0.1, -0.01, 0.0, 0.01, 0.1])


@pytest.mark.parametrize(("low", "high"), [(0, 1), (-3.7, 12.1), (1e-5, 3e-5), (-0.2, -0.1), (0, 117)])
def test_linear_ticks_are_round_and_inside(low, high):
    ticks = linear_ticks(low, high)
    assert 2 <= len(ticks) <= 7
    assert all(low - 1e-9 <= t <= high + 1e-9 for t in ticks)
    step = ticks[1] - ticks[0]
    lead = step / 10.0 ** math.floor(math.log10(step) + 1e-9)
    assert min(abs(lead - f) for f in (1, 2, 2.5, 5, 10)) < 1e-6


def test_both_planes_mark_every_eigenvalue_and_its_conjugate():
    modes = flight_point("Mach 0.8", 0.8, 13000, 9.0)["modes"]
    eigenvalues = sum(2 if m["eigenvalue"][1] else 1 for m in modes)
    root = ElementTree.fromstring(f"<div>{plots.eigenvalue_planes(modes)}</div>")
    spots = [e for e in root.iter() if e.get("class") == "spot"]
    assert len(spots) == 2 * eigenvalues


def test_a_badge_never_covers_another():
    frame = Frame(0, 0, 500, 400, Scale(-1, 1), Scale(-1, 1))
    points = [(250.0 + 0.3 * k, 200.0) for k in range(9)]
    spots = plots._badge_spots(points, frame)
    apart = [math.dist(a, b) for i, a in enumerate(spots) for b in spots[:i]]
    assert min(apart) >= 18.0


def test_convergence_plot_is_valid_xml_and_stands_missing_histories():
    full = ElementTree.fromstring(plots.convergence_plot(convergence("base", 2.5, 16.6, 0.0)))
    curves = [e for e in full.iter() if (e.get("class") or "").startswith("curve")]
    assert len(curves) == 4
    ElementTree.fromstring(plots.convergence_plot({"label": "base"}))


def test_bars_share_their_zero_and_scale():
    root = ElementTree.fromstring(plots.derivative_bars([("a", 2.0), ("b", -1.0), ("c", None)]))
    positive, negative = (e for e in root.iter() if (e.get("class") or "").startswith("bar"))
    assert float(positive.get("width")) == pytest.approx(2 * float(negative.get("width")), rel=0.01)
    assert float(negative.get("x")) + float(negative.get("width")) == pytest.approx(float(positive.get("x")), abs=0.2)
    assert plots.derivative_bars([("a", None)]) == ""


def test_all_flight_points_share_one_plane():
    points = [flight_point(f"Mach {m}", m, 13000, 9.0) for m in (0.8, 1.5, 2.5)]
    root = ElementTree.fromstring(plots.eigenvalues_together(points))
    marks = [e for e in root.iter() if "mode-marker" in (e.get("class") or "")]
    assert len(marks) == sum(len(p["modes"]) for p in points)
    assert plots.eigenvalues_together(points[:1]) == ""  # nothing to compare
