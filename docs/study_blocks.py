"""Generated blocks of the pages on sensitivity and the research questions, from stored extracts in docs/data.

python docs/study_blocks.py --store-sensitivity out/sensitivity/sensitivity.json
python docs/study_blocks.py --store-comparison out/compare/compare.json
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable
from pathlib import Path

from blocks import table  # beside this module

DATA = Path(__file__).resolve().parent / "data"
SENSITIVITY, COMPARISON = DATA / "sensitivity.json", DATA / "comparison.json"
COLUMNS = ("parameter", "side", "parameter_value", "mach", "quantity", "value", "default", "noise", "flow")
DERIVATIVES = ("CD_alpha", "CL_alpha", "Cm_alpha", "CY_beta", "Cl_beta", "Cn_beta", "CD_M", "CL_M", "Cm_M")
CHORD, SPAN = 23.0, 13.0
"""Reference lengths of HORUS-2B, m."""
AFT_CENTRE = 1.8  # m: from the default centre to the one that the published C_m asks for (docs/moment-reference.md)


def sensitivity_extract(document: dict) -> dict:
    """What the pages show of a sensitivity.json."""
    rows = [
        [row[name] for name in COLUMNS]
        for row in document["rows"]
        if row["kind"] in ("derivative", "level") or row["quantity"].startswith(("greatest", "lateral", "CL", "CD"))
    ]
    settings = document["default"]["settings"]
    default = [
        {key: point[key] for key in ("mach", "alpha_deg", "coefficients")}
        | {"modes": [{key: mode[key] for key in ("name", "eigenvalue")} for mode in point["modes"]]}
        for point in document["default"]["flight_points"]
    ]
    return {
        "created": document["created"],
        "version": document["version"],
        "code": document["code"],
        "mesh": settings["mesh"],
        "cells": document["shapes"][0]["cells"],
        "study": document["study"],
        "warnings": document["warnings"],
        "failures": document["failures"],
        "seconds": [round(shape["seconds"], 1) for shape in document["shapes"]],
        "columns": COLUMNS,
        "rows": rows,
        "default": default,
        "agreement": document["thesis_agreement"]["by"],
    }


def study() -> dict:
    """The stored extract of the sensitivity study."""
    return json.loads(SENSITIVITY.read_text(encoding="utf-8"))


def rows_of(document: dict) -> list[dict]:
    """The extract's rows by column name."""
    return [dict(zip(document["columns"], row, strict=True)) for row in document["rows"]]


def words(parameter: str) -> str:
    """A parameter without its unit."""
    return parameter.rpartition("_")[0].replace("_", " ")


def unit(parameter: str) -> str:
    """A parameter's unit."""
    return parameter.rpartition("_")[2]


def study_setup() -> str:
    """Size of the stored study and how its flows converged."""
    document = study()
    shapes = len({(row["parameter"], row["side"], row["parameter_value"]) for row in rows_of(document)})
    machs = ", ".join(f"{mach:g}" for mach in document["study"]["mach"])
    seconds = sorted(document["seconds"])
    return (
        f"{shapes} changed shapes and the default at Mach {machs}; {document['cells']} cells on the default, wall "
        f"cell {document['mesh']['wall_cell']:.3g} m on all; {seconds[len(seconds) // 2]:.0f} s a shape (median, "
        f"busy machine). Flight points with a condition that did not converge: {len(document['warnings'])}; shapes "
        f"without a result: {len(document['failures'])}. Numerical code `{document['code']}`."
    )


def _changes(quantity: str, as_percent: bool) -> str:
    document = study()
    rows = [row for row in rows_of(document) if row["quantity"] == quantity]
    machs = document["study"]["mach"]
    lines = []
    for parameter in dict.fromkeys(row["parameter"] for row in rows):
        line = [words(parameter)]
        for side in ("low", "high"):
            own = {row["mach"]: row for row in rows if (row["parameter"], row["side"]) == (parameter, side)}
            value = next((row["parameter_value"] for row in own.values()), None)
            line.append("-" if value is None else f"{value:g} {unit(parameter)}")
            line += [_change(own.get(mach), as_percent) for mach in machs]
        lines.append(line)
    head = ["parameter"]
    for side in ("low", "high"):
        head += [side, *(f"M {mach:g}" for mach in machs)]
    return table(head, lines, "l" + ("l" + "r" * len(machs)) * 2)


