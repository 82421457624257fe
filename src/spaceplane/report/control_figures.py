"""Pictures of control: eigenvalues and motions of open and closed loop. Every function returns a PNG."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from spaceplane.report.figure_style import FIGURE_STYLE
from spaceplane.report.figures_dynamics import COLOURS, STABLE, STATE_LABELS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STYLE = FIGURE_STYLE | {"font.size": 9, "savefig.dpi": 110}
OPEN, CLOSED = "#888888", "#0077bb"
MOMENTS = {"moment_x": "$M_x$", "moment_y": "$M_y$", "moment_z": "$M_z$"}
NEAR = 0.08
"""1/s: half the width of the closer view."""


def roots(points: Sequence[tuple[str, Sequence[complex], Sequence[complex]]]) -> bytes:
    """Eigenvalues in the upper half plane, open loop hollow and closed loop full, all of them and those near zero.

    Args:
        points: (label, eigenvalues of the open loop, of the closed loop), 1/s, in an order that the colours follow.
    """
    return _png(lambda: _roots(points))


def motions(records: Sequence[dict]) -> bytes:
    """Time responses: a column for each event, open loop grey and closed loop coloured.

    Args:
        records: `responses` of `control_record`.
    """
    return _png(lambda: _motions(records))


def _png(draw: Callable[[], Figure]) -> bytes:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    with plt.rc_context(STYLE):
        figure = draw()
        data = io.BytesIO()
        figure.savefig(data, format="png", bbox_inches="tight", metadata={"Software": None})
        plt.close(figure)
    return data.getvalue()


def _roots(points: Sequence[tuple[str, Sequence[complex], Sequence[complex]]]) -> Figure:
    import matplotlib.pyplot as plt
    from matplotlib.lines import Line2D

    figure, panels = plt.subplots(1, 2, figsize=(11.0, 4.0), layout="constrained")
    shades = plt.get_cmap("viridis")
    for k, (_, open_loop, closed_loop) in enumerate(points):
        colour = shades(k / max(len(points) - 1, 1))
        for values, face in ((open_loop, "none"), (closed_loop, colour)):
            upper = [value for value in values if value.imag >= 0]
            for axes in panels:
                axes.plot(
                    [value.real for value in upper],
                    [value.imag for value in upper],
                    "o",
                    markersize=6,
                    markeredgecolor=colour,
                    markerfacecolor=face,
                    linestyle="",
                    clip_on=True,
                    zorder=3,
                )
    every = [value for _, *loops in points for values in loops for value in values]
    wide = 1.12 * max([abs(value.real) for value in every] + [NEAR])
    tall = 1.1 * max([value.imag for value in every] + [NEAR])
    near = 1.15 * max([value.imag for value in every if abs(value) <= NEAR] + [0.2 * NEAR])
    for axes, (half, top) in zip(panels, ((wide, tall), (NEAR, near)), strict=True):
        axes.set_xlim(-half, half)
        axes.set_ylim(-0.04 * top, top)
        axes.axvspan(-half, 0.0, color=STABLE, zorder=0, linewidth=0)
        axes.axvline(0.0, color="#777777", linewidth=0.8)
        axes.set_xlabel("real part, 1/s")
    panels[0].set_ylabel("imaginary part, 1/s")
    panels[1].set_title("near zero", fontsize=9)
    handles = [
        Line2D([], [], linestyle="", marker="o", color=shades(k / max(len(points) - 1, 1)), label=label)
        for k, (label, *_) in enumerate(points)
    ]
    handles += [
        Line2D([], [], linestyle="", marker="o", markeredgecolor="#333333", markerfacecolor=face, label=label)
        for face, label in (("none", "open loop"), ("#333333", "with feedback"))
    ]
    figure.legend(handles=handles, loc="outside right center", frameon=False)
    return figure


def _motions(records: Sequence[dict]) -> Figure:
    import matplotlib.pyplot as plt

    rows = max(len(one["states"]) for one in records) + 1
    figure, grid = plt.subplots(
        rows,
        len(records),
        figsize=(2.9 * len(records), 1.75 * rows + 0.4),
        squeeze=False,
        sharex="col",
        layout="constrained",
    )
    for column, one in enumerate(records):
        grid[0, column].set_title(_broken(one["name"]), fontsize=9)
        for row in range(rows - 1):
            axes = grid[row, column]
            if row < len(one["states"]):
                _state(axes, one, one["states"][row])
            else:
                axes.remove()
        _inputs(grid[-1, column], one)
        grid[-1, column].set_xlabel("time, s")
    handles = [
        plt.Line2D([], [], color=OPEN, linestyle=(0, (4, 2)), label="controls fixed"),
        plt.Line2D([], [], color=CLOSED, label="with feedback"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=2, frameon=False)
    return figure


def _state(axes: Axes, one: dict, name: str) -> None:
    axes.plot(one["time_s"], one["open"][name], color=OPEN, linestyle=(0, (4, 2)))
    axes.plot(one["time_s"], one["closed"][name], color=CLOSED)
    axes.set_ylabel(f"{STATE_LABELS.get(name, name)}, {one['units'][name]}")


def _inputs(axes: Axes, one: dict) -> None:
    """Deflections from trim, and moments of thrusters on an axis of their own."""
    right = None
    for k, name in enumerate(one["inputs"]):
        turned = name in MOMENTS
        if turned and len(one["inputs"]) > 1 and one["inputs"][0] not in MOMENTS:
            right = right or axes.twinx()
        target = right if turned and right is not None else axes
        values = [value / 1e3 for value in one["closed"][name]] if turned else one["closed"][name]
        label = MOMENTS.get(name, name)
        target.plot(one["time_s"], values, color=COLOURS[(0, 1, 2, 3)[k % 4]], label=label)
        target.set_ylabel("moment, kN m" if turned else f"{label}, deg")
    if len(one["inputs"]) > 1:
        axes.set_ylabel(axes.get_ylabel() if one["inputs"][0] in MOMENTS else "from trim, deg")
        lines = [*axes.lines, *(right.lines if right else [])]
        place = {"loc": "lower center", "bbox_to_anchor": (0.5, 0.97), "ncols": len(lines), "borderaxespad": 0.0}
        axes.legend(lines, [line.get_label() for line in lines], frameon=False, fontsize=8, **place)


def _broken(text: str) -> str:
    """On two lines at the blank nearest the middle."""
    cut = min((i for i, c in enumerate(text) if c == " "), key=lambda i: abs(i - len(text) / 2), default=0)
    return f"{text[:cut]}\n{text[cut + 1 :]}" if cut and len(text) > 20 else text


def growth(eigenvalues: Sequence[complex]) -> float:
    """Fastest growth, 1/s; minus infinity for none."""
    return max((value.real for value in eigenvalues), default=-math.inf)
