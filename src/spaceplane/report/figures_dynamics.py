"""Pictures of flight dynamics: root loci along a parameter, modes over it, phasors of eigenvectors, time responses.

Every function returns a PNG.
"""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.dynamics.modes import Mode
from spaceplane.dynamics.tracking import Branches, Event
from spaceplane.environment.constants import STANDARD_GRAVITY
from spaceplane.errors import InputError, unknown_name
from spaceplane.report.figure_style import FIGURE_STYLE

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#0077bb", "#cc3311", "#009988", "#aa3377", "#222222", "#ee7733", "#33bbee", "#999933", "#882255")
STABLE = "#eaf4ea"
STYLE = FIGURE_STYLE | {"font.size": 9, "savefig.dpi": 110}
MARKS = {"merge": ("D", "two roots become a pair"), "split": ("s", "a pair splits"), "stability": ("*", "stable | not")}
STATE_LABELS = {"alpha": "α", "beta": "β", "gamma": "γ", "sigma": "σ", "R": "h"}

Window = tuple[float, float, float]


def root_locus(branches: Branches, windows: Sequence[Window] = (), label: str = "") -> bytes:
    """Eigenvalues in the upper half of the complex plane, coloured by the parameter; the stable half is shaded.

    Args:
        branches: of `dynamics.tracking.follow`.
        windows: (least real part, greatest real part, greatest imaginary part), 1/s, one panel each; one that holds
            everything by default.
        label: of the parameter's scale; its name and unit by default.
    """
    return png(lambda: _root_locus(branches, windows, label))


def over_parameter(branches: Branches, label: str = "", window: tuple[float, float] | None = None) -> bytes:
    """Real and imaginary part of every branch over the parameter, with the events.

    Args:
        branches: of `dynamics.tracking.follow`.
        label: of the parameter's axis.
        window: least and greatest real part, 1/s.
    """
    return png(lambda: _over_parameter(branches, label, window))


def phasors(modes: Sequence[Mode], speed: float, title: str = "") -> bytes:
    """Eigenvectors as arrows: who leads whom, and by how much.

    Components are made comparable: angles as they are, rates divided by the size of the eigenvalue (the angle swept in
    1 rad of the motion), speed by the speed of flight, height by V^2/g. Those below a tenth of the longest are left
    out.

    Args:
        modes: those to show.
        speed: of flight, m/s.
        title: above all of them.
    """
    if not modes:
        raise InputError("modes: none to show")
    return png(lambda: _phasors(modes, speed, title))


def responses(
    histories: Mapping[str, xr.Dataset],
    variables: Sequence[str],
    limits: Mapping[str, tuple[float, float]] | None = None,
) -> bytes:
    """Time histories, a panel for each variable, a line for each history; angles in degrees.

    Args:
        histories: {label: response}.
        variables: names of states or inputs; a history without it has no line there.
        limits: {variable: (least, greatest)} drawn as dashed lines, in rad or the variable's SI unit.
    """
    known = {str(name) for history in histories.values() for name in history.data_vars}
    for name in variables:
        if name not in known:
            raise InputError(unknown_name("variable", name, sorted(known)))
    return png(lambda: _responses(histories, variables, limits or {}))


def png(draw: Callable[[], Figure]) -> bytes:
    """A figure in the style of these pictures, drawn, as a PNG."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    with plt.rc_context(STYLE):
        figure = draw()
        data = io.BytesIO()
        figure.savefig(data, format="png", bbox_inches="tight", metadata={"Software": None})
        plt.close(figure)
    return data.getvalue()


def _axis(branches: Branches) -> tuple[str, np.ndarray, str]:
    """(name of the parameter, its values, label with unit)."""
    name = str(branches.dataset["real"].dims[0])
    coordinate = branches.dataset[name]
    unit = coordinate.attrs.get("units", "")
    return name, coordinate.values, f"{name}, {unit}" if unit else name


def _path(branches: Branches, k: int) -> tuple[np.ndarray, np.ndarray]:
    """(parameter, eigenvalue) of a branch, with the square roots at its branch points filled in."""
    _, parameter, _ = _axis(branches)
    every = branches.eigenvalues()
    labels = [str(x) for x in branches.dataset["branch"].values]
    extra: list[tuple[float, complex]] = []
    for event in branches.events:
        if event.kind in ("merge", "split") and labels[k] in event.branches:
            other = next(labels.index(x) for x in event.branches if x != labels[k])
            extra.append((event.parameter, event.eigenvalue))
            at = int(np.searchsorted(parameter, event.parameter))
            for j in {max(at - 1, 0), min(at, len(parameter) - 1)}:
                extra += _square_root(parameter[j], every[j, k], every[j, other], event)
    known = list(zip(parameter.tolist(), every[:, k].tolist(), strict=True))
    points = dict([*extra, *known])
    order = sorted(points)
    return np.array(order), np.array([points[x] for x in order])


def _square_root(start: float, own: complex, other: complex, event: Event) -> list[tuple[float, complex]]:
    """Points between a computed one and a branch point: the mean of the two roots is linear there, and so is the square
    of half their difference."""
    mean, half = (own + other) / 2, (own - other) / 2
    points = []
    for share in np.linspace(0.0, 1.0, 12)[1:-1] ** 2:
        away = 1.0 - share
        value = event.eigenvalue + away * (mean - event.eigenvalue) + math.sqrt(away) * half
        points.append((float(event.parameter + away * (start - event.parameter)), complex(value)))
    return points


def _numbers(branches: Branches) -> dict[int, int]:
    """{branch: number in the legend}: one for each branch that ever lies in the upper half plane or on the axis."""
    start = branches.eigenvalues()[0]
    return {int(k): n for n, k in enumerate((k for k in range(len(start)) if start[k].imag >= 0), start=1)}


def _bare(label: str) -> str:
    """A branch's label for the legend: pairs are shown once."""
    return label.replace(" (upper)", "")


