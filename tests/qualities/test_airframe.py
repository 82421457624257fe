"""Criteria on the airframe: closed forms of trim gradients, roll response and steady sideslip, and what they become."""

import math
from dataclasses import replace

import numpy as np
import pytest

from dynamics import horus
from spaceplane.dynamics.flightpoint import flight_point
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.environment.constants import STANDARD_GRAVITY
from spaceplane.errors import InputError
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.assess_airframe import assess_airframe
from spaceplane.qualities.gradients import load_gradient, speed_gradient
from spaceplane.qualities.roll_control import roll_response
from spaceplane.qualities.steady_sideslip import solve
from spaceplane.qualities.verdict import BELOW

CONTROLS = {
    "Cm_elevator": -0.10,
    "CL_elevator": 0.20,
    "CD_elevator": 0.02,
    "Cl_aileron": 0.05,
    "Cn_aileron": -0.004,
    "CY_aileron": 0.01,
    "Cn_rudder": -0.03,
    "Cl_rudder": 0.006,
    "CY_rudder": 0.05,
}
STABLE = {"Cm_alpha": -0.1, "Cn_beta": 0.08, "Cl_beta": -0.06, "CY_beta": -0.9, "Cm_M": 0.0, "CL_M": 0.0, "CD_M": 0.0}


def level_point(**changes):
    return horus.point(**{"gamma_deg": 0.0, "bank_deg": 0.0, **changes})


def airframe(point=None, fields=None, **changes):
    derivatives = horus.derivatives(**{**STABLE, **CONTROLS, **changes})
    return Airframe(point or level_point(), horus.MASS, horus.REFERENCE, derivatives, **(fields or {}))


def of(verdicts, paragraph, quantity=""):
    found = [v for v in verdicts if v.paragraph == paragraph and quantity in v.quantity]
    found = [v for v in found if v.quantity == quantity] or found
    assert len(found) == 1, [(v.paragraph, v.quantity) for v in verdicts]
    return found[0]


def arguments(a):
    return a.point, a.mass, a.reference, a.derivatives


def test_elevator_over_speed_in_closed_form():
    """Level, no lift by the elevator, no Mach effects: d alpha = -2 C_L g/(g - V^2/R) dV / (V C_L_alpha)."""
    a = airframe(CL_elevator=0.0)
    V, g = a.point.velocity, a.point.gravity
    CL = a.mass.mass * (g - V**2 / a.point.radius) / (a.point.dynamic_pressure * a.reference.area)
    a = replace(a, point=level_point(CL=CL))
    found = speed_gradient(*arguments(a))
    alpha = -2 * CL / (V * a.derivatives.CL_alpha) * g / (g - V**2 / a.point.radius)
    assert found.alpha == pytest.approx(alpha, rel=1e-12)
    assert found.elevator == pytest.approx(0.1 / -0.10 * alpha, rel=1e-12)  # C_m_alpha = C_m_elevator
    verdict = of(assess_airframe(a), "3.2.1.1")
    assert verdict.met and verdict.value == pytest.approx(math.degrees(-alpha), rel=1e-12)
    assert not of(assess_airframe(airframe(Cm_alpha=0.05)), "3.2.1.1").met


def test_path_slope_is_that_of_the_glide():
    """tan(gamma) = -C_D / C_L at every speed: the slope against a central difference of the trimmed glide itself."""
    point = flight_point(0.4, 500.0, 8.0, -11.0, 0.0, CL=0.0, CD=0.0)
    mass = replace(horus.MASS, mass=26_000.0)
    d = horus.derivatives(**{**STABLE, **CONTROLS, "CL_elevator": 0.0, "CD_elevator": 0.0})
    force = point.dynamic_pressure * horus.REFERENCE.area
    earth = point.velocity**2 / point.radius
    weight = mass.mass * point.gravity

    def glide(V):
        """Path angle by fixed point iteration: lift from the weight, drag linear in alpha, drag from the path."""
        scale = force * (V / point.velocity) ** 2
        gamma = point.gamma
        for _ in range(200):
            CL = (weight - mass.mass * V**2 / point.radius) * math.cos(gamma) / scale
            gamma = -math.asin(scale * (CD0 + d.CD_alpha / d.CL_alpha * (CL - CL0)) / weight)
        return gamma

    CL0 = (weight - mass.mass * earth) * math.cos(point.gamma) / force
    CD0 = -weight * math.sin(point.gamma) / force
    h = 0.05
    slope = (glide(point.velocity + h) - glide(point.velocity - h)) / (2 * h)
    a = Airframe(point.with_coefficients(CL0, CD0), mass, horus.REFERENCE, d)
    assert speed_gradient(*arguments(a)).gamma == pytest.approx(slope, rel=1e-6)
    verdict = of(assess_airframe(a, category="C"), "3.2.1.3", "path angle per airspeed")
    assert verdict.value == pytest.approx(math.degrees(slope) * 1852 / 3600, rel=1e-6)
    assert verdict.applicable and verdict.level is not None
    elsewhere = of(assess_airframe(a, category="B"), "3.2.1.3", "path angle per airspeed")
    assert not elsewhere.applicable and elsewhere.level is None