def _change(row: dict | None, as_percent: bool) -> str:
    if row is None or row["value"] is None or row["default"] is None:
        return "-"
    if row["flow"] == "failed":
        return "no flow"
    gap = row["value"] - row["default"]
    text = f"{100 * gap / abs(row['default']):+.0f} %" if as_percent else f"{gap:+.2g}"
    return text if row["noise"] is None or abs(gap) > row["noise"] else f"({text})"


def derivative_block(name: str) -> Callable[[], str]:
    """Change of one derivative with every parameter, %."""
    return lambda: _changes(name, True)


def mode_block(quantity: str) -> Callable[[], str]:
    """Change of one figure of a mode with every parameter."""
    return lambda: _changes(quantity, False)


def strongest() -> str:
    """The changes of shape that move each derivative most, by Mach number."""
    document = study()
    lines = []
    for name in DERIVATIVES:
        line = [f"`{name}`"]
        for mach in document["study"]["mach"]:
            own = [
                row
                for row in rows_of(document)
                if (row["quantity"], row["mach"]) == (name, mach)
                and None not in (row["value"], row["default"])
                and row["flow"] != "failed"
                and abs(row["value"] - row["default"]) > (row["noise"] or 0.0)
            ]
            own.sort(key=lambda row: -abs(row["value"] - row["default"]))
            best = [f"{words(row['parameter'])} {row['side']} ({_change(row, True)})" for row in own[:3]]
            line.append("<br>".join(best) or "none above the mesh's noise")
        lines.append(line)
    return table(("derivative", *(f"Mach {mach:g}" for mach in document["study"]["mach"])), lines)


def default_noise() -> str:
    """The default's derivatives and what shifting the mesh changes in them."""
    document = study()
    seen = {(row["quantity"], row["mach"]): row for row in rows_of(document)}
    lines = []
    for name in DERIVATIVES:
        line = [f"`{name}`"]
        for mach in document["study"]["mach"]:
            row = seen[name, mach]
            noise = "-" if row["noise"] is None else f"{row['noise']:.2g}"
            line += [f"{row['default']:.4g}", noise]
        lines.append(line)
    head = ["derivative"]
    for mach in document["study"]["mach"]:
        head += [f"Mach {mach:g}", "shift"]
    return table(head, lines, "l" + "rr" * len(document["study"]["mach"]))


def about_aft_centre(row: dict[str, float], alpha: float, aft: float) -> dict[str, float]:
    """Return `Cm_alpha` and `Cn_beta` about a centre moved aft.

    Args:
        row: CL, CD and derivatives of one shape at one flight point, per radian.
        alpha: angle of attack, rad.
        aft: distance moved, m.
    """
    normal, side = normal_and_side(row, alpha)
    return {"Cm_alpha": row["Cm_alpha"] + normal * aft / CHORD, "Cn_beta": row["Cn_beta"] + side * aft / SPAN}


def normal_and_side(row: dict[str, float], alpha: float) -> tuple[float, float]:
    """Slopes of the normal force with alpha and of the force along body y with sideslip, per radian."""
    normal = row["CL_alpha"] * math.cos(alpha) - row["CL"] * math.sin(alpha)
    normal += row["CD_alpha"] * math.sin(alpha) + row["CD"] * math.cos(alpha)
    return normal, row["CY_beta"] - row["CD"]  # along body y: the drag turns with the wind


def damping_about(row: dict[str, float], moved: dict[str, float], aft: float) -> dict[str, float]:
    """Damping derivatives about a centre moved aft; none where `row` has none.

    A point that lies ahead of the turning centre by a moves up in pitching and to the right in yawing: it meets the air
    at an angle of attack smaller by q a/V and a sideslip greater by r a/V.

    Args:
        row: derivatives about the old centre; moved: `Cm_alpha` and `Cn_beta` about the new one.
        aft: distance moved, m.
    """
    if "Cm_q" not in row:
        return {}
    pitch, yaw = 2.0 * aft / CHORD, 2.0 * aft / SPAN
    return {
        "CL_q": row["CL_q"] - pitch * row["CL_alpha"],
        "Cm_q": row["Cm_q"] + row["CL_q"] * aft / CHORD - pitch * moved["Cm_alpha"],
        "CY_p": row["CY_p"],
        "Cl_p": row["Cl_p"],
        "Cn_p": row["Cn_p"] + row["CY_p"] * aft / SPAN,
        "CY_r": row["CY_r"] + yaw * row["CY_beta"],
        "Cl_r": row["Cl_r"] + yaw * row["Cl_beta"],
        "Cn_r": row["Cn_r"] + row["CY_r"] * aft / SPAN + yaw * moved["Cn_beta"],
    }


