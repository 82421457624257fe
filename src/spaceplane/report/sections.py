"""What the report says about a whole analysis, ready for the template."""

from __future__ import annotations

import base64
import json

from markupsafe import Markup

from spaceplane import __version__
from spaceplane.report import branches, flight_control, flight_point
from spaceplane.report.figures_dynamics import over_parameter
from spaceplane.report.flight_point import level_css
from spaceplane.report.names import COEFFICIENTS, SOURCES, meaning, split_derivative, stability, symbol, words
from spaceplane.report.numbers import Measured, duration, fixed, grouped, is_number, measured, number, unbroken
from spaceplane.report.plots import POINT_COLOURS, eigenvalues_together, range_bar

__all__ = ["level_css", "point", "whole", "words"]

FLIGHT_ROWS = (
    ("Mach number", "", "mach", 1.0, 3),
    ("Altitude", "km", "altitude_m", 1e-3, 4),
    ("Angle of attack", "deg", "alpha_deg", 1.0, 4),
    ("Sideslip", "deg", "beta_deg", 1.0, 3),
    ("Flight-path angle", "deg", "gamma_deg", 1.0, 4),
    ("Bank angle", "deg", "bank_deg", 1.0, 4),
    ("Speed", "m/s", "velocity_ms", 1.0, 5),
    ("Dynamic pressure", "kPa", "dynamic_pressure_Pa", 1e-3, 4),
    ("Pressure", "Pa", "pressure_Pa", 1.0, 5),
    ("Temperature", "K", "temperature_K", 1.0, 5),
    ("Density", "kg/m³", "density_kgm3", 1.0, 4),
    ("Knudsen number", "", "knudsen", 1.0, 3),
    ("Compressibility factor", "", "compressibility_factor", 1.0, 5),
)
RATES = (("Roll rate", "p_rads"), ("Pitch rate", "q_rads"), ("Yaw rate", "r_rads"))
VARIABLE_GROUPS = (("alpha", "Angle of attack"), ("beta", "Sideslip"), ("M", "Mach number"), ("mach", "Mach number"))
PER = {"M": "per unit Mach", "mach": "per unit Mach", "p": "on p b/2V", "q": "on q c/2V", "r": "on r b/2V"}
PRECISIONS = {"single": "fp32", "double": "fp64"}
MESH_ROWS = (
    ("Cells", "cells"),
    ("Split cells", "split_cells"),
    ("Merged cells", "merged_cells"),
)


def point(p: dict) -> dict:
    """Everything the templates show about flight point `p` of result.json."""
    return {**flight_point.point(p), "control": flight_control.control(p)}


def whole(result: dict) -> dict:
    """Template values that concern the vehicle, all flight points together, the mesh and the settings."""
    points = result["flight_points"]
    vehicle = result["vehicle"]
    return {
        "version": result.get("version") or __version__,
        "created": (result.get("created") or "").replace("T", " ")[:16],
        "vehicle": vehicle,
        "lead": _lead(result),
        "chips": _chips(result),
        "warnings": [unbroken(line) for line in warnings(result)],
        "flight_rows": _flight_rows(points),
        "coefficient_rows": _coefficient_rows(points),
        "increments": increments_text(result),
        "uncertainty": uncertainty_text(result),
        "derivative_uncertainty": derivative_uncertainty_text(result),
        "derivative_groups": _derivative_groups(points),
        "point_colours": POINT_COLOURS,
        "together": Markup(eigenvalues_together(points)),
        "followed": followed(result),
        "reference": _reference(vehicle.get("reference") or {}),
        "mesh_rows": _mesh_rows(result),
        "time_rows": _time_rows(result),
        "shape_rows": _shape_rows(vehicle.get("shape") or {}),
        "vehicle_tables": _vehicle_tables(vehicle),
        "settings": json.dumps(result.get("settings") or {}, indent=2, ensure_ascii=False),
    }


def followed(result: dict) -> dict | None:
    """Picture (base64 of a PNG, "" where there is none), events and gaps of the modes along the Mach number."""
    found = result.get("mode_branches")
    if not found or len(result["flight_points"]) < 2:
        return None
    picture = over_parameter(branches.from_record(found), "Mach number") if found["branches"] else b""
    return {
        "picture": base64.b64encode(picture).decode(),
        "names": ", ".join(found["flight_points"]),
        "events": branches.event_rows(found),
        "reasons": found["reasons"],
    }


