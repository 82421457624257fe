"""The validation table on a terminal."""

from __future__ import annotations

from collections.abc import Iterable

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from spaceplane.validation.records import Record, table_rows

COLOURS = {"pass": "green", "fail": "red", "outside": "yellow"}
FILE_WIDTH = 140
"""Characters of a line where the output goes into a file or pipe: room for every column."""


def print_table(records: Iterable[Record], console: Console | None = None) -> None:
    """Print published values beside ours, with deviation, band and verdict."""
    records = list(records)
    console = console or Console()
    if not console.is_terminal:
        console = Console(width=FILE_WIDTH, file=console.file)
    head, *rows = table_rows(records)
    table = Table(box=box.SIMPLE_HEAD, header_style="bold", pad_edge=False)
    table.add_column("case")
    for title in head:
        table.add_column(title, justify="left" if title in ("quantity", "condition") else "right")
    for record, row in zip(records, rows, strict=True):
        table.add_row(record.case, *row[:-1], Text(row[-1], style=COLOURS.get(row[-1], "")))
    console.print(table)
