"""How the report shows uncertainty: probabilities of levels, errors of eigenvalues, what drives a mode."""

from __future__ import annotations

from markupsafe import Markup

from spaceplane.report.names import symbol
from spaceplane.report.numbers import MINUS, fixed, is_number, number
from spaceplane.report.read import level_text

OUTCOME_CSS = {
    "1": "good",
    "met": "good",
    "2": "fair",
    "3": "poor",
    "below 3": "bad",
    "not met": "bad",
    "not applicable": "none",
}
SHOWN_DRIVERS = 3


def outcome_chip(verdict: dict) -> dict:
    """Colour class and text of a verdict: its level, or whether it is met where it knows no levels."""
    level, met = verdict.get("level"), verdict.get("met")
    if not verdict.get("applicable", True) or (level is None and met is None):
        return {"css": "", "text": level_text(None)}
    if level is None:
        return {"css": OUTCOME_CSS["met" if met else "not met"], "text": "met" if met else "not met"}
    return {"css": OUTCOME_CSS[str(level)], "text": level_text(level)}


def chances(verdict: dict) -> list[dict]:
    """Segments of the bar of a verdict's probabilities, best outcome first; empty where one outcome is certain."""
    found = verdict.get("probabilities") or {}
    if len(found) < 2:
        return []
    return [
        {"css": css, "width": f"{100 * found[name]:.2f}", "title": f"{_said(name)}: {fixed(100 * found[name], 1)} %"}
        for name, css in OUTCOME_CSS.items()
        if found.get(name)
    ]


def chance_text(verdict: dict) -> str:
    """Such as `level 2 with 87 % ± 2 % (level 1: 11 %, ...)`; empty where one outcome is certain."""
    if len(verdict.get("probabilities") or {}) < 2:
        return ""
    text, error = verdict.get("probability_text") or "", verdict.get("probability_error")
    head, percent, rest = text.partition(" %")
    return f"{head} ± {fixed(100 * error, 0)}{percent}{rest}" if is_number(error) and error >= 0.005 else text


def certainty(verdict: dict) -> str:
    """Such as ` (87 %)` for the level that is stated; empty where it is all but certain, unknown or not applicable."""
    level = verdict.get("level") if verdict.get("applicable", True) else None
    share = (verdict.get("probabilities") or {}).get(str(level))
    return f" ({fixed(100 * share, 0)} %)" if level is not None and share is not None and share < 0.995 else ""


def eigenvalue_error(mode: dict) -> str:
    """Errors of real and imaginary part; empty without."""
    error = mode.get("eigenvalue_error")
    if not error or not all(is_number(e) for e in error):
        return ""
    real, imaginary = (number(e, 2) for e in error)
    return f"± {real} ± {imaginary}i" if mode["eigenvalue"][1] else f"± {real}"


def drivers(mode: dict) -> Markup:
    """What makes a mode uncertain or, without errors, moves it most by one per cent each; empty where unknown."""
    found = mode.get("drivers") or []
    if not found:
        return Markup("")
    uncertain = any(d.get("error") for d in found)
    said = "uncertain by" if uncertain else "moved most by"
    parts = [f"{symbol(d['parameter'])} {fixed(100 * d['share'], 0)} %" for d in found[:SHOWN_DRIVERS]]
    return Markup(f"{said} {', '.join(parts)}")


def asked(limits: dict) -> str:
    """Limits of a verdict on one line: of each level, or the one that there is."""
    if "met" in limits:
        return _pretty(limits["met"])
    texts = [str(limits[k]) for k in ("1", "2", "3") if limits.get(k) is not None]
    if len(set(texts)) <= 1:
        return _pretty(texts[0]) if texts else ""
    return "; ".join(f"{k}: {_pretty(text)}" for k, text in zip("123", texts, strict=False))


def _pretty(text: str) -> str:
    return text.replace(">=", "≥").replace("<=", "≤").replace("-", MINUS)


def _said(name: str) -> str:
    return f"level {name}" if name in "123" else name
