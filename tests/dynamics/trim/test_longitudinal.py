"""Trim in pitch: closed forms on a linear model, every root, limits, reasons, and the published HORUS-2B tables."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.aero.model import linear

from spaceplane.aero.model.model import SurfaceTable
from spaceplane.aero.model.published import horus_2b_published
from spaceplane.dynamics.trim.longitudinal import (
    HORUS_2B_BODY_FLAP,
    schedule_at,
    trim_alpha,
    trim_elevator,
)
from spaceplane.dynamics.trim.margins import center_shift, static_margin
from spaceplane.errors import InputError

MACH, ALPHA = 2.2, math.radians(13.0)
TAEM = (2.5, math.radians(16.6))
FLAP_UP = math.radians(-20.0)


def expected_elevator(flap=0.0, moment=0.0, alpha=ALPHA, mach=MACH):
    rest = linear.static("Cm", alpha, mach) + linear.FLAP["Cm"] * flap + moment
    return -rest / (2 * linear.ELEVON["Cm"])


@pytest.mark.parametrize("flap", [-0.2, 0.0, 0.3])
@pytest.mark.parametrize("moment", [0.0, 0.01])
def test_elevator_of_a_linear_model(flap, moment):
    found = trim_elevator(linear.model(), MACH, ALPHA, flap, moment)
    assert len(found.trims) == 1 and found.reason == ""
    trim = found.best
    assert trim.elevator == pytest.approx(expected_elevator(flap, moment), abs=1e-14)
    lift = linear.static("CL", ALPHA, MACH) + 0.4 * trim.elevator + 0.11 * flap
    drag = linear.static("CD", ALPHA, MACH) + 0.06 * trim.elevator + 0.04 * flap
    assert trim.lift_to_drag == pytest.approx(lift / drag, rel=1e-13)
    assert trim.margin == pytest.approx(math.radians(40.0) - abs(trim.elevator))


def test_every_input_moves_the_elevator_the_right_way():
    model = linear.model()
    start = trim_elevator(model, MACH, ALPHA).best.elevator
    assert trim_elevator(model, MACH, ALPHA, moment=0.01).best.elevator > start  # nose-up moment: trailing edges down
    assert trim_elevator(model, MACH, ALPHA, body_flap=-0.2).best.elevator > start  # flap up lifts the nose
    assert trim_elevator(model, MACH, ALPHA + 0.05).best.elevator > start  # Cm_alpha > 0 here
    assert trim_elevator(model, MACH + 0.1, ALPHA).best.elevator > start  # Cm_M > 0 here
    aft = model.moved((13.5, 0.0, 0.0))
    assert trim_elevator(aft, MACH, ALPHA).best.elevator > start  # lift ahead of the centre lifts the nose
    high = model.moved((13.0, 0.0, 0.5))
    drag_above_lift = trim_elevator(high, MACH, math.radians(1.0)).best.elevator
    assert drag_above_lift < trim_elevator(model, MACH, math.radians(1.0)).best.elevator  # axial force below the centre


def test_the_reason_names_what_is_needed_and_the_limit():
    strong = linear.model(Cm=(-0.2, 0.0, 0.0))
    found = trim_elevator(strong, MACH, ALPHA)
    needed = math.degrees(-0.2 / 0.18)
    assert not found.trims and found.best is None
    assert found.reason == f"needs elevator {needed:.4g} deg, limit -40 deg"
    assert found.needed == pytest.approx(-0.2 / 0.18)
    assert "limit 40 deg" in trim_elevator(linear.model(Cm=(0.2, 0.0, 0.0)), MACH, ALPHA).reason


def test_narrower_limits_are_kept():
    needed = expected_elevator(moment=0.03)
    assert math.degrees(needed) > 7.0
    narrow = {"elevon_left": (-0.1, 0.1)}
    found = trim_elevator(linear.model(), MACH, ALPHA, moment=0.03, limits=narrow)
    assert found.reason == f"needs elevator {math.degrees(needed):.4g} deg, limit {math.degrees(0.1):g} deg"
    with pytest.raises(InputError, match="limits of elevon_left: -60 to 0 deg, must lie in order within -40 to 40 deg"):
        trim_elevator(linear.model(), MACH, ALPHA, limits={"elevon_left": (math.radians(-60.0), 0.0)})
    with pytest.raises(InputError, match="body_flap = -25 deg: allowed -20 to 30 deg"):
        trim_elevator(linear.model(), MACH, ALPHA, body_flap=math.radians(-25.0))
    with pytest.raises(InputError, match="no table of elevon_left and elevon_right"):
        trim_elevator(replace(linear.model(), surfaces={}), MACH, ALPHA)


@pytest.mark.parametrize(("mach", "alpha"), [(3.2, ALPHA), (MACH, math.radians(31.0))])
def test_outside_the_tables_is_a_reason(mach, alpha):
    found = trim_elevator(linear.model(), mach, alpha)
    assert not found.trims and found.reason.startswith("outside the tables: ")


def bent():
    """Elevons whose moment turns round: both trailing edges far up lose their power again."""
    model = linear.model(Cm=(-0.02, 0.0, 0.0))
    axis = np.radians([-40.0, -20.0, 0.0, 40.0])
    tables = {"Cm": np.array([0.0, 0.02, 0.0, -0.03])[:, None, None] * np.ones((4, 4, 3))}
    pair = {name: SurfaceTable(axis, tables) for name in ("elevon_left", "elevon_right")}
    return replace(model, surfaces=pair)


def test_all_branches_are_reported():
    found = trim_elevator(bent(), MACH, ALPHA)
    assert [math.degrees(trim.elevator) for trim in found.trims] == pytest.approx([-10.0, -30.0])
    assert [math.degrees(trim.margin) for trim in found.trims] == pytest.approx([30.0, 10.0])
    for trim in found.trims:
        both = {"elevon_left": trim.elevator, "elevon_right": trim.elevator}
        assert bent().coefficients(MACH, ALPHA, deflections=both)["Cm"] == pytest.approx(0.0, abs=1e-15)
    beyond = trim_elevator(bent(), MACH, ALPHA, moment=-0.03)
    assert beyond.reason == "Cm runs from -0.11 to -0.01 between elevator -40 and 40 deg"


def test_alpha_for_given_deflections():
    model = linear.model(Cm=(0.05, -0.2, 0.0))
    found = trim_alpha(model, MACH, elevator=0.05, body_flap=0.1)
    expected = (0.05 - 0.18 * 0.05 - 0.05 * 0.1) / 0.2
    assert [trim.alpha for trim in found.trims] == pytest.approx([expected], abs=1e-14)
    assert found.best.stable
    assert trim_alpha(model, MACH, elevator=0.1).best.alpha < trim_alpha(model, MACH, elevator=0.05).best.alpha
    none = trim_alpha(model, MACH, elevator=-0.6)
    assert none.reason.startswith("Cm runs from") and none.reason.endswith("between alpha 0 and 30 deg")
    assert trim_alpha(model, 5.0).reason.startswith("outside the tables: mach = 5")
    with pytest.raises(InputError, match="elevon_left = 45 deg: allowed -40 to 40 deg"):
        trim_alpha(model, MACH, elevator=math.radians(45.0))


def test_every_angle_of_attack_is_found():
    model, elevator, flap = horus_2b_published(), math.radians(-5.0), math.radians(20.0)
    found = trim_alpha(model, 10.0, elevator, flap)
    assert [trim.stable for trim in found.trims] == [False, True]
    both = {"elevon_left": elevator, "elevon_right": elevator, "body_flap": flap}
    for trim in found.trims:
        assert model.coefficients(10.0, trim.alpha, deflections=both)["Cm"] == pytest.approx(0.0, abs=1e-15)
    alphas = np.radians(np.linspace(0.0, 45.0, 700))
    moments = np.array([model.coefficients(10.0, a, deflections=both)["Cm"] for a in alphas])
    assert np.count_nonzero(np.diff(np.sign(moments))) == len(found.trims)


def test_widest_margin_is_the_best_of_all_flaps():
    model = horus_2b_published()
    for mach, alpha_deg in ((1.5, 20.0), (2.5, 5.0), (3.0, 25.0), (10.0, 5.0), (17.0, 33.0)):
        alpha = math.radians(alpha_deg)
        chosen = trim_elevator(model, mach, alpha, None).best
        flaps = np.radians(np.linspace(-20.0, 30.0, 101))
        tried = [trim_elevator(model, mach, alpha, flap).best for flap in flaps]
        best = max(trim.margin for trim in tried if trim)
        assert chosen.margin >= best - 1e-12
        assert math.radians(-20.0) - 1e-12 <= chosen.body_flap <= math.radians(30.0) + 1e-12


def test_no_flap_trims_without_lift_at_hypersonic_speed():
    found = trim_elevator(horus_2b_published(), 10.0, 0.0, None)
    assert found.reason == "needs elevator -42.4 deg, limit -40 deg"


def test_schedule_of_the_body_flap():
    assert schedule_at(HORUS_2B_BODY_FLAP, 2.5) == pytest.approx(FLAP_UP)
    assert schedule_at(HORUS_2B_BODY_FLAP, 0.8) == pytest.approx(FLAP_UP)
    assert schedule_at(HORUS_2B_BODY_FLAP, 3.0) is None
    assert schedule_at({2.0: 0.0, 4.0: 0.2}, 3.0) == pytest.approx(0.1)


def test_horus_at_the_taem_interface():
    """By hand from the tables: Cm0, flap and the elevons' -10 deg column at 16.6 deg, means of Mach 2 and 3."""
    share = 1.6 / 5.0
    at = lambda at15, at20: at15 + share * (at20 - at15)  # noqa: E731
    clean = at(0.5 * (-0.014 + 0.0), 0.5 * (-0.013 + 0.003))
    flap = at(0.5 * (0.006 + 0.0039), 0.5 * (0.0061 + 0.0049))
    pair = 2 * at(0.5 * (0.0024 + 0.0017), 0.5 * (0.0029 + 0.0022))
    trim = trim_elevator(horus_2b_published(), *TAEM, FLAP_UP).best
    assert math.degrees(trim.elevator) == pytest.approx(10.0 * (clean + flap) / pair, abs=1e-9)
    assert -3.5 < math.degrees(trim.elevator) < -2.5
    assert trim.static.margin < 0.0 and not trim.stable  # Table 6.1: Cm_alpha > 0


