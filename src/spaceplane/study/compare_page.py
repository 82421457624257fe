"""A comparison for people: tables as text, Markdown and one HTML page, and the eigenvalues as a picture."""

from __future__ import annotations

import html
import math
from collections.abc import Iterator
from pathlib import Path

from spaceplane.files import json_text, told, write_text
from spaceplane.report.plain_page import Table, document, picture_html, table_html


def tables(comparison: dict) -> list[Table]:
    """Return a comparison's tables in reading order."""
    return list(_tables(comparison))


def as_text(comparison: dict) -> str:
    """Return the tables in plain columns, for a terminal."""
    lines = [_headline(comparison)]
    for table in tables(comparison):
        rows = [table.columns, *table.rows]
        widths = [max(len(row[i]) for row in rows) for i in range(len(table.columns))]
        lines += ["", table.title, *([table.note] if table.note else [])]
        for number, row in enumerate(rows):
            cells = [
                cell.ljust(w) if i == 0 else cell.rjust(w) for i, (cell, w) in enumerate(zip(row, widths, strict=True))
            ]
            lines.append("  ".join(cells).rstrip())
            if number == 0:
                lines.append("  ".join("-" * width for width in widths))
    return "\n".join([*lines, "", *(f"warning: {line}" for line in comparison["warnings"])]).rstrip() + "\n"


def as_markdown(comparison: dict, picture: str | None = None) -> str:
    """Return the comparison as a Markdown page; `picture` is the file of the eigenvalue plot, if any."""
    lines = [f"# {_headline(comparison)}", ""]
    lines += [f"- {line}" for line in comparison["warnings"]]
    if picture:
        lines += ["", f"![Eigenvalues of both by Mach number]({picture})"]
    for table in tables(comparison):
        lines += ["", f"{'#' * table.level} {table.title}", ""]
        lines += [table.note, ""] if table.note else []
        lines.append("| " + " | ".join(table.columns) + " |")
        lines.append("|" + "---|" + "---:|" * (len(table.columns) - 1))
        lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in table.rows]
    return "\n".join(lines) + "\n"


def as_html(comparison: dict, picture_svg: str = "") -> str:
    """Return the comparison as one self-contained page; `picture_svg` is the eigenvalue plot's SVG text."""
    parts = [f"<h1>{html.escape(_headline(comparison))}</h1>"]
    parts.append(f"<p>spaceplane {comparison['version']}, {comparison['created']}</p>")
    if comparison["warnings"]:
        parts.append("<ul>" + "".join(f"<li>{html.escape(line)}</li>" for line in comparison["warnings"]) + "</ul>")
    if picture_svg:
        parts.append(picture_html(picture_svg.encode(), "Eigenvalues of both by Mach number", "svg+xml"))
    parts += [table_html(table) for table in tables(comparison)]
    return document(_headline(comparison), parts)


def write(comparison: dict, out_dir: Path | str) -> dict[str, Path]:
    """Write compare.json, compare.md, compare.html and the eigenvalue plot; return their paths by name.

    Raises:
        InputError: the folder cannot be written.
    """
    folder = Path(out_dir)
    figure = eigenvalue_plot(comparison)
    paths = {kind: folder / f"compare.{kind}" for kind in ("json", "md", "html", "png", "svg")}
    with told(folder):
        folder.mkdir(parents=True, exist_ok=True)
        figure.savefig(paths["png"], bbox_inches="tight", dpi=110)
        figure.savefig(paths["svg"], bbox_inches="tight")
        svg = paths["svg"].read_text(encoding="utf-8")
        texts = {
            "json": json_text(comparison),
            "md": as_markdown(comparison, paths["png"].name),
            "html": as_html(comparison, svg),
        }
        for kind, text in texts.items():
            write_text(text, paths[kind])
    return paths


