"""Seconds of geometry, mesh and solver on HORUS-2B."""

from __future__ import annotations

import dataclasses

from common import DEFLECTED, conditions, peak_memory, timed

from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.build import build
from spaceplane.vehicle.presets import horus_2b

WIDTHS = (3.0, 3.2, 3.3)


def measure(cells: int, count: int) -> dict[str, float]:
    """Seconds, memory and convergence of `count` conditions on about `cells` cells, compiled."""
    vehicle = horus_2b()
    warm_up = generate(build(vehicle.shape, DEFLECTED), MeshSettings(wall_cell=0.5))
    solve(warm_up, conditions(count), FlowSettings(iterations=5, coarse_iterations=5))

    # Parts are remembered between builds: every repeat has a new shape.
    shapes = iter(
        [dataclasses.replace(vehicle.shape, wing_width_m=width, nose_radius_m=0.01 + width / 4) for width in WIDTHS]
    )
    geometry, _ = timed(lambda: build(next(shapes), DEFLECTED), repeats=len(WIDTHS))
    surface = build(vehicle.shape, DEFLECTED)
    meshing, mesh = timed(lambda: generate(surface, MeshSettings(target_cells=cells)))
    solving, solution = timed(lambda: solve(mesh, conditions(count), FlowSettings()))
    iterations = sum(record.iterations for record in solution.records)
    return {
        "geometry_s": geometry,
        "mesh_s": meshing,
        "solver_s": solving,
        "total_s": geometry + meshing + solving,
        "cells": mesh.cells,
        "conditions": count,
        "converged": sum(record.good for record in solution.records),
        "least_decades": min(record.residual_drop for record in solution.records),
        "fine_iterations_mean": iterations / count,
        "ns_per_cell_and_condition_iteration": 1e9 * solving / (mesh.cells * iterations),
        "peak_memory_gb": peak_memory() / 1e9,
    }
