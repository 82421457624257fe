"""Steady sideslip, thrust to one side and a stuck surface of the Boeing 747, against equations solved by hand.

Etkin and Reid, Dynamics of Flight, 3rd ed. (1996): derivatives of Tables 6.6 and 7.3, Mach 0.8 at 40 000 ft. The
book's aileron rolls to the left when positive, ours to the right; its rudder is positive with the trailing edge to the
left, as ours. The elevons of our model stand for ailerons and elevator together, its outboard rudders for the one
rudder: the left one alone gives a positive rudder, the right one a negative one.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from spaceplane.aero.model.derivatives import from_mapping
from spaceplane.aero.model.from_derivatives import linear_model
from spaceplane.dynamics.flightpoint import flight_point
from spaceplane.dynamics.trim.allocation import allocate
from spaceplane.dynamics.trim.lateral import balanced, trim_lateral
from spaceplane.errors import InputError
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

CY = {"beta": -0.8771, "aileron": 0.0, "rudder": 0.1146}
CL_ROLL = {"beta": -0.2797, "aileron": 0.01368, "rudder": 0.006976}
CN = {"beta": 0.1946, "aileron": 0.0001973, "rudder": -0.1257}
LIFT, DRAG = 0.654, 0.043
MASS = MassProperties(288_763.0, 0.247e8, 0.449e8, 0.673e8)
REFERENCE = ReferenceLengths(511.0, 8.324, 59.64, (0.0, 0.0, 0.0))
POINT = flight_point(0.8, 12_192.0, 0.0, 0.0, 0.0, LIFT, DRAG, 18_913.7, 216.384)
# By hand: determinant of (aileron, rudder) in (C_l, C_n), then Cramer's rule with -(C_l_beta, C_n_beta) beta.
DETERMINANT = 0.01368 * -0.1257 - 0.006976 * 0.0001973
AILERON_PER_BETA = (0.2797 * -0.1257 + 0.1946 * 0.006976) / DETERMINANT
RUDDER_PER_BETA = (0.01368 * -0.1946 - 0.0001973 * 0.2797) / DETERMINANT


def weighing(beta=0.0, rudder=0.0):
    """The mass that lift and side force just carry, so that the path is straight as the hand's equations have it."""
    side = CY["beta"] * beta + CY["rudder"] * rudder
    force = POINT.dynamic_pressure * REFERENCE.area * math.hypot(LIFT, side)
    return replace(MASS, mass=force / POINT.gravity)


def boeing(**changes):
    """The model, linear about its flight point."""
    derivatives = {
        "CD_alpha": 0.4347, "CL_alpha": 4.92, "Cm_alpha": -1.023, "CD_M": 0.0, "CL_M": 0.0, "Cm_M": 0.0,
        "CY_beta": CY["beta"], "Cl_beta": CL_ROLL["beta"], "Cn_beta": CN["beta"], "CL_q": 5.92, "Cm_q": -23.92,
        "Cl_p": -0.3295, "Cn_p": -0.04073, "Cl_r": 0.304, "Cn_r": -0.2737,
        "CL_elevator": 0.3648, "Cm_elevator": -1.444,
        "CY_aileron": CY["aileron"], "Cl_aileron": CL_ROLL["aileron"], "Cn_aileron": CN["aileron"],
        "CY_rudder": CY["rudder"], "Cl_rudder": CL_ROLL["rudder"], "Cn_rudder": CN["rudder"],
    } | changes  # fmt: skip
    return linear_model("Boeing 747", from_mapping(derivatives), REFERENCE, 0.8, 0.0, LIFT, DRAG)


def combined(deflections):
    """(aileron, elevator, rudder), rad, of the surfaces."""
    left, right = deflections["elevon_left"], deflections["elevon_right"]
    return (left - right) / 2, (left + right) / 2, (deflections["rudder_left"] - deflections["rudder_right"]) / 2


def test_numbers_solved_by_hand():
    """19.6 deg of aileron and 1.58 deg of rudder for a degree of sideslip: the aileron is weak at Mach 0.8."""
    assert pytest.approx((19.64, 1.579), rel=1e-3) == (AILERON_PER_BETA, RUDDER_PER_BETA)


@pytest.mark.parametrize("beta_deg", [0.5, -0.8])
def test_steady_sideslip(beta_deg):
    beta = math.radians(beta_deg)
    mass = weighing(beta, RUDDER_PER_BETA * beta)
    found = trim_lateral(boeing(), POINT, mass, beta, straight=True)
    aileron, elevator, rudder = combined(found.allocation.deflections)
    assert found.found
    assert aileron / beta == pytest.approx(AILERON_PER_BETA, rel=1e-7)
    assert rudder / beta == pytest.approx(RUDDER_PER_BETA, rel=1e-7)
    side = CY["beta"] * beta + CY["rudder"] * rudder
    assert math.tan(found.bank) == pytest.approx(-side / found.allocation.coefficients["CL"], rel=1e-9)
    assert math.degrees(found.bank) == pytest.approx(1.063 * beta_deg, rel=2e-3)  # right wing down into the wind
    assert elevator == pytest.approx(0.0, abs=1e-8)
    assert (found.rates.p, found.rates.q, found.rates.r) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    assert max(map(abs, balanced(found, POINT, mass, REFERENCE).values())) < 1e-11


