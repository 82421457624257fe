"""A descent flown from tables, for people and machines: JSON, trim map as NetCDF, pictures and one HTML page."""

from __future__ import annotations

import html
import io
import math
from pathlib import Path

from spaceplane import __version__
from spaceplane.analysis.descent import Descent, DescentPoint, DescentSettings
from spaceplane.analysis.tracked import STEP
from spaceplane.dynamics.modes import Mode
from spaceplane.files import json_text, renamed_when_done, told, write_text
from spaceplane.plain import finite
from spaceplane.qualities.verdict import Verdict
from spaceplane.report import descent_control, descent_likelihood
from spaceplane.report.branches import event_record
from spaceplane.report.control_record import control_record
from spaceplane.report.figures_dynamics import over_parameter, phasors, root_locus
from spaceplane.report.plain_page import Table, document, picture_html, table_html
from spaceplane.report.read import level_text
from spaceplane.report.trim_figures import trim_map_figure

SCHEMA, SCHEMA_VERSION = "spaceplane.descent", 2
LEVELS = ("3.2.1.1", "3.2.1.2", "3.2.2.1.1", "3.2.2.1.2", "3.3.1.1", "3.3.1.2", "3.3.1.3", "3.3.1.4")
"""Paragraphs on modes, in the order of the table of levels."""


def write(descent: Descent, out_dir: Path | str) -> dict[str, Path]:
    """Write descent.json, trim.nc, the pictures and descent.html; return their paths by name.

    Raises:
        InputError: the folder cannot be written.
    """
    folder = Path(out_dir)
    drawn = pictures(descent)
    paths = {"json": folder / "descent.json", "trim": folder / "trim.nc", "html": folder / "descent.html"}
    paths |= {name: folder / f"{name}.png" for name in drawn}
    with told(folder):
        write_text(json_text(record(descent)), paths["json"])
        with renamed_when_done(paths["trim"]) as partial:
            descent.trim_map.to_netcdf(partial, engine="netcdf4")
        for name, data in drawn.items():
            with renamed_when_done(paths[name]) as partial:
                partial.write_bytes(data)
        write_text(page(descent, drawn), paths["html"])
    return paths


def record(descent: Descent) -> dict:
    """The descent as plain JSON types, angles in degrees."""
    settings = descent.settings
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "version": __version__,
        "model": descent.model.name,
        "source": descent.model.source,
        "unknown": list(descent.model.unknown()),
        "form": settings.form,
        "class": settings.vehicle_class,
        "category": settings.category,
        "uncertainty": descent_likelihood.given_record(settings.uncertainty),
        "points": [_point_record(one) for one in descent.points],
        "events": [event_record(event) for event in (descent.branches.events if descent.branches else ())],
        "not_followed": list(descent.tracked.reasons),
    }


def _point_record(one: DescentPoint) -> dict:
    point, trim = one.point, one.trim
    return {
        "mach": point.mach,
        "altitude_m": point.altitude,
        "alpha_deg": math.degrees(point.alpha),
        "gamma_deg": trim and math.degrees(point.gamma),
        "bank_deg": trim and math.degrees(point.bank),
        "dynamic_pressure_Pa": point.dynamic_pressure,
        "reason": one.reason,
        "trim": trim
        and {
            "elevator_deg": math.degrees(trim.elevator),
            "body_flap_deg": math.degrees(trim.body_flap),
            "margin_deg": math.degrees(trim.margin),
            "CL": trim.CL,
            "CD": trim.CD,
            "lift_to_drag": finite(trim.lift_to_drag),
            "static_margin": finite(trim.static.margin),
            "Cm_alpha": finite(trim.static.Cm_alpha),
        },
        **descent_likelihood.point_record(one),
        "control": control_record(one.control, histories=False),
    }


