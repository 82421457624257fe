"""One picture per validation case: the published values with their bands, and the computed ones on top of them.

matplotlib is imported when a picture is drawn, not with the package.
"""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from spaceplane.report.figure_style import FIGURE_STYLE
from spaceplane.validation.records import Record, shown_band, shown_deviation

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#0077bb", "#cc3311", "#009988", "#aa3377", "#222222", "#ee7733")
STYLE = FIGURE_STYLE | {"font.size": 8, "savefig.dpi": 90}
COLUMNS, PANEL = 3, (3.9, 2.6)
"""Panels beside each other, and the size of one, inches."""
FARTHEST = 3.0
"""Deviations beyond this many bands are drawn at the edge of the lower panel."""


@dataclass(frozen=True)
class Places:
    """Where the records of one quantity stand on the horizontal axis.

    Attributes:
        name: label of the axis.
        x: [record] place.
        series: [record] what tells curves apart, such as "Mach 3"; empty for a single curve.
        labels: text at the places 0, 1, ...; empty where x is a number of its own.
    """

    name: str
    x: tuple[float, ...]
    series: tuple[str, ...]
    labels: tuple[str, ...] = ()


def places(records: Sequence[Record]) -> Places:
    """Read "Mach 3, half angle 20 deg" as numbers: the last one that varies is the axis, the others tell curves apart.

    Conditions that are not lists of names and numbers, alike in their names, stand beside each other with their text.
    """
    read = [_numbers(record.condition) for record in records]
    names = [tuple(name for name, _, _ in one) for one in read]
    if len(set(names)) == 1 and names[0]:
        varying = [k for k in range(len(names[0])) if len({one[k][1] for one in read}) > 1]
        axis = varying[-1] if varying else 0
        name, _, unit = read[0][axis]
        series = tuple(
            ", ".join(f"{one[k][0]} {one[k][1]:g} {one[k][2]}".strip() for k in varying if k != axis) for one in read
        )
        return Places(f"{name}, {unit}" if unit else name, tuple(one[axis][1] for one in read), series)
    conditions = tuple(record.condition for record in records)
    return Places("", tuple(range(len(records))), ("",) * len(records), conditions)


def picture(records: Sequence[Record], quantities: Sequence[str] = ()) -> bytes:
    """PNG of one case: a panel for each quantity, and below it the deviations in shares of the band.

    Args:
        records: of one case.
        quantities: those to show; all of them when empty.
    """
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    with plt.rc_context(STYLE):
        figure = _figure([r for r in records if not quantities or r.quantity in quantities])
        data = io.BytesIO()
        figure.savefig(data, format="png", bbox_inches="tight", metadata={"Software": None})
        plt.close(figure)
    return data.getvalue()


def _figure(records: Sequence[Record]) -> Figure:
    import matplotlib.pyplot as plt

    names = list(dict.fromkeys(record.quantity for record in records))
    columns = min(COLUMNS, len(names))
    rows = math.ceil(len(names) / columns)
    size = (PANEL[0] * columns, PANEL[1] * 1.55 * rows)
    figure, grid = plt.subplots(
        2 * rows, columns, figsize=size, squeeze=False, layout="constrained", height_ratios=(2.0, 1.1) * rows
    )
    for index, name in enumerate(names):
        row, column = divmod(index, columns)
        own = [record for record in records if record.quantity == name]
        _quantity(grid[2 * row, column], grid[2 * row + 1, column], own)
    for index in range(len(names), rows * columns):
        row, column = divmod(index, columns)
        grid[2 * row, column].axis("off")
        grid[2 * row + 1, column].axis("off")
    return figure


