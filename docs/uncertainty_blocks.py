"""The generated blocks of the page on uncertainty, from docs/data/uncertainty.json (scripts/check_uncertainty.py)."""

from __future__ import annotations

import json
from collections.abc import Callable

from blocks import DATA, number, table

STORED = DATA / "uncertainty.json"
SHOWN = ("CL", "CD", "CY", "Cl", "Cm", "Cn", "CL_alpha", "Cm_alpha", "CY_beta", "Cl_beta", "Cn_beta", "Cl_p", "Cm_q")
SHOWN += ("Cn_r", "CL_elevon_left", "Cm_elevon_left")


def stored() -> dict:
    """What scripts/check_uncertainty.py kept."""
    return json.loads(STORED.read_text(encoding="utf-8"))


def coverage() -> str:
    """How many intervals hold the true value, and how wide they are against the error."""
    result = stored()
    rows = [
        (
            f"**{one['case']}**" if one["case"] in ("held out", "all") else one["case"],
            one["side"],
            one["kind"],
            one["values"],
            f"{100 * one['covered']:.0f} %",
            f"{one['median_ratio']:.1f}",
        )
        for one in result["groups"]
    ]
    head = ("case", "side", "kind", "values", "true value inside", "median of stated over true error")
    return table(head, rows, "lllrrr")


def meshes() -> str:
    """The meshes of each body, and the coverage against the limit that its reference and mesh point to."""
    rows = [
        (
            one["case"],
            *(f"{one[name]}" for name in ("mesh", "companion", "reference")),
            number(one["wall_cell_m"], 3),
            number(one["reference_cell_m"], 3),
            f"{100 * one['covered_limit']:.0f} %",
        )
        for one in stored()["meshes"]
    ]
    head = ("case", "cells", "companion", "reference", "wall cell, m", "reference, m", "inside, on to the limit")
    return table(head, rows, "lrrrrrr")


def values() -> str:
    """Coefficients at the base conditions (lateral ones in sideslip) and derivatives of HORUS-2B, with their errors."""
    rows = []
    for row in stored()["rows"]:
        mach, _, label = row["condition"].partition(", ")
        lateral = row["quantity"] in ("CY", "Cl", "Cn")
        wanted = ("beta",) if lateral else ("base", "")
        if row["case"] != "HORUS-2B" or row["quantity"] not in SHOWN or label not in wanted:
            continue
        inside = "" if abs(row["error"]) <= row["stated"] else "outside"
        name = f"{row['quantity']}{' in sideslip' if lateral else ''}"
        shown = [number(row[key], 2 if key != "value" else 4) for key in ("value", "stated", "error")]
        rows.append((SHOWN.index(row["quantity"]), (f"`{name}`", mach, *shown, inside)))
    ordered = [cells for _, cells in sorted(rows, key=lambda pair: pair[0])]
    return table(("quantity", "at", "value", "stated ±", "error", ""), ordered, "llrrrl")


def exact() -> str:
    """Cones and the sphere against their exact solutions; of the cones no lateral twin but one."""
    rows = []
    for row in stored()["rows"]:
        if row["case"] == "sphere" or row["quantity"] in ("C_A forebody", "C_N_alpha", "C_n_beta"):
            inside = "" if abs(row["error"]) <= row["stated"] else "outside"
            shown = [number(row[key], 2 if key != "value" else 4) for key in ("value", "stated", "error")]
            rows.append((row["case"], row["quantity"], row["condition"], *shown, inside))
    return table(("body", "quantity", "at", "value", "stated ±", "error", ""), rows, "lllrrrl")


BLOCKS: dict[str, Callable[[], str]] = {
    "uncertainty coverage": coverage,
    "uncertainty meshes": meshes,
    "uncertainty values": values,
    "uncertainty exact": exact,
}
