"""MIL-F-8785C 6.2.6: how much roll rate and bank angle oscillate after the aileron moves, and with which phase.

The lateral part of the linear model, rudder fixed, answers a step of the aileron (roll rate) and an impulse (bank
angle). With its first, second and third peak y1 (a maximum), y2 (a minimum), y3 the oscillatory part over average is

    (y1 + y3 - 2 y2) / (y1 + y3 + 2 y2) up to a damping ratio of 0.2,   (y1 - y2) / (y1 + y2) above,

psi_beta is the lag of the Dutch roll's part of the sideslip, -360 deg t_n / T_d + 360 deg (n - 1) for its nth maximum
after an aileron to the right. That part is 2 Re(rho exp(lambda t)) with the residue rho = v_beta (w^H b) / lambda
(times lambda for the impulse) and its maxima lie where lambda t + arg(rho) has the phase -asin(zeta), so that
psi_beta = arg(rho) + asin(zeta): what late maxima of the whole response tend to.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig

from spaceplane.dynamics.statespace import StateSpace
from spaceplane.qualities.roll_step import LATERAL, lateral_part, roll_row, step_states

LIGHT_DAMPING = 0.2  # up to here three peaks count, above it two
PERIODS = 6.0  # that the response is followed for; a slow roll mode puts off the first peak
PER_PERIOD, PER_RATE = 128, 20.0  # times per period, and per 1 / fastest eigenvalue
MOST_DOUBLINGS = 14
MOST_GROWTH = 60.0  # e-fold, that the response is followed for
VISIBLE = 1e-9  # least change between peaks, of the largest: below it lies round-off
EXCITED = 1e-12  # least share of the aileron that reaches the oscillation's sideslip
TURN = 2 * math.pi


@dataclass(frozen=True)
class RollOscillation:
    """Oscillation of roll and its phase; free of the size of the aileron.

    Attributes:
        rate_ratio: p_osc / p_av after a step, ratio; 0 without a second peak; None where the average is not above 0.
        bank_ratio: phi_osc / phi_av after an impulse, likewise.
        rate_phase: psi_beta of the step, rad, above -2 pi and up to 0; None where no sideslip oscillates.
        bank_phase: psi_beta of the impulse, likewise.
        lead: angle by which roll rate leads sideslip in the free oscillation, rad, from 0 up to below 2 pi; None
            where one of them does not move.
        damping_ratio: of the oscillation.
        period: damped, s.
    """

    rate_ratio: float | None
    bank_ratio: float | None
    rate_phase: float | None
    bank_phase: float | None
    lead: float | None
    damping_ratio: float
    period: float


def roll_oscillation(system: StateSpace) -> RollOscillation | None:
    """Oscillation of roll after the aileron.

    Args:
        system: rigid-body linear model with the input "aileron". Of several lateral oscillations the fastest counts.

    Returns:
        The oscillation; None where no aileron rolls, where nothing lateral oscillates, or where an aperiodic
        divergence doubles within a period and hides the peaks.

    Raises:
        InputError: the system lacks a lateral state.
    """
    found = lateral_part(system)
    if found is None:
        return None
    A, b = found
    values, left, right = eig(A, left=True, right=True)
    k = int(np.argmax(values.imag))
    value, w, v = complex(values[k]), left[:, k], right[:, k]
    if value.imag <= 1e-8 * abs(value):
        return None
    zeta, period = -value.real / abs(value), TURN / value.imag
    aperiodic = values[np.abs(values.imag) <= 1e-8 * np.abs(values)].real
    if aperiodic.max(initial=0.0) * period > math.log(2):
        return None
    rate = roll_row(system)
    slip = v[LATERAL.index("beta")]
    residue = slip * np.vdot(w, b) / np.vdot(w, v) / value
    reached = abs(slip * np.vdot(w, b)) > EXCITED * np.linalg.norm(w) * np.linalg.norm(v) * np.linalg.norm(b)
    both = min(abs(slip), abs(rate @ v)) > EXCITED * np.linalg.norm(v)
    end = min(PERIODS * period, MOST_GROWTH / max(values.real.max(), 1e-300))
    step = min(period / PER_PERIOD, 1.0 / (PER_RATE * np.abs(values).max()))
    doublings = min(MOST_DOUBLINGS, math.ceil(math.log2(end / step)))
    step = end / 2**doublings
    stepped = step_states(A, b, step, doublings)
    impulse = A @ stepped + b[:, None]
    bank = LATERAL.index("sigma")
    return RollOscillation(
        rate_ratio=oscillatory_share(peaks(rate @ stepped, rate @ impulse, step), zeta),
        bank_ratio=oscillatory_share(peaks(impulse[bank], A[bank] @ impulse, step), zeta),
        rate_phase=_lag(residue, zeta) if reached else None,
        bank_phase=_lag(residue * value, zeta) if reached else None,
        lead=float(np.angle(rate @ v / slip)) % TURN if both else None,
        damping_ratio=zeta,
        period=period,
    )


def peaks(values: np.ndarray, slopes: np.ndarray, step: float) -> list[float]:
    """The first maximum of a curve, the minimum after it and the maximum after that, as far as they can be seen.

    Args:
        values: [time] of the curve, evenly apart.
        slopes: [time] its derivative, per s.
        step: between times, s.

    Between times the curve is the cubic through values and slopes, exact to the fourth power of the step.
    """
    turns = np.flatnonzero((slopes[:-1] > 0) != (slopes[1:] > 0))
    falls = slopes[turns] > 0  # the curve falls after the turn: a maximum
    first = np.flatnonzero(falls)
    found: list[float] = []
    for k in turns[first[0] : first[0] + 3] if len(first) else ():
        x = slopes[k] / (slopes[k] - slopes[k + 1])
        level = values[k] * (1 + 2 * x) * (1 - x) ** 2 + values[k + 1] * x**2 * (3 - 2 * x)
        bend = step * x * (1 - x) * (slopes[k] * (1 - x) - slopes[k + 1] * x)
        peak = float(level + bend)
        if found and abs(peak - found[-1]) <= VISIBLE * abs(found[0]):
            break
        found.append(peak)
    return found


def oscillatory_share(found: list[float], zeta: float) -> float | None:
    """Oscillatory part over average (6.2.6), ratio; 0 without a second peak, None for an average not above 0.

    Args:
        found: up to three peaks, a maximum first, in any one unit.
        zeta: damping ratio of the oscillation.
    """
    if len(found) < 2:
        return 0.0
    high, low = found[0], found[1]
    if zeta <= LIGHT_DAMPING and len(found) > 2:
        high = 0.5 * (found[0] + found[2])
    return (high - low) / (high + low) if high + low > 0 else None


def _lag(residue: complex, zeta: float) -> float:
    """Phase of the maxima of Re(residue exp(lambda t)), rad, above -2 pi and up to 0."""
    return -((-float(np.angle(residue)) - math.asin(zeta)) % TURN)
