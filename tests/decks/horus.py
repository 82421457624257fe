"""The published HORUS-2B tables with made-up lateral, damping and rudder tables, so that every term counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spaceplane.aero.model.model import AeroModel, SurfaceTable
from spaceplane.aero.model.published import horus_2b_published

SLOPES = {
    "CY_beta": -0.9,
    "Cl_beta": -0.08,
    "Cn_beta": 0.05,
    "CL_q": 0.9,
    "Cm_q": -1.8,
    "CY_p": 0.1,
    "Cl_p": -0.3,
    "Cn_p": 0.04,
    "CY_r": 0.2,
    "Cl_r": 0.07,
    "Cn_r": -0.4,
}
RUDDER_LEFT = {"CD": 0.02, "CY": -0.05, "Cl": -0.01, "Cn": 0.03}


def complete() -> AeroModel:
    """Every slope and surface; the made-up tables vary from node to node, so that swapped axes would show."""
    published = horus_2b_published()
    shape = (len(published.alpha), len(published.mach))
    random = np.random.default_rng(1)

    def varied(value: float) -> np.ndarray:
        return value * random.uniform(0.7, 1.3, shape)

    deflection = np.radians([0.0, 20.0, 40.0])
    growth = np.array([0.0, 0.4, 1.0])[:, None, None]
    left = {name: growth * varied(value) for name, value in RUDDER_LEFT.items()}
    right = {name: table * (1.0 if name == "CD" else -1.0) for name, table in left.items()}
    rolling = {"elevon_left": 0.02, "elevon_right": -0.02}
    elevons = {}
    for name, value in rolling.items():
        elevon = published.surfaces[name]
        roll = elevon.deflection[:, None, None] * varied(value)
        elevons[name] = SurfaceTable(elevon.deflection, {**elevon.increments, "Cl": roll})
    rudders = {"rudder_left": SurfaceTable(deflection, left), "rudder_right": SurfaceTable(deflection, right)}
    return replace(
        published,
        name="HORUS-2B, completed",
        surfaces={**published.surfaces, **elevons, **rudders},
        slopes={name: varied(value) for name, value in SLOPES.items()},
    )
