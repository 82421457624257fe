"""Plots of a sensitivity study, in the manner of the thesis's Figures 7.1 to 7.15.

matplotlib is imported when a plot is drawn, not with the package.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from spaceplane.qualities import limits
from spaceplane.report.figure_style import FIGURE_STYLE
from spaceplane.study.changes import Change, lateral_oscillation, mode_figure, most_unstable
from spaceplane.study.thesis import DERIVATIVES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from spaceplane.study.sensitivity import SensitivityResult

LOW, HIGH, NEUTRAL = "#0077bb", "#ee7733", "#333333"
MACH_COLOURS = ("#0077bb", "#cc3311", "#222222", "#009988", "#aa3377")
LEVEL_COLOURS = {1: "#1b7837", 2: "#b8860b", 3: "#b2182b"}
STYLE = FIGURE_STYLE | {"font.size": 9, "savefig.dpi": 110, "svg.hashsalt": "spaceplane"}
PARTS = (
    ("wing_width_m", "wing_thickness_m", "winglet_top_length_m", "winglet_length_m", "winglet_bottom_length_m"),
    (
        "wing_corner_width_m",
        "wing_corner_length_m",
        "winglet_angle_deg",
        "winglet_angle_back_deg",
        "nosecone_height_m",
    ),
    (
        "fuselage_width_m",
        "fuselage_height_m",
        "fuselage_length_m",
        "fuselage_bottom_curvature_width_m",
        "fuselage_bottom_curvature_height_m",
    ),
)
"""The parameters by figure, as the thesis groups them; others follow in figures of five."""

_CLASS_AND_CATEGORY = (("vehicle_class", "III"), ("category", "B"))
_GREATEST_PERCENT = 150.0  # taller bars are cut there and labelled with their value


def write_plots(found: SensitivityResult, out_dir: Path) -> dict[str, Path]:
    """Draw every plot as PNG and SVG into `out_dir`; return the PNG paths by what they show."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    files = {}
    with plt.rc_context(STYLE):
        for name, figure in _figures(found):
            files[name] = out_dir / f"{name}.png"
            figure.savefig(files[name], bbox_inches="tight", metadata={"Software": None})
            figure.savefig(out_dir / f"{name}.svg", bbox_inches="tight", metadata={"Date": None})
            plt.close(figure)
    return files


def _figures(found: SensitivityResult):
    yield "eigenvalues_default", eigenvalues(found.default)
    for point in found.default["flight_points"]:
        mach = point["mach"]
        for number, parameters in enumerate(_parts(found), start=1):
            yield f"derivatives_mach_{mach:g}_part_{number}", derivative_bars(found.rows, mach, parameters)
        if point["modes"]:  # none where a flow of the default shape failed
            yield f"greatest_real_part_mach_{mach:g}", greatest_real_part(found, mach)
            yield f"lateral_oscillation_mach_{mach:g}", lateral_levels(found, mach)


def derivative_bars(rows: tuple[Change, ...], mach: float, parameters: tuple[str, ...]) -> Figure:
    """Draw relative changes of the nine derivatives, one panel for each parameter (the thesis's Figures 7.1 to 7.9).

    Cm_alpha is near zero by trim, so its change is the relative percent difference of thesis (7.1). Bars beyond 150 %
    are cut and labelled; a cross stands where a flow failed; grey is what a shift of the mesh alone changes.
    """
    import matplotlib.pyplot as plt

    height = 1.25 * len(parameters) + 1.2
    figure, axes = plt.subplots(len(parameters), 1, figsize=(8.2, height), sharex=True, squeeze=False)
    chosen = {(row.parameter, row.side, row.quantity): row for row in rows if row.mach == mach}
    for ax, parameter in zip(axes[:, 0], parameters, strict=True):
        _parameter_panel(ax, chosen, parameter)
    ticks = [symbol(name) + (" (RPD)" if name == "Cm_alpha" else "") for name in DERIVATIVES]
    axes[-1, 0].set_xticks(range(len(DERIVATIVES)), ticks, fontsize=10)
    if len(parameters) > 2:
        figure.supylabel("change from the default shape, %", fontsize=9, color="#444444")
    else:
        axes[0, 0].set_ylabel("change, %")
    figure.suptitle(f"Aerodynamic derivatives with shape, Mach {mach:g}", x=0.01, ha="left", fontsize=12, weight="bold")
    if any(row.noise for row in chosen.values()):
        figure.text(
            0.99, 0.985, "grey: change by a shift of the mesh", ha="right", va="top", fontsize=8, color="#777777"
        )
    figure.tight_layout(h_pad=0.5)
    return figure


