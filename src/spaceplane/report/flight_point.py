"""What the report says about one flight point, ready for the template."""

from __future__ import annotations

from markupsafe import Markup

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.report import likelihood
from spaceplane.report.card import absence, yaw_sentence
from spaceplane.report.names import GREEK, STATES, greek, split_derivative, stability, symbol, words
from spaceplane.report.numbers import MINUS, MISSING, Measured, duration, fixed, grouped, is_number, measured, number
from spaceplane.report.plots import convergence_plot, derivative_bars, eigenvalue_planes, eigenvalue_text, phase_clock
from spaceplane.report.read import level_text

LEVEL_CSS = {1: "good", 2: "fair", 3: "poor", "below 3": "bad"}
VERDICT_CSS = {"converged": "good", "oscillating": "fair", "failed": "bad"}
FIGURES = ("CL", "CD", "L_over_D", "Cm_alpha", "Cn_beta", "Cl_beta")
BARS = ("CL_alpha", "CD_alpha", "Cm_alpha", "CY_beta", "Cl_beta", "Cn_beta")


def level_css(level: int | str | None) -> str:
    """Colour class of a level."""
    return LEVEL_CSS.get(level, "")


def point(p: dict) -> dict:
    """Everything the templates show about flight point `p` of result.json."""
    modes = p.get("modes") or []
    verdicts = p.get("verdicts") or []
    return {
        "name": p["name"],
        "summary": f"{fixed(_in(p, 'altitude_m', 1e-3), 1)} km, α {fixed(p.get('alpha_deg'), 1)}°, "
        f"{fixed(p.get('velocity_ms'), 0)} m/s",
        "figures": _figures(p),
        "level_chips": _level_chips(verdicts),
        "absent": _absent(verdicts),
        "yaw": Markup(yaw_sentence(p, symbol("Cn_beta")).replace(" ± ", "&nbsp;±&nbsp;")),
        **_validity(p),
        "alpha_source": p.get("alpha_source") or "",
        **_parts(p),
        "derivative_bars": _derivative_bars(p),
        **_controls(p),
        "planes": Markup(eigenvalue_planes(modes)),
        "modes": [_mode(m) for m in modes],
        **_eigenvectors(p, modes),
        "matrices": _matrices(p),
        "verdict_groups": _verdict_groups(verdicts),
        "airframe_groups": _verdict_groups(p.get("airframe_verdicts") or []),
        "samples": next((v["samples"] for v in verdicts if v.get("samples")), None),
        "convergence": [_convergence(r) for r in p.get("convergence") or []],
    }


def _figures(p: dict) -> list[dict]:
    """Coefficients and derivatives that stand on the card of a flight point, each with its error."""
    found = []
    for name in FIGURES:
        of_point = {key: (p.get(key) or {}).get(name) for key in ("coefficients", "coefficient_errors", "derivatives")}
        derivative = of_point["derivatives"] or {}
        value = derivative.get("value") if derivative else of_point["coefficients"]
        error = derivative.get("error") if derivative else of_point["coefficient_errors"]
        shown = measured(value, error) if is_number(error) and error > 0 else Measured(number(value, 3))
        uncertain = is_number(value) and is_number(error) and abs(value) <= error
        sign = stability(name, value, error) or ("undecided" if uncertain else "")
        found.append({"symbol": Markup(symbol(name)), "m": shown, "sign": sign})
    return found


def _in(record: dict, key: str, factor: float) -> float | None:
    value = record.get(key)
    return value * factor if is_number(value) else None


def criterion_name(criterion: str) -> str:
    """Short name of a criterion: what stands in brackets, if anything does."""
    _, bracket, inner = criterion.partition("(")
    return inner.rstrip(") ") if bracket else criterion


def worst_levels(verdicts: list[dict]) -> dict[str, dict]:
    """For each criterion its worst applicable verdict, of equal ones that over all; the first where none applies."""
    rank = {1: 1, 2: 2, 3: 3, "below 3": 4}

    def badness(v: dict) -> tuple[int, bool]:
        """To sort by."""
        return rank.get(level_of(v), 0), v.get("quantity") == "overall"

    worst: dict[str, dict] = {}
    for v in verdicts:
        name = criterion_name(v.get("criterion") or v["mode"])
        if name not in worst or badness(v) > badness(worst[name]):
            worst[name] = v
    return worst


def level_of(verdict: dict) -> int | str | None:
    """A verdict's level; None where it does not apply."""
    return verdict.get("level") if verdict.get("applicable", True) else None


