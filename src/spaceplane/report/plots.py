"""The report's drawings: eigenvalues in the complex plane, convergence histories, levels and phases."""

from __future__ import annotations

import math
from html import escape

import numpy as np

from spaceplane.report.numbers import MINUS, duration, measured, number
from spaceplane.report.svg import Frame, Scale, drawing, padded

POINT_COLOURS = 6  # colours of flight points in the style sheet
LEAST_SLOW = 1e-7  # 1/s: an eigenvalue below this is zero to round-off and does not set the slow end of the axes


def eigenvalue_text(eigenvalue: list[float]) -> str:
    """`-0.021 ± 0.015i` as text."""
    real, imaginary = eigenvalue
    if imaginary == 0:
        return number(real, 4)
    return f"{number(real, 4)} ± {number(abs(imaginary), 4)}i"


def mode_title(mode: dict, index: int) -> str:
    """What a mode's marker says when pointed at."""
    lines = [f"{index}  {mode['name']}", f"λ = {eigenvalue_text(mode['eigenvalue'])} 1/s"]
    if mode.get("period_s"):
        lines.append(f"period {duration(mode['period_s'])}, damping ratio {number(mode.get('damping_ratio'), 3)}")
    if mode.get("half_time_s"):
        lines.append(f"half time {duration(mode['half_time_s'])}")
    if mode.get("double_time_s"):
        lines.append(f"double time {duration(mode['double_time_s'])}")
    return "\n".join(lines)


def eigenvalue_planes(modes: list[dict]) -> str:
    """Two views of the complex plane: linear for the fast modes, symmetric-logarithmic for all of them."""
    if not modes:
        return ""
    return _plane(modes, None, "Linear axes: the fast modes") + _plane(
        modes, _linear_width(modes), "Symmetric-logarithmic axes: the slow modes too"
    )


def eigenvalues_together(points: list[dict]) -> str:
    """The upper half of the complex plane with the eigenvalues of every flight point, one colour each."""
    marks = [(k, p["name"], n, m) for k, p in enumerate(points) for n, m in enumerate(p.get("modes") or [], 1)]
    if len({k for k, *_ in marks}) < 2:
        return ""
    modes = [m for *_, m in marks]
    width, height, left, top = 1140.0, 330.0, 68.0, 24.0
    linear = _linear_width(modes)
    x_range, (_, highest) = _ranges(modes, linear)
    frame = Frame(
        left, top, width - left - 12, height - top - 44, Scale(*x_range, linear), Scale(-0.5 * linear, highest, linear)
    )
    out = [_half_planes(frame)]
    for k, name, number_, mode in marks:
        real, imaginary = mode["eigenvalue"]
        title = escape(f"{name}\n{mode_title(mode, number_)}")
        out.append(
            f'<g class="mode-marker point-{k % POINT_COLOURS}" tabindex="0" data-tip="{title}"><title>{title}</title>'
            f'<circle cx="{frame.x(real):.1f}" cy="{frame.y(abs(imaginary)):.1f}" r="6"/></g>'
        )
    return drawing(width, height, *out, title="eigenvalues of all flight points")


def _linear_width(modes: list[dict]) -> float:
    sizes = [abs(part) for mode in modes for part in mode["eigenvalue"] if abs(part) > LEAST_SLOW]
    smallest = min(sizes, default=1e-3)
    return 10.0 ** math.floor(math.log10(smallest))


def _ranges(modes: list[dict], linear_width: float | None) -> tuple[tuple[float, float], tuple[float, float]]:
    """Ranges of real and imaginary part that hold every eigenvalue and its conjugate."""
    reals = [m["eigenvalue"][0] for m in modes]
    largest = max(max(abs(m["eigenvalue"][1]) for m in modes), 0.25 * max(map(abs, reals)), 1e-6)
    if linear_width is None:
        return padded([*reals, 0.0], 0.12, 1e-6), padded([-largest, largest], 0.1)
    reach, least = 3.0, 10 * linear_width
    return (min(min(reals) * reach, -least), max(max(reals) * reach, least)), (-largest * reach, largest * reach)


