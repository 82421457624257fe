"""Errors of forces and moments tied by the body's arms: whatever lengths the moments are made dimensionless with."""

import math

import numpy as np
import pytest
import xarray as xr

from spaceplane.aero.conditions import DerivativeSteps, plan
from spaceplane.aero.derivatives import differentiate
from spaceplane.aero.inclination.solve import local_inclination
from spaceplane.aero.uncertainty.arms import Arms, arms_of, floors
from spaceplane.aero.uncertainty.errors import of_coefficients, of_derivatives
from spaceplane.dynamics.flightpoint import flight_point
from spaceplane.validation.bodies import cone, sphere
from spaceplane.vehicle.properties import ReferenceLengths

ARMS = Arms(pitch=5.0, yaw=4.0, mean_pitch=2.0, along_chord=4.5, along_span=3.5)


def reference(length, center=0.0):
    return ReferenceLengths(math.pi / 4.0, length, length, (center, 0.0, 0.0))


def solved(body, lengths, conditions):
    return local_inclination(body, conditions, lengths)


def points(*machs):
    return plan([flight_point(mach, 10_000.0, 4.0) for mach in machs], DerivativeSteps(rate=0.0))


def test_arms_are_those_of_the_body_about_the_moment_center():
    conditions = points(5.0).conditions
    # on a sphere of radius 1 about its centre the mean of x squared is 1 / 3
    about = arms_of(solved(sphere(), ReferenceLengths(math.pi, 2.0, 4.0, (1.0, 0.0, 0.0)), conditions))
    assert about.pitch == pytest.approx(0.5, rel=0.01) and about.yaw == pytest.approx(0.25, rel=0.01)
    assert about.mean_pitch == pytest.approx(0.5 / math.sqrt(3.0), rel=0.01)
    # its nose for a moment centre: the mean of x squared is 4 / 3, and the farthest wall 2 away
    nose = arms_of(solved(sphere(), ReferenceLengths(math.pi, 2.0, 4.0, (0.0, 0.0, 0.0)), conditions))
    assert nose.pitch == pytest.approx(1.0, rel=0.01) and nose.yaw == pytest.approx(0.5, rel=0.01)
    assert nose.mean_pitch == pytest.approx(0.5 * math.sqrt(4.0 / 3.0), rel=0.01)
    assert nose.along_chord == pytest.approx(1.0, rel=0.01) and nose.along_span == pytest.approx(0.5, rel=0.01)


def test_lift_takes_the_moments_error_over_the_longest_arm_and_the_moment_lift_s_near_the_speed_of_sound():
    mach = np.array([0.5, 0.8, 1.2, 2.0])
    found = floors(["lift alpha", "pitch alpha", "drag alpha", "side beta", "yaw beta"], ARMS, mach)
    assert set(found) == {"lift alpha", "pitch alpha", "side beta", "drag alpha"}
    ((other, share),) = found["pitch alpha"]
    assert other == "lift alpha" and share.tolist() == [0.0, 2.0, 2.0, 0.0]
    for name, wanted, arm in (("lift alpha", "pitch alpha", 5.0), ("side beta", "yaw beta", 4.0)):
        ((other, share),) = found[name]
        assert other == wanted
        np.testing.assert_allclose(share, 1.0 / arm)


def test_near_the_speed_of_sound_rates_take_the_angle_s_error_at_the_farthest_wall():
    mach = np.array([0.5, 0.8, 2.0])
    found = floors(["pitch q", "yaw r", "lift q", "side p", "yaw p", "roll r"], ARMS, mach)
    assert found["pitch q"][1][0] == "pitch alpha" and found["pitch q"][1][1].tolist() == [0.0, 9.0, 0.0]
    ((other, share),) = found["yaw r"]
    assert other == "yaw beta" and share.tolist() == [0.0, 7.0, 0.0]
    assert [other for other, _ in found["lift q"]] == ["pitch q", "lift alpha"]
    assert found["roll r"][0][0] == "roll beta"
    assert "yaw p" not in found and len(found["side p"]) == 1
    # at the nose of a sphere of radius 1 turning about its rear, q c / 2V of one is an angle of 2 / (c / 2) there
    conditions = points(5.0).conditions
    for length in (1.0, 10.0):
        arms = arms_of(solved(sphere(), reference(length, 2.0), conditions))
        ties = floors(["pitch q", "yaw r"], arms, np.array([1.0])).values()
        for *_, (_, share) in ties:
            assert share[0] == pytest.approx(2.0 / (0.5 * length), rel=0.01)


def test_uncertainties_of_forces_do_not_depend_on_the_reference_length():
    """The same flow with moments on a calibre and on ten: the moment's interval scales, the force's stays."""
    machs = (3.0, 5.0)
    plans = points(*machs)
    widths = {}
    for length in (1.0, 10.0):
        # a cone slightly blunter stands for what a coarser mesh makes of it; about a far centre moments are large
        fine, coarse = (solved(cone(angle), reference(length, 3.0), plans.conditions) for angle in (0.3, 0.31))
        slopes, rough = (differentiate(data, plans) for data in (fine, coarse))
        whole = of_coefficients(fine, coarse, 2.0)
        slopes = of_derivatives(slopes, rough, np.array(machs), 2.0, arms_of(fine))
        widths[length] = whole, slopes
    (short, short_slopes), (long, long_slopes) = widths[1.0], widths[10.0]
    for name, power in (("CL", 0), ("CN", 0), ("CD", 0), ("Cm", 1)):
        mesh = short[f"{name}_mesh_error"].values
        assert (mesh > 0.0).all()
        np.testing.assert_allclose(long[f"{name}_mesh_error"], mesh / 10.0**power, rtol=1e-9)
    for name, power in (("CL_alpha", 0), ("CY_beta", 0), ("Cm_alpha", 1), ("Cn_beta", 1)):
        mesh = short_slopes[f"{name}_mesh_error"].values
        np.testing.assert_allclose(long_slopes[f"{name}_mesh_error"], mesh / 10.0**power, rtol=1e-9)


def test_axial_force_is_no_more_certain_than_its_two_shares():
    """A coarse mesh that errs on forebody and base in opposite ways gives the same sum by chance."""
    fine = solved(sphere(), ReferenceLengths(math.pi, 2.0, 2.0, (1.0, 0.0, 0.0)), points(5.0).conditions)
    shift = xr.zeros_like(fine.CA) + 0.01
    coarse = fine.assign(CA_forebody=fine.CA_forebody + shift, CA_base=fine.CA_base - shift)
    found = of_coefficients(fine, coarse, 2.0)
    shares = (found[f"{name}_mesh_error"].values for name in ("CA_forebody", "CA_base"))
    whole = np.hypot(*shares)
    assert (whole > 0.01).all()
    for name in ("CA", "CD"):
        np.testing.assert_allclose(found[f"{name}_mesh_error"], whole)
