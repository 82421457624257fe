"""Air in chemical equilibrium, from the partition functions of its molecules: N2, O2, NO, N, O.

Rigid rotors, harmonic oscillators and the lowest electronic levels (molecular constants of Huber and Herzberg 1979,
atomic levels of the NIST tables); 79 % nitrogen and 21 % oxygen by volume; no ionisation, which begins to matter near
8000 K. Against the NASA polynomials of the same species (Cantera 3.2, air.yaml) from 1000 to 8000 K at 0.01 and 1 atm,
the compressibility factor differs by up to 0.14 % and the enthalpy above 300 K by up to 0.5 %.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy.optimize import brentq

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
    """

    temperature: float
    pressure: float
    compressibility_factor: float
    enthalpy: float
    density: float
    oxygen_dissociated: float


def equilibrium(temperature: float, pressure: float) -> AirState:
    """Composition, density and enthalpy at a temperature, K, and pressure, Pa."""
    T, p = temperature, pressure
    # Square roots of the equilibrium constants: p_O = a x, p_N = b y, p_NO = k x y with x2 = p_O2, y2 = p_N2.
    a = math.exp(_log_function(O, T) - 0.5 * _log_function(O2, T))
    b = math.exp(_log_function(N, T) - 0.5 * _log_function(N2, T))
    k = math.exp(_log_function(NO, T) - 0.5 * (_log_function(N2, T) + _log_function(O2, T)))

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
    energy = sum(share / cold * _enthalpy(species, T) for species, share in partial.items())
    gas_constant = c.BOLTZMANN / ATOMIC_MASS_UNIT * 1e-3 / _MASS_PER_MOLE
    oxygen = 2 * partial[O2] + partial[NO] + partial[O]
    return AirState(T, p, factor, gas_constant * energy, p / (factor * gas_constant * T), partial[O] / oxygen)


def behind_normal_shock(pressure: float, temperature: float, speed: float) -> AirState:
    """Equilibrium air behind a normal shock.

    Args:
        pressure: ahead of the shock, Pa.
        temperature: ahead of the shock, K.
        speed: of the air towards the shock, m/s; supersonic.
    """
    ahead = equilibrium(temperature, pressure)

    def state(ratio: float) -> AirState:
        """Air that momentum and energy give for a density ratio rho1/rho2."""
        p2 = pressure + ahead.density * speed**2 * (1 - ratio)
        h2 = ahead.enthalpy + speed**2 / 2 * (1 - ratio**2)
        T2 = brentq(lambda T: equilibrium(T, p2).enthalpy - h2, temperature, HIGHEST_TEMPERATURE, xtol=1e-6)
        return equilibrium(T2, p2)

    ratio = brentq(lambda e: ahead.density / state(e).density - e, 0.02, 0.999, xtol=1e-8)
    return state(ratio)


def _log_function(species: Species, T: float) -> float:
    """Logarithm of the partition function per volume times kT (Pa), with the energy of formation."""
    translation = 1.5 * math.log(2 * math.pi * species.mass * ATOMIC_MASS_UNIT * c.BOLTZMANN * T / c.PLANCK**2)
    inner = math.log(sum(g * math.exp(-level / T) for g, level in species.levels))
    if species.rotation:
        inner += math.log(T / species.rotation) - math.log1p(-math.exp(-species.vibration / T))
    return translation + inner + math.log(c.BOLTZMANN * T) - species.formation / T


def _enthalpy(species: Species, T: float) -> float:
    """Enthalpy of one mole over the gas constant, K."""
    weights = [g * math.exp(-level / T) for g, level in species.levels]
    total = 2.5 * T + sum(w * level for w, (_, level) in zip(weights, species.levels, strict=True)) / sum(weights)
    if species.rotation:
        total += T + species.vibration / math.expm1(species.vibration / T)
    return total + species.formation
