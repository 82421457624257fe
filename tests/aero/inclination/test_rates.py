"""Steady rates in the fast tier: a flat plate's integrals, the choice of the turning centre, symmetry, signs."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spaceplane.aero.conditions import DerivativeSteps, plan, product, turning
from spaceplane.aero.derivatives import differentiate
from spaceplane.aero.exact.stagnation import stagnation_cp
from spaceplane.aero.inclination.panels import panels_of
from spaceplane.aero.inclination.settings import InclinationSettings, method
from spaceplane.aero.inclination.solve import local_inclination, pressures
from spaceplane.flow.freestream import direction
from spaceplane.vehicle.build import build
from spaceplane.vehicle.presets import horus_2b
from spaceplane.vehicle.properties import ReferenceLengths

from .test_solve import SPACING, Point, plate

VEHICLE = horus_2b()
RATE = 1e-3


@pytest.fixture(scope="module")
def body():
    return build(VEHICLE.shape, spacing=SPACING)


def slope(surface, reference, mach, alpha, rate, name, settings=None):
    """Central difference of a coefficient with a reduced rate, index `rate` of p, q, r."""
    streams = product([mach], [alpha], [0.0])
    both = []
    for sign in (1.0, -1.0):
        reduced = np.zeros((1, 3))
        reduced[0, rate] = sign * RATE
        data = local_inclination(surface, turning(streams, reduced, reference), reference, settings)
        both.append(data[name].sel(part="total").item())
    return (both[0] - both[1]) / (2.0 * RATE)


@pytest.mark.parametrize(("mach", "degrees"), [(3.0, 10.0), (10.0, 35.0)])
def test_a_flat_plate_in_newtonian_flow_damps_as_its_integrals_say(mach, degrees):
    """Cp = K(M) (v_n/V)^2 with v_n = V sin a + p y + q (x - x_c); K at the local speed V + sin a (p y + q (x - x_c)).

    So dCp/dv' = 2 K sin a + M K' sin^3 a for a velocity v' on V down along the plate's normal, and
    Cl_p = -dCp/dv' (2/b^2) mean(y^2), Cm_q = -dCp/dv' (2/c^2) mean((x - x_c)^2).
    """
    length, width, center = 2.0, 3.0, 0.7
    reference = ReferenceLengths(length * width, length, width, (center, 0.0, 0.0))
    alpha, step = math.radians(degrees), 1e-4
    growth = (stagnation_cp(mach * (1 + step), 1.4) - stagnation_cp(mach * (1 - step), 1.4)) / (2.0 * step)
    by_speed = 2.0 * stagnation_cp(mach, 1.4) * math.sin(alpha) + growth * math.sin(alpha) ** 3
    square_y = width**2 / 12.0
    square_x = (center**3 + (length - center) ** 3) / (3.0 * length)
    settings = replace(method("newtonian"), panel=0.005)
    surface = plate(length, width, 1e-6)
    found = {name: slope(surface, reference, mach, alpha, k, name, settings) for k, name in ((0, "Cl"), (1, "Cm"))}
    assert found["Cl"] == pytest.approx(-by_speed * 2.0 / width**2 * square_y, rel=1e-3)
    assert found["Cm"] == pytest.approx(-by_speed * 2.0 / length**2 * square_x, rel=1e-3)


def test_the_turning_centre_is_a_choice_of_words(body):
    """The same motion told about another point, with the velocity of that point, gives the same pressures."""
    panels, settings = panels_of(body, 1.0), InclinationSettings(shadow=False)
    mach, alpha, rates = 5.0, math.radians(25.0), np.array([[0.002, 0.003, -0.002]])
    here, there = np.array([13.0, 0.0, 0.0]), np.array([16.0, 0.5, 1.0])
    first = replace(product([mach], [alpha], [0.0]), rates=rates, center=tuple(here))
    wind = mach * direction(alpha, 0.0) - np.cross(first.angular_velocity()[0], there - here)
    other = float(np.linalg.norm(wind))
    turned = product([other], [math.atan2(wind[2], wind[0])], [-math.asin(wind[1] / other)])
    np.testing.assert_allclose(other * direction(turned.alpha, turned.beta)[0], wind, atol=1e-12)
    second = replace(turned, rates=rates, center=tuple(there))
    one, two = (c.mach[0] ** 2 * pressures(panels, c, settings)[:, 0] for c in (first, second))
    still = mach**2 * pressures(panels, replace(first, rates=None), settings)[:, 0]
    assert np.abs(one - two).max() < 2e-3 * np.abs(one - still).max()


def test_rolls_and_yaws_to_either_side_are_mirror_images(body):
    streams = product([6.0] * 2, [Point().alpha], [0.0])
    reduced = np.array([[0.01, 0.0, 0.02], [-0.01, 0.0, -0.02]])
    data = local_inclination(body, turning(streams, reduced, VEHICLE.reference), VEHICLE.reference)
    for name in ("CY", "Cl", "Cn"):
        right, left = data[name].sel(part="total").values
        assert right == pytest.approx(-left, rel=1e-9) and abs(right) > 1e-5
    for name in ("CL", "CD", "Cm"):
        right, left = data[name].sel(part="total").values
        assert right == pytest.approx(left, rel=1e-9)


def test_horus_is_damped(body):
    made = plan([Point()], DerivativeSteps(), reference=VEHICLE.reference, quantities=("beta", "p", "q", "r"))
    assert made.labels == ("base", "beta", "p", "q+", "q-", "r")
    found = differentiate(local_inclination(body, made.conditions, VEHICLE.reference), made)
    for name in ("Cl_p", "Cm_q", "Cn_r", "CY_beta"):
        assert found[name].sel(part="total").item() < -1e-3, name
    assert found.CL_q.sel(part="total").item() > 0.0 and "CL_alpha" not in found


def test_no_rate_is_a_rate_of_zero(body):
    streams = product([4.0], [0.3], [0.0])
    still = local_inclination(body, streams, VEHICLE.reference)
    turned = local_inclination(body, turning(streams, np.zeros((1, 3)), VEHICLE.reference), VEHICLE.reference)
    for name in ("CL", "CD", "Cm"):
        np.testing.assert_array_equal(still[name].values, turned[name].values)
