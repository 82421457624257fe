"""Pictures of an aerodynamic model: coefficients and slopes over the angle of attack, increments over deflections."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.integrate import LATERAL
from spaceplane.aero.model.model import BASE, SLOPES, AeroModel
from spaceplane.report.figure_style import FIGURE_STYLE
from spaceplane.vehicle.controls import CONTROLS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STYLE = FIGURE_STYLE | {"font.size": 9, "axes.titlesize": 9.5}
INCREMENTS_AT = math.radians(20.0)
"""Increments are shown at the node nearest to this angle of attack, rad."""
_COLUMNS = 4
_PANEL = (3.1, 2.5)


def pictures(model: AeroModel) -> dict[str, bytes]:
    """PNG by name: "coefficients", "increments" where there are control surfaces, "slopes" where there are any."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    drawn = {}
    with plt.rc_context(STYLE):
        for name, draw, present in (
            ("coefficients", coefficients_figure, True),
            ("increments", increments_figure, bool(model.surfaces)),
            ("slopes", slopes_figure, bool(model.slopes)),
        ):
            if present:
                figure = draw(model)
                data = io.BytesIO()
                figure.savefig(data, format="png", dpi=130, bbox_inches="tight")
                plt.close(figure)
                drawn[name] = data.getvalue()
    return drawn


def coefficients_figure(model: AeroModel) -> Figure:
    """CL, CD, Cm and lift over drag over the angle of attack, a line for each Mach number."""
    figure, axes = _panels(_COLUMNS, _COLUMNS)
    tables = dict(model.base) | {"CL / CD": model.base["CL"] / model.base["CD"]}
    for panel, (name, table) in zip(axes, tables.items(), strict=True):
        _over_alpha(panel, model, name, table)
    _finish(figure, axes, model, "coefficients without deflection")
    return figure


def slopes_figure(model: AeroModel) -> Figure:
    """Slopes with sideslip and rates over the angle of attack, a line for each Mach number."""
    names = [name for name in SLOPES if name in model.slopes]
    figure, axes = _panels(len(names), _COLUMNS)
    for panel, name in zip(axes, names, strict=True):
        unit = "per rad" if name.endswith("_beta") else f"on {dict(p='p b', q='q c', r='r b')[name[-1]]}/2V"
        _over_alpha(panel, model, f"{name}, {unit}", model.slopes[name])
    _finish(figure, axes, model, "slopes")
    return figure


def increments_figure(model: AeroModel) -> Figure:
    """What each surface adds over its deflection at one angle of attack; those to the left and in the middle."""
    names = [name for name in CONTROLS if name in model.surfaces and not name.endswith("_right")]
    row = int(np.argmin(np.abs(model.alpha - INCREMENTS_AT)))
    figure, axes = _panels(len(names) * len(FORCES_AND_MOMENTS), len(FORCES_AND_MOMENTS), 0.8)
    for name, line in zip(names, axes.reshape(len(names), -1), strict=True):
        surface = model.surfaces[name]
        for panel, coefficient in zip(line, (*BASE, *LATERAL), strict=True):
            table = surface.increments.get(coefficient)
            if table is None:
                panel.set_axis_off()
                continue
            for mach, colour, values in zip(model.mach, _colours(len(model.mach)), table[:, row].T, strict=True):
                panel.plot(np.degrees(surface.deflection), values, ".-", color=colour, lw=1.2, label=f"Mach {mach:g}")
            panel.axhline(0.0, color="#888888", lw=0.7)
            panel.set_title(f"{coefficient} of {name.replace('_', ' ')}")
            panel.set_xlabel("deflection, deg")
    _finish(figure, axes, model, f"increments at alpha {math.degrees(model.alpha[row]):.3g} deg")
    return figure


def _panels(count: int, columns: int, scale: float = 1.0) -> tuple[Figure, np.ndarray]:
    import matplotlib.pyplot as plt

    rows = math.ceil(count / columns)
    size = (scale * _PANEL[0] * columns, scale * _PANEL[1] * rows + 0.6)
    figure, axes = plt.subplots(rows, columns, figsize=size, layout="constrained", squeeze=False)
    for spare in axes.flat[count:]:
        spare.set_axis_off()
    return figure, axes.flat[:count]


def _over_alpha(panel: Axes, model: AeroModel, title: str, table: np.ndarray) -> None:
    for mach, colour, values in zip(model.mach, _colours(len(model.mach)), table.T, strict=True):
        panel.plot(np.degrees(model.alpha), values, ".-", color=colour, lw=1.2, label=f"Mach {mach:g}")
    panel.axhline(0.0, color="#888888", lw=0.7)
    panel.set_title(title)
    panel.set_xlabel("alpha, deg")


def _colours(count: int) -> list:
    import matplotlib.pyplot as plt

    return list(plt.get_cmap("viridis")(np.linspace(0.0, 0.9, count)))


def _finish(figure: Figure, axes: Sequence[Axes], model: AeroModel, what: str) -> None:
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 10), frameon=False)
    figure.suptitle(f"{model.name}: {what}", fontsize=11)
