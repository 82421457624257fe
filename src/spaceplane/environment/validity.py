"""Whether the air of a flight point may be treated as a continuum and as an ideal gas with constant specific heats."""

from __future__ import annotations

from dataclasses import dataclass

from spaceplane.environment import constants as c
from spaceplane.environment.atmosphere import Ambient
from spaceplane.environment.equilibrium_air import behind_normal_shock, equilibrium

# Knudsen number on the body's length below which slip and rarefaction are neglected (thesis (4.1); Bird 1994).
CONTINUUM_LIMIT = 0.01
# Departure of the compressibility factor from 1 that is taken as ideal.
IDEAL_GAS_LIMIT = 0.01
# Above this temperature vibration takes up heat and the ratio of specific heats falls below 1.4 (Anderson 2006,
# section 9.1).
VIBRATION_TEMPERATURE = 800.0
# Above this temperature at the stagnation point air ionises noticeably, which the equilibrium model leaves out.
IONISATION_TEMPERATURE = 9_000.0

# Fastest shock, m/s, for which the equilibrium model is asked: beyond it ionisation rules.
FASTEST = 8_500.0


@dataclass(frozen=True)
class Validity:
    """What holds at a flight point.

    Attributes:
        knudsen: mean free path over the body's length.
        compressibility_factor: Z = p / (rho R T) behind a normal shock at the free stream's Mach number, in chemical
            equilibrium; 1 in subsonic flight.
        shock_temperature: K behind that shock in equilibrium; the stagnation temperature in subsonic flight.
        ideal_shock_temperature: K behind it with constant specific heats.
        density_ratio_error: how far the ideal gas underestimates the density rise across the shock, as a fraction.
        continuum: Knudsen number below 0.01.
        ideal_gas: Z within 1 % of 1.
        notes: one line for each limit that is passed, and what it means.
    """

    knudsen: float
    compressibility_factor: float
    shock_temperature: float
    ideal_shock_temperature: float
    density_ratio_error: float
    continuum: bool
    ideal_gas: bool
    notes: tuple[str, ...]


def knudsen(ambient: Ambient, length: float) -> float:
    """Mean free path over a length, m."""
    return ambient.mean_free_path / length


def assess_validity(mach: float, ambient: Ambient, length: float) -> Validity:
    """Judge continuum and ideal gas at a flight point.

    The compressibility factor follows from first principles (`spaceplane.environment.equilibrium_air`), in
    equilibrium. A real shock layer at high altitude lags behind equilibrium and lies between the two, so a verdict
    "not ideal" is on the safe side.

    Args:
        mach: Mach number.
        ambient: undisturbed air.
        length: body length, m.
    """
    number = knudsen(ambient, length)
    gamma = c.RATIO_OF_SPECIFIC_HEATS
    notes = []
    if mach > 1.0:
        ideal, ideal_ratio = _ideal_shock(mach, ambient.temperature, gamma)
        factor, temperature, error = 1.0, ideal, 0.0
        # Weak shocks heat the air too little for any chemistry; the iteration would only waste time.
        if ideal > VIBRATION_TEMPERATURE:
            shocked = behind_normal_shock(
                ambient.pressure, ambient.temperature, min(mach * ambient.speed_of_sound, FASTEST)
            )
            factor, temperature = shocked.compressibility_factor, shocked.temperature
            ahead = equilibrium(ambient.temperature, ambient.pressure)
            error = shocked.density / ahead.density / ideal_ratio - 1.0
    else:
        ideal = ambient.temperature * (1 + (gamma - 1) / 2 * mach**2)
        factor, temperature, error = 1.0, ideal, 0.0
    continuum, ideal_gas = number < CONTINUUM_LIMIT, abs(factor - 1.0) < IDEAL_GAS_LIMIT
    if not continuum:
        notes.append(f"Knudsen number {number:.3g} on the length: the air is rarefied, continuum flow does not hold")
    if not ideal_gas:
        notes.append(
            f"oxygen and nitrogen dissociate: Z = {factor:.3f} at {temperature:.0f} K behind a normal shock "
            f"({ideal:.0f} K as an ideal gas), shock density ratio {100 * error:.0f} % above the ideal gas's"
        )
    elif temperature > VIBRATION_TEMPERATURE:
        notes.append(
            f"{temperature:.0f} K behind a normal shock: vibration lowers the ratio of specific heats, shock density "
            f"ratio {100 * error:.1f} % above the ideal gas's"
        )
    if temperature > IONISATION_TEMPERATURE or mach * ambient.speed_of_sound > FASTEST:
        notes.append("ionisation, which the equilibrium model leaves out, matters here")
    return Validity(number, factor, temperature, ideal, error, continuum, ideal_gas, tuple(notes))


def _ideal_shock(mach: float, temperature: float, gamma: float) -> tuple[float, float]:
    """(temperature, K, density ratio) behind a normal shock of a calorically perfect gas."""
    pressure_ratio = 1 + 2 * gamma / (gamma + 1) * (mach**2 - 1)
    density_ratio = (gamma + 1) * mach**2 / (2 + (gamma - 1) * mach**2)
    return temperature * pressure_ratio / density_ratio, density_ratio
