"""The generated blocks: each function returns Markdown made from the code or from stored results in docs/data."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

DATA = Path(__file__).resolve().parent / "data"
DEMO = DATA / "demo.json"
PICTURES = Path(__file__).resolve().parent / "images" / "validation"


def table(head: Sequence[str], rows: Sequence[Sequence[object]], align: str = "") -> str:
    """A Markdown table; `align` has one of l and r per column."""
    rule = ["---:" if kind == "r" else "---" for kind in align.ljust(len(head), "l")]
    return "\n".join("| " + " | ".join(str(cell) for cell in row) + " |" for row in (head, rule, *rows))


def store(path: Path, document: Any) -> None:
    """Write JSON with one line per innermost list or short record, for readable differences."""
    DATA.mkdir(exist_ok=True)
    path.write_text(json.dumps(document, indent=1, allow_nan=False) + "\n", encoding="utf-8")


def validation_path(case: str) -> Path:
    return DATA / f"validation_{case}.json"


def store_validation(path: Path) -> None:
    """Keep the records of each case of a validation.json, one file per case, so that cases can be rerun apart."""
    document = json.loads(path.read_text(encoding="utf-8"))
    for case in dict.fromkeys(record["case"] for record in document["records"]):
        own = [record for record in document["records"] if record["case"] == case]
        store(validation_path(case), document | {"records": own})
        draw_validation(case)


def shown_validation(case: str) -> list:
    """The stored records of a case that its picture shows: of HORUS-2B the clean vehicle's coefficients alone."""
    from spaceplane.validation import read

    records = read(validation_path(case))
    return [r for r in records if case != "horus" or (r.unit == "-" and not r.quantity.startswith("d"))]


def draw_validation(case: str) -> None:
    """Draw the stored records of a case into images/validation."""
    from spaceplane.validation.figures import picture

    PICTURES.mkdir(exist_ok=True)
    (PICTURES / f"{case}.png").write_bytes(picture(shown_validation(case)))


def validation_picture(case: str) -> Callable[[], str]:
    """The picture of one validation case."""

    def block() -> str:
        from spaceplane.validation.figures import caption

        return f"![{caption(shown_validation(case))}](images/validation/{case}.png)"

    return block


def settings_table(record: type) -> str:
    """Fields of a settings dataclass with default and the description from its docstring."""
    described: dict[str, str] = {}
    name = ""
    for line in (record.__doc__ or "").split("Attributes:")[-1].split("Raises:")[0].splitlines():
        text = line.strip()
        head, colon, rest = text.partition(":")
        if colon and head in {item.name for item in fields(record)}:
            name, described[head] = head, rest.strip()
        elif name and text:
            described[name] += " " + text
    rows = []
    for item in fields(record):
        default = "required" if item.default is MISSING and item.default_factory is MISSING else repr(item.default)
        if item.default is MISSING and item.default_factory is not MISSING:
            default = repr(item.default_factory())
        rows.append((f"`{item.name}`", f"`{default}`", described.get(item.name, "")))
    return table(("setting", "default", "meaning"), rows)


def shape_parameters() -> str:
    """Every shape parameter with unit, default, limits, meaning and source."""
    from spaceplane.vehicle.shape import PARAMETERS

    rows = [
        (f"`{p.name}`", p.unit, f"{p.default:g}", f"{p.lower:g}", f"{p.upper:g}", p.description, p.source)
        for p in PARAMETERS
    ]
    return table(("parameter", "unit", "default", "lower", "upper", "meaning", "source"), rows, "llrrrll")


def controls() -> str:
    """Every control surface with its limits and positive sense."""
    from spaceplane.vehicle.controls import CONTROL_LIMITS_DEG, CONTROL_POSITIVE

    rows = [
        (f"`{name}`", CONTROL_POSITIVE[name], f"{lower:g} to {upper:g} deg")
        for name, (lower, upper) in CONTROL_LIMITS_DEG.items()
    ]
    return table(("control", "positive", "limits"), rows)


