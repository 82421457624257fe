"""One published number beside ours, and the tables made of them."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from spaceplane import __version__
from spaceplane.files import json_text, told, write_text
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


def markdown_table(records: Sequence[Record]) -> str:
    """A Markdown table of the records, one row each, with the deviation and the band."""
    head = "| quantity | condition | published | computed | deviation | band | verdict |\n"
    head += "|---|---|---:|---:|---:|---:|---|\n"
    return head + "".join(_markdown_row(record) for record in records)


def markdown_page(records: Sequence[Record]) -> str:
    """A Markdown page with one section and table for each case, and the sources below each table."""
    parts = ["# Validation results\n", f"\nspaceplane {__version__}.\n"]
    for case in dict.fromkeys(record.case for record in records):
        rows = [record for record in records if record.case == case]
        gating = [record for record in rows if record.gate]
        parts.append(f"\n## {case}\n\n")
        parts.append(f"{sum(r.within for r in gating)} of {len(gating)} gating rows inside their band.\n\n")
        parts.append(markdown_table(rows))
        parts.append("\nSources: " + "; ".join(dict.fromkeys(record.source for record in rows)) + ".\n")
        notes = list(dict.fromkeys(record.note for record in rows if record.note))
        parts.extend(f"\n- {note}" for note in notes)
        parts.append("\n" if notes else "")
    return "".join(parts)


def write(records: Sequence[Record], folder: str | Path) -> tuple[Path, Path]:
    """Write `validation.json` and `validation.md` into the folder, made if missing, and return their paths.

    Raises:
        InputError: if the folder cannot be written.
    """
    folder = Path(folder)
    document = {
        "schema": "spaceplane.validation",
        "schema_version": 1,
        "version": __version__,
        "passed": passed(records),
        "records": [as_dict(record) for record in records],
    }
    json_path, page_path = folder / "validation.json", folder / "validation.md"
    with told(folder):
        folder.mkdir(parents=True, exist_ok=True)
        write_text(json_text(document), json_path)
        write_text(markdown_page(records), page_path)
    return json_path, page_path


def read(path: str | Path) -> tuple[Record, ...]:
    """Read the records of a `validation.json` written by `write`."""
    document = json.loads(Path(path).read_text(encoding="utf-8"))
    fields = Record.__dataclass_fields__
    return tuple(Record(**{key: row[key] for key in row if key in fields}) for row in document["records"])


def _markdown_row(record: Record) -> str:
    deviation = record.deviation
    if record.kind == "relative":
        shown = "-" if deviation is None else f"{100 * deviation:+.1f} %"
        band = f"{100 * record.band:.3g} %"
    else:
        shown = "-" if deviation is None else f"{deviation:+.4g}"
        band = f"{record.band:.3g}"
    computed = "not converged" if record.computed is None else f"{record.computed:.4g}"
    unit = "" if record.unit == "-" else f", {record.unit}"
    return (
        f"| {record.quantity}{unit} | {record.condition} | {record.published:.5g} | {computed} | {shown} | {band} "
        f"| {record.verdict} |\n"
    )