def test_path_slope_grows_towards_lower_speed_as_that_of_the_glide():
    """A glide with a parabolic polar: its slope 5 knots slower less that at the point, by differences of the glide."""
    point = flight_point(0.25, 500.0, 8.0, -11.0, 0.0, CL=0.0, CD=0.0)
    mass, knot = replace(horus.MASS, mass=26_000.0), 1852 / 3600
    force = point.dynamic_pressure * horus.REFERENCE.area
    weight = mass.mass * point.gravity

    def lift(V, gamma):
        return (weight - mass.mass * V**2 / point.radius) * math.cos(gamma)

    CL0, CD0 = lift(point.velocity, point.gamma) / force, -weight * math.sin(point.gamma) / force
    d = horus.derivatives(**{**STABLE, **CONTROLS, "CL_elevator": 0.0, "CD_elevator": 0.0, "CD_alpha": 0.25 * CD0 * 2})
    k = d.CD_alpha / (2 * CL0 * d.CL_alpha)

    def glide(V):
        scale, gamma = force * (V / point.velocity) ** 2, point.gamma
        for _ in range(400):
            CL = lift(V, gamma) / scale
            gamma = -math.asin(scale * (CD0 + k * (CL**2 - CL0**2)) / weight)
        return gamma

    def slope(V, h=0.05):
        return (glide(V + h) - glide(V - h)) / (2 * h)

    a = Airframe(point.with_coefficients(CL0, CD0), mass, horus.REFERENCE, d)
    exact = math.degrees(slope(point.velocity - 5 * knot) - slope(point.velocity)) * knot
    found = of(assess_airframe(a, category="C"), "3.2.1.3", "growth")
    assert found.value == pytest.approx(exact, rel=1e-4) and exact > 0
    assert found.met and found.margin == pytest.approx(0.05 - exact, rel=1e-4)
    elsewhere = of(assess_airframe(a, category="B"), "3.2.1.3", "growth")
    assert not elsewhere.applicable and elsewhere.value is None and elsewhere.met is None
    steeper = replace(a, derivatives=replace(d, CD_alpha=2 * d.CD_alpha))
    assert of(assess_airframe(steeper, category="C"), "3.2.1.3", "growth").value > found.value


def test_a_slow_vehicle_on_the_back_of_its_polar_fails():
    """Near the stall a step of 5 knots is a large share of the speed: the slope grows by more than 0.05 deg/knot."""
    point = flight_point(0.07, 0.0, 12.0, -12.0, 0.0, CL=0.0, CD=0.0)
    light = replace(horus.MASS, mass=1_000.0)
    force, weight = point.dynamic_pressure * horus.REFERENCE.area, light.mass * point.gravity
    point = point.with_coefficients(weight * math.cos(point.gamma) / force, weight * math.sin(-point.gamma) / force)
    d = horus.derivatives(**{**STABLE, **CONTROLS, "CD_alpha": 0.4})
    found = of(assess_airframe(Airframe(point, light, horus.REFERENCE, d), category="C"), "3.2.1.3", "growth")
    assert found.applicable and not found.met and found.margin < 0