def command_line() -> str:
    """The help of every command, as the program prints it."""
    import typer

    from spaceplane.cli import app

    root = typer.main.get_command(app)
    parts: list[str] = []

    def section(command: Any, path: str, parent: Any) -> None:
        context = command.context_class(command, info_name=path.split()[-1], parent=parent)
        summary = (command.help or "").replace("\b\n", "").replace("\b", "").strip()
        parts.append(f"## `{path}`\n\n```\n{summary}\n```\n" if parent else f"{summary}\n")
        if hasattr(command, "commands"):
            for name in command.list_commands(context):
                section(command.get_command(context, name), f"{path} {name}", context)
            return
        rows = []
        for parameter in command.get_params(context):
            if parameter.param_type_name == "option":
                record = parameter.get_help_record(context)
                if record and "--help" not in record[0]:
                    rows.append((f"`{record[0]}`".replace("|", "\\|"), record[1].replace("|", "\\|")))
            else:
                rows.append((f"`{parameter.metavar or parameter.name}`".replace("|", "\\|"), parameter.help or ""))
        if rows:
            parts.append(table(("argument", "meaning"), rows) + "\n")
        if command.epilog:
            parts.append(f"`{command.epilog.removeprefix('Example: ')}`\n")

    section(root, "spaceplane", None)
    return "\n".join(parts)


def demo_extract(result: dict) -> dict:
    """What the pages show of a result.json: no histories, matrices or loads by part."""
    keep = (
        "name",
        "mach",
        "altitude_m",
        "alpha_deg",
        "alpha_source",
        "coefficients",
        "derivatives",
        "modes",
        "verdicts",
    )
    points = []
    for point in result["flight_points"]:
        short = {key: point[key] for key in keep}
        short["derivatives"] = {
            name: {key: entry[key] for key in ("value", "error", "unit")}
            for name, entry in point["derivatives"].items()
        }
        shown = ("name", "eigenvalue", "period_s", "half_time_s", "double_time_s", "damping_ratio", "oscillatory")
        short["modes"] = [{key: mode[key] for key in shown} for mode in point["modes"]]
        short["convergence"] = [
            {key: entry[key] for key in ("label", "verdict", "residual_drop", "iterations")}
            for entry in point["convergence"]
        ]
        points.append(short)
    shown = ("geometry", "deflections_deg", "reference")
    return {
        "version": result["version"],
        "vehicle": {key: result["vehicle"][key] for key in shown},
        "mesh": {key: result["mesh"][key] for key in ("cells", "wall_cell_m")},
        "solver": {key: result["solver"][key] for key in ("conditions", "precision")},
        "flight_points": points,
    }


def demo() -> dict:
    """The stored extract of the demo's result."""
    return json.loads(DEMO.read_text(encoding="utf-8"))


def number(value: float | None, digits: int = 4) -> str:
    """A number with `digits` significant digits; a dash where there is none."""
    return "-" if value is None else f"{value:.{digits}g}"


def demo_summary() -> str:
    """Size of the demo's mesh and ensemble, and how its conditions converged."""
    result = demo()
    verdicts = [entry["verdict"] for point in result["flight_points"] for entry in point["convergence"]]
    size = result["vehicle"]["geometry"]
    return (
        f"{size['length_m']:.2f} m long, {size['span_m']:.2f} m in span; {result['mesh']['cells']} cells, wall cell "
        f"{result['mesh']['wall_cell_m']:.3g} m; {verdicts.count('converged')} of {len(verdicts)} conditions converged."
    )


def demo_coefficients() -> str:
    """Coefficients and static derivatives of the demo's flight points."""
    points = demo()["flight_points"]
    head = ["", *(f"Mach {point['mach']:g}" for point in points)]
    rows = [["alpha, deg", *(f"{point['alpha_deg']:.1f}" for point in points)]]
    rows += [[name, *(number(p["coefficients"][name]) for p in points)] for name in ("CL", "CD", "L_over_D", "Cm")]
    for name in ("CL_alpha", "CD_alpha", "Cm_alpha", "CY_beta", "Cl_beta", "Cn_beta"):
        rows.append([f"{name}, 1/rad", *(with_error(p["derivatives"].get(name)) for p in points)])
    return table(head, rows, "l" + "r" * len(points))


