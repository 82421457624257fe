"""The exact cone solution against printed tables and against limits of the theory."""

import math

import pytest

from spaceplane.aero.exact.conical import center_of_pressure, taylor_maccoll
from spaceplane.errors import InputError

# Mach, half angle deg, shock angle deg, surface Cp: independent tabulation for gamma 1.4.
TABLE = [
    (1.5, 10, 42.666, 0.12382),
    (1.5, 20, 49.029, 0.38700),
    (1.5, 30, 64.767, 0.83809),
    (3, 10, 21.715, 0.08748),
    (3, 20, 29.615, 0.28427),
    (3, 30, 39.784, 0.57504),
    (10, 10, 12.297, 0.06670),
    (10, 20, 22.745, 0.24894),
    (10, 30, 33.796, 0.52868),
]


@pytest.mark.parametrize(("mach", "angle_deg", "shock_deg", "cp"), TABLE)
def test_every_printed_digit_of_the_table(mach, angle_deg, shock_deg, cp):
    flow = taylor_maccoll(mach, math.radians(angle_deg))
    assert math.degrees(flow.shock_angle) == pytest.approx(shock_deg, abs=6e-4)
    assert flow.surface_cp == pytest.approx(cp, abs=6e-6)


def test_thin_cone_tends_to_slender_body_theory():
    """Cp = theta^2 (2 ln(2 / (theta sqrt(M^2 - 1))) - 1) as the cone gets thin (Liepmann and Roshko 9.45)."""
    theta, mach = math.radians(1.0), 2.0
    slender = theta**2 * (2.0 * math.log(2.0 / (theta * math.sqrt(mach**2 - 1.0))) - 1.0)
    assert taylor_maccoll(mach, theta).surface_cp == pytest.approx(slender, rel=0.02)


def test_total_enthalpy_and_entropy_order():
    """The flow slows down through the shock and on to the wall, and a stronger shock lies at a larger angle."""
    narrow, wide = taylor_maccoll(3.0, math.radians(10.0)), taylor_maccoll(3.0, math.radians(30.0))
    assert 1.0 < wide.surface_mach < narrow.surface_mach < 3.0
    assert math.asin(1.0 / 3.0) < narrow.shock_angle < wide.shock_angle


def test_detached_shock_is_refused_with_the_limit():
    with pytest.raises(InputError, match=r"half_angle_deg = 45.*between 0 and"):
        taylor_maccoll(1.5, math.radians(45.0))
    with pytest.raises(InputError, match=r"mach = 0\.8"):
        taylor_maccoll(0.8, math.radians(10.0))


def test_a_slender_cone_s_centre_of_pressure_is_that_of_its_plan():
    assert center_of_pressure(0.0) == pytest.approx(2.0 / 3.0)
