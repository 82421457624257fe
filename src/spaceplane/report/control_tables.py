"""What the controls of a flight point can do and are asked to do, summed up from its record for tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from spaceplane.report.flight_point import level_css, level_of, worst_levels
from spaceplane.report.numbers import fixed, is_number
from spaceplane.report.read import level_text

AXES = {"moment_x": "roll", "moment_y": "pitch", "moment_z": "yaw"}
PAIRS = {"elevon": "elevons", "rudder": "rudders"}
FARTHEST = 90.0
"""deg: an offset beyond this is no statement about flight any more."""


@dataclass(frozen=True)
class Asked:
    """The most that some disturbances ask of a pair of surfaces or of a thruster.

    Attributes:
        name: such as elevons or roll thruster.
        thruster: whether it is one.
        least, greatest: deg or kN m.
        margin: deg to the nearer limit, negative beyond it; None for a thruster.
        rate: greatest, deg/s; None for a thruster.
    """

    name: str
    thruster: bool
    least: float
    greatest: float
    margin: float | None = None
    rate: float | None = None


def input_name(name: str) -> str:
    """An input in words, such as `roll thruster` for moment_x."""
    return f"{AXES[name]} thruster" if name in AXES else name.replace("_", " ")


def asked(disturbances: Sequence[dict]) -> list[Asked]:
    """Peaks over the disturbances: pairs of surfaces together, then thrusters.

    Args:
        disturbances: of `control_record`.
    """
    groups: dict[str, list[dict]] = {}
    for one in disturbances:
        for effort in one["efforts"]:
            name = effort["name"]
            key = input_name(name) if name in AXES else PAIRS.get(name.partition("_")[0], name)
            groups.setdefault(key, []).append(effort)
    return [_peaks(name, efforts) for name, efforts in groups.items()]


def _peaks(name: str, efforts: Sequence[dict]) -> Asked:
    thruster = efforts[0]["unit"] != "deg"
    factor = 1e-3 if thruster else 1.0
    least, greatest = min(e["least"] for e in efforts), max(e["greatest"] for e in efforts)
    if thruster:
        return Asked(name, True, factor * least, factor * greatest)
    return Asked(name, False, least, greatest, min(map(_margin, efforts)), max(e["rate"] for e in efforts))


def _margin(effort: dict) -> float:
    """What is left to the nearer limit, deg; a rudder standing at its inboard stop has all its travel left."""
    if effort["name"].startswith("rudder") and effort["least"] >= effort["low"]:
        return effort["high"] - effort["greatest"]
    return effort["margin"]


def range_text(one: Asked) -> str:
    """Least to greatest; one number where they are alike."""
    least, greatest = fixed(one.least, 1), fixed(one.greatest, 1)
    return least if least == greatest else f"{least} to {greatest}"


def supplied(disturbances: Sequence[dict]) -> dict[str, float]:
    """Where surfaces saturate: {thruster: greatest moment, kN m, that supplies what they lack}."""
    found: dict[str, float] = {}
    for one in disturbances:
        for moment, value in one["thrusters_Nm"].items():
            key = input_name(moment)
            found[key] = max(found.get(key, 0.0), value / 1e3)
    return found


def supplied_text(record: dict) -> str:
    """Thruster moments for saturated surfaces in words; `none` where no surface saturates."""
    found = supplied(record["disturbances"])
    lost = any(one["lost"] for one in record["disturbances"])
    text = ", ".join(f"{name.removesuffix(' thruster')} {value:.3g} kN m" for name, value in found.items())
    return f"{text}; lost" if lost else text or "none"


def within_text(record: dict) -> str:
    """Whether surfaces stay within their limits; a dash where none is used."""
    return {True: "yes", False: "no", None: "–"}[record["within"]]


def worst_text(verdicts: Sequence[dict]) -> str:
    """The worst level on a mode and the criteria that have it; a dash where none applies."""
    order = {1: 1, 2: 2, 3: 3, "below 3": 4}
    found = {name: level_of(v) for name, v in worst_levels(list(verdicts)).items()}
    worst = max(found.values(), key=lambda level: order.get(level, 0), default=None)
    names = [name for name, level in found.items() if level == worst]
    return f"{level_text(worst)} ({', '.join(names)})" if worst in order else "–"


def level_chip(verdict: dict | None) -> dict[str, str]:
    """A level in words with its colour class."""
    level = level_of(verdict) if verdict else None
    return {"text": "n/a" if level is None else level_text(level), "css": level_css(level)}


def held_text(record: dict, axis: str) -> str:
    """The offset that surfaces hold, deg; a dash where no surface acts on its axis."""
    if axis not in record["held_deg"]:
        return "–"
    low, high = record["held_deg"][axis]
    if all(not is_number(value) or abs(value) > FARTHEST for value in (low, high)):
        return "any"
    return " to ".join(
        f"{value:.3g}".replace("-", "−") if is_number(value) and abs(value) <= FARTHEST else "any"
        for value in (low, high)
    )


def inputs_text(record: dict) -> str:
    """Which inputs the feedback uses and why, in one or two sentences."""
    surfaces = ", ".join(record["surfaces"]) or "no surface"
    why = [f"{AXES[moment]} ({reason})" for moment, reason in record["thrusters"].items()]
    text = f"The feedback uses {surfaces}"
    return f"{text}; thrusters stand in about {' and '.join(why)}." if why else f"{text}."


def unknown_text(record: dict) -> str:
    """What the linear model does not know; empty where nothing is missing."""
    names = record["unknown"]
    return f"Unknown and zero in the model: the damping {', '.join(names)}." if names else ""


def open_verdicts(verdicts: Sequence[dict]) -> list[dict]:
    """Verdicts on modes among all."""
    return [one for one in verdicts if one.get("mode") != "airframe"]