def with_error(entry: dict | None) -> str:
    """A derivative and its error estimate."""
    if entry is None or entry["value"] is None:
        return "-"
    return number(entry["value"]) + ("" if entry["error"] is None else f" ± {entry['error']:.1g}")


def demo_modes() -> str:
    """Eigenmodes of the demo's flight points with time scales and levels."""
    rows = []
    for point in demo()["flight_points"]:
        for mode in point["modes"]:
            re, im = mode["eigenvalue"]
            value = f"{re:.4g}" + (f" ± {abs(im):.4g}i" if mode["oscillatory"] else "")
            half, double = mode["half_time_s"], mode["double_time_s"]
            time = f"half {half:.3g} s" if half is not None else "-" if double is None else f"doubles {double:.3g} s"
            level = worst_level(point["verdicts"], mode["name"])
            rows.append((f"{point['mach']:g}", mode["name"], value, time, number(mode["damping_ratio"], 3), level))
    return table(("Mach", "mode", "eigenvalue, 1/s", "amplitude", "damping ratio", "level"), rows, "rlrrrl")


def worst_level(verdicts: Sequence[dict], mode: str) -> str:
    """The worst MIL-F-8785C level of a mode over its criteria; a dash where none applies."""
    order = [1, 2, 3, "below 3"]
    levels = [v["level"] for v in verdicts if v["mode"] == mode and v["applicable"] and v["level"] is not None]
    return str(max(levels, key=order.index)) if levels else "-"


def demo_levels() -> str:
    """Flying-quality levels of the demo's flight points."""
    rows = []
    for point in demo()["flight_points"]:
        for verdict in point["verdicts"]:
            level = "not applicable" if not verdict["applicable"] else verdict["level"]
            rows.append(
                (
                    f"{point['mach']:g}",
                    verdict["mode"],
                    verdict["criterion"],
                    verdict["paragraph"],
                    number(verdict["value"], 3),
                    "-" if level is None else level,
                )
            )
    return table(("Mach", "mode", "criterion", "paragraph", "value", "level"), rows, "rlllrl")


def mesh_settings() -> str:
    from spaceplane.mesh.settings import MeshSettings

    return settings_table(MeshSettings)


def flow_settings() -> str:
    from spaceplane.flow.settings import FlowSettings

    return settings_table(FlowSettings)


def increment_settings() -> str:
    from spaceplane.aero.increments.settings import IncrementSettings

    return settings_table(IncrementSettings)


def validation_block(case: str) -> Callable[[], str]:
    """Picture and table of one validation case as last run on fine meshes."""

    def block() -> str:
        from spaceplane.validation import markdown_table, page, read

        records = read(validation_path(case))
        lead = f"{validation_picture(case)()}\n\n{page.judged(records)}\n\n"
        tail = "".join(f"\n- {note}" for note in page.notes(records))
        return f"{lead}{markdown_table(records)}\nSources: {page.sources(records)}.\n{tail}"

    return block


def validation_horus() -> str:
    """HORUS-2B: one compact table per coefficient and configuration, Mach across and angle of attack down."""
    from spaceplane.validation import read

    records = [record for record in read(validation_path("horus")) if record.unit == "-"]
    parts = []
    for quantity in dict.fromkeys(record.quantity for record in records):
        own = {record.condition: record for record in records if record.quantity == quantity}
        inside = sum(record.within for record in own.values())
        title = quantity.replace("dC", "increment of C").replace("Cm", "C_m").replace("CL", "C_L").replace("CD", "C_D")
        parts.append(f"**{title}**: {inside} of {len(own)} within 30 %.\n")
        places = [tuple(part.rpartition(" alpha ")[0::2]) for part in own]
        machs = dict.fromkeys(mach for mach, _ in places)
        alphas = dict.fromkeys(alpha for _, alpha in places)
        rows = [
            [alpha.removesuffix(" deg"), *(_published_and_computed(own[f"{mach} alpha {alpha}"]) for mach in machs)]
            for alpha in alphas
        ]
        head = ("alpha, deg", *(f"{mach.rstrip(',')}: published / computed (deviation)" for mach in machs))
        parts.append(table(head, rows, "r" * len(head)) + "\n")
    return "\n".join(parts)


