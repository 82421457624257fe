"""Air in chemical equilibrium, from the partition functions of its molecules: N2, O2, NO, N, O.

Rigid rotors, harmonic oscillators and the lowest electronic levels (molecular constants of Huber and Herzberg 1979,
atomic levels of the NIST tables); 79 % nitrogen and 21 % oxygen by volume; no ionisation, which begins to matter near
8000 K. Against the NASA polynomials of the same species (Cantera 3.2, air.yaml) from 1000 to 8000 K at 0.01 and 1 atm,
the compressibility factor differs by up to 0.14 % and the enthalpy above 300 K by up to 0.5 %.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spaceplane.environment import constants as c

NITROGEN_SHARE = 0.79
ATOMIC_MASS_UNIT = 1.66053907e-27  # kg
HIGHEST_TEMPERATURE = 20_000.0


@dataclass(frozen=True)
class Species:
    """Molecular data.

    Attributes:
        mass: u.
        rotation: characteristic temperature times symmetry number, K; 0 for an atom.
        vibration: characteristic temperature, K; 0 for an atom.
        levels: (degeneracy, temperature K) of the electronic states.
        formation: energy of formation at 0 K from N2 and O2, over Boltzmann's constant, K.
    """

    mass: float
    rotation: float
    vibration: float
    levels: tuple[tuple[float, float], ...]
    formation: float


_DISSOCIATION_N2, _DISSOCIATION_O2, _DISSOCIATION_NO = 113_250.0, 59_370.0, 75_400.0
N2 = Species(28.0134, 2 * 2.875, 3_371.0, ((1, 0.0),), 0.0)
O2 = Species(31.9988, 2 * 2.080, 2_256.0, ((3, 0.0), (2, 11_390.0), (1, 18_985.0)), 0.0)
_FORMATION_NO = (_DISSOCIATION_N2 + _DISSOCIATION_O2) / 2 - _DISSOCIATION_NO
NO = Species(30.0061, 2.452, 2_719.0, ((2, 0.0), (2, 174.0)), _FORMATION_NO)
N = Species(14.0067, 0.0, 0.0, ((4, 0.0), (10, 27_660.0), (6, 41_495.0)), _DISSOCIATION_N2 / 2)
O = Species(  # noqa: E741
    15.9994, 0.0, 0.0, ((5, 0.0), (3, 228.0), (1, 326.0), (5, 22_830.0), (1, 48_620.0)), _DISSOCIATION_O2 / 2
)
_MASS_PER_MOLE = NITROGEN_SHARE * 28.0134e-3 + (1 - NITROGEN_SHARE) * 31.9988e-3  # kg/mol of cold mixture
GAS_CONSTANT = c.BOLTZMANN / ATOMIC_MASS_UNIT * 1e-3 / _MASS_PER_MOLE  # J/(kg K), of cold mixture


@dataclass(frozen=True)
class AirState:
    """Equilibrium air.

    Attributes:
        temperature: K.
        pressure: Pa.
        compressibility_factor: p / (rho R T) with the gas constant of cold air: moles per mole of cold air.
        enthalpy: J/kg, zero at 0 K.
        density: kg/m3.
        oxygen_dissociated: share of the oxygen that is atomic.
        entropy: J/(kg K).
    """

    temperature: float
    pressure: float
    compressibility_factor: float
    enthalpy: float
    density: float
    oxygen_dissociated: float
    entropy: float


def equilibrium(temperature: float, pressure: float) -> AirState:
    """Composition, density and enthalpy at a temperature, K, and pressure, Pa."""
    from scipy.optimize import brentq  # slow to import, as all of scipy; the perfect gas needs none of it

    T, p = temperature, pressure
    # Square roots of the equilibrium constants: p_O = a x, p_N = b y, p_NO = k x y with x2 = p_O2, y2 = p_N2.
    log = {species: float(_log_function(species, T)) for species in (N2, O2, NO, N, O)}
    a = math.exp(log[O] - 0.5 * log[O2])
    b = math.exp(log[N] - 0.5 * log[N2])
    k = math.exp(log[NO] - 0.5 * (log[N2] + log[O2]))

    def nitrogen_root(x: float) -> float:
        """y that makes the partial pressures add to p."""
        linear, constant = b + k * x, x * x + a * x - p
        if constant >= 0:  # all of the pressure is oxygen's
            return 0.0
        return -2 * constant / (linear + math.sqrt(linear * linear - 4 * constant))

    def imbalance(x: float) -> float:
        y = nitrogen_root(x)
        nitrogen, oxygen = 2 * y * y + b * y + k * x * y, 2 * x * x + a * x + k * x * y
        return (1 - NITROGEN_SHARE) * nitrogen - NITROGEN_SHARE * oxygen

    highest = 2 * p / (a + math.sqrt(a * a + 4 * p))
    x = brentq(imbalance, 0.0, highest, xtol=1e-14 * highest, rtol=1e-12)
    y = nitrogen_root(x)
    partial = {N2: y * y, O2: x * x, NO: k * x * y, N: b * y, O: a * x}
    cold = (2 * partial[N2] + 2 * partial[O2] + 2 * partial[NO] + partial[N] + partial[O]) / 2
    factor = p / cold
    enthalpy = {species: float(_enthalpy(species, T)) for species in partial}
    energy = sum(share / cold * enthalpy[species] for species, share in partial.items())
    # Entropy is (h - g)/T of each species at its own partial pressure; what is not there has none.
    entropy = sum(
        share / cold * (enthalpy[species] / T - math.log(share) + log[species])
        for species, share in partial.items()
        if share > 0
    )
    oxygen = 2 * partial[O2] + partial[NO] + partial[O]
    density = p / (factor * GAS_CONSTANT * T)
    return AirState(T, p, factor, GAS_CONSTANT * energy, density, partial[O] / oxygen, GAS_CONSTANT * entropy)


def heat_at_density(temperature: np.ndarray, density: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(compressibility factor, enthalpy J/kg) at temperatures, K, and densities, kg/m3, of arrays of one shape."""
    T = np.asarray(temperature, dtype=float)
    log = {species: _log_function(species, T) for species in (N2, O2, NO, N, O)}
    a, b = np.exp(log[O] - 0.5 * log[O2]), np.exp(log[N] - 0.5 * log[N2])
    k = np.exp(log[NO] - 0.5 * (log[N2] + log[O2]))
    cold = np.asarray(density, dtype=float) * GAS_CONSTANT * T
    nitrogen, oxygen = 2 * NITROGEN_SHARE * cold, 2 * (1 - NITROGEN_SHARE) * cold

    def root(linear: np.ndarray, constant: np.ndarray) -> np.ndarray:
        """Positive z of 2 z^2 + linear z = constant."""
        return 2 * constant / (linear + np.sqrt(linear * linear + 8 * constant))

    # The two elements are coupled by NO alone, which never holds more than a third of the oxygen: this contracts.
    x = root(a, oxygen)
    for _ in range(40):
        y = root(b + k * x, nitrogen)
        x = root(a + k * y, oxygen)
    partial = {N2: y * y, O2: x * x, NO: k * x * y, N: b * y, O: a * x}
    factor = sum(partial.values()) / cold
    enthalpy = sum(share * _enthalpy(species, T) for species, share in partial.items()) / cold
    return factor, GAS_CONSTANT * enthalpy