def unconverged(result: dict) -> list[tuple[str, dict]]:
    """(flight point name, record) of each condition that did not converge."""
    return [
        (p["name"], record)
        for p in result["flight_points"]
        for record in p.get("convergence") or []
        if record.get("verdict") != "converged"
    ]


def warnings(result: dict) -> list[str]:
    """One line for each condition that did not converge, then the result's own warnings and the mesh's."""
    own = list(result.get("warnings") or [])
    own += [w for w in (result.get("mesh") or {}).get("warnings") or [] if w not in own]
    lines = []
    for name, record in unconverged(result):
        label = str(record.get("label"))
        said = next((w for w in own if w.startswith(f"{name}, condition {label}:")), None)
        if said is not None:
            own.remove(said)
        reason = f": {record['reason']}" if record.get("reason") else ""
        lines.append(said or f"{name}, condition {label}: {record.get('verdict')}{reason}")
    return lines + own


def _lead(result: dict) -> str:
    geometry = result["vehicle"].get("geometry") or {}
    deflections = result["vehicle"].get("deflections_deg") or {}
    pieces = []
    if is_number(geometry.get("length_m")):
        pieces.append(
            f"{fixed(geometry['length_m'], 1)} m long, {fixed(geometry.get('span_m'), 1)} m in span, "
            f"{fixed(geometry.get('height_m'), 1)} m high."
        )
    if deflections:
        moved = [f"{words(k)} {number(v, 3)}°" for k, v in deflections.items() if v]
        pieces.append("Deflections: " + (", ".join(moved) if moved else "none") + ".")
    names = [p["name"] for p in result["flight_points"]]
    if names:
        pieces.append(f"Analysed at {', '.join(names[:-1]) + ' and ' if names[1:] else ''}{names[-1]}.")
    return " ".join(pieces)


def _chips(result: dict) -> list[tuple[str, str]]:
    records = [r for p in result["flight_points"] for r in p.get("convergence") or []]
    bad = len(unconverged(result))
    chips = []
    if records:
        chips.append(
            ("good", f"all {len(records)} conditions converged")
            if not bad
            else ("bad", f"{bad} of {len(records)} conditions not converged")
        )
    cells = (result.get("mesh") or {}).get("cells")
    if cells:
        chips.append(("", f"{grouped(cells)} cells"))
    solver = result.get("solver") or {}
    if solver.get("precision"):
        chips.append(("", PRECISIONS.get(solver["precision"], str(solver["precision"]))))
    asked = result.get("accuracy")
    if asked:
        reached = f"{number(100.0 * asked['reached'], 2)} %" if is_number(asked["reached"]) else "unknown"
        chips.append(("good" if asked["met"] else "bad", f"accuracy {reached}, {100.0 * asked['target']:g} % asked"))
    total = total_seconds(result)
    if total:
        chips.append(("", f"computed in {duration(total)}"))
    return chips


def total_seconds(result: dict) -> float | None:
    """Seconds of all recorded phases together, s."""
    phases = seconds_by_phase(result)
    return sum(phases.values()) if phases else None


def seconds_by_phase(result: dict) -> dict[str, float]:
    """Wall time of each phase of the analysis, s."""
    solver, mesh = result.get("solver") or {}, result.get("mesh") or {}
    phases = dict(solver.get("seconds_by_phase") or {"flow": solver.get("seconds")})
    if "mesh" not in phases:
        phases = {"mesh": mesh.get("seconds")} | phases
    return {name: value for name, value in phases.items() if is_number(value)}


def _flight_rows(points: list[dict]) -> list[dict]:
    rows = []
    for name, unit, key, factor, digits in FLIGHT_ROWS:
        values = [p.get(key) for p in points]
        if any(is_number(v) for v in values):
            cells = [number(v * factor, digits) if is_number(v) else number(None) for v in values]
            rows.append({"name": name, "unit": unit, "cells": cells})
    for name, key in RATES:
        values = [(p.get("equilibrium") or {}).get(key) for p in points]
        if any(is_number(v) for v in values):
            rows.append({"name": f"{name} in equilibrium", "unit": "rad/s", "cells": [number(v, 3) for v in values]})
    return rows


def _coefficient_rows(points: list[dict]) -> list[dict]:
    rows = []
    errors = [p.get("coefficient_errors") or {} for p in points]
    for name, (what, axes) in COEFFICIENTS.items():
        values = [(p.get("coefficients") or {}).get(name) for p in points]
        if any(is_number(v) for v in values):
            text = f"{what} ({axes})" if axes else what
            cells = [_coefficient(v, e.get(name)) for v, e in zip(values, errors, strict=True)]
            rows.append({"symbol": Markup(symbol(name)), "what": text, "cells": cells})
            rows += _source_rows(name, points)
    return rows


