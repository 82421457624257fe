"""Flow on a mesh that follows it: solve, split the cells where that helps most, solve again."""

from __future__ import annotations

import math
from dataclasses import replace

from spaceplane.errors import InputError
from spaceplane.flow.adaptation import error_indicator, largest_errors
from spaceplane.flow.compilation import begin
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions, Solution
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings, check_passes
from spaceplane.mesh.sizing import split
from spaceplane.progress import Progress, silent
from spaceplane.vehicle.surface import Surface

GROWTH, LARGEST_GROWTH = 2.5, 10.0
"""Cells of each mesh on those of the one before, and at most of the last on the first."""
LEAST_CELLS = 8000
"""Cells that the first mesh has at least, where the target has twice as many: a coarser one sees too little."""
TRIES, CLOSE = 5, 0.07
"""Meshes tried to meet a number of cells, and how close to it, in its logarithm, will do."""


def solve_adapted(
    surface: Surface,
    mesh_settings: MeshSettings,
    conditions: FlowConditions,
    flow_settings: FlowSettings | None = None,
    passes: int = 2,
    progress: Progress | None = None,
) -> Solution:
    """Solve on a coarse mesh, split the cells with the largest errors, and again; all conditions share each mesh.

    The first mesh has one layer of cells of each size and no finer edges; what more the flow needs, the passes add. The
    numbers of cells form a geometric sequence up to the target.

    Args:
        surface: closed surface, m.
        mesh_settings: `target_cells` is the number of cells of the last mesh; the wall cell follows from it.
        conditions: free streams.
        flow_settings: numerics; the solutions before the last need not converge as far.
        passes: how many times cells are split, each at most once; 0 solves on the mesh of the settings.
        progress: called with (phase, done, total, text).

    Returns:
        The last solution. Its statistics tell the cells of every mesh under "adaptation", and the seconds of all.

    Raises:
        InputError: as `generate` and `solve`, or passes that are not allowed.
    """
    if check_passes("adapt", passes) and mesh_settings.target_cells is None:
        raise InputError(f"adapt: {passes}, needs target_cells, the number of cells of the last mesh")
    settings, say = flow_settings or FlowSettings(), progress or silent
    begin(settings, conditions)
    if not passes:
        say("mesh", 0, 1, "")
        return solve(generate(surface, mesh_settings, progress), conditions, settings, progress)
    budget = mesh_settings.target_cells
    start = min(GROWTH**passes, LARGEST_GROWTH, max(budget / LEAST_CELLS, 2.0))
    loose = replace(
        mesh_settings, wall_layers=1, growth_layers=1, edge_levels=0, target_cells=max(1000, round(budget / start))
    )
    say("mesh", 0, 1, "")
    mesh = generate(surface, loose, progress)
    fixed = replace(loose, target_cells=None, wall_cell=mesh.record["wall_cell_m"])
    rough = replace(
        settings,
        residual_drop=min(settings.residual_drop, 2.0),
        force_tolerance=max(settings.force_tolerance, 2e-3),
    )
    cells, seconds = [mesh.cells], 0.0
    for number in range(1, passes + 1):
        phase = f"adapt {number}/{passes}"
        solution = solve(mesh, conditions, rough, _under(say, phase))
        seconds += solution.statistics["seconds"]
        say(f"{phase}: mesh", 0, 1, "")
        mesh = refined_mesh(surface, fixed, solution, budget / start ** (1.0 - number / passes), progress)
        cells.append(mesh.cells)
    if abs(mesh.cells - budget) > 0.15 * budget:
        mesh.record["warnings"].append(f"target_cells: {budget} asked, {mesh.cells} reached in {passes} passes")
    solution = solve(mesh, conditions, settings, progress)
    seconds += solution.statistics["seconds"]
    return replace(solution, statistics={**solution.statistics, "seconds": seconds, "adaptation": cells})


def refined_mesh(
    surface: Surface, settings: MeshSettings, solution: Solution, target: float, progress: Progress | None = None
) -> Mesh:
    """A mesh of about `target` cells: that of the solution with the cells of the largest errors split.

    Args:
        surface, settings: of the solution's mesh.
    """
    old, error = solution.mesh, error_indicator(solution)
    per_split, best = 6.0, old
    for _ in range(TRIES):
        count = max(1, min(round((target - old.cells) / per_split), old.cells))
        mesh = generate(surface, settings, progress, split(old, largest_errors(error, count)))
        if best is old or abs(math.log(mesh.cells / target)) < abs(math.log(best.cells / target)):
            best = mesh
        if abs(math.log(mesh.cells / target)) < CLOSE or count == old.cells:
            break
        per_split = max((mesh.cells - old.cells) / count, 0.5)
    return best


def _under(say: Progress, name: str) -> Progress:
    """Tell phases with `name` before them."""
    return lambda phase, done, total, text: say(f"{name}: {phase}", done, total, text)
