"""Equilibrium air against tabulated values, and the verdicts along the descent."""

import pytest

from spaceplane.environment.atmosphere import us1976
from spaceplane.environment.equilibrium_air import behind_normal_shock, equilibrium
from spaceplane.environment.validity import assess_validity, knudsen


@pytest.mark.parametrize(
    ("temperature", "pressure", "factor", "enthalpy_rise"),
    [  # Cantera 3.2.0 with air.yaml (NASA polynomials), 0.79 N2 + 0.21 O2, enthalpy above 300 K in MJ/kg
        (1000.0, 101_325.0, 1.000000, 0.75137),
        (2000.0, 101_325.0, 1.000145, 1.99289),
        (3000.0, 1013.25, 1.142414, 5.86379),
        (4000.0, 101_325.0, 1.151266, 7.43158),
        (5000.0, 1013.25, 1.363814, 14.90454),
        (6000.0, 101_325.0, 1.316817, 14.82426),
        (8000.0, 101_325.0, 1.888106, 37.96862),
    ],
)
def test_equilibrium_air(temperature, pressure, factor, enthalpy_rise):
    air = equilibrium(temperature, pressure)
    assert air.compressibility_factor == pytest.approx(factor, rel=2e-3)
    rise = air.enthalpy - equilibrium(300.0, pressure).enthalpy
    assert rise == pytest.approx(enthalpy_rise * 1e6, rel=6e-3)


def test_weak_shock_is_the_ideal_gas():
    """At Mach 2 and 217 K nothing is excited yet."""
    air = us1976(15_000.0)
    shocked = behind_normal_shock(air.pressure, air.temperature, 2.0 * air.speed_of_sound)
    assert shocked.pressure / air.pressure == pytest.approx(4.5, rel=5e-3)
    assert shocked.temperature / air.temperature == pytest.approx(1.6875, rel=5e-3)


def test_shock_conserves():
    air = us1976(60_000.0)
    speed = 15.0 * air.speed_of_sound
    ahead, behind = (
        equilibrium(air.temperature, air.pressure),
        behind_normal_shock(air.pressure, air.temperature, speed),
    )
    after = speed * ahead.density / behind.density
    assert behind.pressure + behind.density * after**2 == pytest.approx(
        air.pressure + ahead.density * speed**2, rel=1e-6
    )
    assert behind.enthalpy + after**2 / 2 == pytest.approx(ahead.enthalpy + speed**2 / 2, rel=1e-6)


def test_taem_is_continuum_and_ideal():
    for mach, altitude in ((0.8, 13_000.0), (1.5, 20_000.0), (2.5, 25_000.0)):
        found = assess_validity(mach, us1976(altitude), 25.0)
        assert found.continuum and found.ideal_gas and not found.notes
        assert found.compressibility_factor == pytest.approx(1.0, abs=1e-6)


def test_hypersonic_is_not_ideal():
    mach5 = assess_validity(5.0, us1976(38_000.0), 25.0)
    mach10 = assess_validity(10.0, us1976(53_000.0), 25.0)
    assert mach5.ideal_gas and "vibration" in mach5.notes[0]
    assert not mach10.ideal_gas and "dissociate" in mach10.notes[0]
    assert mach10.compressibility_factor == pytest.approx(1.10, abs=0.01)
    assert mach10.shock_temperature < 0.6 * mach10.ideal_shock_temperature
    assert mach10.density_ratio_error > 0.5


def test_knudsen_number_grows_with_altitude_and_smallness():
    assert knudsen(us1976(25_000.0), 25.0) == pytest.approx(8.1e-8, rel=0.01)
    nose = assess_validity(20.0, us1976(86_000.0), 0.8)
    assert nose.knudsen > 0.01 and not nose.continuum and any("rarefied" in note for note in nose.notes)
