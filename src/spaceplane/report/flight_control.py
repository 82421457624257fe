"""What the report says of control at one flight point, ready for the template."""

from __future__ import annotations

from markupsafe import Markup

from spaceplane.report import control_tables as say
from spaceplane.report.control_plots import response_plot
from spaceplane.report.names import GREEK
from spaceplane.report.numbers import MISSING, duration, fixed, number
from spaceplane.report.plots import eigenvalue_text


def control(p: dict) -> dict | None:
    """Everything the template shows of control at flight point `p` of result.json; None where nothing is known.

    Results of earlier versions have no record of it.
    """
    record = p.get("control")
    if not record:
        return None
    return {
        "reason": record["reason"],
        "inputs": say.inputs_text(record) if record["modes"] else "",
        "unknown": say.unknown_text(record),
        "facts": _facts(record) if record["modes"] else [],
        **_modes(record),
        **_demands(record),
        "levels": _levels(p, record),
        "closed_modes": [_closed(mode) for mode in record["closed_loop"]["modes"]],
        "responses": [
            {"name": one["name"], "svg": Markup(response_plot(one))} for one in record.get("responses") or []
        ],
    }


def _facts(record: dict) -> list[tuple[str, str]]:
    energy, degrees = record["energy_s"], f"{record['settings']['offset_deg']:.3g}"
    alone, lost = record["states_moved_by_surfaces"], record["uncontrolled_by_surfaces"]
    rows = [
        ("States that all inputs move", f"{record['states_moved']} of {record['states']}"),
        ("States that the surfaces alone move", f"{alone} of {record['states']}"),
        ("Modes out of reach of the surfaces", ", ".join(lost) or "none"),
    ]
    rows += [
        (f"Largest offset in {GREEK[axis]} that the surfaces hold", f"{say.held_text(record, axis)} deg")
        for axis in record["held_deg"]
        if say.held_text(record, axis) != "any"
    ]
    rows += [
        (f"Least energy for {degrees}° of {GREEK[axis]}", f"{number(value, 2)} s") for axis, value in energy.items()
    ]
    return rows


def _modes(record: dict) -> dict:
    """What each input can do to each mode."""
    names = list(dict.fromkeys(name for mode in record["modes"] for name in mode["reach"]))
    rows = []
    for mode in record["modes"]:
        best = max(mode["share"], key=mode["share"].get) if any(mode["share"].values()) else ""
        cells = [{"text": number(mode["reach"].get(name), 3), "best": name == best} for name in names]
        rows.append(
            {
                "name": mode["name"],
                "grows": mode["growing"],
                "eigenvalue": eigenvalue_text(mode["eigenvalue"]),
                "double": duration(mode["double_time_s"]) if mode["growing"] else MISSING,
                "state": GREEK.get(mode["state"], mode["state"]),
                "unit": mode["unit"],
                "cells": cells,
                "distance": number(mode["distance_by_surfaces"], 2),
            }
        )
    return {"input_names": [say.input_name(name) for name in names], "mode_rows": rows}


def _demands(record: dict) -> dict:
    """A row for each disturbance, with the peaks of every pair of surfaces and thruster."""
    kinds = {one.name: one for one in say.asked(record["disturbances"])}
    rows = []
    for event in record["disturbances"]:
        peaks = {one.name: one for one in say.asked([event])}
        lacking = say.supplied_text({"disturbances": [event]})
        cells = [text for name, one in kinds.items() for text in _peaks(peaks.get(name), one.thruster)]
        rows.append({"name": event["name"], "cells": cells, "supplied": lacking, "within": event["within"]})
    heads = []
    for name, one in kinds.items():
        heads += [f"{name}, kN m"] if one.thruster else [f"{name}, deg", "to the limit", "rate, deg/s"]
    settings = record["settings"]
    return {
        "demand_heads": heads,
        "demand_rows": rows,
        "judged": bool(record["surfaces"]),
        "rate_limit": f"{settings['rate_limit_degs']:.3g}",
        "thruster": f"{settings['thruster_Nm'] / 1e3:.3g}",
        "decay": settings["decay_per_s"],
        "horizon": f"{record['horizon_s']:g}",
    }


def _peaks(one: say.Asked | None, thruster: bool) -> list[str]:
    if one is None:
        return [MISSING] * (1 if thruster else 3)
    if thruster:
        return [fixed(max(abs(one.least), abs(one.greatest)), 3)]
    return [say.range_text(one), fixed(one.margin, 1), fixed(one.rate, 1)]


def _levels(p: dict, record: dict) -> list[dict]:
    """The worst level by criterion, open and closed loop."""
    closed = record["closed_loop"]["verdicts"]
    if not closed:
        return []
    before, after = (say.worst_levels(list(v)) for v in (say.open_verdicts(p.get("verdicts") or []), closed))
    return [
        {"name": name, "cells": [say.level_chip(found.get(name)) for found in (before, after)]}
        for name in dict.fromkeys((*before, *after))
    ]


def _closed(mode: dict) -> dict:
    return {
        "name": mode["name"],
        "eigenvalue": eigenvalue_text(mode["eigenvalue"]),
        "damping": number(mode.get("damping_ratio"), 3),
    }