def _quantity(upper: Axes, lower: Axes, records: Sequence[Record]) -> None:
    """Values with their bands above, deviations over the band below."""
    where = places(records)
    first = records[0]
    upper.set_title(first.quantity + ("" if first.unit == "-" else f", {first.unit}"), fontsize=8, loc="left")
    lower.axhspan(-1.0, 1.0, color="#1b7837", alpha=0.13, lw=0)
    lower.axhline(0.0, color="#1b7837", lw=0.8)
    for number, series in enumerate(dict.fromkeys(where.series)):
        colour = COLOURS[number % len(COLOURS)]
        chosen = [k for k, name in enumerate(where.series) if name == series]
        x, own = [where.x[k] for k in chosen], [records[k] for k in chosen]
        published = [record.published for record in own]
        room = [allowed(record) for record in own]
        upper.errorbar(x, published, room, fmt="none", ecolor=colour, elinewidth=5.0, alpha=0.25)
        upper.plot(x, published, "_", color=colour, ms=11, mew=1.6)
        upper.plot([], [], "-", color=colour, label=series)
        for place, record in zip(x, own, strict=True):
            _mark(upper, lower, place, record, colour)
    if any(where.series):
        upper.legend(fontsize=6.5, frameon=False, handlelength=1.2)
    lower.set_ylim(-1.08 * FARTHEST, 1.08 * FARTHEST)
    lower.set_ylabel("over band", fontsize=7)
    lower.set_xlabel(where.name)
    for axes in (upper, lower):
        if where.labels:
            axes.set_xlim(-0.6, len(where.labels) - 0.4)
            axes.set_xticks(where.x, [])
        elif len(set(where.x)) <= 6:
            axes.set_xticks(sorted(set(where.x)), [f"{x:g}" for x in sorted(set(where.x))])
        axes.margins(x=0.12)
    if where.labels:
        lower.set_xticks(where.x, where.labels, rotation=90, fontsize=6)


def _mark(upper: Axes, lower: Axes, x: float, record: Record, colour: str) -> None:
    """The computed value: a dot, hollow where it is not judged; a cross where it fails or is missing."""
    failed = record.gate and not record.within
    marker = "x" if failed else "o"
    fill = colour if record.gate else "white"
    style = dict(color=colour, marker=marker, markerfacecolor=fill, ms=5, mew=1.3, ls="none", clip_on=False)
    if record.computed is None or not math.isfinite(record.computed):
        lower.plot([x], [0.0], **style)
        lower.annotate("not converged", (x, 0.0), fontsize=6, rotation=90, ha="center", va="bottom")
        return
    upper.plot([x], [record.computed], **style)
    share = (record.computed - record.published) / max(allowed(record), 1e-300)
    lower.plot([x], [min(max(share, -FARTHEST), FARTHEST)], **style)


def allowed(record: Record) -> float:
    """Largest difference from the published value that lies within the band, in the record's unit."""
    return max(record.band if record.kind == "absolute" else record.band * abs(record.published), record.floor)


def caption(records: Sequence[Record]) -> str:
    """What the picture shows and its worst judged row, for those who cannot see it."""
    judged = [record for record in records if record.gate and record.deviation is not None]
    worst = max(judged, key=lambda r: abs(r.computed - r.published) / max(allowed(r), 1e-300), default=None)
    text = "Published values (dashes, with their bands) and computed ones (dots; hollow where shown but not judged)"
    if worst is None:
        return text + "."
    told = f"{worst.quantity}, {worst.condition}: {shown_deviation(worst)}, band {shown_band(worst)}"
    return f"{text}; below, deviations over the band. Nearest to its edge or beyond: {told}."


def _numbers(condition: str) -> tuple[tuple[str, float, str], ...]:
    """(name, number, unit) of each part of "Mach 3, half angle 20 deg"; nothing where a part is not of that form."""
    found = []
    for part in condition.split(", "):
        words = part.split()
        unit = words.pop() if words and words[-1] in ("deg", "m") else ""
        try:
            found.append((" ".join(words[:-1]), float(words[-1]), unit))
        except (IndexError, ValueError):
            return ()
    return tuple(found)
