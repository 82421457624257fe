"""Plain self-contained HTML pages of headings, tables and pictures, readable in light and dark."""

from __future__ import annotations

import base64
import html
from collections.abc import Sequence
from dataclasses import dataclass

BETTER, WORSE = "better", "worse"
"""Cells of these texts are coloured."""

STYLE = """
:root{color-scheme:light dark;--ink:#1c1f24;--paper:#fff;--line:#d9dde3;--soft:#667;--band:#f5f6f8;
--good:#1b7837;--bad:#b2182b}
@media(prefers-color-scheme:dark){:root{--ink:#e6e8eb;--paper:#16181c;--line:#363a42;--soft:#9aa;--band:#1d2026;
--good:#6fcf8a;--bad:#ff8a80}}
body{font:15px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--paper);max-width:1100px;margin:2rem auto;
padding:0 1.2rem}
h1{font-size:1.6rem;margin:0 0 .3rem}h2{margin:2.2rem 0 .4rem;font-size:1.2rem}h3{margin:1.3rem 0 .3rem;font-size:1rem}
p{margin:.3rem 0 .8rem;color:var(--soft)}div.scroll{overflow-x:auto}
table{border-collapse:collapse;font-variant-numeric:tabular-nums;min-width:60%}
th,td{padding:.28rem .8rem;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th{font-weight:600;color:var(--soft)}td:first-child,th:first-child{text-align:left;padding-left:.2rem}
td.text,th.text{text-align:left}tr:hover td{background:var(--band)}
.better{color:var(--good);font-weight:600}.worse{color:var(--bad);font-weight:600}
img{max-width:100%;background:#fff;border-radius:6px}ul{padding-left:1.2rem}
"""


@dataclass(frozen=True)
class Table:
    """One table of a page.

    Attributes:
        title: heading.
        level: of the heading, 2 or 3.
        note: a line on what the table shows.
        columns: headings.
        rows: texts, one for each column.
    """

    title: str
    level: int
    note: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def document(title: str, parts: Sequence[str]) -> str:
    """The page: `parts` are HTML in reading order."""
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" '
        f'content="width=device-width"><title>{html.escape(title)}</title><style>{STYLE}</style></head>'
        f"<body>{''.join(parts)}</body></html>\n"
    )


def table_html(table: Table) -> str:
    """Heading, note and rows."""
    note = f"<p>{html.escape(table.note)}</p>" if table.note else ""
    head = "".join(f"<th>{html.escape(cell)}</th>" for cell in table.columns)
    body = "".join("<tr>" + "".join(_cell(cell) for cell in row) + "</tr>" for row in table.rows)
    return (
        f"<h{table.level}>{html.escape(table.title)}</h{table.level}>{note}"
        f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'
    )


def picture_html(data: bytes, text: str, form: str = "png") -> str:
    """A picture within the page; `text` says what it shows to those who do not see it."""
    code = base64.b64encode(data).decode()
    return f'<img alt="{html.escape(text)}" src="data:image/{form};base64,{code}">'


def _cell(text: str) -> str:
    style = f' class="{text}"' if text in (BETTER, WORSE) else ""
    return f"<td{style}>{html.escape(text)}</td>"
