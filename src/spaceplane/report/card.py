"""Short sentences on the card of a flight point: why a criterion does not apply, and whether yaw is stable."""

from __future__ import annotations

from spaceplane.qualities.probability import per_cent
from spaceplane.report.names import stability
from spaceplane.report.numbers import is_number, measured, number

SHOWN = 2
YAW = {
    "stable": ("Stable in yaw", ""),
    "unstable": ("Unstable in yaw", ""),
    "undecided": ("Stable or unstable in yaw is open", ", and zero lies within the error"),
}


def absence(verdict: dict) -> str:
    """Why a criterion does not apply, short: what moves instead, or how likely it arises within the errors."""
    note = verdict.get("note") or ""
    _, instead, rest = note.partition(" Instead ")
    if instead:
        names = list(dict.fromkeys(piece.partition(":")[0].strip() for piece in rest.split(";")))
        more = " and more" if len(names) > SHOWN else ""
        return f"{' and '.join(names[:SHOWN])}{more} instead"
    if note.startswith("not applicable at the nominal"):
        share = 1.0 - (verdict.get("probabilities") or {}).get("not applicable", 1.0)
        return f"arises with {per_cent(share)} within the errors"
    reason = note.removeprefix("not applicable: ").rstrip(".")
    return "no such mode" if reason.startswith("no ") and verdict.get("mode", "") in reason else reason


def yaw_sentence(point: dict, name: str = "Cn_beta") -> str:
    """Whether a flight point is stable in yaw, one sentence with the error; empty where it is not known.

    Args:
        point: of result.json.
        name: how to write the derivative, C_n by sideslip per rad.
    """
    record = (point.get("derivatives") or {}).get("Cn_beta") or {}
    value, error = record.get("value"), record.get("error")
    if not is_number(value) or value == 0.0:
        return ""
    known = is_number(error) and error > 0.0
    start, end = YAW[stability("Cn_beta", value, error if known else None)]
    text = str(measured(value, error)) if known else number(value, 3)
    return f"{start}: {name} = {text} per rad{end}."