def _parameter_panel(ax: Axes, chosen: dict, parameter: str) -> None:
    values = {}
    tallest = 2.0
    for side, colour, shift in (("low", LOW, -0.2), ("high", HIGH, 0.2)):
        for place, name in enumerate(DERIVATIVES):
            row = chosen.get((parameter, side, name))
            if row is None:
                continue
            values[side] = row.parameter_value
            size = row.rpd_percent if name == "Cm_alpha" else row.relative_percent
            if row.flow == "failed" or size is None:
                ax.plot(place + shift, 0.0, "x", color=colour, ms=6, zorder=4)
                continue
            shown = max(-_GREATEST_PERCENT, min(_GREATEST_PERCENT, size))
            ax.bar(place + shift, shown, 0.38, color=colour, zorder=3)
            tallest = max(tallest, abs(shown))
            if shown != size:
                edge = "bottom" if size > 0 else "top"
                ax.text(place + shift, shown, f"{size:.0f}", ha="center", va=edge, fontsize=6.5, color=colour)
    ax.axhline(0.0, color="#666666", lw=0.8, zorder=2)
    widest = _noise_bands(ax, chosen, parameter)
    limit = 1.25 * max(tallest, min(widest, 2.0 * tallest))  # noise far above every change runs out of the panel
    ax.set_ylim(-limit, limit)
    ax.xaxis.grid(False)
    unit = _unit(parameter)
    texts = [f"{side} {value:g} {unit}" for side, value in values.items()]
    ax.set_title(title(parameter), loc="left", fontsize=9, weight="bold", pad=3)
    for text, colour, place in zip(texts, (LOW, HIGH), (0.86, 1.0), strict=False):
        ax.text(
            place, 1.03, text, transform=ax.transAxes, ha="right", va="bottom", fontsize=8, color=colour, weight="bold"
        )


def _noise_bands(ax: Axes, chosen: dict, parameter: str) -> float:
    """Shade, for each derivative, the change that a shift of the mesh alone makes; return the greatest, %."""
    widest = 0.0
    for place, name in enumerate(DERIVATIVES):
        row = chosen.get((parameter, "low", name)) or chosen.get((parameter, "high", name))
        if row is None or not row.noise or not row.default:
            continue
        size = min(100.0 * row.noise / abs(row.default), _GREATEST_PERCENT)
        ax.bar(place, 2 * size, 0.86, bottom=-size, color="#d5d5d5", zorder=1)
        widest = max(widest, size)
    return widest


def eigenvalues(result: dict) -> Figure:
    """Draw all eigenvalues of one vehicle by flight point, and those near the origin (the thesis's Figure 7.10)."""
    import matplotlib.pyplot as plt

    figure, (whole, near) = plt.subplots(1, 2, figsize=(9.2, 4.2))
    for point, colour in zip(result["flight_points"], MACH_COLOURS, strict=False):
        values = [complex(*mode["eigenvalue"]) for mode in point["modes"]]
        values += [value.conjugate() for value in values if value.imag]
        for ax in (whole, near):
            ax.scatter(
                [value.real for value in values],
                [value.imag for value in values],
                s=44,
                facecolors="none",
                edgecolors=colour,
                linewidths=1.6,
                label=f"Mach {point['mach']:g}",
                zorder=3,
            )
    near.set_xlim(-0.12, 0.12)
    near.set_ylim(-0.12, 0.12)
    for ax, name in ((whole, "all"), (near, "near the origin")):
        _complex_plane(ax)
        ax.set_title(name, loc="left", fontsize=9, weight="bold")
    whole.legend(frameon=False, loc="best")
    figure.suptitle("Eigenvalues of the default shape", x=0.01, ha="left", fontsize=12, weight="bold")
    figure.tight_layout()
    return figure