def _root_locus(branches: Branches, windows: Sequence[Window], label: str) -> Figure:
    import matplotlib.pyplot as plt
    from matplotlib.lines import Line2D

    _, parameter, axis = _axis(branches)
    values = branches.eigenvalues()
    if not windows:
        pad = 0.06 * max(np.ptp(values.real), 1e-6)
        highest = max(1.08 * values.imag.max(), 0.25 * np.ptp(values.real))
        windows = [(values.real.min() - pad, values.real.max() + pad, highest)]
    figure, panels = plt.subplots(
        1, len(windows), figsize=(5.2 * len(windows) + 1.2, 4.4), squeeze=False, layout="constrained"
    )
    shade = plt.Normalize(parameter[0], parameter[-1])
    collection = None
    for k, (axes, window) in enumerate(zip(panels[0], windows, strict=True)):
        collection = _locus_panel(axes, branches, window, shade, windows[k + 1 :])
    figure.colorbar(collection, ax=panels[0].tolist(), label=label or axis, pad=0.01, aspect=30)
    numbers = _numbers(branches)
    labels = branches.dataset["branch"].values
    handles = [Line2D([], [], linestyle="", label=f"{n}  {_bare(str(labels[k]))}") for k, n in numbers.items()]
    handles += [
        Line2D([], [], linestyle="", marker=mark, color="#222222", markersize=9 if mark == "*" else 5, label=text)
        for kind, (mark, text) in MARKS.items()
        if any(event.kind == kind for event in branches.events)
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, handlelength=1.0)
    return figure


def _locus_panel(axes: Axes, branches: Branches, window: Window, shade: object, details: Sequence[Window]) -> object:
    """One panel; what lies in one of the later, closer views is numbered and marked there."""
    from matplotlib.collections import LineCollection

    left, right, top = window
    axes.set_xlim(left, right)
    axes.set_ylim(-0.04 * top, top)
    axes.axvspan(left, min(max(0.0, left), right), color=STABLE, zorder=0, linewidth=0)
    axes.axvline(0.0, color="#777777", linewidth=0.8, zorder=1)
    axes.axhline(0.0, color="#777777", linewidth=0.8, zorder=1)
    axes.set_xlabel("real part, 1/s")
    axes.set_ylabel("imaginary part, 1/s")
    collection = None
    for k in range(len(branches.dataset["branch"])):
        parameter, values = _path(branches, k)
        points = np.column_stack([values.real, values.imag])
        segments = np.stack([points[:-1], points[1:]], axis=1)
        upper = (segments[:, :, 1] >= -1e-12).all(axis=1)
        collection = LineCollection(list(segments[upper]), cmap="viridis", norm=shade, linewidths=2.0, zorder=3)
        collection.set_array(0.5 * (parameter[:-1] + parameter[1:])[upper])
        axes.add_collection(collection)
    numbers = _numbers(branches)
    placed: list[tuple[float, float]] = []
    for k, n in numbers.items():
        start, end = branches.eigenvalues()[[0, -1], k]
        axes.plot(start.real, start.imag, "o", color="#440154", markersize=4, zorder=4)
        axes.plot(end.real, abs(end.imag), "o", color="#c8b900", markersize=4, zorder=4)
        if _inside(start, window) and not any(_inside(start, detail) for detail in details):
            where = (start.real - left) / (right - left), start.imag / top
            rise = 1 + sum(abs(where[0] - x) < 0.03 and abs(where[1] - y) < 0.05 for x, y in placed)
            placed.append(where)
            shift = (3, 6 + 10 * (rise - 1))
            axes.annotate(str(n), (start.real, start.imag), shift, textcoords="offset points", fontsize=9, zorder=6)
    for event in branches.events:
        shown = event.kind in MARKS and _inside(event.eigenvalue, window)
        if shown and not any(_inside(event.eigenvalue, detail) for detail in details):
            mark = MARKS[event.kind][0]
            size = 10 if mark == "*" else 5
            x, y = event.eigenvalue.real, event.eigenvalue.imag
            axes.plot(x, y, mark, color="#cc3311", markersize=size, markeredgecolor="white", zorder=5)
    return collection