def increments_text(result: dict) -> str:
    """One sentence on the viscous increments in the coefficients; empty where there are none."""
    settings = (result.get("settings") or {}).get("increments") or {}
    friction, base = settings.get("friction", "off"), settings.get("base", "inviscid")
    glow = settings.get("emissivity")
    wall, transition = settings.get("wall_temperature_K"), settings.get("transition_reynolds")
    pieces = []
    if friction != "off":
        at = f"wall at {number(wall, 4)} K" if is_number(wall) else "adiabatic wall"
        at = f"radiating wall of emissivity {number(glow, 3)}" if is_number(glow) else at
        onset = f", laminar below a Reynolds number of {number(transition, 3)}" if is_number(transition) else ""
        pieces.append(f"{friction} skin friction ({at}{onset})")
    if base != "inviscid":
        pieces.append("base pressure by correlation")
    return f"With {' and '.join(pieces)} over the inviscid flow; the parts are listed apart." if pieces else ""


def _companion(result: dict) -> str:
    """The companion mesh in words; empty where there was none."""
    found = result.get("uncertainty") or {}
    if not is_number(found.get("cells")):
        return ""
    size = f"{grouped(found['cells'])} cells, at the wall {number(found.get('ratio'), 2)} times as large"
    return f"a coarser companion mesh ({size})"


def uncertainty_text(result: dict) -> str:
    """What the ± of a coefficient means, in one sentence."""
    companion = _companion(result)
    if companion:
        return (
            f"The ± is the numerical uncertainty, meant to hold the exact inviscid value in "
            f"{100 * result['uncertainty']['level']:.0f} % of all cases: what {companion} shows of the mesh's error, "
            "and how far the value still wandered over the last iterations."
        )
    return (
        "The ± of a force is how far it still wandered over the last iterations, that of a moment what this wandering "
        "means at the wall's root-mean-square distance from the moment centre; the error of the mesh is in neither."
    )


def derivative_uncertainty_text(result: dict) -> str:
    """What the ± of a derivative means, in one sentence."""
    if _companion(result):
        return (
            "The ± holds the error of the difference quotient and that of the mesh: the same quotient on the companion "
            "mesh."
        )
    return "The ± is the error of the difference quotient; that of the mesh is not in it."


def _source_rows(name: str, points: list[dict]) -> list[dict]:
    """What each source adds to a coefficient; no rows where all is inviscid or the coefficient is zero by symmetry."""
    found = [p.get("coefficients_by_source") or {} for p in points]
    sources = list(dict.fromkeys(source for f in found for source in f))
    rows = []
    for source in sources if len(sources) > 1 else ():
        values = [(f.get(source) or {}).get(name) for f in found]
        if any(is_number(v) and abs(v) >= 5e-6 for v in values):
            cells = [_coefficient(v, None) for v in values]
            rows.append({"symbol": "", "what": f"… {SOURCES.get(source, source)}", "cells": cells})
    return rows


def _coefficient(value: float | None, error: float | None) -> Measured:
    """With its error where known; else four digits or five decimals, and two digits for what is zero by symmetry."""
    if is_number(error):
        return measured(value, error)
    if is_number(value) and abs(value) < 1e-4:
        return Measured(number(value, 2))
    return Measured(fixed(value, 5) if is_number(value) and abs(value) < 0.1 else number(value, 4))


def _derivative_groups(points: list[dict]) -> list[dict]:
    names = list(dict.fromkeys(name for p in points for name in p.get("derivatives") or {}))
    names = [name for name in names if not split_derivative(name).control]
    grouped_names: dict[str, list[str]] = {}
    labels = dict(VARIABLE_GROUPS)
    for name in names:
        parts = split_derivative(name)
        title = labels.get(parts.variable, "Rates")
        grouped_names.setdefault(title, []).append(name)
    return [
        {"name": title, "rows": [_derivative_row(n, points) for n in group]} for title, group in grouped_names.items()
    ]


def _derivative_row(name: str, points: list[dict]) -> dict:
    records = [(p.get("derivatives") or {}).get(name) or {} for p in points]
    cells = [{"m": _measured(r), "sign": stability(name, r.get("value"), r.get("error"))} for r in records]
    first = next((r for r in records if r), {})
    step = f"; step {number(first['step'], 3)} {first.get('step_unit') or ''}" if is_number(first.get("step")) else ""
    return {
        "symbol": Markup(symbol(name)),
        "what": meaning(name),
        "unit": PER.get(split_derivative(name).variable, "per rad"),
        "title": f"{name}{step}",
        "cells": cells,
    }


