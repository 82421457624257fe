"""What drives the modes along a descent, and how certain they and the levels are: tables, pictures, JSON, terminal."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from spaceplane.analysis.descent import Descent, DescentPoint
from spaceplane.dynamics.given_errors import GivenError
from spaceplane.dynamics.modes import Mode
from spaceplane.dynamics.sensitivity import ModeSensitivity, drivers
from spaceplane.plain import finite
from spaceplane.qualities.outlook_record import mode_records, verdict_records
from spaceplane.qualities.probability import NORMAL_95, Outlook, per_cent, wilson_half_width
from spaceplane.qualities.verdict import AIRFRAME
from spaceplane.report.flight_point import criterion_name
from spaceplane.report.plain_page import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DRIVERS = "What drives each mode"
SCATTER = "How far eigenvalues scatter"
LIKELY = "How likely the levels are"
BELOW = {SCATTER: [("eigenvalue-scatter", "Eigenvalues of the draws at each Mach number")]}
"""Pictures below the tables, by their titles."""
SHOWN = 3
NEVER = "-"
_LINEAR = 0.01  # 1/s, the linear part of the axes around zero


def given_record(errors: Mapping[str, GivenError]) -> dict:
    """Errors as they were stated: name to `half_width` (per rad, ...) or `share`."""
    return {name: {"share" if one.relative else "half_width": one.amount} for name, one in errors.items()}


def point_record(one: DescentPoint) -> dict:
    """Modes and verdicts of a flight point with their uncertainty, as plain JSON types."""
    known = one.likelihood
    if known is None:
        return {"uncertainty": {}, "modes": [], "verdicts": []}
    modes = mode_records(one.modes, known.sensitivities, known.uncertainty)
    scatter: list[dict | None] = [None] * len(modes)
    if known.spreads:
        scatter = [{"real": s.real, "imaginary": s.imaginary, "same_kind": finite(s.same_kind)} for s in known.spreads]
    on_modes, on_airframe = verdict_records(one.verdicts, known.outlooks)
    return {
        "uncertainty": dict(known.uncertainty.half_width) if known.uncertainty else {},
        "modes": [mode | {"scatter": s} for mode, s in zip(modes, scatter, strict=True)],
        "verdicts": on_modes + on_airframe,
    }


def tables(descent: Descent) -> list[Table]:
    """What drives each mode; with errors of derivatives also how far they scatter and how likely the levels are."""
    found = [_drivers(descent)]
    return [*found, _scatter(descent), _likely(descent)] if _uncertain(descent) else found


def _uncertain(descent: Descent) -> list[DescentPoint]:
    return [one for one in descent.points if one.likelihood and one.likelihood.uncertainty]


def _moving(one: DescentPoint) -> list[tuple[int, Mode]]:
    return [(k, mode) for k, mode in enumerate(one.modes) if mode.kind != "neutral"]


def _drivers(descent: Descent) -> Table:
    rows = [
        (f"{one.point.mach:g}", mode.name, *_driver_cells(one.likelihood.sensitivities[k]))
        for one in descent.points
        if one.likelihood
        for k, mode in _moving(one)
    ]
    note = (
        "Change of the eigenvalue by one per cent of each derivative, C_L or C_D, to first order: the greatest, and "
        "their part in the sum of squares over all."
    )
    head = ("Mach", "mode", *(f"{k}." for k in range(1, SHOWN + 1)), "1 % of the first, 1/s")
    return Table(DRIVERS, 3, note, head, tuple(rows))


def _driver_cells(one: ModeSensitivity) -> tuple[str, ...]:
    """The greatest drivers with their shares, and what the first does; dashes at a double eigenvalue."""
    finite_slopes = all(math.isfinite(abs(slope)) for slope in one.slopes)
    found = drivers(one)[:SHOWN] if finite_slopes else ()
    cells = [f"{d.parameter} {per_cent(d.share)}" for d in found if d.share >= 0.005]
    first = complex_text(found[0].per_percent, one.eigenvalue.imag != 0) if found else NEVER
    return (*cells, *[""] * (SHOWN - len(cells)), first)


def complex_text(value: complex, oscillatory: bool) -> str:
    """Such as `+0.0012 -0.03i`, 1/s; of an aperiodic mode the real part alone."""
    return f"{value.real:+.2g}" + (f" {value.imag:+.2g}i" if oscillatory else "")


def _scatter(descent: Descent) -> Table:
    rows = []
    for one in _uncertain(descent):
        records = point_record(one)["modes"]
        for k, mode in _moving(one):
            error, spread = records[k]["eigenvalue_error"], one.likelihood.spreads[k]
            value = mode.eigenvalue
            text = f"{value.real:.4g} ± {value.imag:.4g}i" if mode.oscillatory else f"{value.real:.4g}"
            first = (NEVER, NEVER) if error is None else tuple(f"{e / NORMAL_95:.2g}" for e in error)
            sampled = (f"{spread.real:.2g}", f"{spread.imaginary:.2g}")
            rows.append((f"{one.point.mach:g}", mode.name, text, *first, *sampled, per_cent(spread.same_kind)))
    note = (
        "Standard deviations of real and imaginary part, 1/s, to first order by the eigenvalue's derivatives and of "
        "the draws. They differ where eigenvalues meet or part within the errors; the last column says how often the "
        "mode keeps its kind."
    )
    head = ("Mach", "mode", "eigenvalue, 1/s", "σ real", "σ imag", "σ real, draws", "σ imag, draws", "kind kept")
    return Table(SCATTER, 2, note, head, tuple(rows))


def _likely(descent: Descent) -> Table:
    found = [_by_criterion(one) for one in descent.points]
    keys = [key for key in dict.fromkeys(key for row in found for key in row) if any(_shown(row, key) for row in found)]
    rows = [(f"{criterion_name(c)}: {q}", *(_likely_cell(row.get((c, q))) for row in found)) for c, q in keys]
    settings = descent.settings
    stated = ", ".join(
        f"{name} {100 * one.amount:g} %" if one.relative else f"{name} ± {one.amount:g}"
        for name, one in settings.uncertainty.items()
    )
    note = (
        f"Half widths of 95 % intervals: {stated}; {settings.samples} draws at each Mach number about the nominal "
        f"trim, so that probabilities hold to {100 * wilson_half_width(0.5, settings.samples):.2g} % at worst. Every "
        "criterion on modes, and those on the airframe that the errors leave open; all outcomes are in descent.json."
    )
    machs = tuple(f"Mach {one.point.mach:g}" for one in descent.points)
    return Table(LIKELY, 2, note, ("criterion", *machs), tuple(rows))


def _by_criterion(one: DescentPoint) -> dict[tuple[str, str], Outlook]:
    """The outlook of each criterion and quantity; of several modes the one least likely to be level 1."""
    found: dict[tuple[str, str], Outlook] = {}
    for outlook in one.likelihood.outlooks if one.likelihood else ():
        key = (outlook.verdict.criterion, outlook.verdict.quantity)
        best = outlook.probabilities.get("1", 0.0) + outlook.probabilities.get("met", 0.0)
        if key not in found or best < found[key].probabilities.get("1", 0.0) + found[key].probabilities.get("met", 0.0):
            found[key] = outlook
    return found


def _shown(row: Mapping[tuple[str, str], Outlook], key: tuple[str, str]) -> bool:
    outlook = row.get(key)
    if outlook is None or set(outlook.probabilities) == {"not applicable"}:
        return False
    return outlook.verdict.mode != AIRFRAME or len(outlook.probabilities) > 1


def _likely_cell(outlook: Outlook | None) -> str:
    """Such as `level 2 with 87 %`; the outcome alone where there is no other."""
    if outlook is None or set(outlook.probabilities) == {"not applicable"}:
        return NEVER
    name, share = max(outlook.probabilities.items(), key=lambda item: item[1])
    text = f"level {name}" if name in "123" else name.replace("not applicable", "n/a")
    return text if share == 1.0 else f"{text} with {per_cent(share)}"


def print_levels(descent: Descent) -> None:
    """Print how likely the levels are, a line for each flight point and criterion that the errors leave open."""
    for one in _uncertain(descent):
        for outlook in one.likelihood.outlooks:
            if outlook.verdict.mode != AIRFRAME and max(outlook.probabilities.values()) < 0.995:
                verdict = outlook.verdict
                print(
                    f"Mach {one.point.mach:g}: {criterion_name(verdict.criterion)}, {verdict.quantity}: {outlook.text}"
                )


def pictures(descent: Descent) -> dict[str, bytes]:
    """PNG by name: the eigenvalues of the draws; none without errors of derivatives."""
    points = _uncertain(descent)
    if not points:
        return {}
    from spaceplane.report.figures_dynamics import png

    return {"eigenvalue-scatter": png(lambda: _cloud_figure(points))}


def _cloud_figure(points: Sequence[DescentPoint]) -> Figure:
    import matplotlib.pyplot as plt

    columns = min(3, len(points))
    rows = math.ceil(len(points) / columns)
    size = (3.6 * columns + 0.6, 2.7 * rows + 0.7)
    figure, axes = plt.subplots(
        rows, columns, figsize=size, squeeze=False, sharex=True, sharey=True, layout="constrained"
    )
    for panel, one in zip(axes.flat, points, strict=False):
        _cloud_panel(panel, one)
    for panel in list(axes.flat)[len(points) :]:
        panel.remove()
    figure.supxlabel("real part, 1/s (linear within the dotted lines)", fontsize=9)
    figure.supylabel("imaginary part, 1/s", fontsize=9)
    return figure


def _cloud_panel(panel: Axes, one: DescentPoint) -> None:
    """Draws as dots, the nominal eigenvalues as crosses, in the upper half plane; the stable side is shaded."""
    from spaceplane.report.figures_dynamics import STABLE

    cloud = one.likelihood.cloud.ravel()
    upper = cloud[cloud.imag >= 0]
    panel.scatter(upper.real, upper.imag, s=3, alpha=0.25, color="#0077bb", linewidths=0, zorder=3)
    values = [mode.eigenvalue for _, mode in _moving(one)]
    panel.scatter([z.real for z in values], [z.imag for z in values], marker="x", color="#cc3311", s=26, zorder=4)
    panel.set_xscale("symlog", linthresh=_LINEAR, linscale=0.6)
    panel.set_yscale("symlog", linthresh=_LINEAR, linscale=0.6)
    decades = [_LINEAR, 0.1, 1.0]
    panel.set_xticks([*(-x for x in decades), 0.0, *decades], [f"{x:g}" for x in (-0.01, -0.1, -1, 0, 0.01, 0.1, 1)])
    panel.set_yticks([0.0, *decades], ["0", *(f"{x:g}" for x in decades)])
    for edge in (-_LINEAR, _LINEAR):
        panel.axvline(edge, color="#999999", linewidth=0.7, linestyle=":")
    panel.axhline(_LINEAR, color="#999999", linewidth=0.7, linestyle=":")
    panel.axvspan(-10.0, 0.0, color=STABLE, zorder=0, linewidth=0)
    panel.set_xlim(-4.0, 4.0)
    panel.set_ylim(bottom=-0.004)
    panel.set_title(f"Mach {one.point.mach:g}", fontsize=9)
