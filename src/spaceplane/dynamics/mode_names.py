"""Names of eigenmodes by what takes part in them.

A textbook name is given only where the motion is the textbook's: a short period and a phugoid are oscillations, the
second about an angle of attack that the vehicle holds, a Dutch roll is an
oscillation in which yawing leads rolling, a roll mode is stable, and a growing aperiodic motion is called a divergence
of what moves (a slow spiral excepted, which may diverge under its own name).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

PITCH = ("q", "alpha", "w")
PATH = ("V", "u", "gamma", "theta", "R", "h")
HEIGHT = ("R", "h")
SPEED = ("V", "u")
ROLL = ("p",)
BANK = ("sigma", "phi")
YAW = ("r",)
SIDESLIP = ("beta", "v")
LATERAL = (*ROLL, *BANK, *YAW, *SIDESLIP, "psi", "chi")

# A motion belongs to a group when the group holds this share of the participation.
DOMINANT = 0.75
# Sideslip or bank take part when they hold this share.
NOTICEABLE = 0.15
# A bank-dominated divergence faster than level 3 of MIL-F-8785C 3.3.1.3 (4 s to double) is no spiral.
FASTEST_SPIRAL = math.log(2.0) / 4.0

PITCH_APERIODIC = ("pitch_aperiodic", "pitch_speed_aperiodic")

KINDS = {
    "short_period": "short period",
    "phugoid": "phugoid",
    "path_oscillation": "speed-and-path oscillation",
    "third_oscillation": "third oscillation (pitch and speed)",
    "dutch_roll": "Dutch roll",
    "lateral_oscillation": "lateral oscillation (roll and sideslip)",
    "roll_spiral_oscillation": "coupled roll-spiral oscillation",
    "coupled_oscillation": "pitch/roll oscillation",
    "roll": "roll mode",
    "spiral": "spiral",
    "height": "height mode",
    "neutral": "neutral mode",
    "pitch_aperiodic": "aperiodic pitch",
    "pitch_speed_aperiodic": "aperiodic pitch-and-speed",
    "path_aperiodic": "aperiodic speed-and-path",
    "roll_aperiodic": "aperiodic roll",
    "yaw_aperiodic": "aperiodic yaw",
    "roll_yaw_aperiodic": "aperiodic roll/yaw",
    "coupled_aperiodic": "aperiodic pitch/roll",
}


@dataclass(frozen=True)
class Naming:
    """What a mode is called and why.

    Attributes:
        name: such as lateral oscillation.
        kind: key of the name in `KINDS`.
        group: longitudinal, lateral or coupled.
        explanation: the reason, in words.
    """

    name: str
    kind: str
    group: str
    explanation: str


def name_mode(eigenvalue: complex, participation: Mapping[str, float]) -> Naming:
    """Name a mode.

    Args:
        eigenvalue: 1/s; a zero imaginary part means aperiodic.
        participation: share of each state, adding to 1.
    """
    shares = {key: _share(participation, states) for key, states in _GROUPS.items()}
    group = _group(shares)
    if eigenvalue == 0:
        kind, tail = "neutral", ""
    elif eigenvalue.imag != 0:
        kind, tail = _oscillation(group, shares), ""
    else:
        kind, tail = _aperiodic(eigenvalue.real, group, shares)
    name = KINDS[kind] + tail
    return Naming(name, kind, group, _explain(eigenvalue, participation, group))


_GROUPS = {
    "pitch": PITCH,
    "path": PATH,
    "height": HEIGHT,
    "speed": SPEED,
    "lateral": LATERAL,
    "roll": ROLL,
    "bank": BANK,
    "yaw": YAW,
    "sideslip": SIDESLIP,
}


def _share(participation: Mapping[str, float], states: tuple[str, ...]) -> float:
    return float(sum(participation.get(state, 0.0) for state in states))


def _group(shares: Mapping[str, float]) -> str:
    if shares["lateral"] >= DOMINANT:
        return "lateral"
    if shares["pitch"] + shares["path"] >= DOMINANT:
        return "longitudinal"
    return "coupled"


def _oscillation(group: str, shares: Mapping[str, float]) -> str:
    if group == "coupled":
        return "coupled_oscillation"
    if group == "longitudinal":
        longitudinal = shares["pitch"] + shares["path"]
        if shares["pitch"] >= DOMINANT * longitudinal:
            return "short_period"
        return "phugoid" if shares["path"] >= DOMINANT * longitudinal else "third_oscillation"
    if shares["bank"] >= NOTICEABLE > shares["sideslip"]:
        return "roll_spiral_oscillation"
    return (
        "dutch_roll" if shares["yaw"] >= shares["roll"] and shares["sideslip"] >= NOTICEABLE else "lateral_oscillation"
    )


def _aperiodic(growth: float, group: str, shares: Mapping[str, float]) -> tuple[str, str]:
    """(kind, rest of the name)."""
    tail = " divergence" if growth > 0 else " subsidence"
    if group == "coupled":
        return "coupled_aperiodic", tail
    if group == "longitudinal":
        longitudinal = shares["pitch"] + shares["path"]
        if shares["pitch"] >= DOMINANT * longitudinal:
            return "pitch_aperiodic", tail
        if shares["path"] < DOMINANT * longitudinal:
            return "pitch_speed_aperiodic", tail
        return ("height", "") if shares["height"] >= 0.5 else ("path_aperiodic", tail)
    if shares["bank"] >= max(shares["roll"], shares["yaw"], shares["sideslip"]) and growth < FASTEST_SPIRAL:
        return "spiral", ""
    if shares["roll"] >= 0.5 and shares["sideslip"] < NOTICEABLE:
        return ("roll", "") if growth < 0 else ("roll_aperiodic", tail)
    return ("yaw_aperiodic", tail) if shares["sideslip"] >= NOTICEABLE else ("roll_yaw_aperiodic", tail)


def without_pitch_stiffness(naming: Naming) -> Naming:
    """The name where the vehicle diverges in pitch: a phugoid needs an angle of attack that is held, so it is none
    there."""
    if naming.kind != "phugoid":
        return naming
    reason = (
        f"{naming.explanation}; no phugoid, since the vehicle diverges in pitch and nothing holds its angle of attack"
    )
    return replace(naming, name=KINDS["path_oscillation"], kind="path_oscillation", explanation=reason)


def _explain(eigenvalue: complex, participation: Mapping[str, float], group: str) -> str:
    leading = sorted(participation.items(), key=lambda item: -item[1])
    parts = ", ".join(f"{state} {100 * share:.0f} %" for state, share in leading if share >= 0.05)
    if eigenvalue == 0:
        motion = "neither grows nor decays"
    elif eigenvalue.imag != 0:
        motion = f"oscillates with a period of {2 * math.pi / eigenvalue.imag:.3g} s and "
        motion += _growth(eigenvalue.real)
    else:
        motion = f"does not oscillate and {_growth(eigenvalue.real)}"
    return f"{group}: it {motion}; taking part: {parts}"


def _growth(growth: float) -> str:
    if growth == 0:
        return "keeps its amplitude"
    time = math.log(2) / abs(growth)
    return f"doubles in {time:.3g} s" if growth > 0 else f"halves in {time:.3g} s"