def _inside(value: complex, window: Window) -> bool:
    left, right, top = window
    return left <= value.real <= right and value.imag <= top


def _over_parameter(branches: Branches, label: str, window: tuple[float, float] | None) -> Figure:
    import matplotlib.pyplot as plt

    _, parameter, axis = _axis(branches)
    figure, panels = plt.subplots(2, 1, figsize=(8.2, 6.2), sharex=True, layout="constrained")
    numbers = _numbers(branches)
    labels = [str(x) for x in branches.dataset["branch"].values]
    for k in range(len(labels)):
        x, values = _path(branches, k)
        shown = numbers.get(k)
        colour = COLOURS[((shown or numbers.get(k - 1, 1)) - 1) % len(COLOURS)]
        style = "-" if shown else (0, (4, 2))
        panels[0].plot(x, values.real, color=colour, linestyle=style, label=_bare(labels[k]) if shown else None)
        panels[1].plot(x, np.where(values.imag >= 0, values.imag, np.nan), color=colour, linestyle=style)
    panels[0].axhspan(*_below_zero(panels[0], window), color=STABLE, zorder=0, linewidth=0)
    panels[0].axhline(0.0, color="#777777", linewidth=0.8)
    for event in branches.events:
        if event.kind in MARKS:
            mark = MARKS[event.kind][0]
            for axes, y in ((panels[0], event.eigenvalue.real), (panels[1], event.eigenvalue.imag)):
                size = 10 if mark == "*" else 5
                axes.plot(event.parameter, y, mark, color="#222222", markersize=size, markeredgecolor="white", zorder=5)
    panels[0].set_ylabel("real part, 1/s")
    panels[1].set_ylabel("imaginary part, 1/s")
    panels[1].set_xlabel(label or axis)
    panels[1].set_xlim(parameter[0], parameter[-1])
    panels[1].set_ylim(bottom=0.0)
    figure.legend(loc="outside lower center", ncols=3, frameon=False)
    return figure


def _below_zero(axes: Axes, window: tuple[float, float] | None) -> tuple[float, float]:
    if window is not None:
        axes.set_ylim(*window)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high)
    return low, min(max(0.0, low), high)


def _phasors(modes: Sequence[Mode], speed: float, title: str) -> Figure:
    import matplotlib.pyplot as plt

    columns = min(4, len(modes))
    rows = math.ceil(len(modes) / columns)
    figure = plt.figure(figsize=(2.75 * columns, 3.1 * rows), layout="constrained")
    for k, mode in enumerate(modes):
        components = _components(mode, speed)
        if mode.oscillatory:
            _arrows(figure.add_subplot(rows, columns, k + 1, projection="polar"), mode, components)
        else:
            _bars(figure.add_subplot(rows, columns, k + 1), mode, components)
        value = mode.eigenvalue
        text = f"{value.real:.3g}" + (f" ± {value.imag:.3g}i" if value.imag else "")
        figure.axes[-1].set_title(f"{_wrapped(mode.name)}\n{text} 1/s", fontsize=8.5)
    if title:
        figure.suptitle(title, fontsize=10)
    return figure


def _components(mode: Mode, speed: float) -> dict[str, complex]:
    """Comparable components over the largest, those of at least a tenth, largest first."""
    pairs = zip(mode.states, mode.eigenvector, strict=True)
    values = {state: _comparable(state, complex(z), mode, speed) for state, z in pairs}
    lead = max(values.values(), key=abs)
    shares = {state: z / lead for state, z in values.items() if abs(z) >= 0.1 * abs(lead)}
    return dict(sorted(shares.items(), key=lambda item: -abs(item[1])))


