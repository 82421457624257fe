"""The plane of LCDP and C_n_beta,dyn with its regions and points in it; matplotlib is imported when it is drawn."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from spaceplane.errors import InputError
from spaceplane.qualities.departure import PER_DEGREE, regions
from spaceplane.report.figure_style import FIGURE_STYLE

SHADES = {"A": "#d7efe0", "B": "#eef5d8", "F": "#faf0d4", "C": "#fbe6d8", "U": "#f6e3ea", "D": "#f7d5da"}
MARKS = ("#1f5fae", "#9c6ade", "#d97b29", "#0f7f6e", "#b3263a", "#555555")


@dataclass(frozen=True)
class DeparturePoint:
    """A point of the plane.

    Attributes:
        lcdp: lateral control departure parameter, 1/rad.
        directional: C_n_beta,dyn, 1/rad.
        lcdp_error, directional_error: half widths, 1/rad; 0 where unknown.
    """

    lcdp: float
    directional: float
    lcdp_error: float = 0.0
    directional_error: float = 0.0

    def __post_init__(self) -> None:
        for name in ("lcdp", "directional", "lcdp_error", "directional_error"):
            if not math.isfinite(getattr(self, name)):
                raise InputError(f"{name} = {getattr(self, name)}: must be a finite number, 1/rad")


def write_departure_plot(points: Mapping[str, DeparturePoint], path: Path) -> Path:
    """Draw the regions and named points into a PNG or SVG file and return its path.

    Args:
        points: label to point.
        path: of the file, ending in .png or .svg.

    Raises:
        InputError: no point, or another ending.
    """
    if not points:
        raise InputError("points: give at least one")
    if Path(path).suffix not in (".png", ".svg"):
        raise InputError(f"path = {path}: must end in .png or .svg")
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    with plt.rc_context(FIGURE_STYLE | {"font.size": 10, "savefig.dpi": 140, "svg.hashsalt": "spaceplane"}):
        figure, axes = plt.subplots(figsize=(7.4, 4.6))
        _draw(axes, points)
        figure.savefig(path, bbox_inches="tight", metadata={"Software": None} if Path(path).suffix == ".png" else None)
        plt.close(figure)
    return Path(path)


def _draw(axes, points: Mapping[str, DeparturePoint]) -> None:
    xs = [sign * p.lcdp_error + p.lcdp for p in points.values() for sign in (-1, 1)]
    ys = [sign * p.directional_error + p.directional for p in points.values() for sign in (-1, 1)]
    left, right = _window([x * PER_DEGREE for x in xs], (-0.004, 0.004))
    low, high = _window([y * PER_DEGREE for y in ys], (-0.004, 0.008))
    for r in regions():
        x0, x1 = max(r.lcdp[0], left), min(r.lcdp[1], right)
        y0, y1 = max(r.directional[0], low), min(r.directional[1], high)
        axes.fill([x0, x1, x1, x0], [y0, y0, y1, y1], color=SHADES[r.name], lw=0, zorder=0)
        outer = x0 + 0.02 * (right - left) if x0 == left else x1 - 0.02 * (right - left)
        axes.annotate(
            r.name, (outer, 0.5 * (y0 + y1)), ha="left" if x0 == left else "right", va="center", fontsize=15,
            color="#667", fontweight="bold",
        )  # fmt: skip
    axes.axvline(0.0, color="#888888", lw=0.9)
    axes.axhline(0.0, color="#888888", lw=0.9)
    for k, (label, p) in enumerate(points.items()):
        axes.errorbar(
            p.lcdp * PER_DEGREE, p.directional * PER_DEGREE, xerr=p.lcdp_error * PER_DEGREE or None,
            yerr=p.directional_error * PER_DEGREE or None, fmt="o", ms=6, capsize=3, lw=1.2,
            color=MARKS[k % len(MARKS)], label=label,
        )  # fmt: skip
    axes.set(xlim=(left, right), ylim=(low, high))
    axes.grid(visible=False)
    axes.set_xlabel("LCDP, 1/deg  (below 0: rolls against the aileron)")
    axes.set_ylabel(r"$C_{n_\beta,dyn}$, 1/deg")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)


def _window(values: list[float], least: tuple[float, float]) -> tuple[float, float]:
    """Bounds, 1/deg, that hold the values and at least `least`."""
    low, high = min(*values, least[0]), max(*values, least[1])
    margin = 0.06 * (high - low)
    return low - margin, high + margin