def _moved(aft_of_default: float) -> list[dict]:
    """Rows of `Cm_alpha` and `Cn_beta` about a centre that lies aft of 13.0 m on the default shape, m."""
    from spaceplane.vehicle.presets import load

    document = study()
    alpha = {point["mach"]: math.radians(point["alpha_deg"]) for point in document["default"]}
    shapes: dict[tuple, dict] = {}
    for row in rows_of(document):
        shapes.setdefault((row["parameter"], row["side"], row["parameter_value"], row["mach"]), {})[row["quantity"]] = (
            row
        )
    default_centre = load("horus-2b").reference.moment_center[0]
    rows = []
    for (parameter, side, value, mach), found in shapes.items():
        centre = load("horus-2b", {parameter: value}, allow_outside=True).reference.moment_center[0]
        new = {name: row["value"] for name, row in found.items()}
        old = {name: row["default"] for name, row in found.items()}
        if None in (new["Cm_alpha"], new["Cn_beta"], old["Cm_alpha"], old["Cn_beta"]):
            continue
        after = about_aft_centre(new, alpha[mach], aft_of_default * centre / default_centre)
        before = about_aft_centre(old, alpha[mach], aft_of_default)
        for name in ("Cm_alpha", "Cn_beta"):
            key = {"parameter": parameter, "side": side, "parameter_value": value, "mach": mach, "quantity": name}
            rows.append(key | {"value": after[name], "default": before[name], "noise": found[name]["noise"]})
    return rows


def aft_centre() -> str:
    """Moment derivatives about 13.0 and 14.8 m, and how far the signs of their changes agree with the thesis's."""
    from spaceplane.study import thesis

    lines = []
    for name in ("Cm_alpha", "Cn_beta"):
        for aft in (0.0, AFT_CENTRE):
            rows = [row for row in _moved(aft) if row["quantity"] == name]
            defaults = {row["mach"]: row["default"] for row in rows}
            ours = [
                thesis.Sensitivity(
                    row["parameter"],
                    row["side"],
                    row["parameter_value"],
                    row["mach"],
                    name,
                    row["value"],
                    row["default"],
                    max(thesis.resolution(row["value"], row["default"]), row["noise"] or 0.0),
                )
                for row in rows
            ]
            (count,) = thesis.agreement_table(thesis.agreement(ours), "derivative")
            share = "-" if count["agreement_percent"] is None else f"{count['agreement_percent']:.0f} %"
            told = f"{share} of {count['agree'] + count['disagree']}"
            lines.append((f"`{name}`", f"{13.0 + aft:.1f} m", *(f"{value:+.3f}" for value in defaults.values()), told))
        printed = thesis.derivatives("original")
        lines.append((f"`{name}`", "thesis", *(f"{printed[mach][name]:+.3f}" for mach in defaults), ""))
    machs = [f"Mach {mach:g}" for mach in study()["study"]["mach"]]
    return table(("default shape", "centre", *machs, "same sign as the thesis"), lines, "ll" + "r" * (len(machs) + 1))


def agreement_block(by: str) -> Callable[[], str]:
    """Signs of our changes against the thesis's, counted."""

    def block() -> str:
        lines = []
        for line in study()["agreement"][by]:
            percent = line["agreement_percent"]
            name = words(line[by]) if by == "parameter" else f"`{line[by]}`" if by == "derivative" else f"{line[by]:g}"
            share = "-" if percent is None else f"{percent:.0f} %"
            lines.append((name, line["agree"], line["disagree"], line["too small to tell"], share))
        return table((by, "same sign", "opposite sign", "too small to tell", "same, of those told"), lines, "lrrrr")

    return block