def eigenvalue_plot(comparison: dict):
    """Return a figure of both vehicles' eigenvalues, one panel for each Mach number, matched modes joined by a line."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.ticker import MaxNLocator

    points = comparison["flight_points"]
    figure = Figure(figsize=(3.3 * len(points) + 0.6, 3.5), layout="constrained")
    for ax, point in zip(figure.subplots(1, len(points), squeeze=False)[0], points, strict=True):
        _plot_modes(ax, point["modes"])
        ax.set_title(f"Mach {point['mach']:g}", loc="left", fontsize=10, weight="bold")
        ax.set_xlabel("real part, 1/s", fontsize=8)
        ax.tick_params(labelsize=8)
        ax.xaxis.set_major_locator(MaxNLocator(4))
    figure.axes[0].set_ylabel("imaginary part, 1/s", fontsize=8)
    entries = [
        Line2D([], [], marker=marker, color=colour, ls="", mfc="none", mew=1.6, label=label)
        for marker, colour, label in zip(("o", "s"), ("#0077bb", "#ee7733"), comparison["labels"], strict=True)
    ]
    figure.legend(handles=entries, ncols=2, frameon=False, loc="outside upper right", fontsize=9)
    return figure


def _plot_modes(ax, rows: list[dict]) -> None:
    for row in rows:
        places = [None if mode is None else mode["eigenvalue"] for mode in row["modes"]]
        if None not in places:
            ax.plot(*zip(*places, strict=True), color="#bbbbbb", lw=1.2, zorder=1)
        for place, marker, colour in zip(places, ("o", "s"), ("#0077bb", "#ee7733"), strict=True):
            if place is not None:
                ax.plot(*place, marker, mfc="none", mec=colour, mew=1.6, ms=7, zorder=3)
    ax.axvline(0.0, color="#999999", lw=0.8, zorder=0)
    ax.axhline(0.0, color="#999999", lw=0.8, zorder=0)
    ax.grid(color="#ececec", lw=0.6, zorder=0)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)


def _tables(comparison: dict) -> Iterator[Table]:
    one, two = comparison["labels"]
    if comparison["shape"]:
        rows = tuple((row["name"], *(_number(value) for value in row["values"])) for row in comparison["shape"])
        yield Table("Shape: what differs", 2, "", ("parameter", one, two), rows)
    yield Table(
        "Levels at a glance",
        2,
        "MIL-F-8785C; levels of the first and the second.",
        ("criterion", *(f"Mach {point['mach']:g}" for point in comparison["flight_points"])),
        tuple(_level_glance(comparison)),
    )
    for point in comparison["flight_points"]:
        yield Table(
            f"Mach {point['mach']:g}: coefficients",
            2,
            _point_note(point),
            ("coefficient", one, two, "difference", "%"),
            tuple(
                (row["name"], *(_number(v) for v in row["values"]), _number(row["difference"], True), _percent(row))
                for row in point["coefficients"]
            ),
        )
        yield _derivative_table(point, one, two)
        yield _mode_table(point, one, two)
        yield _level_table(point, one, two)


def _derivative_table(point: dict, one: str, two: str) -> Table:
    with_thesis = any(value is not None for row in point["derivatives"] for value in row.get("thesis", ()))
    columns = ("derivative", one, two, "difference", "%", "beyond numerical error")
    rows = []
    for row in point["derivatives"]:
        values = [_measured(*pair) for pair in zip(row["values"], row["errors"], strict=True)]
        told = {True: "yes", False: "no", None: "not known"}[row["resolved"]]
        cells = (row["name"], *values, _number(row["difference"], True), _percent(row), told)
        rows.append((*cells, *(_number(value) for value in row["thesis"])) if with_thesis else cells)
    columns += (f"thesis {one}", f"thesis {two}") if with_thesis else ()
    note = "Per radian for angles, per unit for Mach number; ± is the estimated numerical error."
    return Table(f"Mach {point['mach']:g}: derivatives", 3, note, columns, tuple(rows))


def _mode_table(point: dict, one: str, two: str) -> Table:
    rows = []
    for row in point["modes"]:
        names = list(dict.fromkeys(mode["name"] for mode in row["modes"] if mode))
        sides = [cell for mode in row["modes"] for cell in (_eigenvalue(mode), _pace(mode))]
        similarity = "-" if row["similarity"] is None else f"{row['similarity']:.2f}"
        rows.append((" → ".join(names), *sides, similarity))
    columns = ("mode", f"{one}, 1/s", "pace", f"{two}, 1/s", "pace", "similarity")
    note = (
        "Paired by motion and eigenvalue. Pace: the time in which the amplitude halves or doubles and, of an "
        "oscillation, its damping ratio. Similarity: modal assurance criterion of the eigenvectors."
    )
    return Table(f"Mach {point['mach']:g}: modes", 3, note, columns, tuple(rows))


def _level_table(point: dict, one: str, two: str) -> Table:
    rows = []
    for row in point["levels"]:
        sides = [
            cell
            for pair in zip(row["values"], row["levels"], strict=True)
            for cell in (_number(pair[0]), _level(pair[1]))
        ]
        rows.append(
            (
                _criterion(row),
                " → ".join(dict.fromkeys(name for name in row["modes"] if name)),
                row["paragraph"] or "",
                row["unit"] or "",
                *sides,
                row["change"],
            )
        )
    columns = ("criterion", "mode", "paragraph", "unit", one, "level", two, "level", "change")
    return Table(f"Mach {point['mach']:g}: flying-quality levels", 3, "", columns, tuple(rows))


def _level_glance(comparison: dict) -> Iterator[tuple[str, ...]]:
    by_point = [[(_criterion(row), row["levels"]) for row in point["levels"]] for point in comparison["flight_points"]]
    for name in dict.fromkeys(name for rows in by_point for name, _ in rows):
        cells = []
        for rows in by_point:
            found = [" → ".join(_level(level) for level in levels) for key, levels in rows if key == name]
            cells.append("; ".join(found) or "-")
        yield (name, *cells)


def _headline(comparison: dict) -> str:
    return f"{comparison['labels'][0]} against {comparison['labels'][1]}"


def _point_note(point: dict) -> str:
    return (
        f"Altitude {point['altitude_m'][0] / 1000:.3g} km, angle of attack {point['alpha_deg'][0]:.3g}°; "
        f"flow: {point['flow'][0]} and {point['flow'][1]}."
    )


def _number(value: float | None, signed: bool = False) -> str:
    if value is None:
        return "-"
    if value == 0:
        return "0"
    size = abs(value)
    sign = "+" if signed and value > 0 else ""
    if size < 1e-4 or size >= 1e5:
        return f"{sign}{value:.2e}"
    return f"{sign}{value:.{max(0, 3 - math.floor(math.log10(size)))}f}"


def _measured(value: float | None, error: float | None) -> str:
    if value is None or error is None:
        return _number(value)
    return f"{_number(value)} ± {error:.1g}"


def _percent(row: dict) -> str:
    value = row["relative_percent"]
    return "-" if value is None else f"{value:+.1f}" if abs(value) < 1000 else f"{value:+.0f}"


def _eigenvalue(mode: dict | None) -> str:
    if mode is None:
        return "-"
    re, im = mode["eigenvalue"]
    return f"{_number(re)} ± {_number(abs(im))}i" if im else _number(re)


def _pace(mode: dict | None) -> str:
    if mode is None:
        return "-"
    half, double, ratio = mode["half_time_s"], mode["double_time_s"], mode["damping_ratio"]
    parts = [f"halves in {half:.3g} s"] if half else [f"doubles in {double:.3g} s"] if double else []
    parts += [f"ζ {ratio:.3f}"] if ratio is not None else []
    return ", ".join(parts) or "-"


def _criterion(row: dict) -> str:
    return f"{row['criterion']}: {row['quantity']}"


def _level(level: int | str | None) -> str:
    return "n/a" if level is None else str(level)