def _half_planes(frame: Frame) -> str:
    """Axes with the growing half shaded."""
    zero, right, bottom = frame.x(0.0), frame.left + frame.width, frame.top + frame.height
    level, names = frame.y(0.0), frame.top - 8
    return (
        f'<rect class="unstable-half" x="{zero:.1f}" y="{frame.top}" width="{right - zero:.1f}" '
        f'height="{frame.height}"/>'
        + frame.axes("real part, 1/s", "imaginary part, rad/s", 6, 6)
        + f'<line class="zero" x1="{zero:.1f}" x2="{zero:.1f}" y1="{frame.top}" y2="{bottom}"/>'
        f'<line class="zero" x1="{frame.left}" x2="{right}" y1="{level:.1f}" y2="{level:.1f}"/>'
        f'<text class="half-name" x="{right}" y="{names}" text-anchor="end">grows</text>'
        f'<text class="half-name decays" x="{frame.left}" y="{names}">decays</text>'
    )


def _plane(modes: list[dict], linear_width: float | None, caption: str) -> str:
    width, height, left, top = 560.0, 390.0, 68.0, 24.0
    x_range, y_range = _ranges(modes, linear_width)
    frame = Frame(
        left, top, width - left - 12, height - top - 44, Scale(*x_range, linear_width), Scale(*y_range, linear_width)
    )
    out = [_half_planes(frame)]
    marks = [
        (frame.x(mode["eigenvalue"][0]), frame.y(part), index, mode)
        for index, mode in enumerate(modes, 1)
        for part in sorted({mode["eigenvalue"][1], -mode["eigenvalue"][1]})
    ]
    spots = _badge_spots([(x, y) for x, y, _, _ in marks], frame)
    for (x, y, index, mode), (bx, by) in zip(marks, spots, strict=True):
        title = escape(mode_title(mode, index))
        css = "mode-marker grows" if mode["eigenvalue"][0] > 0 else "mode-marker"
        leader = f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{bx:.1f}" y2="{by:.1f}"/>' if (bx, by) != (x, y) else ""
        out.append(
            f'<g class="{css}" tabindex="0" data-tip="{title}"><title>{title}</title>{leader}'
            f'<circle class="spot" cx="{x:.1f}" cy="{y:.1f}" r="3.5"/>'
            f'<circle cx="{bx:.1f}" cy="{by:.1f}" r="9"/><text x="{bx:.1f}" y="{by + 3.6:.1f}">{index}</text></g>'
        )
    return f"<figure>{drawing(width, height, *out, title=caption)}<figcaption>{escape(caption)}</figcaption></figure>"


def _badge_spots(points: list[tuple[float, float]], frame: Frame) -> list[tuple[float, float]]:
    """Where each point's numbered badge goes: on the point, or beside it where another badge or point is in the way."""
    angles = [math.radians(a) for a in (90, 50, 130, 20, 160, -20, -160, -50, -130, -90)]
    around = [(reach * math.cos(a), -reach * math.sin(a)) for reach in (26.0, 46.0, 66.0, 86.0) for a in angles]
    placed: list[tuple[float, float]] = []
    for k, (x, y) in enumerate(points):
        others = points[:k] + points[k + 1 :]
        for dx, dy in [(0.0, 0.0), *around]:
            bx, by = x + dx, y + dy
            free = all(math.hypot(bx - px, by - py) >= 19 for px, py in placed)
            clear = all(math.hypot(bx - px, by - py) >= 13 for px, py in others)
            inside = frame.left + 9 <= bx <= frame.left + frame.width - 9
            inside = inside and frame.top + 9 <= by <= frame.top + frame.height - 9
            if free and clear and inside:
                break
        placed.append((bx, by))
    return placed