def level_counts() -> str:
    """How many shapes reach each level of each criterion, and the default's own."""
    document = study()
    lines = []
    rows = [
        row
        for row in rows_of(document)
        if ": " in row["quantity"] and not row["quantity"].startswith(("greatest", "lateral o"))
    ]
    rows = [row for row in rows if row["quantity"] not in (*DERIVATIVES, "CL", "CD")]
    for quantity in dict.fromkeys(row["quantity"] for row in rows):
        line = [quantity]
        for mach in document["study"]["mach"]:
            own = [row for row in rows if (row["quantity"], row["mach"]) == (quantity, mach)]
            if not own:
                line.append("-")
                continue
            counts = [sum(row["value"] == level for row in own) for level in (1, 2, 3, 4)]
            missing = len(own) - sum(counts)
            shown = " / ".join(map(str, counts)) + (f" ({missing} n/a)" if missing else "")
            line.append(f"{_level(own[0]['default'])}: {shown}")
        lines.append(line)
    return table(("criterion: quantity", *(f"Mach {mach:g}" for mach in document["study"]["mach"])), lines)


def _level(level: int | None) -> str:
    return {None: "n/a", 4: "below 3"}.get(level, str(level))


def comparison() -> dict:
    """The stored comparison of default and optimised shape."""
    return json.loads(COMPARISON.read_text(encoding="utf-8"))


def comparison_setup() -> str:
    """Meshes and flows of the stored comparison."""
    document = comparison()
    flows = "; ".join(
        f"Mach {point['mach']:g}: alpha {point['alpha_deg'][0]:.3g} deg, {point['altitude_m'][0] / 1000:.3g} km, "
        f"{point['flow'][0]} / {point['flow'][1]}"
        for point in document["flight_points"]
    )
    return f"{document['mesh'][0]} and {document['mesh'][1]} cells. {flows}."


def comparison_derivatives() -> str:
    """Derivatives of both shapes at all Mach numbers, with the thesis's."""
    points = comparison()["flight_points"]
    lines = []
    for name in DERIVATIVES:
        for point in points:
            row = next((row for row in point["derivatives"] if row["name"] == name), None)
            if row is None:
                continue
            ours = [_number(value) for value in row["values"]]
            printed = [_number(value) for value in row.get("thesis", (None, None))]
            percent = row["relative_percent"]
            change = "-" if percent is None else f"{percent:+.0f} %"
            mark = "" if row["resolved"] in (True, None) else " (within error)"
            lines.append(
                (f"`{name}`" if point is points[0] else "", f"{point['mach']:g}", *ours, change + mark, *printed)
            )
    head = ("derivative", "Mach", "default", "optimised", "change", "thesis default", "thesis optimised")
    return table(head, lines, "lrrrrrr")


def comparison_modes() -> str:
    """Modes of both shapes, paired."""
    lines = []
    for point in comparison()["flight_points"]:
        for row in point["modes"]:
            names = list(dict.fromkeys(mode["name"] for mode in row["modes"] if mode))
            values = [_eigenvalue(mode) for mode in row["modes"]]
            times = [_time(mode) for mode in row["modes"]]
            lines.append((f"{point['mach']:g}", " → ".join(names), values[0], times[0], values[1], times[1]))
    return table(("Mach", "mode", "default, 1/s", "", "optimised, 1/s", ""), lines, "rlrlrl")


def comparison_levels() -> str:
    """Levels of both shapes at all Mach numbers."""
    from spaceplane.study.compare_page import tables

    glance = next(item for item in tables(comparison()) if item.title == "Levels at a glance")
    return table(glance.columns, glance.rows)


def entry_loads() -> str:
    """What the lift of both shapes means for the entry: equilibrium glide density, dynamic pressure and heating."""
    lines = []
    for point in comparison()["flight_points"]:
        if point["mach"] < 5:
            continue
        lift = next(row["values"] for row in point["coefficients"] if row["name"] == "CL")
        ratio = lift[0] / lift[1]
        lines.append(
            (
                f"{point['mach']:g}",
                f"{point['alpha_deg'][0]:.3g}",
                *(f"{value:.3f}" for value in lift),
                f"{100 * (ratio - 1):+.0f} %",
                f"{100 * (math.sqrt(ratio) - 1):+.0f} %",
            )
        )
    head = (
        "Mach",
        "alpha, deg",
        "C_L default",
        "C_L optimised",
        "density and dynamic pressure",
        "stagnation heat flux",
    )
    return table(head, lines, "rrrrrr")


def comparison_aft() -> str:
    """Both shapes about 13.0 and 14.8 m: moment derivatives and the fastest growing motion, from the same flows."""
    lines = []
    for point in comparison()["flight_points"]:
        for aft in (0.0, AFT_CENTRE):
            cells = [cell for side in (0, 1) for cell in _about(point, side, aft)]
            lines.append((f"{point['mach']:g}", f"{13.0 + aft:.1f} m", *cells))
    head = ["Mach", "centre"]
    for name in ("default", "optimised"):
        head += [f"{name}: `Cm_alpha`", "`Cn_beta`", "fastest growth"]
    return table(head, lines, "rl" + "rrl" * 2)