@pytest.mark.parametrize("elevator_deg", [-12.5, -17.5])
def test_shift_of_the_centre_makes_given_elevons_trim(elevator_deg):
    model, elevator = horus_2b_published(), math.radians(elevator_deg)
    mach, alpha = 3.0, math.radians(15.0)  # a node, where moved tables are exact
    deflections = {"elevon_left": elevator, "elevon_right": elevator, "body_flap": FLAP_UP}
    shift = center_shift(model, mach, alpha, deflections)
    for center in ((13.0 + shift.aft, 0.0, 0.0), (13.0, 0.0, shift.up)):
        moved = model.moved(center)
        assert moved.coefficients(mach, alpha, deflections=deflections)["Cm"] == pytest.approx(0.0, abs=1e-15)
        trims = trim_elevator(moved, mach, alpha, FLAP_UP).trims
        assert min(abs(trim.elevator - elevator) for trim in trims) < 1e-9
    assert shift.aft < 0.0 < shift.up  # nose-up elevons: the lift must act further behind the centre


def test_shift_is_by_hand_arm_over_force():
    shift = center_shift(linear.model(), MACH, ALPHA, {})
    CL, CD, Cm = (linear.static(name, ALPHA, MACH) for name in ("CL", "CD", "Cm"))
    CN = CL * math.cos(ALPHA) + CD * math.sin(ALPHA)
    assert shift.aft == pytest.approx(-23.0 * Cm / CN) and pytest.approx(CN) == shift.CN
    assert shift.up == pytest.approx(23.0 * Cm / (CD * math.cos(ALPHA) - CL * math.sin(ALPHA)))