def horus_of_unit(unit: str) -> Callable[[], str]:
    """The rows of the HORUS-2B case with this unit: 1/deg the lateral point, m the moment centre."""

    def block() -> str:
        from spaceplane.validation import markdown_table, read

        return markdown_table([record for record in read(validation_path("horus")) if record.unit == unit])

    return block


def _digits(value: float) -> str:
    """Two significant digits; all before the point from 100 on."""
    return f"{value:.0f}" if abs(value) >= 99.5 else f"{value:.2g}"


def trust() -> str:
    """One row per validation case and quantity: the typical deviation, and how many rows lie inside the band."""
    from statistics import median

    from spaceplane.validation import read

    cases = ("cones", "sphere", "hb2", "finner", "m6", "horus")
    rows = []
    for case in (case for case in cases if validation_path(case).exists()):
        records = [r for r in read(validation_path(case)) if r.unit != "m" and r.quantity[0] != "d"]
        records = [r for r in records if not r.quantity.endswith(", inviscid")]
        for quantity, kind in dict.fromkeys((record.quantity, record.kind) for record in records):
            own = [record for record in records if (record.quantity, record.kind) == (quantity, kind)]
            gaps = [abs(record.deviation) for record in own if record.deviation is not None]
            scale, unit = (100.0, " %") if kind == "relative" else (1.0, "")
            typical = "-" if not gaps else f"{_digits(scale * median(gaps))}{unit}"
            inside = f"{sum(record.within for record in own)} of {len(own)}"
            rows.append((case, quantity, typical, f"{scale * own[0].band:.3g}{unit}", inside))
    return table(("case", "quantity", "median deviation", "band", "inside"), rows, "llrrr")


def _published_and_computed(record: Any) -> str:
    if record.computed is None:
        return f"{record.published:g} / not converged"
    deviation = f"{record.computed - record.published:+.4f}"
    if record.deviation is not None:
        deviation = f"{100 * record.deviation:+.0f} %"
    shown = f"{record.published:g} / {record.computed:.4f} ({deviation})"
    return shown if record.within else f"**{shown}**"


def dynamics_validation() -> str:
    """Published eigenmodes beside ours; computed on the spot, there is no flow in them."""
    from spaceplane.validation import markdown_table, run

    records = run(("dynamics",))
    notes = dict.fromkeys(record.note for record in records if record.note)
    sources = "; ".join(dict.fromkeys(record.source for record in records))
    return f"{markdown_table(records)}\nSources: {sources}.\n" + "".join(f"\n- {note}" for note in notes)


def reproduction_block(name: str) -> Callable[[], str]:
    """A table of the page on the thesis's eigenvalues."""

    def block() -> str:
        from spaceplane.validation import thesis

        return thesis.tables()[name]

    return block


def alpha_schedule() -> str:
    """Angle of attack by Mach number."""
    from spaceplane.dynamics.flightpoint import ALPHA_SCHEDULE

    return table(("Mach", "alpha, deg"), [(f"{mach:g}", f"{alpha:g}") for mach, alpha in ALPHA_SCHEDULE], "rr")


