"""Normal-force slopes of cones: published values, limits and what is refused."""

from __future__ import annotations

import math

import pytest

from spaceplane.aero.exact.inclined_cone import normal_force_slope, shock_tilt
from spaceplane.errors import InputError

PUBLISHED = {
    (1.5, 10.0): 1.8282,
    (1.5, 20.0): 1.6057,
    (1.5, 30.0): 1.3821,
    (3.0, 10.0): 1.8203,
    (3.0, 20.0): 1.6860,
    (3.0, 30.0): 1.4497,
    (10.0, 10.0): 1.9217,
    (10.0, 20.0): 1.7782,
    (10.0, 30.0): 1.5124,
}
"""(Mach, half angle in deg) -> C_N_alpha per rad on the base area, gamma 1.4, as tabulated by Kopal (MIT Tech. Rep. 3,
1947) and Sims (NASA SP-3007, 1964)."""


@pytest.mark.parametrize(("flow", "slope"), PUBLISHED.items())
def test_published_slopes_to_four_digits(flow, slope):
    mach, half_angle_deg = flow
    assert normal_force_slope(mach, math.radians(half_angle_deg)) == pytest.approx(slope, abs=6e-5)


def test_slender_cones_have_the_slope_of_slender_body_theory():
    """Two, at any Mach number; the difference falls with the angle."""
    errors = [2.0 - normal_force_slope(2.0, math.radians(angle)) for angle in (4.0, 2.0, 1.0)]
    assert 0.0 < errors[2] < 0.01 and errors[2] < errors[1] < errors[0]


def test_the_slope_tends_to_that_of_impact_theory_where_the_shock_lies_on_the_cone():
    """Newton's is 2 cos^2 of the half angle; a layer of no thickness is that of gamma = 1."""
    angle = math.radians(20.0)
    newton = 2.0 * math.cos(angle) ** 2
    errors = [abs(normal_force_slope(50.0, angle, gamma) / newton - 1.0) for gamma in (1.4, 1.2, 1.05)]
    assert errors[2] < errors[1] < errors[0] and errors[2] < 0.003


def test_weak_shocks_turn_with_the_wind():
    """The Mach cone of a needle lies about the wind, whatever the needle's incidence."""
    short = [1.0 - shock_tilt(3.0, math.radians(angle)) for angle in (4.0, 2.0, 1.0)]
    assert 0.0 < short[2] < 0.01 and short[2] < short[1] < short[0]


def test_shocks_that_lie_on_the_cone_turn_with_it():
    """Where the layer has no thickness (gamma = 1) the shock is the cone."""
    tilts = [abs(shock_tilt(50.0, math.radians(10.0), gamma)) for gamma in (1.4, 1.2, 1.05)]
    assert tilts[2] < tilts[1] < tilts[0] and tilts[2] < 0.1


def test_detached_shocks_are_refused():
    with pytest.raises(InputError, match="half_angle_deg"):
        normal_force_slope(1.5, math.radians(50.0))