def _about(point: dict, side: int, aft: float) -> tuple[str, str, str]:
    """`Cm_alpha`, `Cn_beta` and the fastest growing mode of one shape about a centre moved aft, m."""
    from spaceplane.aero.model.derivatives import STATIC, Derivatives
    from spaceplane.dynamics.flightpoint import taem_point
    from spaceplane.dynamics.linearise import linearise
    from spaceplane.dynamics.modes import identify
    from spaceplane.vehicle.presets import horus_2b

    vehicle = horus_2b()
    values = {row["name"]: row["values"][side] for row in point["derivatives"] + point["coefficients"]}
    alpha = math.radians(point["alpha_deg"][side])
    moved = about_aft_centre(values, alpha, aft)
    normal = values["CL_M"] * math.cos(alpha) + values["CD_M"] * math.sin(alpha)
    moved["Cm_M"] = values["Cm_M"] + normal * aft / vehicle.reference.chord
    static = {name: values[name] for name in STATIC} | moved
    static |= damping_about(values, moved, aft)
    flight = taem_point(point["mach"], alpha_deg=point["alpha_deg"][side])
    flight = flight.with_coefficients(values["CL"], values["CD"])
    modes = identify(linearise(flight, vehicle.mass, vehicle.reference, Derivatives(**static)))
    worst = max(modes, key=lambda mode: mode.eigenvalue.real)
    growth = "none" if worst.double_time is None else f"{worst.name}, doubles in {worst.double_time:.3g} s"
    return f"{moved['Cm_alpha']:+.3f}", f"{moved['Cn_beta']:+.3f}", growth


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"


def _eigenvalue(mode: dict | None) -> str:
    if mode is None:
        return "-"
    re, im = mode["eigenvalue"]
    return f"{re:.3g} ± {abs(im):.3g}i" if im else f"{re:.3g}"


def _time(mode: dict | None) -> str:
    if mode is None:
        return ""
    if mode["half_time_s"] is not None:
        return f"halves in {mode['half_time_s']:.3g} s"
    return "" if mode["double_time_s"] is None else f"doubles in {mode['double_time_s']:.3g} s"


BLOCKS: dict[str, Callable[[], str]] = {
    "study setup": study_setup,
    "study noise": default_noise,
    "study strongest": strongest,
    "study cn beta": derivative_block("Cn_beta"),
    "study cl beta": derivative_block("Cl_beta"),
    "study cy beta": derivative_block("CY_beta"),
    "study cm alpha": derivative_block("Cm_alpha"),
    "study cl alpha": derivative_block("CL_alpha"),
    "study greatest": mode_block("greatest real part: real part"),
    "study lateral real": mode_block("lateral oscillation: real part"),
    "study lateral damping": mode_block("lateral oscillation: damping ratio"),
    "study levels": level_counts,
    "study aft centre": aft_centre,
    "study agreement derivative": agreement_block("derivative"),
    "study agreement parameter": agreement_block("parameter"),
    "study agreement mach": agreement_block("mach"),
    "comparison setup": comparison_setup,
    "comparison derivatives": comparison_derivatives,
    "comparison modes": comparison_modes,
    "comparison levels": comparison_levels,
    "comparison entry loads": entry_loads,
    "comparison aft centre": comparison_aft,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--store-sensitivity", type=Path, metavar="FILE", help="keep what the pages show of a study")
    parser.add_argument("--store-comparison", type=Path, metavar="FILE", help="keep a comparison")
    options = parser.parse_args()
    DATA.mkdir(exist_ok=True)
    if options.store_sensitivity:
        document = sensitivity_extract(json.loads(options.store_sensitivity.read_text(encoding="utf-8")))
        head = json.dumps({key: value for key, value in document.items() if key != "rows"}, indent=1)[:-2]
        rows = ",\n  ".join(json.dumps(row) for row in document["rows"])
        SENSITIVITY.write_text(f'{head},\n "rows": [\n  {rows}\n ]\n}}\n', encoding="utf-8")
    if options.store_comparison:
        document = json.loads(options.store_comparison.read_text(encoding="utf-8"))
        COMPARISON.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
