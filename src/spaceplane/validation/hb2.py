"""Validation case: the AGARD HB-2 ballistic model against wind-tunnel measurements."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from spaceplane.aero.increments.add import integrate_with
from spaceplane.aero.increments.settings import Air, IncrementSettings
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
REYNOLDS, TEMPERATURE = 1e6, 200.0
"""Reynolds number on the cylinder's diameter, assumed (3e5 to 3e6: forebody's axial force at Mach 1.5 by +-1 %), and
static temperature of the stream, K."""
FRICTION_NOTE = (
    "The measured values contain skin friction; so do ours: turbulent, adiabatic wall, at an assumed Reynolds number "
    "of 1e6 on the cylinder's diameter, added to the inviscid flow's pressure forces."
)
INVISCID_NOTE = "Rows marked inviscid leave the friction out; shown, not judged."
BASE_NOTE = "Base pressure is viscous; the inviscid value is shown, not judged."
SEPARATION_NOTE = "Mach 6: laminar separation ahead of the flare lowers the measured normal force; shown, not judged."


def run(fine: bool, progress: Progress) -> list[Record]:
    """Normal force, centre of pressure and axial force of the HB-2 at Mach 1.5, 3 and 6, with skin friction.

    Args:
        fine: 30 wall cells per cylinder diameter instead of 12.
        progress: told what runs.
    """
    progress("Mach 1.5, 3 and 6", 0.0)
    mach = np.repeat(list(MEASURED), 2)
    alpha = np.tile([0.0, STEP], len(MEASURED))
    conditions = FlowConditions(mach, alpha, np.zeros_like(alpha))
    solution = solve_body(bodies.hb2(), mesh_settings(1.0 / (30 if fine else 12)), conditions, progress)
    reference = reference_of(math.pi / 4.0, 1.0, (MOMENT_STATION, 0.0, 0.0))
    air = Air.at_reynolds(REYNOLDS, mach, TEMPERATURE)
    friction = IncrementSettings(friction="turbulent")
    viscous, inviscid = (
        data.sel(part="total")
        for data in (integrate_with(solution, reference, friction, air), integrate(solution, reference))
    )
    records = []
    for row, (number, measured) in enumerate(MEASURED.items()):
        good = all(solution.records[2 * row + k].good for k in range(2))
        computed, plain = (_values(data, row) if good else {} for data in (viscous, inviscid))
        records += _records(number, measured, computed, plain)
    return records


def mesh_settings(cell: float) -> MeshSettings:
    """Mesh of wall cells of this size, m: a grid plane lies in the base, so that no cell holds cone and base at once.

    A cell that holds the rim has one pressure for both, too low for the flare and too high for the base.
    """
    offset = (-LENGTH / cell + 1e-6) % 1.0
    return MeshSettings(wall_cell=cell, wall_layers=6, growth_layers=4, far_field=1.5, offset=(offset, 0.236))


def _values(data: xr.Dataset, row: int) -> dict[str, float]:
    """Derivatives and axial forces from conditions 2 `row` (straight) and 2 `row` + 1 (inclined)."""
    zero, pitch = data.isel(condition=2 * row), data.isel(condition=2 * row + 1)
    normal = float(pitch.CN - zero.CN)
    return {
        "CN_alpha": normal / math.degrees(STEP),
        "x_cp": (MOMENT_STATION - float(pitch.Cm - zero.Cm) / normal) / LENGTH,
        "CA_forebody": float(zero.CA - zero.CA_base),
        "CA_base": float(zero.CA_base),
    }


def _records(
    mach: float, measured: dict[str, float], computed: dict[str, float], plain: dict[str, float]
) -> list[Record]:
    separated = SEPARATION_NOTE if mach > 4.0 else ""
    forces = {
        "CN_alpha": ("C_N_alpha", "1/deg", 0.05, "relative", 0.001, not separated),
        "x_cp": ("x_cp / length", "-", 0.02, "absolute", 0.01, not separated),
        "CA_forebody": ("C_A forebody", "-", 0.04, "relative", 0.01, True),
    }
    rows = [(key, *row, computed, separated or FRICTION_NOTE) for key, row in forces.items()]
    rows += [(key, f"{name}, inviscid", *row[:-1], False, plain, INVISCID_NOTE) for key, (name, *row) in forces.items()]
    rows.append(("CA_base", "C_A base", "-", 0.30, "relative", 0.01, False, plain, BASE_NOTE))
    return [
        Record(
            case=CASE,
            quantity=quantity,
            condition=f"Mach {mach:g}",
            unit=unit,
            published=measured[key],
            computed=values.get(key),
            band=band,
            kind=kind,
            source=SOURCE,
            floor=floor,
            gate=gate,
            note=note,
        )
        for key, quantity, unit, band, kind, floor, gate, values, note in rows
    ]
