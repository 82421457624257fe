"""The validation page: every case with its table and picture, in Markdown and as one HTML file."""

from __future__ import annotations

import base64
import html
from collections.abc import Mapping, Sequence
from pathlib import Path

from spaceplane import __version__
from spaceplane.files import json_text, renamed_when_done, told, write_text
from spaceplane.validation.figures import caption, picture
from spaceplane.validation.records import Record, as_dict, markdown_table, passed, table_rows

STYLE = """
:root{color-scheme:light dark;--ink:#1c1f24;--paper:#fff;--line:#d9dde3;--soft:#667;--good:#1b7837;--bad:#b2182b}
@media(prefers-color-scheme:dark){:root{--ink:#e6e8eb;--paper:#16181c;--line:#363a42;--soft:#9aa;--good:#6fcf8a;
--bad:#ff8a80}}
body{font:15px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--paper);max-width:1100px;margin:2rem auto;
padding:0 1.2rem}
h1{font-size:1.6rem}h2{margin:2.4rem 0 .4rem;font-size:1.2rem}p,li{color:var(--soft)}
img{max-width:100%;background:#fff;border-radius:6px}div.scroll{overflow-x:auto}
table{border-collapse:collapse;font-variant-numeric:tabular-nums}
th,td{padding:.2rem .7rem;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th{color:var(--soft)}td:nth-child(-n+2),th:nth-child(-n+2),td:last-child{text-align:left}
tr.pass td:last-child{color:var(--good)}tr.fail td:last-child{color:var(--bad);font-weight:600}
"""


def by_case(records: Sequence[Record]) -> dict[str, list[Record]]:
    """The records of each case, in the order in which the cases come."""
    return {
        case: [record for record in records if record.case == case]
        for case in dict.fromkeys(record.case for record in records)
    }


def judged(records: Sequence[Record]) -> str:
    """How many of the rows that may fail lie inside their band."""
    gating = [record for record in records if record.gate]
    return f"{sum(record.within for record in gating)} of {len(gating)} judged rows lie inside their band."


def sources(records: Sequence[Record]) -> str:
    """Every source of the records once."""
    return "; ".join(dict.fromkeys(record.source for record in records))


def notes(records: Sequence[Record]) -> list[str]:
    """Every note of the records once."""
    return list(dict.fromkeys(record.note for record in records if record.note))


def markdown_page(records: Sequence[Record], pictures: Mapping[str, str] | None = None) -> str:
    """A Markdown page with one section, picture and table for each case, and the sources below each table.

    Args:
        records: of any cases.
        pictures: case -> file of its picture, as seen from the page; None for a page without pictures.
    """
    parts = ["# Validation results\n", f"\nspaceplane {__version__}. {judged(records)}\n"]
    for case, rows in by_case(records).items():
        parts.append(f"\n## {case}\n\n{judged(rows)}\n\n")
        if pictures and case in pictures:
            parts.append(f"![{caption(rows)}]({pictures[case]})\n\n")
        parts.append(f"{markdown_table(rows)}\nSources: {sources(rows)}.\n")
        listed = notes(rows)
        parts.extend(f"\n- {note}" for note in listed)
        parts.append("\n" if listed else "")
    return "".join(parts)


def html_page(records: Sequence[Record], pictures: Mapping[str, bytes]) -> str:
    """The same as one HTML file that needs no other.

    Args:
        records: of any cases.
        pictures: case -> PNG of its picture.
    """
    parts = [
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width"><title>Validation</title>'
        f"<style>{STYLE}</style></head><body><h1>Validation</h1>"
        f"<p>spaceplane {html.escape(__version__)}. {html.escape(judged(records))}</p>"
    ]
    for case, rows in by_case(records).items():
        code = base64.b64encode(pictures[case]).decode()
        text = html.escape(caption(rows))
        parts.append(f"<h2>{html.escape(case)}</h2><p>{html.escape(judged(rows))}</p>")
        parts.append(f'<img alt="{text}" src="data:image/png;base64,{code}"><p>{text}</p>')
        parts.append(f'<div class="scroll">{_html_table(rows)}</div><p>Sources: {html.escape(sources(rows))}.</p>')
        listed = "".join(f"<li>{html.escape(note)}</li>" for note in notes(rows))
        parts.append(f"<ul>{listed}</ul>" if listed else "")
    return "".join([*parts, "</body></html>\n"])


def write(records: Sequence[Record], folder: str | Path) -> dict[str, Path]:
    """Write the records and the page into the folder, made if missing.

    Returns:
        The paths of `validation.json`, of the page as `validation.md` and `validation.html`, by ending without dot,
        and of `validation-CASE.png` by name of the case.

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
    files = {kind: folder / f"validation.{kind}" for kind in ("json", "md", "html")}
    with told(folder):
        folder.mkdir(parents=True, exist_ok=True)
        write_text(json_text(document), files["json"])
    drawn = {case: picture(rows) for case, rows in by_case(records).items()}
    names = {case: f"validation-{case}.png" for case in drawn}
    with told(folder):
        for case, data in drawn.items():
            files[case] = folder / names[case]
            with renamed_when_done(files[case]) as partial:
                partial.write_bytes(data)
        write_text(markdown_page(records, names), files["md"])
        write_text(html_page(records, drawn), files["html"])
    return files


def _html_table(records: Sequence[Record]) -> str:
    head, *rows = table_rows(records)
    first = "".join(f"<th>{html.escape(cell)}</th>" for cell in head)
    body = "".join(
        f'<tr class="{row[-1]}">' + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{first}</tr></thead><tbody>{body}</tbody></table>"
