"""Flight points, the schedule of the descent, and the axes."""

import math

import numpy as np
import pytest

from spaceplane.dynamics import frames
from spaceplane.dynamics.flightpoint import (
    TAEM_MACH,
    scheduled_alpha_deg,
    taem_point,
    trajectory_altitude,
)
from spaceplane.errors import InputError


def test_the_points_of_the_descent():
    assert TAEM_MACH == (0.8, 1.5, 2.5)
    points = [taem_point(mach) for mach in TAEM_MACH]
    assert [p.altitude for p in points] == [13_000.0, 20_000.0, 25_000.0]
    assert math.degrees(points[2].alpha) == pytest.approx(16.6)
    assert "thesis" in points[2].alpha_source and "schedule" in points[0].alpha_source
    # the thesis prints the standard atmosphere of geopotential altitudes: 1.5 % less pressure at 25 km
    assert points[2].ambient.pressure == pytest.approx(2511.02, rel=0.016)


def test_schedule_rises_with_mach():
    machs = np.linspace(0.8, 25.0, 50)
    alphas = [scheduled_alpha_deg(m) for m in machs]
    assert np.all(np.diff(alphas) >= 0)
    assert trajectory_altitude(10.0) == 53_000.0
    assert taem_point(5.0, alpha_deg=10.0).alpha_source == "given"
    with pytest.raises(InputError, match="mach"):
        taem_point(0.3)
    assert taem_point(0.3, altitude_m=2_000.0, alpha_deg=8.0).mach == 0.3


def test_body_to_wind():
    """The velocity lies along wind x; lift along -z stays in the plane of symmetry."""
    alpha, beta = 0.3, -0.2
    velocity = np.array([math.cos(alpha) * math.cos(beta), math.sin(beta), math.sin(alpha) * math.cos(beta)])
    turn = frames.body_to_wind(alpha, beta)
    assert turn @ velocity == pytest.approx([1.0, 0.0, 0.0], abs=1e-15)
    assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-15)
    assert (turn.T @ np.array([0.0, 0.0, 1.0]))[1] == pytest.approx(0.0, abs=1e-15)


def test_bank_turns_lift_to_the_right():
    """Right wing down: lift (wind -z) gets a component along trajectory +y."""
    lift = frames.wind_to_trajectory(0.5) @ np.array([0.0, 0.0, -1.0])
    assert lift == pytest.approx([0.0, math.sin(0.5), -math.cos(0.5)])


def test_axial_and_normal_force():
    CD, CL = frames.axial_normal_to_drag_lift(0.1, 0.5, 0.3)
    assert frames.drag_lift_to_axial_normal(CD, CL, 0.3) == pytest.approx((0.1, 0.5))
    # the same through the wind axes: aft and up are -x and -z of the body
    force = frames.body_to_wind(0.3, 0.0) @ np.array([-0.1, 0.0, -0.5])
    assert (-force[0], -force[2]) == pytest.approx((CD, CL))


def test_geometry_to_body():
    assert frames.geometry_to_body([1.0, 2.0, 3.0]) == pytest.approx([-1.0, 2.0, -3.0])
