"""US Standard Atmosphere 1976 from -5 to 86 km (NOAA-S/T 76-1562, sections 1.2 and 1.3)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spaceplane.environment import constants as c
from spaceplane.errors import InputError

LOWEST_ALTITUDE = -5_000.0
HIGHEST_ALTITUDE = 86_000.0

# Table 4 of the standard: base of each layer, geopotential metres, and the gradient of molecular-scale
# temperature above it, K per geopotential metre.
_LAYER_BASE = (0.0, 11_000.0, 20_000.0, 32_000.0, 47_000.0, 51_000.0, 71_000.0)
_LAYER_GRADIENT = (-6.5e-3, 0.0, 1.0e-3, 2.8e-3, 0.0, -2.8e-3, -2.0e-3)
_SEA_LEVEL_TEMPERATURE = 288.15
_SEA_LEVEL_PRESSURE = 101_325.0

# Table 8 of the standard: molar mass over its sea-level value, by geometric altitude.
# Only the kinetic temperature needs it.
_MASS_RATIO_ALTITUDE = np.arange(80_000.0, 86_001.0, 500.0)
_MASS_RATIO = 1.0 - 1e-6 * np.array([0, 4, 11, 29, 59, 91, 130, 171, 214, 259, 306, 359, 421])


@dataclass(frozen=True)
class Ambient:
    """The undisturbed air at one altitude.

    Attributes:
        altitude: geometric altitude above mean sea level, m.
        pressure: Pa.
        temperature: kinetic temperature, K.
        density: kg/m3.
        speed_of_sound: m/s.
        viscosity: dynamic viscosity by Sutherland's law, Pa s.
        mean_free_path: m, hard spheres of 3.65e-10 m.
        source: where the pressure and temperature come from.
    """

    altitude: float
    pressure: float
    temperature: float
    density: float
    speed_of_sound: float
    viscosity: float
    mean_free_path: float
    source: str = "US Standard Atmosphere 1976"


def geopotential(altitude: float) -> float:
    """Geopotential altitude, m', of a geometric altitude, m (equation 18 of the standard)."""
    return c.EARTH_RADIUS * altitude / (c.EARTH_RADIUS + altitude)


def us1976(altitude_m: float) -> Ambient:
    """The US Standard Atmosphere 1976 at a geometric altitude.

    Args:
        altitude_m: geometric altitude, m, from -5 000 to 86 000.

    Raises:
        InputError: the altitude is not finite or lies outside these limits. Above 86 km the standard leaves hydrostatic
            mixing for diffusive separation by species, and the continuum flow model of this package has ended as well.
    """
    altitude = float(altitude_m)
    if not LOWEST_ALTITUDE <= altitude <= HIGHEST_ALTITUDE:
        raise InputError(
            f"altitude_m = {altitude_m}: the US 1976 atmosphere is available from {LOWEST_ALTITUDE:.0f} to "
            f"{HIGHEST_ALTITUDE:.0f} m"
        )
    molecular_temperature, pressure = _layered(geopotential(altitude))
    ratio = float(np.interp(altitude, _MASS_RATIO_ALTITUDE, _MASS_RATIO))
    return _ambient(altitude, pressure, molecular_temperature, ratio, "US Standard Atmosphere 1976")


def from_pressure_temperature(altitude_m: float, pressure: float, temperature: float) -> Ambient:
    """Air with a given static pressure, Pa, and temperature, K, at an altitude, m (perfect gas, sea-level composition).

    Raises:
        InputError: a value is not finite, or pressure or temperature is not above zero.
    """
    for name, value in (("pressure_Pa", pressure), ("temperature_K", temperature)):
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"{name} = {value}: must be a finite number above 0")
    if not (math.isfinite(altitude_m) and altitude_m > -c.EARTH_RADIUS):
        raise InputError(f"altitude_m = {altitude_m}: must be a finite number above the Earth's centre")
    return _ambient(float(altitude_m), float(pressure), float(temperature), 1.0, "given pressure and temperature")


def sutherland_viscosity(temperature: float) -> float:
    """Dynamic viscosity of air, Pa s, at a temperature, K, also of an array (equation 51 of the standard)."""
    return c.SUTHERLAND_BETA * temperature**1.5 / (temperature + c.SUTHERLAND_TEMPERATURE)


def _layered(height: float) -> tuple[float, float]:
    """Molecular-scale temperature, K, and pressure, Pa, at a geopotential height, m' (equations 23, 33a and 33b)."""
    temperature, pressure = _SEA_LEVEL_TEMPERATURE, _SEA_LEVEL_PRESSURE
    tops = (*_LAYER_BASE[1:], math.inf)
    for base, top, gradient in zip(_LAYER_BASE, tops, _LAYER_GRADIENT, strict=True):
        rise = min(height, top) - base
        upper = temperature + gradient * rise
        if gradient == 0.0:
            pressure *= math.exp(-c.STANDARD_GRAVITY * rise / (c.GAS_CONSTANT_AIR * temperature))
        else:
            pressure *= (temperature / upper) ** (c.STANDARD_GRAVITY / (c.GAS_CONSTANT_AIR * gradient))
        temperature = upper
        if height <= top:
            break
    return temperature, pressure


def _ambient(altitude: float, pressure: float, molecular_temperature: float, mass_ratio: float, source: str) -> Ambient:
    """The dependent quantities (equations 42, 50, 51 and the mean free path of section 1.3.9)."""
    temperature = molecular_temperature * mass_ratio
    return Ambient(
        altitude=altitude,
        pressure=pressure,
        temperature=temperature,
        density=pressure / (c.GAS_CONSTANT_AIR * molecular_temperature),
        speed_of_sound=math.sqrt(c.RATIO_OF_SPECIFIC_HEATS * c.GAS_CONSTANT_AIR * molecular_temperature),
        viscosity=sutherland_viscosity(temperature),
        mean_free_path=c.UNIVERSAL_GAS_CONSTANT
        * temperature
        / (math.sqrt(2.0) * math.pi * c.AVOGADRO * c.COLLISION_DIAMETER**2 * pressure),
        source=source,
    )
