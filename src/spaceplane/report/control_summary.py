"""Control of one flight point on a terminal."""

from __future__ import annotations

from rich import box
from rich.console import Console
from rich.table import Table

from spaceplane.report import control_tables as say
from spaceplane.report.numbers import duration, fixed, number


def print_control(record: dict, verdicts: list[dict], console: Console) -> None:
    """Print what the controls can do and what the feedback asks.

    Args:
        record: of `control_record`.
        verdicts: on the modes with the controls fixed.
        console: to print on.
    """
    if record["modes"]:
        console.print(say.inputs_text(record), say.unknown_text(record))
        console.print(_power(record))
    if record["reason"]:
        console.print(f"no feedback: {record['reason']}")
        return
    for axis in record["held_deg"]:
        console.print(f"surfaces hold an offset in {axis}, deg: {say.held_text(record, axis)}")
    console.print(_demands(record))
    before, after = say.worst_text(say.open_verdicts(verdicts)), say.worst_text(record["closed_loop"]["verdicts"])
    console.print(f"worst level: {before}, with the feedback {after}")


def _power(record: dict) -> Table:
    table = _table("what grows")
    names = list(dict.fromkeys(name for mode in record["modes"] for name in mode["reach"]))
    for heading in ("doubles in", "reach in", *(say.input_name(name) for name in names), "distance, 1/s"):
        table.add_column(heading, justify="right", no_wrap=True)
    for mode in record["modes"]:
        if mode["growing"]:
            reach = (number(mode["reach"].get(name), 3) for name in names)
            what = f"{mode['state']}, {mode['unit']}"
            alone = number(mode["distance_by_surfaces"], 2)
            table.add_row(mode["name"], duration(mode["double_time_s"]), what, *reach, alone)
    return table


def _demands(record: dict) -> Table:
    table = _table("least-effort feedback")
    kinds = say.asked(record["disturbances"])
    for one in kinds:
        table.add_column(f"{one.name}, {'kN m' if one.thruster else 'deg'}", justify="right", no_wrap=True)
        if not one.thruster:
            table.add_column("rate, deg/s", justify="right", no_wrap=True)
    for heading in ("for saturation", "within limits"):
        table.add_column(heading, justify="right", no_wrap=True)
    for event in record["disturbances"]:
        cells = []
        for one in say.asked([event]):
            if one.thruster:
                cells.append(fixed(max(abs(one.least), abs(one.greatest)), 3))
            else:
                cells += [say.range_text(one), fixed(one.rate, 1)]
        within = "–" if not record["surfaces"] else "yes" if event["within"] else "no"
        table.add_row(event["name"], *cells, say.supplied_text({"disturbances": [event]}), within)
    return table


def _table(first: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, header_style="bold", pad_edge=False)
    table.add_column(first, no_wrap=False)
    return table