def _level_chips(verdicts: list[dict]) -> list[dict]:
    chips = []
    for name, v in worst_levels(verdicts).items():
        level = level_of(v)
        if level is None:
            continue
        text = f"{name}: {level_text(level)}{likelihood.certainty(v)}"
        title = v.get("note") or f"{v['mode']}: {v.get('quantity') or v.get('criterion') or ''}"
        chips.append({"css": level_css(level), "text": text, "title": title})
    return chips


def _absent(verdicts: list[dict]) -> list[dict]:
    """Criteria that do not apply, each with a short reason, and the whole note to point at."""
    none = {name: v for name, v in worst_levels(verdicts).items() if level_of(v) is None}
    for v in verdicts:  # of several quantities the one that says what moves instead
        name = criterion_name(v.get("criterion") or v["mode"])
        if name in none and " Instead " in (v.get("note") or ""):
            none[name] = v
    return [
        {"name": name, "reason": absence(v), "title": f"{v.get('paragraph') or ''} {v.get('note') or ''}".strip()}
        for name, v in none.items()
    ]


def _validity(p: dict) -> dict:
    validity = p.get("validity") or {}
    chips = []
    for key, yes, no in (("continuum", "continuum", "not a continuum"), ("ideal_gas", "ideal gas", "real-gas effects")):
        if key in validity and validity[key] is not None:
            chips.append(("good", yes) if validity[key] else ("fair", no))
    return {"validity": chips, "validity_notes": list(validity.get("notes") or [])}


def _parts(p: dict) -> dict:
    by_part = p.get("coefficients_by_part") or {}
    columns = [c for c in FORCES_AND_MOMENTS if any(c in row for row in by_part.values())]
    largest = {c: max((abs(row[c]) for row in by_part.values() if is_number(row.get(c))), default=0.0) for c in columns}
    rows = []
    for part, values in by_part.items():
        cells = []
        for c in columns:
            value = values.get(c)
            share = abs(value) / largest[c] if is_number(value) and largest[c] > 1e-7 else 0.0
            cells.append({"text": fixed(value, 5), "heat": f"{0.22 * share:.3f}"})
        rows.append({"name": words(part), "cells": cells})
    return {"part_rows": rows, "part_symbols": [Markup(symbol(c)) for c in columns]}


def _controls(p: dict) -> dict:
    """Control derivatives as a matrix: a row for each surface, a column for each coefficient."""
    found: dict[str, dict[str, dict]] = {}
    for name, record in (p.get("derivatives") or {}).items():
        parts = split_derivative(name)
        if parts.control:
            found.setdefault(parts.variable, {})[parts.coefficient] = record
    columns = [c for c in FORCES_AND_MOMENTS if any(c in row for row in found.values())]
    rows = []
    for control, row in found.items():
        cells = [measured((row.get(c) or {}).get("value"), (row.get(c) or {}).get("error")) for c in columns]
        step = next((r for r in row.values() if is_number(r.get("step"))), {})
        text = f"step {number(step.get('step'), 3)} {step.get('step_unit') or ''}" if step else ""
        rows.append({"name": words(control), "cells": cells, "title": text})
    return {"control_rows": rows, "control_symbols": [Markup(symbol(c)) for c in columns]}


def _derivative_bars(p: dict) -> list[tuple[Markup, Markup]]:
    found = []
    for name in BARS:
        by_part = ((p.get("derivatives") or {}).get(name) or {}).get("by_part") or {}
        svg = derivative_bars([(words(part), value) for part, value in by_part.items()])
        if svg:
            found.append((Markup(symbol(name)), Markup(svg)))
    return found


def time_text(mode: dict) -> str:
    """Half time or double time in words; a dash for neither."""
    if is_number(mode.get("half_time_s")):
        return f"half {duration(mode['half_time_s'])}"
    if is_number(mode.get("double_time_s")):
        return f"double {duration(mode['double_time_s'])}"
    return MISSING


def _mode(mode: dict) -> dict:
    return {
        "name": mode["name"],
        "grows": mode["eigenvalue"][0] > 0,
        "eigenvalue": eigenvalue_text(mode["eigenvalue"]),
        "period": duration(mode.get("period_s")),
        "time": time_text(mode),
        "damping": number(mode.get("damping_ratio"), 3),
        "frequency": number(mode.get("natural_frequency_rads") if mode["eigenvalue"][1] else None, 3),
        "explanation": greek(mode.get("explanation") or ""),
        "error": likelihood.eigenvalue_error(mode),
        "drivers": likelihood.drivers(mode),
    }