def pictures(descent: Descent) -> dict[str, bytes]:
    """PNG by name: trim map, root locus, eigenvalues by Mach number and, at the slowest point, eigenvectors."""
    data = io.BytesIO()
    trim_map_figure(descent.trim_map).savefig(data, format="png", dpi=130, bbox_inches="tight")
    drawn = {"trim-map": data.getvalue()}
    if descent.branches is not None:
        drawn["root-locus"] = root_locus(descent.branches, label="Mach number")
        drawn["modes-by-mach"] = over_parameter(descent.branches, "Mach number")
    flown = [one for one in descent.points if one.modes]
    if flown:
        slowest = flown[0].point
        drawn["eigenvectors"] = phasors(flown[0].modes, slowest.velocity, f"Eigenvectors at {slowest.name}")
    return drawn | descent_likelihood.pictures(descent) | descent_control.pictures(descent)


def page(descent: Descent, drawn: dict[str, bytes]) -> str:
    """The HTML page, with the pictures in it."""
    title = f"{descent.model.name}: trim, modes and flying qualities"
    settings = descent.settings
    told_first = (
        f"Source: {descent.model.source}. {_flown_by(settings)} MIL-F-8785C class {settings.vehicle_class}, category "
        f"{settings.category}."
    )
    unknown = f"Not in the tables and taken as zero: {', '.join(descent.model.unknown()) or 'nothing'}."
    parts = [f"<h1>{html.escape(title)}</h1>", *(f"<p>{html.escape(text)}</p>" for text in (told_first, unknown))]
    for table in tables(descent):
        parts.append(table_html(table))
        parts += [picture_html(drawn[name], text) for name, text in _BELOW.get(table.title, ()) if name in drawn]
    return document(title, [*parts, *descent_control.html_parts(descent, drawn)])


def _flown_by(settings: DescentSettings) -> str:
    """How altitude, angle of attack, path and bank angle come about."""
    sources = {
        "Altitude": (settings.altitude_m, "of thesis Table 4.1"),
        "angle of attack": (settings.alpha_deg, "by the schedule"),
        "path angle": (settings.gamma_deg, "that on which drag slows down as fast as the altitudes ask"),
        "bank angle": (settings.bank_deg, "that which holds the path, 0 where lift is too little for it"),
    }
    return "; ".join(f"{what} {'as given' if given else source}" for what, (given, source) in sources.items()) + "."


EVENTS = "Events along the descent"
_BELOW = {
    "Trim": [("trim-map", "Trim over Mach number and angle of attack")],
    "Modes": [
        ("modes-by-mach", "Eigenvalues by Mach number"),
        ("root-locus", "Root locus along the descent"),
        ("eigenvectors", "Eigenvectors at the slowest flight point"),
    ],
    **descent_likelihood.BELOW,
}


def tables(descent: Descent) -> list[Table]:
    """Flight points, trim, modes and levels by Mach number."""
    likely = descent_likelihood.tables(descent)
    return [_flight_points(descent), _trims(descent), _modes(descent), *_events(descent), _levels(descent), *likely]


def _flight_points(descent: Descent) -> Table:
    columns = ("Mach", "altitude, km", "q, kPa", "alpha, deg", "path, deg", "bank, deg", "CL", "CD", "L/D")
    rows = []
    for one in descent.points:
        point, t = one.point, one.trim
        air = f"{point.mach:g}", f"{point.altitude / 1e3:.1f}", f"{point.dynamic_pressure / 1e3:.2f}"
        alpha, *angles = (f"{math.degrees(value):.1f}" for value in (point.alpha, point.gamma, point.bank))
        flown = (*angles, f"{t.CL:.3f}", f"{t.CD:.3f}", f"{t.lift_to_drag:.2f}") if t else ("-",) * 5
        rows.append((*air, alpha, *flown))
    return Table("Flight points", 2, "", columns, tuple(rows))


