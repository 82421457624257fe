"""The section on control of a descent's page: what the controls can do by Mach number, and how the vehicle answers."""

from __future__ import annotations

import html

import numpy as np

from spaceplane.analysis.descent import Descent, DescentPoint
from spaceplane.qualities.verdict import to_record
from spaceplane.report import control_tables as say
from spaceplane.report.control_figures import growth, motions, roots
from spaceplane.report.control_record import control_record
from spaceplane.report.numbers import fixed, number
from spaceplane.report.plain_page import Table, picture_html, table_html

ROOTS, MOTIONS = "control-roots", "control-responses"
SLOWEST = 600.0
"""s: what takes longer to double is left out of the table."""


def pictures(descent: Descent) -> dict[str, bytes]:
    """PNG by name: eigenvalues of both loops, and motions where the growth is fastest; none without feedback."""
    points = [one for one in descent.points if one.control and one.control.regulator and one.system]
    if not points:
        return {}
    loops = [(f"Mach {one.point.mach:g}", *_eigenvalues(one)) for one in points]
    return {ROOTS: roots(loops), MOTIONS: motions(control_record(_fastest(points).control)["responses"])}


def html_parts(descent: Descent, drawn: dict[str, bytes]) -> list[str]:
    """The section; nothing where no feedback was asked for."""
    records = _records(descent)
    if not records:
        return []
    parts = ["<h2>Control</h2>", *(f"<p>{html.escape(text)}</p>" for text in _told_first(records))]
    feedback = {mach: record for mach, record in records.items() if record["gain"] is not None}
    measured = {mach: record for mach, record in records.items() if record["modes"]}
    if measured:
        parts += [table_html(_growing(measured)), table_html(_measures(measured))]
    if feedback:
        parts += [table_html(_demands(feedback)), table_html(_levels(descent, feedback))]
    for name, text in _captions(descent).items():
        if name in drawn:
            parts += [f"<h3>{html.escape(text)}</h3>", picture_html(drawn[name], text)]
    return parts


def _records(descent: Descent) -> dict[str, dict]:
    found = {f"{one.point.mach:g}": control_record(one.control, histories=False) for one in descent.points}
    return {mach: record for mach, record in found.items() if record}


def _eigenvalues(one: DescentPoint) -> tuple[np.ndarray, np.ndarray]:
    return tuple(np.linalg.eigvals(system.A) for system in (one.system, one.control.regulator.closed()))


def _fastest(points: list[DescentPoint]) -> DescentPoint:
    return max(points, key=lambda one: growth(np.linalg.eigvals(one.system.A)))


def _captions(descent: Descent) -> dict[str, str]:
    points = [one for one in descent.points if one.control and one.control.regulator]
    if not points:
        return {}
    mach = f"{_fastest(points).point.mach:g}"
    return {
        ROOTS: "Eigenvalues with the controls fixed and with the feedback",
        MOTIONS: f"Motions at Mach {mach}, where the growth is fastest (linear; alpha and beta without the gust)",
    }


def _told_first(records: dict[str, dict]) -> list[str]:
    """Inputs, and by Mach number where they differ; what is unknown; why there is no feedback."""
    lines = []
    for tell in (say.inputs_text, say.unknown_text):
        texts: dict[str, list[str]] = {}
        for mach, record in records.items():
            if record["modes"] and tell(record):
                texts.setdefault(tell(record), []).append(mach)
        for text, machs in texts.items():
            lines.append(text if len(texts) == 1 else f"Mach {', '.join(machs)}: {text}")
    return lines + [f"Mach {mach}: no feedback: {r['reason']}." for mach, r in records.items() if r["reason"]]


def _growing(records: dict[str, dict]) -> Table:
    names = list(dict.fromkeys(name for record in records.values() for m in record["modes"] for name in m["reach"]))
    rows = []
    for mach, record in records.items():
        growing = [mode for mode in record["modes"] if mode["growing"] and mode["double_time_s"] <= SLOWEST]
        for mode in growing:
            reach = (number(mode["reach"].get(name), 3) for name in names)
            alone = number(mode["distance_by_surfaces"], 2)
            what = f"{mode['state']}, {mode['unit']}"
            rows.append((mach, mode["name"], number(mode["double_time_s"], 3), what, *reach, alone))
        if not growing:
            rows.append((mach, "none", *("–",) * (len(names) + 3)))
    columns = ("Mach", "mode", "doubles in, s", "in", *(say.input_name(name) for name in names), "distance, 1/s")
    thruster = next(iter(records.values()))["settings"]["thruster_Nm"]
    note = (
        f"Against what doubles within {SLOWEST:g} s: how far the motion may be displaced along the mode for the input "
        f"at its limit to balance it; a thruster counts with {thruster / 1e3:g} kN m, a round number. Distance: of the "
        "surfaces alone from losing the mode (0 is out of reach), inputs scaled by their limits."
    )
    return Table("Control power", 3, note, columns, tuple(rows))