def greatest_real_part(found: SensitivityResult, mach: float) -> Figure:
    """Draw the most unstable eigenvalue by shape: complex plane and distance (the thesis's Figures 7.11 to 7.13)."""
    import matplotlib.pyplot as plt

    shapes = _modes_by_shape(found, mach, most_unstable)
    default = most_unstable(_point(found.default, mach)["modes"])
    figure, (plane, rows) = plt.subplots(1, 2, figsize=(10.5, 4.6), width_ratios=(1.0, 1.1))
    for (_, side), mode in shapes.items():
        marker, colour = ("v", LOW) if side == "low" else ("^", HIGH)
        plane.plot(mode["eigenvalue"][0], abs(mode["eigenvalue"][1]), marker, color=colour, ms=6, alpha=0.85)
    plane.plot(default["eigenvalue"][0], abs(default["eigenvalue"][1]), "*", color=NEUTRAL, ms=13, zorder=4)
    _complex_plane(plane)
    plane.set_title("complex plane (upper half)", loc="left", fontsize=9, weight="bold")
    _label_farthest(plane, shapes, default)
    values = {key: mode["eigenvalue"][0] for key, mode in shapes.items()}
    _dumbbells(rows, values, default["eigenvalue"][0], "greatest real part, 1/s")
    rows.set_title("real part by parameter", loc="left", fontsize=9, weight="bold")
    _side_legend(figure)
    figure.suptitle(f"Most unstable eigenvalue, Mach {mach:g}", x=0.01, ha="left", fontsize=12, weight="bold")
    figure.tight_layout()
    return figure


def lateral_levels(found: SensitivityResult, mach: float) -> Figure:
    """Draw the lateral oscillation against MIL-F-8785C (the thesis's Figures 7.14 and 7.15)."""
    import matplotlib.pyplot as plt

    shapes = _modes_by_shape(found, mach, lateral_oscillation)
    default = lateral_oscillation(_point(found.default, mach)["modes"])
    vehicle_class, category = (found.default["settings"].get(key, default) for key, default in _CLASS_AND_CATEGORY)
    limits_of = limits.of("dutch_roll", category, vehicle_class)
    figure, axes = plt.subplots(1, 3, figsize=(12.0, 4.6), sharey=True)
    panels = (
        ("damping ratio ζ", lambda mode: mode_figure(mode, "damping_ratio"), "zeta"),
        ("natural frequency ω, rad/s", lambda mode: mode_figure(mode, "natural_frequency"), "omega"),
        ("ζω, 1/s", _product, "zeta_omega"),
    )
    for ax, (label, figure_of, limited) in zip(axes, panels, strict=True):
        values = {key: figure_of(mode) for key, mode in shapes.items()}
        _dumbbells(ax, values, figure_of(default) if default else None, label)
        for row, (limit, levels) in enumerate(_by_limit(limits_of[limited]).items()):
            level = levels[0]
            ax.axvline(limit, color=LEVEL_COLOURS[level], lw=1.2, ls="--", zorder=1)
            text = f"level {level}" if len(levels) == 1 else f"levels {levels[0]}-{levels[-1]}"
            style = {"color": LEVEL_COLOURS[level], "fontsize": 7.5, "ha": "center", "va": "bottom"}
            ax.text(limit, 1.01 + 0.04 * (row % 2), text, transform=ax.get_xaxis_transform(), **style)
    _side_legend(figure)
    figure.suptitle(
        f"Lateral oscillation, Mach {mach:g}; dashed: least values of MIL-F-8785C, class {vehicle_class}, category "
        f"{category}",
        x=0.01,
        ha="left",
        fontsize=12,
        weight="bold",
    )
    figure.tight_layout()
    return figure


def symbol(name: str) -> str:
    """Return a derivative as mathematics."""
    coefficient, _, variable = name.partition("_")
    variable = {"alpha": r"\alpha", "beta": r"\beta"}.get(variable, variable)
    return rf"$C_{{{coefficient[1:]}_{{{variable}}}}}$"


def title(parameter: str) -> str:
    """Return a parameter's name in words, without its unit."""
    return parameter.rpartition("_")[0].replace("_", " ")


