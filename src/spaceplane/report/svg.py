"""Small SVG drawings whose colours come from the page's style sheet, so that they follow light and dark."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from spaceplane.report.numbers import MINUS


@dataclass(frozen=True)
class Scale:
    """A map from numbers to 0..1, linear or symmetric-logarithmic.

    Attributes:
        lower, upper: the numbers that become 0 and 1, in the unit of what is drawn.
        linear_width: the map is linear within plus or minus this; None makes it linear throughout.
    """

    lower: float
    upper: float
    linear_width: float | None = None

    def _bend(self, value: float) -> float:
        if self.linear_width is None:
            return value
        return math.copysign(math.log10(1.0 + abs(value) / self.linear_width), value)

    def __call__(self, value: float) -> float:
        """Where a number lies: 0 at `lower`, 1 at `upper`."""
        low, high = self._bend(self.lower), self._bend(self.upper)
        return (self._bend(value) - low) / (high - low)

    def ticks(self, count: int = 5) -> list[float]:
        """Round numbers within the range: about `count` of them, or zero and the decades."""
        if self.linear_width is None:
            return linear_ticks(self.lower, self.upper, count)
        decades = math.ceil(math.log10(max(abs(self.lower), abs(self.upper)) / self.linear_width))
        positive = [self.linear_width * 10.0**k for k in range(decades + 1)]
        ticks = [-t for t in reversed(positive)] + [0.0, *positive]
        return [t for t in ticks if self.lower * (1 + 1e-9) <= t <= self.upper * (1 + 1e-9)]


def linear_ticks(lower: float, upper: float, count: int = 5) -> list[float]:
    """About `count` round numbers within [lower, upper]."""
    span = upper - lower
    if not span > 0:
        return [lower]
    step = 10.0 ** math.floor(math.log10(span / count))
    step *= next(f for f in (1, 2, 2.5, 5, 10) if span / (step * f) <= count + 0.5)
    first = math.ceil(lower / step - 1e-9)
    return [round(k * step, 12) for k in range(first, math.floor(upper / step + 1e-9) + 1)]


def padded(values: Iterable[float], share: float = 0.08, least: float = 1e-12) -> tuple[float, float]:
    """Range of `values` with a margin of `share` on both sides."""
    found = [v for v in values if math.isfinite(v)]
    low, high = (min(found), max(found)) if found else (0.0, 1.0)
    margin = max((high - low) * share, least)
    return low - margin, high + margin


def tick_text(value: float) -> str:
    """A tick's label: short, with a true minus sign."""
    if value == 0:
        return "0"
    size = abs(value)
    if size < 1e-3 or size >= 1e5:
        exponent = math.floor(math.log10(size) + 1e-9)
        mantissa = value / 10.0**exponent
        text = f"{mantissa:.3g}e{exponent}"
    else:
        text = f"{value:.6g}"
    return text.replace("-", MINUS)


@dataclass(frozen=True)
class Frame:
    """A plot's box in an SVG drawing.

    Attributes:
        left, top, width, height: of the box, pixels.
        x_scale, y_scale: from numbers to shares of its width and height.
    """

    left: float
    top: float
    width: float
    height: float
    x_scale: Scale
    y_scale: Scale

    def x(self, value: float) -> float:
        """Pixel position of a value across."""
        return self.left + self.width * self.x_scale(value)

    def y(self, value: float) -> float:
        """Pixel position of a value, downwards."""
        return self.top + self.height * (1.0 - self.y_scale(value))

    def _labelled(self, ticks: list[float], along: float, scale: Scale, room: float) -> set[float]:
        """Ticks that get a label: zero first, then outward, none closer than `room` pixels to another."""
        chosen: list[float] = []
        order = [0.0] if 0.0 in ticks else []
        order += sorted((t for t in ticks if t != 0.0), key=lambda t: -abs(t))
        for tick in order:
            if all(abs(scale(tick) - scale(other)) * along >= room for other in chosen):
                chosen.append(tick)
        return set(chosen)

    def axes(self, x_label: str = "", y_label: str = "", x_ticks: int = 5, y_ticks: int = 5) -> str:
        """Grid, ticks, labels and border."""
        bottom, right = self.top + self.height, self.left + self.width
        out = [f'<rect class="frame" x="{self.left}" y="{self.top}" width="{self.width}" height="{self.height}"/>']
        ticks = self.x_scale.ticks(x_ticks)
        labelled = self._labelled(ticks, self.width, self.x_scale, 36)
        for tick in ticks:
            x = self.x(tick)
            out.append(f'<line class="grid" x1="{x:.1f}" x2="{x:.1f}" y1="{self.top}" y2="{bottom}"/>')
            if tick in labelled:
                place = f'x="{x:.1f}" y="{bottom + 13}" text-anchor="middle"'
                out.append(f'<text class="tick" {place}>{tick_text(tick)}</text>')
        ticks = self.y_scale.ticks(y_ticks)
        labelled = self._labelled(ticks, self.height, self.y_scale, 14)
        for tick in ticks:
            y = self.y(tick)
            out.append(f'<line class="grid" x1="{self.left}" x2="{right}" y1="{y:.1f}" y2="{y:.1f}"/>')
            if tick in labelled:
                place = f'x="{self.left - 6}" y="{y + 3.5:.1f}" text-anchor="end"'
                out.append(f'<text class="tick" {place}>{tick_text(tick)}</text>')
        if x_label:
            place = f'x="{self.left + self.width / 2}" y="{bottom + 30}" text-anchor="middle"'
            out.append(f'<text class="label" {place}>{escape(x_label)}</text>')
        if y_label:
            x, y = self.left - 50, self.top + self.height / 2
            place = f'x="{x}" y="{y}" text-anchor="middle" transform="rotate(-90 {x} {y})"'
            out.append(f'<text class="label" {place}>{escape(y_label)}</text>')
        return "".join(out)

    def line(self, xs: Sequence[float], ys: Sequence[float], css: str, title: str = "") -> str:
        """A line through the finite points, thinned to the drawing's resolution and kept within the frame."""
        xs, ys = np.asarray(xs, float), np.asarray(ys, float)
        keep = np.isfinite(xs) & np.isfinite(ys)
        xs, ys = xs[keep], ys[keep]
        if len(xs) > 2 * self.width:
            chosen = np.unique(np.linspace(0, len(xs) - 1, int(2 * self.width)).astype(int))
            xs, ys = xs[chosen], ys[chosen]
        ys = np.clip(ys, self.y_scale.lower, self.y_scale.upper)
        points = " ".join(f"{self.x(a):.1f},{self.y(b):.1f}" for a, b in zip(xs, ys, strict=True))
        inner = f"<title>{escape(title)}</title>" if title else ""
        return f'<polyline class="{css}" points="{points}">{inner}</polyline>'


def drawing(width: float, height: float, *content: str, title: str = "") -> str:
    """An SVG element that scales with its container."""
    name = f' role="img" aria-label="{escape(title)}"' if title else ""
    return (
        f'<svg class="plot" viewBox="0 0 {width:g} {height:g}" width="{width:g}" height="{height:g}"{name} '
        f'xmlns="http://www.w3.org/2000/svg">{"".join(content)}</svg>'
    )
