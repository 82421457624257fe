"""The same findings on a terminal: short tables."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from spaceplane.qualities.probability import per_cent
from spaceplane.report.card import yaw_sentence
from spaceplane.report.control_summary import print_control
from spaceplane.report.flight_point import LEVEL_CSS, level_of, time_text, worst_levels
from spaceplane.report.likelihood import SHOWN_DRIVERS, eigenvalue_error, outcome_chip
from spaceplane.report.names import stability
from spaceplane.report.numbers import duration, fixed, grouped, is_number, measured, number
from spaceplane.report.plots import eigenvalue_text
from spaceplane.report.read import level_text
from spaceplane.report.sections import total_seconds, unconverged, warnings

if TYPE_CHECKING:
    from spaceplane.aero.uncertainty.accuracy import Accuracy, Refined, Trial

COLOURS = {"good": "green", "fair": "yellow", "poor": "dark_orange", "bad": "red"}
COEFFICIENT_ROWS = ("CL", "CD", "L_over_D", "Cm")
DERIVATIVE_ROWS = (
    *("CL_alpha", "CD_alpha", "Cm_alpha", "CY_beta", "Cl_beta", "Cn_beta"),
    *("CL_M", "CD_M", "Cm_M", "Cl_p", "Cm_q", "Cn_r"),
)
WIDEST = 1000
"""Characters that the table of a flow may be wide."""
SIGN_COLOURS = {"stable": "green", "unstable": "red", "undecided": "yellow", "": ""}


def shortcomings(result: dict) -> list[str]:
    """What keeps a result from being good, one line each: unconverged conditions, flight points without modes."""
    found = [
        f"{name}, condition {record.get('label')}: {record.get('verdict')}" for name, record in unconverged(result)
    ]
    found += [f"{p['name']}: no modes" for p in result["flight_points"] if not p.get("modes")]
    if not result["flight_points"]:
        found.append("no flight point")
    asked = result.get("accuracy")
    if asked and not asked["met"]:
        reached = asked["reached"]
        share = "unknown" if reached is None else percent(reached)
        found.append(f"accuracy: {percent(asked['target'])} asked, {share} reached")
    return found


def complain(problems: list[str]) -> int:
    """Say on stderr what is not good, on one line, and return the exit code: 1, or 0 when there is nothing to say."""
    if not problems:
        return 0
    more = f" and {len(problems) - 3} more" if len(problems) > 3 else ""
    print(f"not good: {'; '.join(problems[:3])}{more}", file=sys.stderr)
    return 1


def print_summary(result: dict, report: Path | None = None, console: Console | None = None) -> None:
    """Print what an analysis found: coefficients, key derivatives, modes with levels, convergence, time, report."""
    console = console or _console()
    points = result["flight_points"]
    console.print(Text(result["vehicle"]["name"], style="bold"), highlight=False)
    console.print(_points_table(points))
    for p in points:
        if yaw_sentence(p):
            console.print(f"{p['name']}: {yaw_sentence(p)}", highlight=False, soft_wrap=True)
    for p in points:
        if p.get("modes"):
            console.print(_modes_table(f"modes at {p['name']}", p["modes"]))
    if any(p.get("verdicts") for p in points):
        console.print(_levels_table(points))
    if any(p.get("airframe_verdicts") for p in points):
        console.print(_airframe_table(points))
    for line in warnings(result):
        console.print(Text(f"warning: {line}", style="yellow"), highlight=False, soft_wrap=True)
    console.print(_convergence_line(result), highlight=False)
    asked = result.get("accuracy")
    if asked:
        reached = "unknown" if asked["reached"] is None else percent(asked["reached"])
        verb = "met" if asked["met"] else "NOT met"
        text = f"accuracy: {percent(asked['target'])} {verb}: C_L, C_D and C_m within {reached} of the force"
        console.print(Text(text, style="green" if asked["met"] else "red"), highlight=False)
    if report is not None:
        console.print(f"report: {report}", highlight=False, soft_wrap=True)


def _console() -> Console:
    """A terminal of its own width; a file or pipe gets room enough for every column."""
    console = Console()
    return console if console.is_terminal else Console(width=120)


def _convergence_line(result: dict) -> Text:
    records = [r for p in result["flight_points"] for r in p.get("convergence") or []]
    bad = len(unconverged(result))
    if bad:
        line = Text(f"{bad} of {len(records)} flow conditions NOT converged", style="red")
    else:
        line = Text(f"all {len(records)} flow conditions converged", style="green")
    cells = grouped((result.get("mesh") or {}).get("cells"))
    return line.append(f" on {cells} cells in {duration(total_seconds(result))}", style="default")


def _points_table(points: list[dict]) -> Table:
    table = _table("")
    for p in points:
        table.add_column(p["name"], justify="right", no_wrap=True)
    table.add_row("altitude, km", *(fixed(_scaled(p.get("altitude_m"), 1e-3), 1) for p in points))
    table.add_row("alpha, deg", *(fixed(p.get("alpha_deg"), 1) for p in points))
    for name in COEFFICIENT_ROWS:
        cells = [_coefficient_cell(p, name) for p in points]
        table.add_row("L/D" if name == "L_over_D" else name, *cells)
    table.add_section()
    table.add_row(Text("per rad, per Mach", style="dim"))
    for name in DERIVATIVE_ROWS:
        records = [(p.get("derivatives") or {}).get(name) or {} for p in points]
        if any(records):
            table.add_row(name, *(_derivative_cell(name, r) for r in records))
    return table


def _coefficient_cell(point: dict, name: str) -> str:
    value, error = ((point.get(key) or {}).get(name) for key in ("coefficients", "coefficient_errors"))
    return str(measured(value, error)) if is_number(error) and error > 0 else fixed(value, 4)


def _derivative_cell(name: str, record: dict) -> Text:
    value, error = record.get("value"), record.get("error")
    return Text(str(measured(value, error)), style=SIGN_COLOURS[stability(name, value, error)])


def _modes_table(title: str, modes: list[dict], details: bool = False) -> Table:
    table = _table(title)
    for heading in ("eigenvalue, 1/s", "half or double time", "period", "damping"):
        table.add_column(heading, justify="right", no_wrap=True)
    for mode in modes:
        grows = mode["eigenvalue"][0] > 0
        table.add_row(
            Text(mode["name"], style="red" if grows else ""),
            eigenvalue_text(mode["eigenvalue"]),
            time_text(mode),
            duration(mode.get("period_s")),
            number(mode.get("damping_ratio"), 3),
        )
        if details:
            table.add_row(Text(_drivers(mode), style="dim"), Text(eigenvalue_error(mode), style="dim"))
    return table


def _drivers(mode: dict) -> str:
    """What makes a mode uncertain or, without errors, moves it most by one per cent each."""
    found = mode.get("drivers") or []
    if not found:
        return ""
    said = "uncertain by" if any(d.get("error") for d in found) else "moved most by"
    return f"  {said} " + ", ".join(
        f"{d['parameter']} {per_cent(d['share'])}" for d in found[:SHOWN_DRIVERS] if d["share"] >= 0.02
    )


def _levels_table(points: list[dict]) -> Table:
    """MIL-F-8785C levels: a row for each criterion with its worst level, a column for each flight point."""
    table = _table("MIL-F-8785C")
    for p in points:
        table.add_column(p["name"], justify="right", no_wrap=True)
    found = [worst_levels(p.get("verdicts") or []) for p in points]
    for name in dict.fromkeys(name for worst in found for name in worst):
        paragraph = next(w[name].get("paragraph") or "" for w in found if name in w)
        table.add_row(f"{name} ({paragraph})", *(_level_cell(w.get(name)) for w in found))
    return table


def _level_cell(verdict: dict | None) -> Text:
    level = level_of(verdict) if verdict else None
    text = "n/a" if level is None else level_text(level)
    return Text(text + _share(verdict, str(level)), style=COLOURS.get(LEVEL_CSS.get(level, ""), "dim"))


def _airframe_table(points: list[dict]) -> Table:
    """What is asked of the airframe, its controls and departure, where it applies at some flight point."""
    table = _table("airframe, controls, departure")
    for p in points:
        table.add_column(p["name"], justify="right", no_wrap=True)
    found = [{(v["criterion"], v["quantity"]): v for v in p.get("airframe_verdicts") or []} for p in points]
    for key in dict.fromkeys(key for verdicts in found for key in verdicts):
        row = [verdicts.get(key) for verdicts in found]
        if any(v and v["applicable"] for v in row):
            paragraph = next(v["paragraph"] for v in row if v)
            number_of = f" ({paragraph})" if paragraph[:1].isdigit() else ""
            table.add_row(f"{key[0].removeprefix('departure: ')}: {key[1]}{number_of}", *(_outcome(v) for v in row))
    return table


def _outcome(verdict: dict | None) -> Text:
    if verdict is None:
        return Text("n/a", style="dim")
    chip = outcome_chip(verdict)
    name = str(verdict["level"]) if verdict.get("level") is not None else chip["text"]
    text = "n/a" if not chip["css"] else chip["text"] + _share(verdict, name)
    return Text(text, style=COLOURS.get(chip["css"], "dim"))


def _share(verdict: dict | None, outcome: str) -> str:
    """How likely an outcome is, where others are possible."""
    found = (verdict or {}).get("probabilities") or {}
    return f", {per_cent(found[outcome])}" if len(found) > 1 and outcome in found else ""


def print_modes(record: dict, console: Console | None = None) -> None:
    """Print the modes and levels of a `spaceplane modes` record."""
    console = console or _console()
    console.print(_modes_table("mode", record["modes"], details=True))
    if record.get("verdicts"):
        console.print(_levels_table([{"name": "verdict", "verdicts": record["verdicts"]}]))
    if record.get("airframe_verdicts"):
        console.print(_airframe_table([{"name": "verdict", "airframe_verdicts": record["airframe_verdicts"]}]))
    if record.get("control"):
        print_control(record["control"], record["verdicts"], console)


def trial_line(trial: Trial) -> str:
    """One mesh on the way to an accuracy."""
    start = f"accuracy: {trial.cells} cells, wall cell {trial.wall_cell:.3g} m"
    if trial.reached is None:
        return f"{start}: nothing to compare with yet"
    if not math.isfinite(trial.reached):
        return f"{start}: unknown, {trial.worst} failed"
    return f"{start}: {percent(trial.reached)} ({trial.worst})"


def accuracy_line(wanted: Accuracy, found: Refined) -> str:
    """Whether the accuracy asked for was reached, and what was."""
    last = found.trials[-1]
    verb = "met" if found.met else "NOT met"
    line = f"accuracy: {percent(wanted.target)} {verb}: {percent(found.reached)} ({last.worst}) on {last.cells} cells"
    if found.met:
        return line
    more = "" if found.needed is None else f"; about {found.needed:.2g} would be needed"
    return f"{line}, at most {wanted.max_cells} allowed{more}"


def percent(share: float) -> str:
    """A share in per cent, two digits."""
    return f"{100.0 * share:.2g} %" if math.isfinite(share) else "unknown"


def print_flow(records: Iterable[dict], console: Console | None = None) -> None:
    """Print the coefficients of each condition of a `spaceplane flow` run, whole: a narrow terminal wraps the lines."""
    console = console or _console()
    table = Table(box=box.SIMPLE_HEAD, header_style="bold")
    names = ("CL", "CD", "CY", "Cl", "Cm", "Cn", "CA", "CN")
    for title in ("Mach", "alpha", "beta", *names, "verdict"):
        table.add_column(title, justify="right", no_wrap=True)
    for r in records:
        style = "green" if r["converged"] else "red"
        values = [fixed(r.get(name), 5) for name in names]
        where = [number(r["mach"], 3), fixed(r["alpha_deg"], 2), fixed(r["beta_deg"], 2)]
        table.add_row(*where, *values, Text(r.get("verdict") or "", style=style))
        errors = r.get("coefficient_errors") or {}
        if "mesh" in (r.get("coefficient_errors_by_source") or {}):
            table.add_row("", "", "", *(f"±{fixed(errors.get(name), 5)}" for name in names), "", style="dim")
    needed = console.measure(table, options=console.options.update(max_width=WIDEST)).maximum
    console.width = max(console.width, needed)
    console.print(table)


def _table(first: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, header_style="bold", pad_edge=False)
    table.add_column(first, no_wrap=False)
    return table


def _scaled(value: float | None, factor: float) -> float | None:
    return value * factor if is_number(value) else None
