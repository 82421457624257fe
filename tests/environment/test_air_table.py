"""Equilibrium air as a table, and what thermodynamics asks of the model behind it."""

import numpy as np
import pytest

from spaceplane.environment.air_table import air_table
from spaceplane.environment.equilibrium_air import (
    GAS_CONSTANT,
    behind_normal_shock,
    equilibrium,
    heat_at_density,
    stagnation,
)


@pytest.fixture(scope="module")
def states():
    rng = np.random.default_rng(1)
    temperature = rng.uniform(50.0, 12_000.0, 20_000)
    density = np.exp(rng.uniform(np.log(1e-8), np.log(50.0), 20_000))
    factor, enthalpy = heat_at_density(temperature, density)
    return density, factor * density * GAS_CONSTANT * temperature, temperature, enthalpy


def test_at_given_density_the_air_is_that_at_given_pressure():
    for temperature in (60.0, 300.0, 1500.0, 3500.0, 8000.0, 15_000.0):
        for pressure in (1e-2, 1e3, 1e6):
            air = equilibrium(temperature, pressure)
            factor, enthalpy = heat_at_density(np.array([temperature]), np.array([air.density]))
            assert factor[0] == pytest.approx(air.compressibility_factor, rel=1e-9)
            assert enthalpy[0] == pytest.approx(air.enthalpy, rel=1e-9)


def test_table_holds_the_model(states):
    density, pressure, temperature, enthalpy = states
    found = air_table().look(density, pressure)
    np.testing.assert_allclose(found["factor"], enthalpy * density / pressure, rtol=2e-4)
    np.testing.assert_allclose(found["temperature"], temperature, rtol=1.5e-4)


def test_slopes_are_those_of_the_model(states):
    density, pressure, _, _ = states
    table, step = air_table(), 0.02
    found = table.look(density, pressure)
    for name, r, p in (("by_density", step, 0.0), ("by_pressure", 0.0, step)):
        up, down = (table.look(density * np.exp(s * r), pressure * np.exp(s * p))["factor"] for s in (1, -1))
        error = (up - down) / (2 * step) - found[name]
        assert np.sqrt(np.mean(error**2)) < 0.01 * np.sqrt(np.mean(found[name] ** 2))


def test_cold_air_is_the_perfect_gas():
    density = np.array([1e-8, 1e-3, 10.0])
    found = air_table().look(density, density * GAS_CONSTANT * 120.0)
    np.testing.assert_allclose(found["factor"], 3.5, rtol=1e-6)
    np.testing.assert_allclose(found["by_pressure"], 0.0, atol=1e-5)


@pytest.mark.parametrize(("temperature", "pressure"), [(300.0, 1e5), (3000.0, 1e3), (6000.0, 1e4)])
def test_entropy_and_enthalpy_belong_together(temperature, pressure):
    """T ds = dh - v dp, along both."""
    step = 1e-4
    air = equilibrium(temperature, pressure)
    warm, cool = (equilibrium(temperature * (1 + s * step), pressure) for s in (1, -1))
    assert temperature * (warm.entropy - cool.entropy) == pytest.approx(warm.enthalpy - cool.enthalpy, rel=1e-6)
    more, less = (equilibrium(temperature, pressure * (1 + s * step)) for s in (1, -1))
    work = (more.pressure - less.pressure) / air.density
    heat = more.enthalpy - less.enthalpy - temperature * (more.entropy - less.entropy)
    assert heat == pytest.approx(work, rel=1e-6)


def test_stagnation_is_isentropic_and_keeps_the_energy():
    pressure, temperature, speed = 20.0, 245.0, 6000.0
    ahead, behind = equilibrium(temperature, pressure), behind_normal_shock(pressure, temperature, speed)
    rest = stagnation(pressure, temperature, speed)
    assert rest.entropy == pytest.approx(behind.entropy, rel=1e-8)
    assert rest.enthalpy == pytest.approx(ahead.enthalpy + speed**2 / 2, rel=1e-8)
    assert 1.0 < rest.pressure / behind.pressure < 1.06
    # A cold shock is the perfect gas's: Rayleigh's pitot formula gives 12.06 at Mach 3.
    weak = stagnation(1e3, 100.0, 3.0 * np.sqrt(1.4 * GAS_CONSTANT * 100.0))
    assert weak.pressure / 1e3 == pytest.approx(12.061, rel=1e-3)