def convergence_plot(record: dict) -> str:
    """Residual (decades) above and force deviation from its final value (per cent) below, over iterations."""
    width, height, left = 300.0, 206.0, 40.0
    residual = np.asarray(record.get("residual_history") or [], float)
    force = np.asarray(record.get("force_history") or [], float).reshape(-1, 3)
    out = []
    if len(residual):
        scale = Scale(*padded([*residual, 0.0], 0.06, 0.2))
        frame = Frame(left, 8, width - left - 8, 84, Scale(0, max(len(residual) - 1, 1)), scale)
        out += [axes_above(frame, 3), frame.line(range(len(residual)), residual, "curve residual")]
    if len(force):
        final = force[-max(len(force) // 10, 1) :].mean(axis=0)
        size = max(float(np.hypot(final[0], final[2])), 1e-12)
        deviation = 100.0 * (force - final) / size
        reach = float(np.clip(2.0 * np.abs(deviation[len(deviation) // 2 :]).max(initial=0.0), 0.5, 20.0))
        frame = Frame(left, 104, width - left - 8, 70, Scale(0, max(len(force) - 1, 1)), Scale(-reach, reach))
        out.append(frame.axes("iteration", "", 4, 3))
        for column, css in ((1, "c-y"), (2, "c-z"), (0, "c-x")):
            out.append(frame.line(range(len(force)), deviation[:, column], f"curve {css}"))
    return drawing(width, height, *out, title=f"convergence of {record.get('label', '')}")


def axes_above(frame: Frame, y_ticks: int) -> str:
    """Axes of the upper of two stacked plots: no tick labels on x."""
    upper = Frame(frame.left, frame.top, frame.width, frame.height, Scale(0, 1, None), frame.y_scale)
    out = [f'<rect class="frame" x="{upper.left}" y="{upper.top}" width="{upper.width}" height="{upper.height}"/>']
    for tick in upper.y_scale.ticks(y_ticks):
        y = upper.y(tick)
        right = upper.left + upper.width
        out.append(f'<line class="grid" x1="{upper.left}" x2="{right}" y1="{y:.1f}" y2="{y:.1f}"/>')
        text = f"{tick:g}".replace("-", MINUS)
        out.append(f'<text class="tick" x="{upper.left - 6}" y="{y + 3.5:.1f}" text-anchor="end">{text}</text>')
    return "".join(out)


def phase_clock(magnitude: float, phase_deg: float) -> str:
    """A small arrow whose length is the magnitude (largest = 1) and whose angle is the phase."""
    size, reach = 30.0, 12.0
    center = size / 2
    length = reach * min(max(magnitude, 0.0), 1.0)
    angle = math.radians(phase_deg)
    x, y = center + length * math.cos(angle), center - length * math.sin(angle)
    return (
        f'<svg class="clock" viewBox="0 0 {size:g} {size:g}" width="26" height="26" aria-hidden="true">'
        f'<circle cx="{center}" cy="{center}" r="{reach}"/>'
        f'<line x1="{center}" y1="{center}" x2="{x:.1f}" y2="{y:.1f}"/>'
        f'<circle class="tip" cx="{x:.1f}" cy="{y:.1f}" r="2"/></svg>'
    )


def range_bar(value: float, lower: float, upper: float, default: float | None = None) -> str:
    """Where a value stands between its limits, with a tick at the default."""
    width, height = 120.0, 14.0
    span = upper - lower
    if not span > 0:
        return ""

    def place(v: float) -> float:
        return 4 + (width - 8) * min(max((v - lower) / span, 0.0), 1.0)

    tick = ""
    if default is not None:
        tick = f'<line class="default" x1="{place(default):.1f}" x2="{place(default):.1f}" y1="2" y2="12"/>'
    size = f'viewBox="0 0 {width:g} {height:g}" width="{width:g}" height="{height:g}"'
    return (
        f'<svg class="range" {size} aria-hidden="true">'
        f'<line class="rail" x1="4" x2="{width - 4}" y1="7" y2="7"/>{tick}'
        f'<circle cx="{place(value):.1f}" cy="7" r="4"/></svg>'
    )


def derivative_bars(rows: list[tuple[str, float | None]]) -> str:
    """Contributions side by side about a common zero: [(name, value)]."""
    known = [(name, value) for name, value in rows if value is not None]
    largest = max((abs(v) for _, v in known), default=0.0)
    if not largest > 0:
        return ""
    row, left, half = 20.0, 110.0, 120.0
    width, height = left + 2 * half + 70, row * len(known) + 6
    zero = left + half
    out = [f'<line class="zero" x1="{zero}" x2="{zero}" y1="0" y2="{height}"/>']
    for k, (name, value) in enumerate(known):
        y, size = 3 + k * row, half * abs(value) / largest
        x = zero if value >= 0 else zero - size
        css = "bar" if value >= 0 else "bar negative"
        out.append(
            f'<rect class="{css}" x="{x:.1f}" y="{y + 3:.1f}" width="{max(size, 0.5):.1f}" height="{row - 7}" rx="2"/>'
        )
        out.append(f'<text class="tick" x="{left - 8}" y="{y + 13:.1f}" text-anchor="end">{escape(name)}</text>')
        out.append(f'<text class="tick" x="{left + 2 * half + 8}" y="{y + 13:.1f}">{measured(value, None, 3)}</text>')
    return drawing(width, height, *out)