def behind_normal_shock(pressure: float, temperature: float, speed: float) -> AirState:
    """Equilibrium air behind a normal shock.

    Args:
        pressure: ahead of the shock, Pa.
        temperature: ahead of the shock, K.
        speed: of the air towards the shock, m/s; supersonic.
    """
    from scipy.optimize import brentq

    ahead = equilibrium(temperature, pressure)

    def state(ratio: float) -> AirState:
        """Air that momentum and energy give for a density ratio rho1/rho2."""
        p2 = pressure + ahead.density * speed**2 * (1 - ratio)
        h2 = ahead.enthalpy + speed**2 / 2 * (1 - ratio**2)
        T2 = brentq(lambda T: equilibrium(T, p2).enthalpy - h2, temperature, HIGHEST_TEMPERATURE, xtol=1e-6)
        return equilibrium(T2, p2)

    ratio = brentq(lambda e: ahead.density / state(e).density - e, 0.02, 0.999, xtol=1e-8)
    return state(ratio)


def stagnation(pressure: float, temperature: float, speed: float) -> AirState:
    """Equilibrium air at a blunt body's stagnation point: through a normal shock, then brought to rest isentropically.

    Args:
        pressure: ahead of the shock, Pa.
        temperature: ahead of the shock, K.
        speed: of the air towards the shock, m/s; supersonic.
    """
    from scipy.optimize import brentq

    behind = behind_normal_shock(pressure, temperature, speed)
    total = equilibrium(temperature, pressure).enthalpy + speed**2 / 2

    def state(p: float) -> AirState:
        T = brentq(lambda T: equilibrium(T, p).enthalpy - total, behind.temperature, HIGHEST_TEMPERATURE, xtol=1e-6)
        return equilibrium(T, p)

    return state(brentq(lambda p: state(p).entropy - behind.entropy, behind.pressure, 2 * behind.pressure, rtol=1e-8))


def _log_function(species: Species, T: float | np.ndarray) -> float | np.ndarray:
    """Logarithm of the partition function per volume times kT (Pa), with the energy of formation."""
    translation = 1.5 * np.log(2 * math.pi * species.mass * ATOMIC_MASS_UNIT * c.BOLTZMANN * T / c.PLANCK**2)
    inner = np.log(sum(g * np.exp(-level / T) for g, level in species.levels))
    if species.rotation:
        inner = inner + np.log(T / species.rotation) - np.log1p(-np.exp(-species.vibration / T))
    return translation + inner + np.log(c.BOLTZMANN * T) - species.formation / T


def _enthalpy(species: Species, T: float | np.ndarray) -> float | np.ndarray:
    """Enthalpy of one mole over the gas constant, K."""
    weights = [g * np.exp(-level / T) for g, level in species.levels]
    total = 2.5 * T + sum(w * level for w, (_, level) in zip(weights, species.levels, strict=True)) / sum(weights)
    if species.rotation:
        total = total + T + species.vibration / np.expm1(species.vibration / T)
    return total + species.formation
