"""Gliding flight along given altitudes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spaceplane.dynamics.equations import flight_model, state_rates
from spaceplane.dynamics.flightpoint import taem_point, trajectory_altitude
from spaceplane.dynamics.glide import (
    glide_alpha,
    glide_bank,
    glide_lift_coefficient,
    glide_path_angle,
    tabulated_slope,
)
from spaceplane.environment.atmosphere import us1976
from spaceplane.errors import InputError

from . import horus

FLOWN = 26_000.0, 110.0


def rates(point):
    """dV/dt, dgamma/dt and dR/dt at a flight point."""
    model = flight_model(point, horus.MASS, horus.REFERENCE, horus.derivatives())
    return state_rates(model.reference_state(), np.zeros(3), model)[:3]


def test_the_lift_of_equilibrium_glide():
    """The thesis's own point glides in equilibrium: CL 0.36 at 25 km, bank 55 deg."""
    point = taem_point(2.5)
    assert glide_lift_coefficient(point, *FLOWN) == pytest.approx(0.36, rel=0.03)
    alpha = glide_alpha(point, *FLOWN, lambda a: -0.04 + 1.6 * a)
    assert -0.04 + 1.6 * alpha == pytest.approx(glide_lift_coefficient(point, *FLOWN), rel=1e-9)
    steady = point.with_coefficients(glide_lift_coefficient(point, *FLOWN), 0.2)
    assert rates(steady)[1] == pytest.approx(0.0, abs=1e-6)
    with pytest.raises(InputError, match="equilibrium glide"):
        glide_alpha(point, *FLOWN, lambda a: 0.01 * a)


@pytest.mark.parametrize("mach", [1.5, 2.5, 5.0, 10.0, 20.0])
def test_the_glide_holds_its_path_and_follows_the_altitudes(mach):
    """By the equations of motion: no curvature of the path, and height over speed as asked."""
    mass, area = horus.MASS.mass, horus.REFERENCE.area
    point = taem_point(mach).with_coefficients(0.8, 0.4)
    point = replace(point, gamma=glide_path_angle(point, mass, area, tabulated_slope(mach)))
    point = replace(point, bank=glide_bank(point, mass, area))
    slower, curved, sinking = rates(point)
    assert 0.0 < point.bank < 0.5 * math.pi
    assert slower < 0.0 and sinking < 0.0
    assert sinking / slower == pytest.approx(tabulated_slope(mach), rel=1e-9)
    assert curved == pytest.approx(0.0, abs=1e-12)


def test_more_drag_descends_more_steeply_and_less_lift_banks_less():
    def angles(CL, CD):
        point = taem_point(2.5).with_coefficients(CL, CD)
        return glide_path_angle(point, *FLOWN, 20.0), glide_bank(point, *FLOWN)

    assert angles(0.4, 0.3)[0] < angles(0.4, 0.2)[0] < 0.0
    assert angles(0.35, 0.2)[1] < angles(0.4, 0.2)[1]
    assert angles(0.1, 0.2)[1] == 0.0  # all lift upwards is too little


def test_faster_than_an_orbit_lift_points_down():
    fast = replace(taem_point(25.0), mach=35.0).with_coefficients(0.8, 0.4)
    assert fast.velocity**2 / fast.radius > fast.gravity
    assert glide_bank(fast, *FLOWN) > 0.5 * math.pi


def test_level_flight_and_altitudes_that_no_glide_follows():
    point = taem_point(2.5).with_coefficients(0.4, 0.2)
    assert glide_path_angle(point, *FLOWN, 0.0) == 0.0
    with pytest.raises(InputError, match="no glide follows altitudes"):
        glide_path_angle(point, *FLOWN, -60.0)


def test_the_slope_is_that_of_the_table():
    """Between Mach 5 and 7.5 the table is one straight line over the Mach number."""
    low, high = 5.5, 7.0
    slopes = [tabulated_slope(m) for m in np.linspace(low, high, 31)]
    speeds = [m * us1976(trajectory_altitude(m)).speed_of_sound for m in (low, high)]
    mean = (trajectory_altitude(high) - trajectory_altitude(low)) / (speeds[1] - speeds[0])
    assert np.mean(slopes) == pytest.approx(mean, rel=0.01)
    assert tabulated_slope(0.8) > 0.0 and tabulated_slope(25.0) > 0.0
    with pytest.raises(InputError, match=r"mach = 0\.5"):
        tabulated_slope(0.5)