def test_sideslip_is_limited_by_the_aileron():
    """Elevons of 40 deg at most: a little over 2 deg of sideslip, and a reason beyond."""
    limits = boeing().limits("elevon_left")
    greatest = min(-limits[0], limits[1]) / AILERON_PER_BETA
    assert trim_lateral(boeing(), POINT, MASS, 0.98 * greatest, straight=True).found
    beyond = trim_lateral(boeing(), POINT, MASS, 1.05 * greatest, straight=True)
    assert not beyond.found and "needs C" in beyond.reason and "elevon" in beyond.reason


THRUST = 0.004
"""C_n of thrust to one side, nose right: the left engines pull alone."""


def test_thrust_to_one_side_without_sideslip():
    """Rudder against it, a little aileron against the rudder's rolling moment, and a bank against its side force."""
    needed = -THRUST * CL_ROLL["aileron"] / DETERMINANT
    mass = weighing(rudder=needed)
    found = trim_lateral(boeing(), POINT, mass, 0.0, straight=True, external={"Cn": THRUST})
    aileron, _, rudder = combined(found.allocation.deflections)
    assert found.found
    assert rudder == pytest.approx(needed, rel=1e-7)
    assert aileron == pytest.approx(THRUST * CL_ROLL["rudder"] / DETERMINANT, rel=1e-7)
    assert rudder > 0.0 > aileron  # trailing edge left; against the roll to the right
    assert math.degrees(found.bank) == pytest.approx(-math.degrees(math.atan(CY["rudder"] * rudder / LIFT)), rel=1e-7)
    assert max(map(abs, balanced(found, POINT, mass, REFERENCE).values())) < 1e-11
    other = trim_lateral(boeing(), POINT, mass, 0.0, straight=True, external={"Cn": -THRUST})
    assert combined(other.allocation.deflections)[2] == pytest.approx(-rudder, rel=1e-9)
    assert other.bank == pytest.approx(-found.bank, rel=1e-6)


def test_thrust_to_one_side_with_the_wings_level():
    """Sideslip, aileron and rudder from three equations: C_Y = C_l = 0, C_n = -C_n of the thrust."""
    rows = np.array([[c["beta"], c["aileron"], c["rudder"]] for c in (CY, CL_ROLL, CN)])
    exact = np.linalg.solve(rows, [0.0, 0.0, -THRUST])
    wanted = {"CY": 0.0, "Cl": 0.0, "Cm": 0.0, "Cn": -THRUST}
    found = allocate(boeing(), 0.8, 0.0, wanted, beta=None)
    aileron, _, rudder = combined(found.deflections)
    assert found.found
    assert (found.beta, aileron, rudder) == pytest.approx(tuple(exact), rel=1e-6)
    whole = trim_lateral(boeing(), POINT, weighing(), None, external={"Cn": THRUST})
    assert (whole.beta, whole.bank) == (pytest.approx(exact[0], rel=1e-7), 0.0)


def test_a_rudder_that_is_stuck():
    """Two outboard rudders: the right one makes up for the left one, stuck at 4 deg, as long as that is outboard."""
    stuck = math.radians(4.0)
    beta = math.radians(0.5)
    mass = weighing(beta, RUDDER_PER_BETA * beta)
    found = trim_lateral(boeing(), POINT, mass, beta, straight=True, held={"rudder_left": stuck})
    aileron, _, rudder = combined(found.allocation.deflections)
    assert found.found and found.allocation.deflections["rudder_left"] == stuck
    assert rudder == pytest.approx(RUDDER_PER_BETA * beta, rel=1e-7)
    assert found.allocation.deflections["rudder_right"] == pytest.approx(stuck - 2 * RUDDER_PER_BETA * beta, rel=1e-7)
    assert aileron == pytest.approx(AILERON_PER_BETA * beta, rel=1e-7)
    steeper = trim_lateral(boeing(), POINT, MASS, math.radians(1.5), straight=True, held={"rudder_left": stuck})
    assert not steeper.found and "needs C" in steeper.reason


def test_an_elevon_that_is_stuck_is_paid_with_sideslip():
    """The other one must balance pitch, so both roll, and only sideslip holds that: a 3 x 3 by hand.

    With the other elevon opposite, the aileron is the stuck deflection; sideslip and rudder follow.
    """
    stuck = math.radians(6.0)
    rows = np.array([[CL_ROLL["beta"], CL_ROLL["rudder"]], [CN["beta"], CN["rudder"]]])
    beta, rudder = np.linalg.solve(rows, [-CL_ROLL["aileron"] * stuck, -CN["aileron"] * stuck])
    assert math.degrees(beta) == pytest.approx(6.0 / AILERON_PER_BETA, rel=1e-9)
    found = allocate(boeing(), 0.8, 0.0, beta=None, held={"elevon_left": stuck})
    assert found.found
    assert found.deflections["elevon_right"] == pytest.approx(-stuck, rel=1e-9)
    assert (found.beta, combined(found.deflections)[2]) == pytest.approx((beta, rudder), rel=1e-6)
    without = trim_lateral(boeing(), POINT, MASS, 0.0, straight=True, held={"elevon_left": stuck})
    assert not without.found and "needs C" in without.reason


@pytest.mark.parametrize(
    ("external", "match"), [({"Cn": math.nan}, "external Cn"), ({"CN": 0.1}, "Cn"), ({"CY": 0.1}, "moment")]
)
def test_external_moments_that_are_none(external, match):
    with pytest.raises(InputError, match=match):
        trim_lateral(boeing(), POINT, MASS, external=external)
