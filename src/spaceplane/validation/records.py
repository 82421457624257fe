"""One published number beside ours, and the tables made of them."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

from spaceplane.plain import finite


@dataclass(frozen=True)
class Record:
    """A published or exact value, the computed one, and whether they agree.

    Attributes:
        case: name of the validation case, such as "cones".
        quantity: what is compared, such as "surface Cp".
        condition: where, such as "Mach 3, half angle 20 deg".
        unit: unit of both values; "-" for a pure number.
        published: the published or exact value.
        computed: our value; None when the flow did not converge.
        band: allowed deviation, in `unit` for kind "absolute", else as a fraction of the published value.
        kind: "relative" or "absolute".
        source: author, year, table or equation of the published value.
        floor: absolute difference that is always allowed, in `unit`: the rounding of the published value.
        gate: whether a deviation beyond the band fails the case. A record with `gate=False` is shown, not judged.
        note: what a reader must know about this row; empty when nothing.
    """

    case: str
    quantity: str
    condition: str
    unit: str
    published: float
    computed: float | None
    band: float
    kind: str
    source: str
    floor: float = 0.0
    gate: bool = True
    note: str = ""

    @property
    def deviation(self) -> float | None:
        """Computed minus published, for kind "relative" as a fraction of the published value; None where undefined."""
        if self.computed is None or (self.kind == "relative" and self.published == 0.0):
            return None
        difference = self.computed - self.published
        return difference if self.kind == "absolute" else difference / abs(self.published)

    @property
    def within(self) -> bool:
        """Whether the deviation lies inside the band; an unconverged value never does."""
        if self.computed is None or not math.isfinite(self.computed):
            return False
        allowed = self.band if self.kind == "absolute" else self.band * abs(self.published)
        return abs(self.computed - self.published) <= max(allowed, self.floor)

    @property
    def verdict(self) -> str:
        """ "pass", "fail", or for rows that do not gate "inside" and "outside" the band."""
        if self.gate:
            return "pass" if self.within else "fail"
        return "inside" if self.within else "outside"


def passed(records: Iterable[Record]) -> bool:
    """Whether no gating record lies outside its band."""
    return all(record.within for record in records if record.gate)


def as_dict(record: Record) -> dict:
    """The record with its deviation and verdict, ready for JSON (no NaN: null instead)."""
    row = asdict(record)
    row["computed"] = finite(record.computed)
    row["deviation"] = finite(record.deviation)
    row["verdict"] = record.verdict
    return row


def table_rows(records: Iterable[Record]) -> list[tuple[str, ...]]:
    """The head of a table of the records, and a row for each with deviation, band and verdict."""
    head = ("quantity", "condition", "published", "computed", "deviation", "band", "verdict")
    return [head, *map(_row, records)]


def markdown_table(records: Iterable[Record]) -> str:
    """A Markdown table of the records, one row each, with the deviation and the band."""
    head, *rows = ("| " + " | ".join(row) + " |\n" for row in table_rows(records))
    return f"{head}|---|---|---:|---:|---:|---:|---|\n{''.join(rows)}"


def shown_deviation(record: Record) -> str:
    """The deviation as text: in per cent for kind "relative", else in the record's unit; "-" where undefined."""
    if record.deviation is None:
        return "-"
    return f"{100 * record.deviation:+.1f} %" if record.kind == "relative" else f"{record.deviation:+.4g}"


def shown_band(record: Record) -> str:
    """The band as text, like `shown_deviation`."""
    return f"{100 * record.band:.3g} %" if record.kind == "relative" else f"{record.band:.3g}"


def read(path: str | Path) -> tuple[Record, ...]:
    """Read the records of a `validation.json` written by `write`."""
    document = json.loads(Path(path).read_text(encoding="utf-8"))
    fields = Record.__dataclass_fields__
    return tuple(Record(**{key: row[key] for key in row if key in fields}) for row in document["records"])


def _row(record: Record) -> tuple[str, ...]:
    return (
        record.quantity + ("" if record.unit == "-" else f", {record.unit}"),
        record.condition,
        f"{record.published:.5g}",
        "not converged" if record.computed is None else f"{record.computed:.4g}",
        shown_deviation(record),
        shown_band(record),
        record.verdict,
    )
