"""Pressure laws against the exact solutions that they tabulate, and the limits of each theory."""

import math

import numpy as np
import pytest

from spaceplane.aero.exact.conical import taylor_maccoll
from spaceplane.aero.exact.oblique import detachment, weak_shock_cp
from spaceplane.aero.exact.prandtl_meyer import expanded_cp, vacuum_cp
from spaceplane.aero.exact.stagnation import stagnation_cp
from spaceplane.aero.inclination.laws import LEEWARD, WINDWARD
from spaceplane.errors import InputError

MACHS = (2.0, 3.0, 5.0, 10.0, 25.0)
ANGLES = np.linspace(0.0, 0.5 * math.pi, 1001)


@pytest.mark.parametrize("mach", MACHS)
@pytest.mark.parametrize("gamma", [1.2, 1.4])
def test_tangent_wedge_is_the_oblique_shock(mach, gamma):
    attached = np.linspace(0.0, detachment(mach, gamma).deflection, 777)
    found = WINDWARD["tangent_wedge"](mach, gamma)(attached)
    np.testing.assert_allclose(found, weak_shock_cp(mach, attached, gamma), atol=1e-6)


@pytest.mark.parametrize("mach", MACHS)
@pytest.mark.parametrize("degrees", [0.5, 2.0, 7.0, 20.0, 39.0])
def test_tangent_cone_is_the_taylor_maccoll_flow(mach, degrees):
    found = WINDWARD["tangent_cone"](mach, 1.4)(np.radians([degrees]))[0]
    assert found == pytest.approx(taylor_maccoll(mach, math.radians(degrees)).surface_cp, abs=1e-6)


def test_tangent_cone_for_another_gas():
    found = WINDWARD["tangent_cone"](6.0, 1.2)(np.radians([25.0]))[0]
    assert found == pytest.approx(taylor_maccoll(6.0, math.radians(25.0), 1.2).surface_cp, abs=1e-6)


@pytest.mark.parametrize("mach", MACHS)
def test_tangent_cone_detaches_where_the_exact_flow_does(mach):
    """The slope of Cp grows without bound there: the steepest step of a fine sweep ends at the last attached cone."""
    sweep = np.radians(np.arange(35.0, 60.0, 0.01))
    steepest = int(np.argmax(np.diff(WINDWARD["tangent_cone"](mach, 1.4)(sweep))))
    taylor_maccoll(mach, sweep[steepest] - 1e-4)
    with pytest.raises(InputError, match="attached"):
        taylor_maccoll(mach, sweep[steepest + 1] + 1e-4)


def test_newtonian_is_the_square_of_the_sine():
    law = WINDWARD["newtonian"](7.0, 1.4)
    np.testing.assert_allclose(law(ANGLES), stagnation_cp(7.0) * np.sin(ANGLES) ** 2)


@pytest.mark.parametrize("mach", MACHS)
def test_prandtl_meyer_ends_at_vacuum(mach):
    found = LEEWARD["prandtl_meyer"](mach, 1.4)(ANGLES)
    np.testing.assert_allclose(found, expanded_cp(mach, ANGLES), atol=1e-6)
    assert found.min() >= vacuum_cp(mach)
    if mach >= 5.0:
        assert found[-1] == pytest.approx(vacuum_cp(mach), rel=1e-9)


@pytest.mark.parametrize("name", WINDWARD)
@pytest.mark.parametrize("mach", MACHS)
def test_every_windward_law_rises_from_the_free_stream_to_the_stagnation_pressure(name, mach):
    """Also past detachment, and without a jump there: a wedge's and a cone's slope is unbounded, but not their Cp."""
    cp = WINDWARD[name](mach, 1.4)(np.linspace(0.0, 0.5 * math.pi, 100_001))
    assert cp[0] == pytest.approx(0.0, abs=1e-12)
    assert cp[-1] == pytest.approx(stagnation_cp(mach))
    assert (np.diff(cp) >= 0.0).all()
    assert np.diff(cp).max() < 0.01


@pytest.mark.parametrize("name", LEEWARD)
@pytest.mark.parametrize("mach", MACHS)
def test_every_leeward_law_falls_from_the_free_stream_and_not_below_vacuum(name, mach):
    cp = LEEWARD[name](mach, 1.4)(ANGLES)
    assert cp[0] == pytest.approx(0.0, abs=1e-12)
    assert (np.diff(cp) <= 0.0).all()
    assert cp[-1] >= vacuum_cp(mach)


def test_a_cone_is_pressed_less_than_a_wedge():
    """The flow round a cone is relieved to the sides."""
    angles = np.radians([5.0, 20.0, 35.0])
    assert (WINDWARD["tangent_cone"](5.0, 1.4)(angles) < WINDWARD["tangent_wedge"](5.0, 1.4)(angles)).all()
