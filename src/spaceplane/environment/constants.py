"""The one place for physical constants. SI units; every other module imports them from here."""

from __future__ import annotations

# US Standard Atmosphere 1976 (NOAA-S/T 76-1562), table 2 and section 1.2.
STANDARD_GRAVITY = 9.80665  # m/s2, at EARTH_RADIUS
EARTH_RADIUS = 6_356_766.0  # m, the effective radius that goes with STANDARD_GRAVITY
UNIVERSAL_GAS_CONSTANT = 8.31432  # J/(mol K), the 1976 value the standard is built on
AVOGADRO = 6.022169e23  # 1/mol, likewise
MOLAR_MASS_AIR = 28.9644e-3  # kg/mol at sea level
GAS_CONSTANT_AIR = UNIVERSAL_GAS_CONSTANT / MOLAR_MASS_AIR  # 287.053 J/(kg K)
RATIO_OF_SPECIFIC_HEATS = 1.4
SUTHERLAND_BETA = 1.458e-6  # kg/(s m K^0.5)
SUTHERLAND_TEMPERATURE = 110.4  # K
PRANDTL_NUMBER_AIR = 0.72  # of air as a perfect gas
COLLISION_DIAMETER = 3.65e-10  # m, effective, for the mean free path

# CODATA 2018 (exact), for the equilibrium-air model that works from molecular data.
BOLTZMANN = 1.380649e-23  # J/K
PLANCK = 6.62607015e-34  # J s
STEFAN_BOLTZMANN = 5.670374419e-8  # W/(m2 K4)


def gravity(radius: float) -> float:
    """Acceleration of gravity of a spherical Earth, m/s2, at a distance from its centre, m (inverse square)."""
    return STANDARD_GRAVITY * (EARTH_RADIUS / radius) ** 2