def _eigenvectors(p: dict, modes: list[dict]) -> dict:
    states = p.get("states") or next((list(m["eigenvector"]) for m in modes if m.get("eigenvector")), [])
    rows = []
    for mode in modes:
        vector = mode.get("eigenvector") or {}
        participation = mode.get("participation") or {}
        most = max((share for share in participation.values() if is_number(share)), default=0.0)
        cells = []
        for state in states:
            entry, share = vector.get(state) or {}, participation.get(state) or 0.0
            magnitude, phase = entry.get("magnitude"), entry.get("phase_deg")
            visible = most > 0 and share > 0.02 and is_number(phase)
            cells.append(
                {
                    "clock": Markup(phase_clock(share / most, phase)) if visible else "",
                    "magnitude": number(magnitude, 3),
                    "phase": f"{fixed(phase, 0)}°" if is_number(phase) else "",
                    "heat": f"{0.34 * min(share, 1.0):.3f}",
                    "title": f"{STATES.get(state, (state, ''))[0]}: {number(magnitude, 4)} at {fixed(phase, 1)}°, "
                    f"participation {fixed(100 * share, 1)} %",
                }
            )
        rows.append({"name": mode["name"], "grows": mode["eigenvalue"][0] > 0, "cells": cells})
    shown = any(mode.get("eigenvector") for mode in modes)
    return {
        "form": p.get("form") or "",
        "states": [(GREEK.get(s, s), *STATES.get(s, (s, ""))) for s in states],
        "eigenvectors": rows if shown else [],
    }


def _matrices(p: dict) -> list[dict]:
    """A and B of the linear model with their rows and columns named."""
    states, inputs = p.get("states") or [], p.get("inputs") or []
    found = []
    for name, columns in (("A", states), ("B", inputs)):
        rows = p.get(name) or []
        if rows and len(rows) == len(states):
            named = [
                (GREEK.get(s, s), [(number(v, 3), v == 0) for v in row]) for s, row in zip(states, rows, strict=True)
            ]
            found.append({"name": name, "columns": [GREEK.get(c, words(c)) for c in columns], "rows": named})
    return found


def _verdict_groups(verdicts: list[dict]) -> list[dict]:
    """Verdicts under their criterion, with paragraph, class and category said once."""
    groups: dict[tuple, list[dict]] = {}
    for v in verdicts:
        key = tuple(v.get(k) or "" for k in ("criterion", "paragraph", "vehicle_class", "category"))
        groups.setdefault(key, []).append(_verdict(v))
    return [
        {"criterion": c, "paragraph": p, "vehicle_class": k, "category": a, "rows": rows}
        for (c, p, k, a), rows in groups.items()
    ]


def _verdict(v: dict) -> dict:
    limits = v.get("limits") or {}
    margin = v.get("margin")
    return {
        "mode": v["mode"],
        "quantity": _pretty(v.get("quantity") or ""),
        "value": number(v.get("value"), 4),
        "unit": _pretty(v.get("unit") or "") if is_number(v.get("value")) else "",
        "limits": [_limit(limits.get(k)) for k in ("1", "2", "3")],
        "chip": likelihood.outcome_chip(v),
        "chances": likelihood.chances(v),
        "chance_text": likelihood.chance_text(v),
        "asked": likelihood.asked(limits),
        "margin": f"{'+' if margin > 0 else ''}{number(margin, 3)}" if is_number(margin) else MISSING,
        "inside": is_number(margin) and margin >= 0,
        "note": _pretty(v.get("note") or ""),
    }


def _pretty(text: str) -> str:
    """Plain-text formulas with Greek letters and powers."""
    for plain, sign in (("omega", "ω"), ("n/alpha", "n/α"), ("^2", "²"), (" s2", " s²"), ("zeta", "ζ"), ("_beta", "β")):
        text = text.replace(plain, sign)
    return text


def _limit(limit: object) -> str:
    """A limit as it is given, text or number."""
    return limit.replace(">=", "≥").replace("<=", "≤") if isinstance(limit, str) else number(limit, 3)


def _convergence(record: dict) -> dict:
    spread = record.get("window_spread") or {}
    pieces = [
        f"M {number(record.get('mach'), 3)}, α {fixed(record.get('alpha_deg'), 2)}°, "
        f"β {fixed(record.get('beta_deg'), 1)}°",
        f"{fixed(record.get('residual_drop'), 1)} decades in {grouped(record.get('iterations'))} iterations",
    ]
    if any(is_number(v) for v in spread.values()):
        pieces.append("forces within " + ", ".join(f"{k} ±{number(v, 2)}" for k, v in spread.items()))
    if record.get("reason"):
        pieces.append(record["reason"])
    return {
        "label": words(record.get("label") or "").replace("-", MINUS),
        "verdict": record.get("verdict") or "",
        "css": VERDICT_CSS.get(record.get("verdict"), ""),
        "svg": Markup(convergence_plot(record)),
        "text": " · ".join(pieces),
    }