def _measures(records: dict[str, dict]) -> Table:
    first = next(iter(records.values()))
    degrees = f"{first['settings']['offset_deg']:.3g}"
    columns = (
        "Mach",
        "states moved",
        "by surfaces alone",
        "alpha held, deg",
        "beta held, deg",
        f"energy for {degrees} deg of alpha, s",
        "of beta, s",
    )
    rows = []
    for mach, record in records.items():
        held = (say.held_text(record, axis) for axis in ("alpha", "beta"))
        energy = (number(record["energy_s"].get(axis), 2) for axis in ("alpha", "beta"))
        moved = (f"{record[key]} of {record['states']}" for key in ("states_moved", "states_moved_by_surfaces"))
        rows.append((mach, *moved, *held, *energy))
    note = (
        "States moved: rank, which says nothing of how well. Held: the largest offset that limited surfaces bring back "
        "whatever the law, motions that take 55 s or more to double left aside; any: beyond 90 deg. Energy: the least, "
        "by the Gramian; 1 s is one input at its limit for a second."
    )
    return Table("Controllability", 3, note, columns, tuple(rows))


def _demands(records: dict[str, dict]) -> Table:
    kinds = {one.name: one for record in records.values() for one in say.asked(record["disturbances"])}
    columns = ["Mach"]
    for name, one in kinds.items():
        columns += [f"{name}, kN m"] if one.thruster else [f"{name}, deg", "left, deg", "rate, deg/s"]
    rows = []
    for mach, record in records.items():
        peaks, cells = {one.name: one for one in say.asked(record["disturbances"])}, []
        for name, one in kinds.items():
            cells += _cells(peaks.get(name), 1 if one.thruster else 3)
        rows.append((mach, *cells, say.supplied_text(record), say.within_text(record)))
    first = next(iter(records.values()))
    events = ", ".join(one["name"] for one in first["disturbances"])
    rate, decay = first["settings"]["rate_limit_degs"], first["settings"]["decay_per_s"]
    aim = "stabilises and no more" if decay == 0.0 else f"makes everything decay at {decay:g} 1/s or faster"
    note = (
        f"The linear quadratic regulator of least effort, which {aim}. The most over {first['horizon_s']:g} s after "
        f"each of: {events}. Gusts are sharp-edged and stay. Left: to the nearer limit. Rate limit {rate:.3g} deg/s, "
        "an assumption; an offset asks for a deflection at once, the rate is that of the time after. Thrusters have no "
        "known limit. For saturation: the moment of a thruster that supplies what a surface at its limit lacks."
    )
    columns += ["for saturation", "limits kept"]
    return Table("What the feedback asks", 3, note, tuple(columns), tuple(rows))


def _cells(one: say.Asked | None, count: int) -> list[str]:
    if one is None:
        return ["–"] * count
    if one.thruster:
        return [fixed(max(abs(one.least), abs(one.greatest)), 3)]
    return [say.range_text(one), fixed(one.margin, 1), fixed(one.rate, 2)]


def _levels(descent: Descent, records: dict[str, dict]) -> Table:
    rows = []
    for one in descent.points:
        record = records.get(f"{one.point.mach:g}")
        if record is None:
            continue
        before = say.worst_text(say.open_verdicts([to_record(verdict) for verdict in one.verdicts]))
        closed = record["closed_loop"]
        slowest = min((-mode["eigenvalue"][0] for mode in closed["modes"]), default=None)
        rows.append((f"{one.point.mach:g}", before, say.worst_text(closed["verdicts"]), number(slowest, 2)))
    note = "The worst level of MIL-F-8785C on the modes; all levels and modes are in descent.json."
    columns = ("Mach", "controls fixed", "with feedback", "slowest decay, 1/s")
    return Table("Levels with the feedback", 3, note, columns, tuple(rows))
