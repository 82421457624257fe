"""Validation case: the ONERA M6 wing in transonic flow against Euler solutions on body-fitted grids."""

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

CASE = "m6"
SOURCE = "Euler solutions on body-fitted grids: C_L 0.281 to 0.283; SU2, test case euler/oneram6: 0.2817 and 0.0118"
MACH, ALPHA = 0.8395, math.radians(3.06)
LIFT, DRAG = 0.282, 0.0118
DRAG_NOTE = (
    "Drag is what the suction on the nose leaves of the pressure's axial force; cut cells resolve that nose with a few "
    "cells only, and the value falls with their size; shown, not judged."
)


def run(fine: bool, progress: Progress) -> list[Record]:
    """Lift and drag of the wing at Mach 0.8395, alpha 3.06 deg, on its trapezoidal planform.

    Args:
        fine: 95 wall cells on the root chord instead of 32.
        progress: told what runs.
    """
    progress("Mach 0.8395", 0.0)
    conditions = FlowConditions(np.array([MACH]), np.array([ALPHA]), np.zeros(1))
    solution = solve_body(bodies.m6(), mesh_settings(fine), conditions, progress)
    area = bodies.M6_ROOT_CHORD * (1.0 + bodies.M6_TAPER) * bodies.M6_SEMI_SPAN
    values = integrate(solution, reference_of(area, bodies.M6_ROOT_CHORD)).sel(part="total")
    good = solution.records[0].good
    rows = (("C_L", LIFT, values.CL, 0.02, True, ""), ("C_D", DRAG, values.CD, 0.10, False, DRAG_NOTE))
    return [
        Record(
            case=CASE,
            quantity=quantity,
            condition="Mach 0.8395, alpha 3.06 deg",
            unit="-",
            published=published,
            computed=value.item() if good else None,
            band=band,
            kind="relative",
            source=SOURCE,
            floor=0.001,
            gate=gate,
            note=note,
        )
        for quantity, published, value, band, gate, note in rows
    ]


def mesh_settings(fine: bool) -> MeshSettings:
    """Mesh of the case, see `run`."""
    return MeshSettings(wall_cell=0.0085 if fine else 0.025)