def _trims(descent: Descent) -> Table:
    columns = ("Mach", "alpha, deg", "elevator, deg", "body flap, deg", "margin, deg", "static margin")
    rows, reasons = [], []
    for one in descent.points:
        start = (f"{one.point.mach:g}", f"{math.degrees(one.point.alpha):.1f}")
        if one.trim is None:
            rows.append((*start, "none", "-", "-", "-"))
            reasons.append(f" Mach {one.point.mach:g}: {one.reason}.")
            continue
        t = one.trim
        angles = (f"{math.degrees(value):.1f}" for value in (t.elevator, t.body_flap, t.margin))
        rows.append((*start, *angles, f"{100.0 * t.static.margin:+.1f} %"))
    note = "The trim with the largest margin of the elevator to its nearer limit. Outside the tables there is none."
    return Table("Trim", 2, note + "".join(reasons), columns, tuple(rows))


def _modes(descent: Descent) -> Table:
    rows = [
        (f"{one.point.mach:g}", mode.name, _eigenvalue(mode), _pace(mode))
        for one in descent.points
        for mode in one.modes
        if mode.kind != "neutral"
    ]
    return Table("Modes", 2, "", ("Mach", "mode", "eigenvalue, 1/s", "half or double time, damping"), tuple(rows))


def _events(descent: Descent) -> list[Table]:
    gaps = "; ".join(descent.tracked.reasons)
    if descent.branches is None:
        return [Table(EVENTS, 3, f"The modes are not followed: {gaps}.", (), ())]
    rows = [
        (f"{e.parameter:.2f}", e.kind, " and ".join(e.branches), " and ".join(e.before), " and ".join(e.after))
        for e in descent.branches.events
        if e.kind != "name"
    ]
    note = (
        "Where eigenvalues meet, part or turn from decay to growth. Between flight points the vehicle is trimmed "
        f"anew at steps of {100 * STEP:g} % of the Mach number; modes jump where the angle of attack passes a node "
        "of the tables, since slopes of linear tables do."
    )
    note += f" Not followed farther: {gaps}." if gaps else ""
    return [Table(EVENTS, 3, note, ("Mach", "event", "branches", "before", "after"), tuple(rows))]


def _levels(descent: Descent) -> Table:
    machs = tuple(f"Mach {one.point.mach:g}" for one in descent.points)
    keys = dict.fromkeys((v.criterion, v.paragraph) for one in descent.points for v in one.verdicts if v.applicable)
    rows = [
        (_title(*key), *(_worst(one.verdicts, *key) for one in descent.points))
        for key in sorted(keys, key=lambda key: (key[1] not in LEVELS, key[1]))
    ]
    note = "The worst level of each criterion; - where it does not apply, for the reasons in descent.json."
    return Table("Levels of MIL-F-8785C and departure criteria", 2, note, ("criterion", *machs), tuple(rows))


def _title(criterion: str, paragraph: str) -> str:
    """A criterion with its paragraph of the specification; sources of others are in descent.json."""
    return f"{criterion} ({paragraph})" if paragraph[:1].isdigit() else criterion


def _worst(verdicts: tuple[Verdict, ...], criterion: str, paragraph: str) -> str:
    """The worst level; of requirements without levels whether they are met."""
    here = [v for v in verdicts if (v.criterion, v.paragraph) == (criterion, paragraph) and v.applicable]
    levels = [v.level for v in here if v.level is not None]
    if levels:
        return level_text(max(levels, key=lambda level: 4 if isinstance(level, str) else level))
    told_met = [v.met for v in here if v.met is not None]
    return ("met" if all(told_met) else "not met") if told_met else "-"


def _eigenvalue(mode: Mode) -> str:
    value = mode.eigenvalue
    return f"{value.real:.4g} ± {value.imag:.4g}i" if mode.oscillatory else f"{value.real:.4g}"


def _pace(mode: Mode) -> str:
    parts = [f"halves in {mode.half_time:.3g} s"] if mode.half_time else []
    parts += [f"doubles in {mode.double_time:.3g} s"] if mode.double_time else []
    parts += [f"ζ {mode.damping_ratio:.3f}"] if mode.damping_ratio is not None else []
    return ", ".join(parts) or "-"
