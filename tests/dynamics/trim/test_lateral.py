"""Steady flight about all axes: rates against the equations of motion, moments balanced, signs, failures."""

import math

import numpy as np
import pytest
from tests.aero.model import linear
from tests.dynamics.horus import MASS, TILTED

from spaceplane.dynamics.equations import flight_model, state_rates
from spaceplane.dynamics.flightpoint import equilibrium_rates, flight_point
from spaceplane.dynamics.trim.lateral import balanced, gyroscopic_moments, steady_rates, trim_lateral
from spaceplane.errors import InputError

ALPHA = math.radians(13.0)


def point(bank_deg=0.0, gamma_deg=-8.4, mach=2.2):
    return flight_point(mach, 25_000.0, 13.0, gamma_deg, bank_deg, CL=0.4, CD=0.2)


@pytest.mark.parametrize("bank_deg", [-70.0, 0.0, 55.0])
def test_rates_without_side_force_are_those_of_the_linear_model(bank_deg):
    at = point(bank_deg)
    expected = equilibrium_rates(at, MASS.mass, linear.REFERENCE.area)
    found = steady_rates(at, MASS.mass, linear.REFERENCE.area, 0.4)
    for name in "pqr":
        assert getattr(found, name) == pytest.approx(getattr(expected, name), abs=1e-15)


@pytest.mark.parametrize("bank_deg", [-30.0, 10.0, 55.0])
@pytest.mark.parametrize("beta_deg", [-6.0, 0.0, 4.0])
def test_rates_hold_the_attitude_in_the_equations_of_motion(bank_deg, beta_deg):
    at, beta = point(bank_deg), math.radians(beta_deg)
    slopes = linear.model().derivatives(2.2, ALPHA)
    model = flight_model(at, MASS, linear.REFERENCE, slopes)
    state = model.reference_state()
    rates = (0.0, 0.0, 0.0)
    for _ in range(60):  # lift and side force change with the rates
        state[3:6] = rates
        state[7] = beta
        roll, yaw = (
            (x - s) * 13.0 / (2 * at.velocity) for x, s in ((rates[0], model.rates.p), (rates[2], model.rates.r))
        )
        CY = slopes.CY_beta * beta + slopes.CY_p * roll + slopes.CY_r * yaw
        CL = 0.4 + slopes.CL_q * (rates[1] - model.rates.q) * 23.0 / (2 * at.velocity)
        found = steady_rates(at, MASS.mass, linear.REFERENCE.area, CL, CY, beta)
        rates = (found.p, found.q, found.r)
    change = state_rates(state, np.zeros(len(model.inputs)), model)
    assert change[6:9] == pytest.approx([0.0, 0.0, 0.0], abs=1e-14)


@pytest.mark.parametrize("mass", [MASS, TILTED], ids=["symmetric", "Ixz"])
def test_gyroscopic_moments_hold_the_rates(mass):
    at = point(55.0)
    rates = steady_rates(at, mass.mass, 110.0, 0.4, -0.02, 0.05)
    needed = gyroscopic_moments(at, mass, linear.REFERENCE, rates)
    inertia = np.array([[mass.Ixx, 0.0, -mass.Ixz], [0.0, mass.Iyy, 0.0], [-mass.Ixz, 0.0, mass.Izz]])
    spin = np.array([rates.p, rates.q, rates.r])
    moment = np.cross(spin, inertia @ spin)
    scale = at.dynamic_pressure * 110.0 * np.array([13.0, 23.0, 13.0])
    assert [needed[name] for name in ("Cl", "Cm", "Cn")] == pytest.approx(moment / scale, rel=1e-12)


@pytest.mark.parametrize(
    "case",
    [
        {"bank_deg": 55.0},
        {"bank_deg": -55.0, "beta": math.radians(2.0)},
        {"bank_deg": 40.0, "beta": None},
        {"beta": math.radians(5.0), "straight": True},
        {"beta": math.radians(-3.0), "straight": True, "held": {"rudder_right": math.radians(8.0)}},
    ],
)
def test_moments_are_balanced_by_the_model_itself(case):
    case = dict(case)
    at, model = point(case.pop("bank_deg", 0.0)), linear.model()
    found = trim_lateral(model, at, MASS, **case)
    assert found.found
    lengths = np.array([13.0, 23.0, 13.0])
    reduced = np.array([found.rates.p, found.rates.q, found.rates.r]) * lengths / (2 * at.velocity)
    total = model.coefficients(2.2, ALPHA, found.beta, tuple(reduced), found.allocation.deflections)
    needed = gyroscopic_moments(at, MASS, linear.REFERENCE, found.rates)
    for name, value in needed.items():
        assert total[name] == pytest.approx(value, abs=1e-11), name
    assert max(map(abs, balanced(found, at, MASS, linear.REFERENCE).values())) < 1e-11
    again = steady_rates(at, MASS.mass, 110.0, total["CL"], total["CY"], found.beta, found.bank)
    assert (again.p, again.q, again.r) == pytest.approx((found.rates.p, found.rates.q, found.rates.r), abs=1e-11)
    if case.get("straight"):
        assert total["CL"] * math.sin(found.bank) + total["CY"] * math.cos(found.bank) == pytest.approx(0.0, abs=1e-10)
        assert found.bank != 0.0
    if case.get("beta", 0.0) is None:
        assert total["CY"] == pytest.approx(0.0, abs=1e-12) and found.beta != 0.0


def test_sideslip_from_the_right_is_flown_with_the_right_wing_down():
    right = trim_lateral(linear.model(), point(), MASS, math.radians(4.0), straight=True)
    left = trim_lateral(linear.model(), point(), MASS, math.radians(-4.0), straight=True)
    assert right.found and right.bank > math.radians(1.0)
    assert left.bank == pytest.approx(-right.bank, abs=1e-9)
    assert right.allocation.deflections["rudder_left"] == pytest.approx(left.allocation.deflections["rudder_right"])
    more = trim_lateral(linear.model(), point(), MASS, math.radians(5.0), straight=True)
    assert more.bank > right.bank


def test_mirrored_turns_take_mirrored_deflections():
    right, left = (trim_lateral(linear.model(), point(bank), MASS) for bank in (55.0, -55.0))
    for one, other in (("elevon_left", "elevon_right"), ("rudder_left", "rudder_right")):
        assert right.allocation.deflections[one] == pytest.approx(left.allocation.deflections[other], abs=1e-8)
    assert (left.rates.p, left.rates.q, left.rates.r) == pytest.approx(
        (-right.rates.p, right.rates.q, -right.rates.r), abs=1e-10
    )
    level = trim_lateral(linear.model(), point(0.0), MASS)
    assert (level.rates.p, level.rates.r) == pytest.approx((0.0, 0.0), abs=1e-15) and right.rates.r > 0.0


def test_a_failure_that_cannot_be_held_says_so():
    held = {"elevon_left": math.radians(30.0)}
    found = trim_lateral(linear.model(), point(), MASS, held=held)
    assert not found.found and "needs" in found.reason and "at the limit" in found.reason
    outside = trim_lateral(linear.model(), point(mach=3.5), MASS)
    assert outside.reason.startswith("outside the tables: mach = 3.5") and outside.allocation is None
    too_far = trim_lateral(linear.model(), point(), MASS, math.radians(12.0))
    assert too_far.reason.startswith("outside the tables: beta = 12 deg")
    with pytest.raises(InputError, match="beta = nan"):
        trim_lateral(linear.model(), point(), MASS, math.nan)