def gas_validity() -> str:
    """Continuum and ideal gas along the descent."""
    from spaceplane.dynamics.flightpoint import TRAJECTORY_ALTITUDE
    from spaceplane.environment.atmosphere import us1976
    from spaceplane.environment.validity import assess_validity

    rows = []
    for mach, altitude in TRAJECTORY_ALTITUDE.items():
        found = assess_validity(mach, us1976(altitude), 25.0)
        rows.append(
            (
                f"{mach:g}",
                f"{altitude / 1000:g}",
                f"{found.knudsen:.2g}",
                f"{found.ideal_shock_temperature:.0f}",
                f"{found.shock_temperature:.0f}",
                f"{found.compressibility_factor:.3f}",
                f"{100 * found.density_ratio_error:.0f} %",
            )
        )
    head = (
        "Mach",
        "altitude, km",
        "Knudsen number",
        "T2 ideal, K",
        "T2 equilibrium, K",
        "Z",
        "shock density above ideal",
    )
    return table(head, rows, "rrrrrrr")


def mil_limits() -> str:
    """Limits of MIL-F-8785C for class III, category B, as the program holds them."""
    from spaceplane.qualities import limits

    spec = limits.specification()
    phugoid, period, cap = spec["phugoid"], spec["short_period_damping"]["B"], spec["short_period_frequency"]["B"]
    dutch, roll, spiral = limits.of("dutch_roll", "B", "III"), limits.of("roll", "B", "III"), spec["spiral"]["B"]
    low = phugoid["damping_ratio_low"]
    rows = [
        (
            "phugoid",
            "damping ratio",
            f">= {low[0]}",
            f">= {low[1]:g}",
            f"doubles in >= {phugoid['double_time_low_s']:g} s",
        ),
        ("short period", "damping ratio", *_ranges(period)),
        ("short period", "omega^2 / (n/alpha), 1/(g s^2)", *_ranges(cap)),
        ("Dutch roll", "damping ratio", *(f">= {x:g}" for x in dutch["zeta"])),
        ("Dutch roll", "damping ratio times frequency, rad/s", *(f">= {x:g}" for x in dutch["zeta_omega"]), "-"),
        ("Dutch roll", "natural frequency, rad/s", *(f">= {x:g}" for x in dutch["omega"])),
        ("roll mode", "time constant, s", *(f"<= {x:g}" for x in roll)),
        ("spiral", "time to double, s", *(f">= {x:g}" for x in spiral)),
    ]
    keys = ("phugoid", "short_period_damping", "short_period_frequency", *["dutch_roll"] * 3, "roll", "spiral")
    rows = [(spec[key]["paragraph"], *row) for key, row in zip(keys, rows, strict=True)]
    return table(("paragraph", "mode", "quantity", "level 1", "level 2", "level 3"), rows)


def _ranges(entry: dict) -> list[str]:
    highs = [*entry["high"], None]
    return [f">= {a:g}" if b is None else f"{a:g} to {b:g}" for a, b in zip(entry["low"], highs, strict=True)]


BLOCKS: dict[str, Callable[[], str]] = {
    "shape parameters": shape_parameters,
    "controls": controls,
    "command line": command_line,
    "mesh settings": mesh_settings,
    "flow settings": flow_settings,
    "increment settings": increment_settings,
    "demo summary": demo_summary,
    "demo coefficients": demo_coefficients,
    "demo modes": demo_modes,
    "demo levels": demo_levels,
    "trust": trust,
    "validation cones": validation_block("cones"),
    "validation sphere": validation_block("sphere"),
    "validation hb2": validation_block("hb2"),
    "validation finner": validation_block("finner"),
    "validation m6": validation_block("m6"),
    "validation horus": validation_horus,
    "validation horus picture": validation_picture("horus"),
    "validation horus lateral": horus_of_unit("1/deg"),
    "moment centre": horus_of_unit("m"),
    "dynamics validation": dynamics_validation,
    "alpha schedule": alpha_schedule,
    "gas validity": gas_validity,
    "mil limits": mil_limits,
    "reproduction reference": reproduction_block("reference"),
    "reproduction side force": reproduction_block("side force"),
    "reproduction lateral": reproduction_block("lateral"),
    "reproduction longitudinal": reproduction_block("longitudinal"),
    "reproduction converted": reproduction_block("converted"),
}
