import math

import numpy as np
import pytest
from scipy.optimize import brentq

from spaceplane.aero.increments.friction_laws import LAMINAR, TURBULENT, local_friction, radiative_temperature
from spaceplane.environment.atmosphere import sutherland_viscosity


def karman_schoenherr(reynolds):
    """Local friction of an incompressible turbulent plate (Hopkins and Inouye, AIAA J. 9 (1971), equation 8)."""
    mean = brentq(lambda c: 0.242 / math.sqrt(c) - math.log10(reynolds * c), 1e-4, 0.1)
    return 0.242 * mean / (0.242 + 0.8686 * math.sqrt(mean))


def van_driest(reynolds, mach, temperature, wall_ratio=None):
    """Van Driest's second theory, as Hopkins and Inouye (1971) state it; wall temperature over adiabatic."""
    m = 0.2 * mach**2
    edge = 0.88 * m
    wall = (1.0 + edge) * (wall_ratio or 1.0)
    a, b = math.sqrt(edge / wall), (1.0 + edge - wall) / wall
    root = math.sqrt(4.0 * a * a + b * b)
    alpha, beta = (2.0 * a * a - b) / root, b / root
    factor = edge / (math.asin(alpha) + math.asin(beta)) ** 2 if mach > 0.0 else 1.0
    viscosity = sutherland_viscosity(temperature) / sutherland_viscosity(wall * temperature)
    return karman_schoenherr(reynolds * viscosity / factor) / factor


@pytest.mark.parametrize(("reynolds", "band"), [(1e6, 0.06), (1e7, 0.01), (1e8, 0.01)])
def test_turbulent_friction_at_rest_is_the_incompressible_law(reynolds, band):
    found = local_friction(TURBULENT, np.array([reynolds]), np.array([1e-4]), np.array([250.0]), 250.0)[0]
    assert found == pytest.approx(0.02296 / reynolds**0.139, rel=1e-5)
    assert found == pytest.approx(karman_schoenherr(reynolds), rel=band)


@pytest.mark.parametrize(
    ("mach", "wall_ratio", "band"),
    [(1.0, None, 0.02), (2.0, None, 0.05), (3.0, None, 0.09), (1.0, 0.5, 0.04), (3.0, 0.5, 0.02), (5.0, 0.5, 0.08)],
)
def test_compressibility_follows_van_driest(mach, wall_ratio, band):
    """c_f / c_f incompressible at Re 1e7, wall temperature in parts of the adiabatic one (None: adiabatic)."""
    temperature, reynolds = 220.0, 1e7
    wall = None if wall_ratio is None else wall_ratio * temperature * (1.0 + 0.88 * 0.2 * mach**2)
    args = np.array([reynolds]), np.array([mach]), np.array([temperature])
    ratio = local_friction(TURBULENT, *args, wall)[0] / (0.02296 / reynolds**0.139)
    exact = van_driest(reynolds, mach, temperature, wall_ratio) / karman_schoenherr(reynolds)
    assert ratio == pytest.approx(exact, rel=band)


def test_laminar_reference_temperature_by_hand():
    """Mach 2, adiabatic, 216.65 K: recovery temperature 1 + 0.8 sqrt(0.72) of the edge's."""
    rise = 0.8 * math.sqrt(0.72)
    star = 0.45 + 0.55 * (1.0 + rise) + 0.16 * rise
    viscosity = star**1.5 * (216.65 + 110.4) / (star * 216.65 + 110.4)
    expected = 0.664 / math.sqrt(1e6 / star / viscosity) / star
    found = local_friction(LAMINAR, np.array([1e6]), np.array([2.0]), np.array([216.65]), None)[0]
    assert found == pytest.approx(expected, rel=1e-12)


def test_laminar_friction_hardly_changes_with_mach_number_on_an_adiabatic_wall():
    """Chapman and Rubesin: c_f sqrt(Re) of an adiabatic plate falls from 0.664 to about 0.60 at Mach 4."""
    at = [local_friction(LAMINAR, np.array([1e6]), np.array([m]), np.array([216.65]), None)[0] for m in (0.1, 4.0)]
    assert at[0] * 1e3 == pytest.approx(0.664, rel=1e-3)
    assert 0.57 < at[1] * 1e3 < 0.62


def test_a_cold_wall_has_more_friction():
    args = np.array([1e7]), np.array([3.0]), np.array([220.0])
    cold, warm, adiabatic = (local_friction(TURBULENT, *args, wall)[0] for wall in (220.0, 400.0, None))
    assert cold > warm > adiabatic


def test_no_reynolds_number_no_friction():
    assert local_friction(TURBULENT, np.zeros(2), np.ones(2), np.full(2, 250.0), None) == pytest.approx(0.0)


@pytest.mark.parametrize("law", [LAMINAR, TURBULENT])
def test_a_radiating_wall_is_in_balance(law):
    """Heat by Reynolds' analogy equals emitted heat; the blacker the colder, without emission adiabatic."""
    reynolds, mach, temperature, flux = (np.array([v]) for v in (1e6, 6.0, 240.0, 20.0))
    recovered = 240.0 * (1.0 + 0.2 * law.recovery * 36.0)
    walls = [radiative_temperature(law, reynolds, mach, temperature, flux, e)[0] for e in (1e-9, 0.3, 0.85)]
    assert walls[0] == pytest.approx(recovered, rel=1e-5)
    assert walls[0] > walls[1] > walls[2] > 240.0
    stanton = local_friction(law, reynolds, mach, temperature, walls[2])[0] / 2.0 * 0.72 ** (-2.0 / 3.0)
    heat = stanton * 20.0 * 1004.685 * (recovered - walls[2])
    assert heat == pytest.approx(0.85 * 5.670374419e-8 * walls[2] ** 4, rel=1e-5)
