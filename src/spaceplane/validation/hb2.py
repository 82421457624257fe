"""Validation case: the AGARD HB-2 ballistic model against wind-tunnel measurements."""

from __future__ import annotations

import math

import numpy as np

from spaceplane.aero.integrate import integrate
from spaceplane.flow.solution import FlowConditions
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies
from spaceplane.validation.cases import Progress
from spaceplane.validation.flowcase import reference_of, solve_body
from spaceplane.validation.records import Record

CASE = "hb2"
SOURCE = "Gray, AEDC-TDR-64-137 (1964), digitised"
LENGTH, MOMENT_STATION = 4.9, 1.95
STEP = math.radians(2.0)
MEASURED = {
    1.5: {"CN_alpha": 0.080, "x_cp": 0.460, "CA_forebody": 0.82, "CA_base": 0.345},
    3.0: {"CN_alpha": 0.0835, "x_cp": 0.520, "CA_forebody": 0.665, "CA_base": 0.23},
    6.0: {"CN_alpha": 0.0665, "x_cp": 0.535, "CA_forebody": 0.565, "CA_base": 0.065},
}
"""Mach -> C_N_alpha per degree, centre of pressure over the length, axial force of forebody and base on pi d^2 / 4."""
FRICTION_NOTE = "The measured forebody axial force contains skin friction, which an inviscid method does not have."
BASE_NOTE = "Base pressure is viscous; the inviscid value is shown, not judged."
SEPARATION_NOTE = "Mach 6: laminar separation ahead of the flare lowers the measured normal force; shown, not judged."


def run(fine: bool, progress: Progress) -> list[Record]:
    """Normal force, centre of pressure and axial force of the HB-2 at Mach 1.5, 3 and 6.

    Args:
        fine: 24 wall cells per cylinder diameter instead of 12.
        progress: told what runs.
    """
    progress("Mach 1.5, 3 and 6", 0.0)
    mach = np.repeat(list(MEASURED), 2)
    alpha = np.tile([0.0, STEP], len(MEASURED))
    conditions = FlowConditions(mach, alpha, np.zeros_like(alpha))
    solution = solve_body(bodies.hb2(), MeshSettings(wall_cell=1.0 / (24 if fine else 12)), conditions, progress)
    reference = reference_of(math.pi / 4.0, 1.0, (MOMENT_STATION, 0.0, 0.0))
    values = integrate(solution, reference).sel(part="total")
    records = []
    for row, (number, measured) in enumerate(MEASURED.items()):
        zero, pitch = values.isel(condition=2 * row), values.isel(condition=2 * row + 1)
        good = all(solution.records[2 * row + k].good for k in range(2))
        normal = float(pitch.CN - zero.CN)
        computed = {
            "CN_alpha": normal / math.degrees(STEP),
            "x_cp": (MOMENT_STATION - float(pitch.Cm - zero.Cm) / normal) / LENGTH,
            "CA_forebody": float(zero.CA_forebody),
            "CA_base": float(zero.CA_base),
        }
        records += _records(number, measured, computed if good else {})
    return records


def _records(mach: float, measured: dict[str, float], computed: dict[str, float]) -> list[Record]:
    separated = SEPARATION_NOTE if mach > 4.0 else ""
    rows = {
        "CN_alpha": ("C_N_alpha", "1/deg", 0.10, "relative", 0.001, not separated, separated),
        "x_cp": ("x_cp / length", "-", 0.02, "absolute", 0.01, not separated, separated),
        "CA_forebody": ("C_A forebody", "-", 0.10, "relative", 0.01, True, FRICTION_NOTE),
        "CA_base": ("C_A base", "-", 0.30, "relative", 0.01, False, BASE_NOTE),
    }
    return [
        Record(
            case=CASE,
            quantity=quantity,
            condition=f"Mach {mach:g}",
            unit=unit,
            published=measured[key],
            computed=computed.get(key),
            band=band,
            kind=kind,
            source=SOURCE,
            floor=floor,
            gate=gate,
            note=note,
        )
        for key, (quantity, unit, band, kind, floor, gate, note) in rows.items()
    ]
