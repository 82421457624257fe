"""Small drawings of control for the report: how the vehicle answers, with the controls fixed and with the feedback."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

from spaceplane.report.names import GREEK
from spaceplane.report.plots import axes_above
from spaceplane.report.svg import Frame, Scale, drawing, padded

MOMENTS = {"moment_x": "M_x", "moment_y": "M_y", "moment_z": "M_z"}
INPUT_CSS = ("c-x", "c-z", "c-y")
_WIDTH, _LEFT, _PANEL, _GAP, _TOP = 300.0, 46.0, 72.0, 22.0, 16.0
_LEAST = 0.01  # deg, deg/s or kN m: a panel spans at least twice this, so that round-off does not fill it


@dataclass(frozen=True)
class _Panel:
    """One panel: heading, and the lines in it."""

    title: str
    lines: tuple[tuple[str, Sequence[float]], ...]


def response_plot(record: dict) -> str:
    """Motion above and inputs below, over time; the open loop dashed.

    Args:
        record: one of `responses` of `control_record`.
    """
    panels = [_state(record, name) for name in record["states"]] + list(_inputs(record))
    time = record["time_s"]
    out = []
    for k, panel in enumerate(panels):
        last = k == len(panels) - 1
        top = _TOP + k * (_PANEL + _GAP)
        scale = Scale(*padded(_values(panel.lines), 0.08, _LEAST))
        frame = Frame(_LEFT, top, _WIDTH - _LEFT - 8, _PANEL, Scale(time[0], time[-1]), scale)
        out.append(frame.axes("time, s", "", 4, 3) if last else axes_above(frame, 3))
        out.append(f'<text class="label" x="{_LEFT}" y="{top - 4}">{escape(panel.title)}</text>')
        out += [frame.line(time, values, css) for css, values in panel.lines]
    height = _TOP + len(panels) * (_PANEL + _GAP) + 18
    return drawing(_WIDTH, height, *out, title=record["name"])


def _values(lines: Iterable[tuple[str, Sequence[float]]]) -> list[float]:
    return [value for _, values in lines for value in values]


def _state(record: dict, name: str) -> _Panel:
    lines = (("curve c-x", record["closed"][name]), ("curve open", record["open"][name]))
    return _Panel(f"{GREEK.get(name, name)}, {record['units'][name]}", lines)


def _inputs(record: dict) -> list[_Panel]:
    """Deflections together, then moments together."""
    surfaces = [name for name in record["inputs"] if name not in MOMENTS]
    thrusters = [name for name in record["inputs"] if name in MOMENTS]
    panels = []
    for names, factor, unit in ((surfaces, 1.0, "deg from trim"), (thrusters, 1e-3, "kN m")):
        if names:
            lines = tuple(
                (f"curve {INPUT_CSS[k]}", [factor * value for value in record["closed"][name]])
                for k, name in enumerate(names)
            )
            title = " (orange: ".join(MOMENTS.get(name, name) for name in names) + (")" if len(names) > 1 else "")
            panels.append(_Panel(f"{title}, {unit}", lines))
    return panels
