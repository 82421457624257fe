"""The generated blocks of the page on real-gas effects, from docs/data/real_gas.json (scripts/compare_gases.py)."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import product

from blocks import DATA, table

STORED = DATA / "real_gas.json"
FINE, COARSE = 0.25, 0.35
"""Wall cells, m."""


def stored() -> dict:
    """What scripts/compare_gases.py kept."""
    return json.loads(STORED.read_text(encoding="utf-8"))


def _run(result: dict, gas: str, elevon: float = 0.0, cell: float = FINE) -> dict:
    wanted = {"gas": gas, "elevon_deg": elevon, "wall_cell_m": cell}
    return next(run for run in result["runs"] if run | wanted == run)


def _places(result: dict) -> list[tuple[float, float]]:
    """[condition] Mach number and angle of attack, deg."""
    return list(product(result["machs"], result["alphas_deg"]))


def coefficients() -> str:
    """Both gases with elevons at rest."""
    result = stored()
    ideal, air = _run(result, "perfect"), _run(result, "equilibrium")
    altitude = dict(zip(result["machs"], result["altitudes_m"], strict=True))
    rows = []
    for k, (mach, alpha) in enumerate(_places(result)):
        row = [f"{mach:g}", f"{altitude[mach] / 1e3:g}", f"{alpha:g}"]
        for name in ("CL", "CD", "Cm"):
            row += [f"{ideal[name][k]:.4f}", f"{air[name][k]:.4f}"]
        rows.append([*row, "" if air["verdict"][k] == "converged" else "not converged"])
    head = ["Mach", "km", "alpha, deg"]
    head += [f"{name} {gas}" for name in ("CL", "CD", "Cm") for gas in ("perfect", "equilibrium")]
    return table((*head, ""), rows, "r" * 9 + "l")


def trim() -> str:
    """What equilibrium air does to the pitching moment, on two meshes, and the elevon angle that makes up for it."""
    result = stored()
    up = min(run["elevon_deg"] for run in result["runs"])
    rows = []
    for k, (mach, alpha) in enumerate(_places(result)):
        row = [f"{mach:g}", f"{alpha:g}"]
        for cell in (FINE, COARSE):
            ideal, air = _run(result, "perfect", cell=cell), _run(result, "equilibrium", cell=cell)
            shift = -(air["Cm"][k] / air["CN"][k] - ideal["Cm"][k] / ideal["CN"][k]) * result["c_ref_m"]
            mark = "" if {air["verdict"][k], ideal["verdict"][k]} == {"converged"} else " *"
            row += [f"{air['Cm'][k] - ideal['Cm'][k]:+.4f}{mark}", f"{1e3 * shift:+.0f}{mark}"]
        rest, moved = _run(result, "perfect"), _run(result, "perfect", up)
        slope = (rest["Cm"][k] - moved["Cm"][k]) / -up
        change = _run(result, "equilibrium")["Cm"][k] - rest["Cm"][k]
        rows.append([*row, f"{slope:+.5f}", f"{-change / slope:+.1f}"])
    head = ["Mach", "alpha, deg"]
    for cell in (FINE, COARSE):
        head += [f"change of Cm, {cell:g} m", "x_cp moves aft, mm"]
    return table((*head, "Cm per deg of elevons", "elevons make up for it, deg"), rows, "r" * 8)


def runs() -> str:
    """Mesh and convergence."""
    parts = []
    for run in stored()["runs"]:
        good = run["verdict"].count("converged")
        parts.append(
            f"{run['gas']}, wall cell {run['wall_cell_m']:g} m, elevons {run['elevon_deg']:g} deg: {run['cells']} "
            f"cells, {good} of {len(run['verdict'])}"
        )
    return "Conditions converged: " + "; ".join(parts) + "."


BLOCKS: dict[str, Callable[[], str]] = {
    "real gas coefficients": coefficients,
    "real gas trim": trim,
    "real gas runs": runs,
}