def test_elevator_per_g_and_the_load_factors_it_reaches():
    a = airframe(CL_elevator=0.0, Cm_q=-0.5)
    V, g = a.point.velocity, a.point.gravity
    slope = a.mass.mass * STANDARD_GRAVITY / (a.point.dynamic_pressure * 110.0) / a.derivatives.CL_alpha
    elevator = (-0.1 * slope - 0.5 * g * 23.0 / (2 * V**2)) / 0.10
    found = load_gradient(*arguments(a))
    assert (found.alpha, found.elevator) == pytest.approx((slope, elevator), rel=1e-12)
    assert of(assess_airframe(a), "3.2.2.2").met
    free = of(assess_airframe(a), "3.2.3.2")
    here = a.point.dynamic_pressure * 110.0 * 0.36 / (26_000 * STANDARD_GRAVITY)
    reach = here + math.radians(40) / abs(elevator)
    assert not free.applicable and free.value == pytest.approx(reach)
    for factors, level in (((-0.2, reach - 0.1), 1), ((-9.0, reach - 0.1), 3), ((-9.0, reach + 0.1), 3)):
        found = of(assess_airframe(replace(a, load_factors=factors)), "3.2.3.2")
        assert found.level == level and (found.margin >= 0) == (level == 1)
    stiff = of(assess_airframe(replace(airframe(Cm_alpha=-2.0, Cm_q=-0.5), load_factors=(-0.2, 2.5))), "3.2.3.2")
    assert stiff.level == BELOW and stiff.value < 2.0 and stiff.limits["3"] == "0.5 to 2"


def test_trim_elevator_and_its_limit():
    """C_m 0.02 at zero elevator takes +11.5 deg at -0.10 per rad; 0.08 takes 45.8 deg, beyond 40."""
    inside = of(assess_airframe(airframe(fields={"pitching_moment": 0.02})), "3.2.3.1")
    assert inside.met and inside.value == pytest.approx(math.degrees(0.2))
    outside = of(assess_airframe(airframe(fields={"pitching_moment": 0.08})), "3.2.3.1")
    assert not outside.met and outside.margin == pytest.approx(40 - math.degrees(0.8))
    assert not of(assess_airframe(airframe()), "3.2.3.1").applicable


def pure_roll(tau=0.5, power=10.0):
    """p' = -p/tau + power a, sigma' = p; yaw and sideslip at rest."""
    A, B = np.zeros((4, 4)), np.zeros((4, 1))
    A[0, 0], A[3, 0], B[0, 0] = -1 / tau, 1.0, power
    return StateSpace(A, B, ("p", "r", "beta", "sigma"), ("aileron",), "rigid-body")


def test_time_to_bank_of_pure_roll():
    """phi = a L tau (t - tau (1 - exp(-t/tau)))."""
    response = roll_response(pure_roll(), 0.2)
    t = response.time
    exact = 0.2 * 10 * 0.5 * (t - 0.5 * (1 - np.exp(-t / 0.5)))
    assert np.allclose(response.bank, exact, rtol=1e-10, atol=1e-14)
    time = response.time_to_bank(math.radians(30))
    assert 1.0 * (time - 0.5 * (1 - math.exp(-time / 0.5))) == pytest.approx(math.radians(30), rel=1e-3)
    assert response.oscillation() == 1.0
    assert np.allclose(roll_response(pure_roll(power=-10.0), 0.2).bank, exact)  # the sense that rolls to the right


def test_roll_rate_minimum_of_a_known_oscillation():
    """p = exp(-s t) sin(w t) / w: its first minimum is -exp(-s pi / w) times its first peak."""
    s, w = 0.2, 2.0
    A, B = np.zeros((4, 4)), np.zeros((4, 1))
    A[0, 0], A[0, 1], A[1, 0], B[0, 0] = -2 * s, -(s**2 + w**2), 1.0, 1.0
    response = roll_response(StateSpace(A, B, ("p", "r", "beta", "sigma"), ("aileron",)), 1.0)
    assert response.oscillation() == pytest.approx(-math.exp(-s * math.pi / w), rel=2e-3)
    assert response.half_period == pytest.approx(math.pi / w)