def test_moment_slope_vanishes_about_the_neutral_point():
    model, step = linear.model(), 1e-6
    found = static_margin(model, MACH, ALPHA)
    arm = (found.neutral_point - 13.0) / 23.0

    def about_neutral_point(alpha):
        c = model.coefficients(MACH, alpha)
        return c["Cm"] + arm * (c["CL"] * math.cos(alpha) + c["CD"] * math.sin(alpha))

    slope = (about_neutral_point(ALPHA + step) - about_neutral_point(ALPHA - step)) / (2 * step)
    assert slope == pytest.approx(0.0, abs=1e-9)
    assert found.margin == pytest.approx(arm) and (found.margin > 0) == (found.Cm_alpha < 0)
    stable = static_margin(linear.model(Cm=(0.0, -0.3, 0.0)), MACH, ALPHA)
    assert stable.margin > 0.0 and stable.neutral_point > 13.0


@pytest.mark.parametrize(("elevator_deg", "forward"), [(-12.5, 0.230), (-17.5, 0.357)])
def test_centre_that_the_literatures_elevons_need(elevator_deg, forward):
    """The numbers of docs/trim.md."""
    elevator = math.radians(elevator_deg)
    deflections = {"elevon_left": elevator, "elevon_right": elevator, "body_flap": FLAP_UP}
    assert center_shift(horus_2b_published(), *TAEM, deflections).aft == pytest.approx(-forward, abs=5e-4)
