"""Oblique shocks and expansions against printed values, against each other and against their limits."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from spaceplane.aero.exact.oblique import behind, detachment, weak_shock_cp
from spaceplane.aero.exact.prandtl_meyer import expanded_cp, prandtl_meyer_angle, vacuum_cp
from spaceplane.errors import InputError


@pytest.mark.parametrize(
    ("mach", "deflection_deg", "shock_deg", "ratio"), [(2.0, 10.0, 39.314, 1.7066), (3.0, 20.0, 37.764, 3.7713)]
)
def test_weak_shock_of_the_printed_charts(mach, deflection_deg, shock_deg, ratio):
    """Shock angle and pressure ratio from tables of NACA 1135's equations."""
    _, deflection, jump = behind(mach, math.radians(shock_deg))
    assert math.degrees(float(deflection)) == pytest.approx(deflection_deg, abs=1e-3)
    assert jump == pytest.approx(ratio, abs=2e-4)
    cp = float(weak_shock_cp(mach, math.radians(deflection_deg)))
    assert 1.0 + cp * 0.7 * mach**2 == pytest.approx(ratio, abs=2e-4)


@pytest.mark.parametrize("gamma", [1.2, 1.4, 5.0 / 3.0])
@pytest.mark.parametrize("mach", [1.1, 2.0, 5.0, 20.0])
def test_the_closed_form_inverts_the_shock_relations(mach, gamma):
    """From a hair above the Mach wave to detachment: shock angle -> deflection and Cp; the closed form goes back."""
    limit = detachment(mach, gamma)
    wave = math.asin(1.0 / mach)
    shock = wave + (limit.shock_angle - wave) * np.array([1e-9, 1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999])
    _, deflection, jump = behind(mach, shock, gamma)
    cp = (jump - 1.0) * 2.0 / (gamma * mach**2)
    np.testing.assert_allclose(weak_shock_cp(mach, deflection, gamma), cp, rtol=1e-6, atol=1e-13)


def test_detachment_is_the_largest_deflection():
    """Mach 2: 22.97 deg, Mach 5: 41.12 deg (charts of NACA 1135); no neighbouring shock turns the stream farther."""
    for mach, printed in ((2.0, 22.97), (5.0, 41.12)):
        limit = detachment(mach)
        assert math.degrees(limit.deflection) == pytest.approx(printed, abs=5e-3)
        for side in (-1e-3, 1e-3):
            assert behind(mach, limit.shock_angle + side)[1] < limit.deflection
    with pytest.raises(InputError, match="mach = 1"):
        detachment(1.0)


def test_small_turns_meet_linear_theory_from_both_sides():
    """Ackeret: Cp = 2 theta / sqrt(M^2 - 1) for compression, and its negative for expansion, to first order."""
    for theta in (1e-8, 1e-5, 1e-4):
        linear = 2.0 * theta / math.sqrt(8.0)
        assert weak_shock_cp(3.0, theta) == pytest.approx(linear, rel=max(20.0 * theta, 1e-7))
        assert expanded_cp(3.0, theta) == pytest.approx(-linear, rel=max(20.0 * theta, 1e-7))
    assert weak_shock_cp(3.0, 0.0) == 0.0 and abs(expanded_cp(3.0, 0.0)) < 1e-15


def test_prandtl_meyer_angles_of_the_tables():
    """NACA 1135 table II: Mach 2: 26.380 deg, Mach 5: 76.920 deg; all the way to vacuum: 130.45 deg."""
    for mach, degrees in ((1.0, 0.0), (2.0, 26.380), (5.0, 76.920), (1e9, 130.454)):
        assert math.degrees(prandtl_meyer_angle(mach)) == pytest.approx(degrees, abs=1e-3)
    with pytest.raises(InputError, match=r"mach = 0\.9"):
        prandtl_meyer_angle(0.9)


@pytest.mark.parametrize("mach", [1.0, 2.0, 10.0])
def test_expansion_by_a_root_finder(mach):
    """The Mach number that has turned so much farther, found by bisection, and the isentropic pressure ratio."""
    room = prandtl_meyer_angle(1e9) - prandtl_meyer_angle(mach)
    for share in (0.1, 0.5, 0.9):
        target = prandtl_meyer_angle(mach) + share * room
        after = brentq(lambda m, target=target: prandtl_meyer_angle(m) - target, mach, 1e6, xtol=1e-13, rtol=1e-14)
        ratio = ((1.0 + 0.2 * mach**2) / (1.0 + 0.2 * after**2)) ** 3.5
        assert expanded_cp(mach, share * room) == pytest.approx((ratio - 1.0) / (0.7 * mach**2), abs=1e-12)


def test_expansion_ends_at_vacuum():
    room = prandtl_meyer_angle(1e12) - prandtl_meyer_angle(5.0)
    turning = np.array([0.9, 1.0, 1.1, 2.0]) * room
    cp = expanded_cp(5.0, turning)
    assert cp[0] > cp[1] and cp[0] == pytest.approx(vacuum_cp(5.0), abs=1e-7)
    np.testing.assert_allclose(cp[1:], vacuum_cp(5.0), rtol=1e-12)