def _arrows(axes: Axes, mode: Mode, components: Mapping[str, complex]) -> None:
    from matplotlib.patheffects import withStroke

    colours = dict(zip(mode.states, COLOURS, strict=False))
    drawn: list[tuple[float, float]] = []
    placed: list[complex] = []
    for state, z in components.items():
        size, angle = abs(z), float(np.angle(z))
        axes.annotate(
            "",
            (angle, size),
            (angle, 0.0),
            arrowprops={"arrowstyle": "-|>", "color": colours[state], "linewidth": 1.7, "shrinkA": 0, "shrinkB": 0},
        )
        # Beside the tip where a longer arrow goes the same way, else behind it; farther out until it is free.
        covered = any(abs(np.exp(1j * angle) - np.exp(1j * other)) < 0.3 for other, _ in drawn)
        place = size * np.exp(1j * angle) + (0.13j if covered else 0.13) * np.exp(1j * angle)
        while any(abs(place - other) < 0.19 for other in placed):
            place += 0.08 * np.exp(1j * angle) + (0.06j * np.exp(1j * angle) if covered else 0)
        drawn.append((angle, size))
        placed.append(place)
        text = STATE_LABELS.get(state, state)
        label = axes.text(np.angle(place), abs(place), text, color=colours[state], ha="center", va="center", fontsize=9)
        label.set(zorder=6, path_effects=[withStroke(linewidth=2.5, foreground="white")])
    axes.set_ylim(0.0, max([1.2, *(abs(place) + 0.1 for place in placed)]))
    axes.set_yticks([0.5, 1.0], ["", ""])
    axes.set_xticks(np.radians([0, 90, 180, 270]), ["", "", "", ""])
    axes.spines["polar"].set_visible(False)


def _bars(axes: Axes, mode: Mode, components: Mapping[str, complex]) -> None:
    """An aperiodic mode has no phase: its components are of one sign or the other."""
    colours = dict(zip(mode.states, COLOURS, strict=False))
    labels = [STATE_LABELS.get(state, state) for state in components]
    axes.barh(labels, [z.real for z in components.values()], color=[colours[s] for s in components], height=0.6)
    axes.axvline(0.0, color="#777777", linewidth=0.8)
    axes.set_xlim(-1.1, 1.1)
    axes.set_ylim(max(len(labels), 4) - 0.4, -0.6)
    axes.grid(axis="y", visible=False)


def _wrapped(text: str) -> str:
    """The text on two lines where it is long."""
    if len(text) <= 24:
        return text
    cut = min((i for i, c in enumerate(text) if c == " "), key=lambda i: abs(i - len(text) / 2), default=0)
    return f"{text[:cut]}\n{text[cut + 1 :]}" if cut else text


def _comparable(state: str, value: complex, mode: Mode, speed: float) -> complex:
    if state in ("p", "q", "r"):
        return value / max(abs(mode.eigenvalue), 1e-12)
    if state in ("V", "u", "v", "w"):
        return value / speed
    if state in ("R", "h"):
        return value * STANDARD_GRAVITY / speed**2
    return value


def _responses(
    histories: Mapping[str, xr.Dataset], variables: Sequence[str], limits: Mapping[str, tuple[float, float]]
) -> Figure:
    import matplotlib.pyplot as plt

    columns = 2 if len(variables) > 1 else 1
    rows = math.ceil(len(variables) / columns)
    figure, grid = plt.subplots(
        rows, columns, figsize=(4.6 * columns, 2.0 * rows + 0.5), squeeze=False, sharex=True, layout="constrained"
    )
    for axes, name in zip(grid.flat, variables, strict=False):
        factor, unit = 1.0, ""
        for k, (label, history) in enumerate(histories.items()):
            if name in history:
                unit = history[name].attrs.get("units", "")
                factor = 180.0 / math.pi if unit.startswith("rad") else 1.0
                time = history["time"].values
                axes.plot(time, factor * history[name].values, color=COLOURS[k % len(COLOURS)], label=label)
        low, high = axes.get_ylim()
        for bound in limits.get(name, ()):
            axes.axhline(factor * bound, color="#666666", linestyle="--", linewidth=1.0)
        if name not in limits:
            axes.set_ylim(low, high)
        axes.set_ylabel(f"{STATE_LABELS.get(name, name.replace('_', ' '))}, {unit.replace('rad', 'deg')}")
    for axes in list(grid.flat)[len(variables) :]:
        axes.remove()
    for axes in grid[-1]:
        axes.set_xlabel("time, s")
    if len(histories) > 1:
        handles, labels = next(
            (a.get_legend_handles_labels() for a in grid.flat if len(a.lines) >= len(histories)),
            grid[0, 0].get_legend_handles_labels(),
        )
        figure.legend(handles, labels, loc="outside upper center", ncols=len(histories), frameon=False)
    return figure
