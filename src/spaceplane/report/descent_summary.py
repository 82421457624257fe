"""A descent on a terminal: a line for each flight point."""

from __future__ import annotations

import math

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from spaceplane.analysis.descent import Descent, DescentPoint
from spaceplane.qualities.verdict import to_record
from spaceplane.report import control_tables as say
from spaceplane.report.numbers import number

COLUMNS = (
    *("Mach", "km", "alpha", "path", "bank", "elevator", "body flap", "margin", "L/D"),
    *("growth, 1/s", "worst level"),
)


def print_descent(descent: Descent, console: Console | None = None) -> None:
    """Print flight points, trim, fastest growth and worst level; angles in degrees."""
    table = Table(box=box.SIMPLE_HEAD, header_style="bold", pad_edge=False)
    for name in COLUMNS:
        table.add_column(name, justify="left" if name == COLUMNS[-1] else "right")
    for one in descent.points:
        table.add_row(*_row(one))
    (console or Console(width=None if Console().is_terminal else 130)).print(table)


def _row(one: DescentPoint) -> list[str | Text]:
    point, trim = one.point, one.trim
    start = [f"{point.mach:g}", f"{point.altitude / 1e3:.1f}", f"{math.degrees(point.alpha):.1f}"]
    if trim is None:
        return [*start, *("-",) * (len(COLUMNS) - len(start) - 1), Text("no trim", style="yellow")]
    angles = (point.gamma, point.bank, trim.elevator, trim.body_flap, trim.margin)
    row = [*start, *(f"{math.degrees(angle):.1f}" for angle in angles), f"{trim.lift_to_drag:.2f}"]
    if not one.modes:
        return [*row, "-", Text(one.reason, style="yellow")]
    fastest = max(mode.eigenvalue.real for mode in one.modes)
    worst = say.worst_text(say.open_verdicts([to_record(verdict) for verdict in one.verdicts]))
    return [*row, number(fastest, 2) if fastest > 0.0 else "none", worst]