@pytest.mark.parametrize(("aileron", "level"), [(0.2, 1), (0.003, 2), (0.0014, 3), (0.0004, BELOW)])
def test_roll_power_sets_the_level(aileron, level):
    """Class III, category B, speed range M: 30 deg in 2.0, 3.3, 5.0 s."""
    quiet = {"Cl_beta": -1e-6, "Cn_aileron": 0.0, "CY_aileron": 0.0, "Cl_p": -0.3}
    point = level_point(alpha_deg=0.0)
    found = of(assess_airframe(airframe(point, Cl_aileron=aileron, **quiet)), "3.3.4")
    force = point.dynamic_pressure * 110.0 * 13.0 / 119_000.0
    tau = 1 / (force * 0.3 * 13.0 / (2 * point.velocity))
    steady = force * aileron * math.radians(40) * tau
    banked = steady * (found.value - tau * (1 - math.exp(-found.value / tau)))
    assert banked == pytest.approx(math.radians(30), rel=0.01)
    assert found.level == level
    assert found.quantity == "time to bank by 30 deg" and "speed range M" in found.note


def test_speed_range_and_class_change_the_requirement():
    a = airframe()
    assert of(assess_airframe(a), "3.3.4").limits["1"] == "<= 2"
    assert of(assess_airframe(replace(a, speed_range="L")), "3.3.4").limits["1"] == "<= 2.3"
    assert "60 deg" in of(assess_airframe(a, "I"), "3.3.4").quantity
    for category, speed, quantity, level_1 in (
        ("A", "M", "90 deg", "<= 1.3"),
        ("A", "H", "50 deg", "<= 1.1"),
        ("A", "L", "30 deg", "<= 1.1"),
        ("B", "VL", "90 deg", "<= 2"),
        ("B", "L", "90 deg", "<= 1.7"),
        ("C", "VL", "30 deg", "<= 1.1"),
    ):
        found = of(assess_airframe(replace(a, speed_range=speed), "IV", category), "3.3.4")
        assert found.quantity == f"time to bank by {quantity}" and found.limits["1"] == level_1
        assert found.applicable and f"speed range {speed}" in found.note
    assert of(assess_airframe(replace(a, speed_range="VL")), "3.3.4").limits["1"] == "<= 2.3"  # class III has no VL
    adverse = [of(assess_airframe(a, name), "3.3.2.4", "adverse") for name in ("III", "IV")]
    assert all(v.applicable for v in adverse) and adverse[0].value != adverse[1].value  # k by the class's own table


def test_sideslip_per_k_is_free_of_the_size_of_the_step():
    """Half the aileron power rolls half as far and slips half as far: the same value, another time to bank."""
    full = airframe()
    half = replace(full, control_limits={"elevon_left": (-0.35, 0.35), "elevon_right": (-0.35, 0.35)})
    for side in ("adverse", "proverse"):
        pair = [of(assess_airframe(a), "3.3.2.4", side).value for a in (full, half)]
        assert pair[0] == pytest.approx(pair[1], rel=1e-9)
    assert of(assess_airframe(half), "3.3.4").value > of(assess_airframe(full), "3.3.4").value


def test_sideslip_of_small_inputs_is_shown_but_not_judged():
    """Its figure is in no public copy; the greatest change of sideslip is that to both sides together."""
    found = assess_airframe(airframe())
    shown = of(found, "3.3.2.4.1")
    sides = [of(found, "3.3.2.4", side).value for side in ("adverse", "proverse")]
    assert shown.value == pytest.approx(sum(sides), rel=1e-9) and shown.value > 0
    assert not shown.applicable and shown.level is None and "not judged" in shown.note and "ψ_beta" in shown.note


def test_adverse_yaw_gives_adverse_sideslip():
    adverse, proverse = (
        [of(assess_airframe(airframe(level_point(alpha_deg=0.0), Cn_aileron=c)), "3.3.2.4", side).value for side in
         ("adverse", "proverse")]
        for c in (-0.02, 0.02)
    )  # fmt: skip
    assert adverse[0] > 10 * adverse[1] and proverse[1] > 10 * proverse[0]


