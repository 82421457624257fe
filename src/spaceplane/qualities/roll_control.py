"""MIL-F-8785C 3.3.2.2 to 3.3.2.4, 3.3.4: roll rate, sideslip and time to bank after a step of the aileron.

The lateral part of the linear model (p, r, beta, sigma) answers a step to the limit of the aileron, rudder fixed; the
longitudinal motion is held. The response is exact for the linear system (matrix exponential); for bank angles of 30
to 60 deg it is its extrapolation. Roll rate is that about the velocity, p cos(alpha) + r sin(alpha), which at the
angles of attack of an entry is what turns the lift.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spaceplane.dynamics.statespace import StateSpace
from spaceplane.errors import InputError
from spaceplane.qualities import limits, roll_figures
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.roll_oscillation import RollOscillation, roll_oscillation
from spaceplane.qualities.roll_step import lateral_part, roll_row, step_states
from spaceplane.qualities.verdict import (
    AIRFRAME,
    BELOW,
    Context,
    Level,
    Verdict,
    least_text,
    level_of_least,
    level_of_most,
    most_text,
)

STEP = 0.02  # s
DOUBLINGS = 10  # 1024 steps, 20.5 s
LEAST_WINDOW = 2.0  # s of 3.3.2.4
SMALL_SIDESLIP = "sideslip per k of small inputs"
NO_AILERON = "not applicable: no aileron with a rolling moment is known"


@dataclass(frozen=True)
class RollResponse:
    """Answer of the lateral motion to a step of the aileron to the right.

    Attributes:
        time: [step] s, from 0.
        rate: [step] roll rate about the velocity, rad/s.
        bank: [step] change of the bank angle, rad.
        sideslip: [step] change of the sideslip, rad; right positive.
        half_period: s, of the fastest lateral oscillation; None if there is none.
    """

    time: np.ndarray
    rate: np.ndarray
    bank: np.ndarray
    sideslip: np.ndarray
    half_period: float | None

    def time_to_bank(self, angle: float) -> float | None:
        """Time, s, until the bank angle has changed by `angle`, rad; None if it does not within the response."""
        beyond = np.flatnonzero(self.bank >= angle)
        if not len(beyond):
            return None
        k = int(beyond[0])
        share = (angle - self.bank[k - 1]) / (self.bank[k] - self.bank[k - 1])
        return float(self.time[k - 1] + share * (self.time[k] - self.time[k - 1]))

    def bank_at(self, time: float) -> float:
        """Change of the bank angle, rad, after a time, s."""
        return float(np.interp(time, self.time, self.bank))

    def window(self) -> float:
        """Time, s, within which sideslip counts: half a period of the oscillation, 2 s at least."""
        return max(LEAST_WINDOW, self.half_period or 0.0)

    def oscillation(self) -> float:
        """Roll rate at the first minimum after the first peak, as a ratio to that at the peak; 1 without a minimum."""
        turns = np.diff(np.sign(np.diff(self.rate)))
        peaks = np.flatnonzero(turns < 0) + 1
        if not len(peaks):
            return 1.0
        troughs = np.flatnonzero(turns > 0) + 1
        troughs = troughs[troughs > peaks[0]]
        return float(self.rate[troughs[0]] / self.rate[peaks[0]]) if len(troughs) else 1.0


def roll_response(system: StateSpace, aileron: float) -> RollResponse | None:
    """Answer of the lateral states to a step of the aileron, rad, in the sense that rolls to the right.

    Args:
        system: rigid-body linear model with the input "aileron".
        aileron: size of the step, rad, above 0.

    Returns:
        The response, or None where no aileron rolls.

    Raises:
        InputError: the step is not a positive number, or the system lacks a lateral state.
    """
    if not (math.isfinite(aileron) and aileron > 0):
        raise InputError(f"aileron = {aileron}: must be a step above 0 rad")
    found = lateral_part(system)
    if found is None:
        return None
    states = aileron * step_states(*found, STEP, DOUBLINGS)
    swings = [value.imag for value in np.linalg.eigvals(found[0]) if value.imag > 1e-8]
    return RollResponse(
        time=STEP * np.arange(states.shape[1]),
        rate=roll_row(system) @ states,
        bank=states[3],
        sideslip=states[2],
        half_period=math.pi / max(swings) if swings else None,
    )


def requirement(context: Context, speed_range: str) -> tuple[float, Sequence[float]]:
    """(bank angle, rad; longest times, s, at levels 1 to 3) of table IX; some classes ask by the speed range."""
    entry = limits.specification()["roll_control"][context.category][context.vehicle_class]
    times = entry.get("time_s") or entry.get(speed_range) or entry["L"]  # class III knows no VL, which is below its L
    bank = entry["bank_deg"]
    return math.radians(bank[speed_range] if isinstance(bank, dict) else bank), times


def verdicts(airframe: Airframe, system: StateSpace, context: Context) -> list[Verdict]:
    """Roll rate and bank angle oscillations, sideslip of large and small inputs, time to bank."""
    quantities = (
        ("roll_rate_oscillation", "roll rate at first minimum over first peak"),
        ("sideslip_excursion", "adverse sideslip per k"),
        ("sideslip_excursion", "proverse sideslip per k"),
        ("sideslip_excursion_small", SMALL_SIDESLIP),
        ("roll_control", "time to bank"),
    )
    limit = airframe.aileron_limit()
    known = "aileron" in airframe.derivatives.available_controls()
    response = roll_response(system, limit) if known and limit > 0 else None
    if response is None:
        note = NO_AILERON if limit > 0 else "not applicable: the elevator leaves no aileron"
        silent = [context.verdict(key, AIRFRAME, quantity, applicable=False, note=note) for key, quantity in quantities]
        return [silent[0], *roll_figures.verdicts(system, context, note), *silent[1:]]
    wanted = requirement(context, airframe.speed_range)
    return [
        _oscillation(response, context),
        *roll_figures.verdicts(system, context),
        *(_sideslip(response, side, wanted, context) for side in ("adverse", "proverse")),
        _small_sideslip(response, roll_oscillation(system), wanted, context),
        _time_to_bank(response, wanted, limit, airframe.speed_range, context),
    ]


def _oscillation(response: RollResponse, context: Context) -> Verdict:
    lows = [*limits.specification()["roll_rate_oscillation"][context.category], None]
    value = response.oscillation()
    return context.verdict(
        "roll_rate_oscillation",
        AIRFRAME,
        "roll rate at first minimum over first peak",
        value=value,
        limits=least_text(lows),
        level=level_of_least(value, lows),
        margin=value - lows[0],
        note="no minimum follows the first peak" if value == 1.0 else "step of the aileron, rudder fixed",
    )


def _sideslip(response: RollResponse, side: str, wanted: tuple[float, Sequence[float]], context: Context) -> Verdict:
    quantity = f"{side} sideslip per k"
    angle, times = wanted
    highs = limits.specification()["sideslip_excursion"][context.category][side]
    window = response.window()
    within = response.sideslip[response.time <= window + 1e-9]
    excursion = math.degrees(max(0.0, within.max() if side == "adverse" else -within.min()))
    ratios = [response.bank_at(time) / angle for time in times[:2]]
    level: Level = BELOW if min(ratios) <= 0 else 3
    for k in (1, 0):
        if ratios[k] > 0 and excursion / ratios[k] <= highs[k]:
            level = k + 1
    value = excursion / ratios[0] if ratios[0] > 0 else None
    return context.verdict(
        "sideslip_excursion",
        AIRFRAME,
        quantity,
        value=value,
        unit="deg",
        limits=most_text([*highs, None]),
        level=level,
        margin=None if value is None else highs[0] - value,
        note=f"within {window:.3g} s of the step, rudder fixed; k = {ratios[0]:.3g} at level 1"
        + ("" if ratios[0] > 0 else ": the vehicle rolls against the aileron"),
    )


def _small_sideslip(
    response: RollResponse, found: RollOscillation | None, wanted: tuple[float, Sequence[float]], context: Context
) -> Verdict:
    """The value of figure 6 without a verdict; in the linear model it does not depend on the size of the step."""
    angle, times = wanted
    k = response.bank_at(times[0]) / angle
    within = response.sideslip[response.time <= response.window() + 1e-9]
    notes = ["not judged: figure 6 is in no public copy that could be read"]
    if found is not None and found.rate_phase is not None:
        notes.append(f"ψ_beta {math.degrees(found.rate_phase):.0f} deg")
    return context.verdict(
        "sideslip_excursion_small",
        AIRFRAME,
        SMALL_SIDESLIP,
        value=math.degrees(np.ptp(within)) / k if k > 0 else None,
        unit="deg",
        applicable=False,
        note="; ".join(notes),
    )


def _time_to_bank(
    response: RollResponse,
    wanted: tuple[float, Sequence[float]],
    aileron: float,
    speed_range: str,
    context: Context,
) -> Verdict:
    angle, highs = wanted
    quantity = f"time to bank by {math.degrees(angle):.0f} deg"
    value = response.time_to_bank(angle)
    notes = [f"aileron {math.degrees(aileron):.3g} deg at once, rudder fixed"]
    if context.vehicle_class in ("III", "IV"):
        notes.append(f"speed range {speed_range}")
    if value is None:
        reverses = response.bank_at(highs[2]) < 0
        notes.append("rolls against the aileron" if reverses else f"not within {response.time[-1]:.3g} s")
    return context.verdict(
        "roll_control",
        AIRFRAME,
        quantity,
        value=value,
        unit="s",
        limits=most_text(highs),
        level=BELOW if value is None else level_of_most(value, highs),
        margin=None if value is None else highs[0] - value,
        note="; ".join(notes),
    )
