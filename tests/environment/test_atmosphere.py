"""US Standard Atmosphere 1976 against the printed tables of NOAA-S/T 76-1562 and an independent package."""

import ambiance
import numpy as np
import pytest

from spaceplane.environment import constants as c
from spaceplane.environment.atmosphere import from_pressure_temperature, geopotential, us1976
from spaceplane.errors import InputError


@pytest.mark.parametrize(
    ("altitude", "temperature", "pressure", "density"),
    [  # table I of the standard: geometric altitude, K, Pa (printed in mbar), kg/m3
        (0.0, 288.150, 1.01325e5, 1.2250),
        (10_000.0, 223.252, 2.6500e4, 4.1351e-1),
        (30_000.0, 226.509, 1.1970e3, 1.8410e-2),
        (50_000.0, 270.650, 7.9779e1, 1.0269e-3),
        (70_000.0, 219.585, 5.2209, 8.2829e-5),
        (86_000.0, 186.87, 3.7338e-1, 6.958e-6),
    ],
)
def test_printed_table(altitude, temperature, pressure, density):
    air = us1976(altitude)
    assert air.temperature == pytest.approx(temperature, abs=6e-3)
    assert air.pressure == pytest.approx(pressure, rel=1e-4)
    assert air.density == pytest.approx(density, rel=1e-4)


def test_agrees_with_independent_package():
    altitudes = np.linspace(-4_500.0, 80_000.0, 100)
    theirs = ambiance.Atmosphere(altitudes)
    for i, altitude in enumerate(altitudes):
        ours = us1976(altitude)
        assert ours.pressure == pytest.approx(theirs.pressure[i], rel=2e-5)
        assert ours.temperature == pytest.approx(theirs.temperature[i], abs=2e-3)
        assert ours.speed_of_sound == pytest.approx(theirs.speed_of_sound[i], rel=1e-5)
        assert ours.viscosity == pytest.approx(theirs.dynamic_viscosity[i], rel=1e-4)
        assert ours.mean_free_path == pytest.approx(theirs.mean_free_path[i], rel=1e-4)


def test_hydrostatic_balance():
    """dp/dh = -rho g at geometric altitude, with the package's own gravity."""
    for altitude in (3_000.0, 15_000.0, 26_700.0, 40_000.0, 65_000.0, 83_000.0):
        step = 1.0
        slope = (us1976(altitude + step).pressure - us1976(altitude - step).pressure) / (2 * step)
        assert slope == pytest.approx(-us1976(altitude).density * c.gravity(c.EARTH_RADIUS + altitude), rel=1e-6)


def test_continuous_at_layer_boundaries():
    for height in (11_000.0, 20_000.0, 32_000.0, 47_000.0, 51_000.0, 71_000.0):
        altitude = c.EARTH_RADIUS * height / (c.EARTH_RADIUS - height)
        assert geopotential(altitude) == pytest.approx(height, rel=1e-12)
        below, above = us1976(altitude - 1e-3), us1976(altitude + 1e-3)
        assert below.pressure == pytest.approx(above.pressure, rel=1e-6)
        assert below.temperature == pytest.approx(above.temperature, abs=1e-4)


@pytest.mark.parametrize("altitude", [-5_001.0, 86_001.0, float("nan"), float("inf")])
def test_outside_is_refused(altitude):
    with pytest.raises(InputError, match="altitude_m"):
        us1976(altitude)


def test_given_state_is_a_perfect_gas():
    air = from_pressure_temperature(26_700.0, 1967.5, 223.24)
    assert air.pressure == pytest.approx(air.density * c.GAS_CONSTANT_AIR * air.temperature)
    assert air.speed_of_sound == pytest.approx(us1976(26_700.0).speed_of_sound, rel=1e-4)
    with pytest.raises(InputError, match="temperature_K"):
        from_pressure_temperature(0.0, 1e5, -3.0)
