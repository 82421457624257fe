"""Validation case: the Basic Finner in free flight, static and damping derivatives."""

from __future__ import annotations

import math

import numpy as np

from spaceplane.aero.conditions import turning
from spaceplane.aero.integrate import integrate
from spaceplane.flow.solution import FlowConditions
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies
from spaceplane.validation.cases import Progress
from spaceplane.validation.flowcase import reference_of, solve_body
from spaceplane.validation.records import Record

CASE = "finner"
SOURCE = "Dupuis and Hathaway, DREV-TM-9703 (1997), free flight in an aeroballistic range"
MOMENT_STATION = 5.5
"""m from the nose, of 10 m in all."""
STEP, RATE = math.radians(1.0), 0.005
"""Incidence, rad, and reduced pitch rate q d/2V of the difference quotients."""
MEASURED = {
    1.846: {"C_N_alpha": 11.80, "C_m_alpha": -27.45, "C_m_q": -370.0},
    2.969: {"C_N_alpha": 8.00, "C_m_alpha": -13.90, "C_m_q": -250.0},
}
"""Mach -> derivatives on pi d^2 / 4 and d, per rad and on q d/2V."""
BANDS = {"C_N_alpha": 0.08, "C_m_alpha": 0.12, "C_m_q": 0.25}
DAMPING_NOTE = "Measured with C_m_alphadot, which steady pitching does not have."


def run(fine: bool, progress: Progress) -> list[Record]:
    """Normal force, pitching moment and pitch damping of the Basic Finner at Mach 1.846 and 2.969.

    Args:
        fine: 16 wall cells per calibre on the body and 32 on the fins, instead of 10 and 20.
        progress: told what runs.
    """
    progress("Mach " + " and ".join(f"{mach:g}" for mach in MEASURED), 0.0)
    reference = reference_of(math.pi / 4.0, 1.0, (MOMENT_STATION, 0.0, 0.0))
    # Zero, incidence, pitch rate; the body is its own mirror image top to bottom, so that one side is enough.
    mach = np.repeat(list(MEASURED), 3)
    alpha = np.tile([0.0, STEP, 0.0], len(MEASURED))
    pitch = np.tile([0.0, 0.0, RATE], len(MEASURED))
    streams = FlowConditions(mach, alpha, np.zeros_like(alpha))
    streams = turning(streams, np.stack([0 * pitch, pitch, 0 * pitch], axis=1), reference)
    solution = solve_body(bodies.basic_finner(), mesh_settings(fine), streams, progress)
    values = integrate(solution, reference).sel(part="total")
    records = []
    for row, (number, measured) in enumerate(MEASURED.items()):
        zero, inclined, pitching = (values.isel(condition=3 * row + k) for k in range(3))
        computed = {
            "C_N_alpha": float(inclined.CN - zero.CN) / STEP,
            "C_m_alpha": float(inclined.Cm - zero.Cm) / STEP,
            "C_m_q": float(pitching.Cm - zero.Cm) / RATE,
        }
        good = all(solution.records[3 * row + k].good for k in range(3))
        records += [
            Record(
                case=CASE,
                quantity=name + (" (+ C_m_alphadot)" if name == "C_m_q" else ""),
                condition=f"Mach {number:g}",
                unit="1" if name == "C_m_q" else "1/rad",
                published=published,
                computed=computed[name] if good else None,
                band=BANDS[name],
                kind="relative",
                source=SOURCE,
                note=DAMPING_NOTE if name == "C_m_q" else "",
            )
            for name, published in measured.items()
        ]
    return records


def mesh_settings(fine: bool) -> MeshSettings:
    """Mesh of the case, see `run`."""
    return MeshSettings(wall_cell=1.0 / (16 if fine else 10), fine_parts=("fins",), far_field=1.0)
