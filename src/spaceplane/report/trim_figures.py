"""Pictures of trim maps. matplotlib is imported when one is drawn."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.report.figure_style import FIGURE_STYLE

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STYLE = FIGURE_STYLE | {"font.size": 9, "savefig.dpi": 130, "axes.grid": False}
NO_TRIM = "#d9d9d9"
_WIDE = 3.0  # ratio of Mach numbers from which their axis is logarithmic
_MACH_TICKS = (0.5, 0.8, 1, 1.5, 2, 3, 5, 7.5, 10, 15, 20, 25)
_SHARES = (1.0, 99.0)  # per cent of the cells between the ends of the colours
_FLAT = 1e-6
# quantity, title, factor to the unit shown, colours, whether zero is the middle
_PANELS = (
    ("elevator", "elevator, deg (down positive)", math.degrees(1.0), "RdBu_r", True),
    ("body_flap", "body flap, deg (down positive)", math.degrees(1.0), "PuOr_r", True),
    ("margin", "elevator's distance to its limit, deg", math.degrees(1.0), "viridis", False),
    ("static_margin", "static margin, % of the chord", 100.0, "RdBu", True),
    ("lift_to_drag", "trimmed lift over drag", 1.0, "cividis", False),
    ("CL", "trimmed lift coefficient", 1.0, "cividis", False),
)


def trim_map_figure(found: xr.Dataset) -> Figure:
    """Deflections, margins and trimmed forces over Mach number and angle of attack; grey where there is no trim.

    Args:
        found: what `dynamics.trim.maps.trim_map` gave, with at least two values on either axis.
    """
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 3, figsize=(12.0, 6.6), sharex=True, sharey=True, layout="constrained")
    for panel, (name, title, factor, colours, centred) in zip(axes.flat, _PANELS, strict=True):
        _panel(panel, found, name, title, factor, colours, centred)
    for panel in axes[-1]:
        panel.set_xlabel("Mach number")
    for panel in axes[:, 0]:
        panel.set_ylabel("angle of attack, deg")
    figure.suptitle(f"{found.attrs['model']}: trim in pitch; grey: none within limits", fontsize=11)
    return figure


def write_trim_map(found: xr.Dataset, path: Path | str) -> None:
    """Draw `trim_map_figure` into a file.

    Args:
        found: what `dynamics.trim.maps.trim_map` gave.
        path: ends in .png, .svg or .pdf.
    """
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    with plt.rc_context(STYLE):
        figure = trim_map_figure(found)
        figure.savefig(path, bbox_inches="tight")
        plt.close(figure)


def _panel(axes: Axes, found: xr.Dataset, name: str, title: str, factor: float, colours: str, centred: bool) -> None:
    mach, alpha = found.mach.values, np.degrees(found.alpha.values)
    values = factor * found[name].values.T
    axes.set_facecolor(NO_TRIM)
    axes.set_title(title, fontsize=9.5)
    known = values[np.isfinite(values)]
    # A few extreme cells, such as a static margin where the normal force hardly changes, do not set the colours.
    low, high = np.percentile(known, _SHARES).tolist() if len(known) else (0.0, 1.0)
    if centred:
        high = max(abs(low), abs(high), 1e-9)
        low = -high
    mesh = axes.pcolormesh(mach, alpha, values, cmap=colours, vmin=low, vmax=high, shading="nearest")
    beyond = len(known) > 0 and (known.min() < low, known.max() > high)
    extend = {(True, True): "both", (True, False): "min", (False, True): "max"}.get(beyond, "neither")
    axes.figure.colorbar(mesh, ax=axes, pad=0.02, extend=extend)
    if min(values.shape) > 1 and high - low > _FLAT:
        smooth = np.clip(np.round(values, 6), low, high)
        lines = axes.contour(mach, alpha, smooth, levels=6, colors="#333333", linewidths=0.6)
        axes.clabel(lines, fontsize=7, fmt="%.3g")
    if mach[-1] > _WIDE * mach[0] > 0.0:
        axes.set_xscale("log")
        ticks = [tick for tick in _MACH_TICKS if mach[0] <= tick <= mach[-1]]
        axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.minorticks_off()