def _unit(parameter: str) -> str:
    return {"deg": "°"}.get(parameter.rpartition("_")[2], parameter.rpartition("_")[2])


def _parts(found: SensitivityResult) -> list[tuple[str, ...]]:
    asked = list(dict.fromkeys(one.parameter for one in found.variations))
    parts = [tuple(name for name in part if name in asked) for part in PARTS]
    rest = [name for name in asked if not any(name in part for part in PARTS)]
    parts += [tuple(rest[start : start + 5]) for start in range(0, len(rest), 5)]
    return [part for part in parts if part]


def _point(result: dict, mach: float) -> dict:
    return next(point for point in result["flight_points"] if point["mach"] == mach)


def _modes_by_shape(found: SensitivityResult, mach: float, choose) -> dict[tuple[str, str], dict]:
    modes = {}
    for one, result in zip(found.variations, found.results, strict=True):
        point = _point(result, mach)
        mode = choose(point["modes"])
        if mode is not None and not any(record["verdict"] == "failed" for record in point["convergence"]):
            modes[one.parameter, one.side] = mode
    return modes


def _product(mode: dict) -> float | None:
    ratio, frequency = mode_figure(mode, "damping_ratio"), mode_figure(mode, "natural_frequency")
    return None if ratio is None or frequency is None else ratio * frequency


def _by_limit(least: list[float]) -> dict[float, list[int]]:
    """Return the levels that share each least value."""
    levels: dict[float, list[int]] = {}
    for level, limit in enumerate(least, start=1):
        levels.setdefault(limit, []).append(level)
    return levels


def _dumbbells(ax: Axes, values: dict[tuple[str, str], float | None], default: float | None, label: str) -> None:
    parameters = list(dict.fromkeys(parameter for parameter, _ in values))
    for row, parameter in enumerate(reversed(parameters)):
        ends = [values.get((parameter, side)) for side in ("low", "high")]
        known = [value for value in (*ends, default) if value is not None]
        if known:
            ax.plot([min(known), max(known)], [row, row], color="#bbbbbb", lw=2, zorder=2)
        for value, colour, marker in zip(ends, (LOW, HIGH), ("v", "^"), strict=True):
            if value is not None:
                ax.plot(value, row, marker, color=colour, ms=6, zorder=3)
    if default is not None:
        ax.axvline(default, color=NEUTRAL, lw=1.0, zorder=1)
    ax.set_yticks(range(len(parameters)), [title(name) for name in reversed(parameters)])
    ax.yaxis.grid(False)
    ax.set_xlabel(label)


def _complex_plane(ax: Axes) -> None:
    ax.axhline(0.0, color="#999999", lw=0.8, zorder=1)
    ax.axvline(0.0, color="#999999", lw=0.8, zorder=1)
    ax.set_xlabel("real part, 1/s")
    ax.set_ylabel("imaginary part, 1/s")


def _label_farthest(ax: Axes, shapes: dict[tuple[str, str], dict], default: dict) -> None:
    """Name the four shapes whose eigenvalue lies farthest from the default's."""
    if not any(mode["eigenvalue"][1] for mode in shapes.values()):
        return  # all on the real axis: the other panel tells them apart
    start = complex(*default["eigenvalue"])
    distance = {key: abs(complex(*mode["eigenvalue"]) - start) for key, mode in shapes.items()}
    for key in sorted(distance, key=distance.get, reverse=True)[:4]:
        re, im = shapes[key]["eigenvalue"]
        ax.annotate(
            f"{title(key[0])} {key[1]}",
            (re, abs(im)),
            xytext=(5, 5),
            textcoords="offset points",
            fontsize=7,
            color="#444444",
        )


def _side_legend(figure: Figure) -> None:
    from matplotlib.lines import Line2D

    entries = [
        Line2D([], [], marker="v", color=LOW, ls="", label="low value"),
        Line2D([], [], marker="^", color=HIGH, ls="", label="high value"),
        Line2D([], [], marker="*", color=NEUTRAL, ls="", ms=10, label="default (line or star)"),
    ]
    figure.legend(handles=entries, ncols=3, frameon=False, loc="upper right", fontsize=8)