def _measured(record: dict) -> Measured:
    return measured(record.get("value"), record.get("error"))


def _reference(reference: dict) -> dict:
    center = reference.get("moment_center_m") or [None] * 3
    return {
        "area": number(reference.get("area_m2"), 5),
        "chord": number(reference.get("c_ref_m"), 5),
        "span": number(reference.get("b_ref_m"), 5),
        "center": [number(v, 4) for v in center],
    }


def _mesh_rows(result: dict) -> list[tuple[str, str]]:
    mesh = result.get("mesh") or {}
    rows = [(label, grouped(mesh[key])) for label, key in MESH_ROWS if is_number(mesh.get(key))]
    if is_number(mesh.get("wall_cell_m")):
        rows.insert(1, ("Cell at the wall", f"{number(mesh['wall_cell_m'], 3)} m"))
    steps = mesh.get("adaptation")
    if steps:
        passes = f"{steps['passes']} {'pass' if steps['passes'] == 1 else 'passes'}"
        rows.insert(1, ("Adapted to the flow", f"{passes}: {' → '.join(grouped(n) for n in steps['cells'])}"))
    for label, key in (("Error of the wetted area", "area_error"), ("Error of the volume", "volume_error")):
        if is_number(mesh.get(key)):
            rows.append((label, number(mesh[key], 2)))
    conditions = (result.get("solver") or {}).get("conditions")
    if is_number(conditions):
        rows.append(("Flow conditions in all", grouped(conditions)))
    return rows


def _time_rows(result: dict) -> list[tuple[str, str, float]]:
    phases = seconds_by_phase(result)
    largest = max(phases.values(), default=0.0) or 1.0
    return [(words(k).capitalize(), duration(v), round(100 * v / largest, 1)) for k, v in phases.items()]


def _shape_rows(shape: dict) -> list[dict]:
    rows = []
    for name, record in shape.items():
        record = record if isinstance(record, dict) else {"value": record}
        value, lower, upper = record.get("value"), record.get("lower"), record.get("upper")
        known = all(is_number(v) for v in (value, lower, upper))
        bar = range_bar(value, lower, upper, record.get("default")) if known else ""
        unit = record.get("unit") or ""
        limits = f"{number(lower)} to {number(upper)}" if known else "no limits"
        label = words(name.removesuffix(f"_{unit}") if unit else name)
        rows.append(
            {
                "name": label,
                "value": number(value, 4) if is_number(value) else str(value),
                "unit": unit,
                "bar": Markup(bar),
                "title": f"{name}: {limits}, default {number(record.get('default'))}",
            }
        )
    return rows


def _vehicle_tables(vehicle: dict) -> list[tuple[str, list[tuple[str, str, str]]]]:
    mass, reference = vehicle.get("mass") or {}, vehicle.get("reference") or {}
    geometry, deflections = vehicle.get("geometry") or {}, vehicle.get("deflections_deg") or {}
    tables = [
        ("Deflections", [(words(k), number(v, 4), "deg") for k, v in deflections.items()]),
        (
            "Mass properties",
            [("Mass", number(mass.get("mass_kg"), 6), "kg")]
            + [(f"I{a}{a}", number(mass.get(f"I{a}{a}_kgm2"), 6), "kg m²") for a in "xyz"]
            + ([("Ixz", number(mass["Ixz_kgm2"], 6), "kg m²")] if mass.get("Ixz_kgm2") else []),
        ),
        (
            "Reference lengths",
            [
                ("Area S", number(reference.get("area_m2"), 5), "m²"),
                ("Chord c", number(reference.get("c_ref_m"), 5), "m"),
                ("Span b", number(reference.get("b_ref_m"), 5), "m"),
                ("Moment centre x, y, z", ", ".join(_reference(reference)["center"]), "m"),
            ],
        ),
        (
            "Geometry",
            [
                ("Length", number(geometry.get("length_m"), 4), "m"),
                ("Span", number(geometry.get("span_m"), 4), "m"),
                ("Height", number(geometry.get("height_m"), 4), "m"),
                ("Wetted area", number(geometry.get("wetted_area_m2"), 4), "m²"),
                ("Volume", number(geometry.get("volume_m3"), 4), "m³"),
                ("Triangles", grouped(geometry.get("triangles")), ""),
            ],
        ),
    ]
    return [(title, rows) for title, rows in tables if rows]