def test_steady_sideslip_is_steady():
    """The linear model at rest in p, r with these controls has no rolling, yawing or sideways acceleration."""
    a = airframe()
    aileron, rudder, bank = solve(a)
    system = linearise(a.point, a.mass, a.reference, a.derivatives)
    state, controls = np.zeros(9), np.zeros(len(system.inputs))
    state[system.index("beta")], state[system.index("sigma")] = 1.0, bank
    controls[system.inputs.index("aileron")], controls[system.inputs.index("rudder")] = aileron, rudder
    rates = system.A @ state + system.B @ controls
    for name in ("p", "r", "beta"):
        row = system.index(name)
        terms = np.abs(system.A[row] * state).sum()
        assert abs(rates[row]) < 1e-12 * terms


def test_aileron_that_dihedral_takes():
    """Share of the aileron at 10 deg of sideslip, from the linear model at rest: p' = r' = 0 with the two controls."""
    a = airframe(fields={"elevator": math.radians(-10)})
    system = linearise(a.point, a.mass, a.reference, a.derivatives)
    rows = [system.index("p"), system.index("r")]
    columns = [system.inputs.index("aileron"), system.inputs.index("rudder")]
    held = np.linalg.solve(system.B[np.ix_(rows, columns)], -system.A[rows, system.index("beta")] * math.radians(10))
    found = of(assess_airframe(a), "3.3.6.3.2")
    assert found.value == pytest.approx(100 * abs(held[0]) / (math.radians(40) - math.radians(10)), rel=1e-9)
    assert found.met == (found.value <= 75) and found.margin == pytest.approx(75 - found.value)
    assert found.limits == {"1": "<= 75", "2": "<= 75", "3": "not specified"} and found.level is None


def test_what_moves_the_aileron_that_dihedral_takes():
    def share(**changes):
        return of(assess_airframe(airframe(**changes)), "3.3.6.3.2")

    plain, half = share(), {"elevon_left": (-0.3, 0.3), "elevon_right": (-0.3, 0.3)}
    assert share(Cl_beta=-0.3).value > plain.value and not share(Cl_beta=-0.3).met and plain.met
    assert share(Cl_aileron=0.1).value < plain.value
    assert share(fields={"control_limits": half}).value == pytest.approx(plain.value * math.radians(40) / 0.3)
    alone = share(Cn_rudder=0.0, Cl_rudder=0.0)
    assert alone.value == pytest.approx(100 * 0.06 / 0.05 * 10 / 40) and "C_l_beta alone" in alone.note
    assert not share(Cl_beta=0.06).applicable and "not positive" in share(Cl_beta=0.06).note
    assert not share(Cl_aileron=0.0).applicable and not share(fields={"elevator": math.radians(40)}).applicable


def test_senses_in_steady_sideslip():
    verdicts = assess_airframe(airframe())
    assert [of(verdicts, p).met for p in ("3.3.6.1", "3.3.6.2", "3.3.6.3")] == [True, True, True]
    verdicts = assess_airframe(airframe(Cn_beta=-0.05, Cl_beta=0.08, CY_beta=0.5))
    assert [of(verdicts, p).met for p in ("3.3.6.1", "3.3.6.2", "3.3.6.3")] == [False, False, False]


def test_without_controls_signs_decide_and_the_rest_does_not_apply():
    bare = Airframe(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives())
    verdicts = assess_airframe(bare)
    assert [of(verdicts, p).met for p in ("3.3.6.1", "3.3.6.2", "3.3.6.3")] == [False, True, True]
    for paragraph in ("3.2.1.1", "3.2.2.2", "3.2.3.1", "3.2.3.2", "3.3.2.2", "3.3.4", "3.3.6.3.2"):
        assert not of(verdicts, paragraph).applicable
    assert all(v.note.startswith("not applicable") for v in verdicts if not v.applicable)


@pytest.mark.parametrize(
    ("fields", "match"),
    [
        ({"speed_range": "X"}, "speed_range"),
        ({"load_factors": (1.5, 2.0)}, "load_factors"),
        ({"elevator": math.nan}, "elevator"),
        ({"control_limits": {"flap": (0.0, 1.0)}}, "control surface"),
        ({"control_limits": {"elevon_left": (1.0, 0.0)}}, "elevon_left"),
    ],
)
def test_bad_input(fields, match):
    with pytest.raises(InputError, match=match):
        airframe(fields=fields)
