"""Flow on a mesh that follows it: solve, split the cells where that helps most, join those where it does not matter."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from spaceplane.errors import InputError
from spaceplane.flow.adaptation import error_indicator, largest_errors, smallest_errors
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
PER_SPLIT = 6.0
"""Cells that splitting one adds at first guess: seven, less what joining others takes away."""


@dataclass(frozen=True)
class Adapted:
    """A mesh that follows the flow.

    Attributes:
        mesh: the last mesh, not solved on yet.
        settings: that it was made with, beside the sizes of its cells.
        solution: on the mesh before.
        cells: of every mesh, the last included.
        seconds: wall time of the flow so far, s.
        missed: a warning where the number of cells is not what was asked for.
    """

    mesh: Mesh
    settings: MeshSettings
    solution: Solution
    cells: tuple[int, ...]
    seconds: float
    missed: tuple[str, ...] = ()


def solve_adapted(
    surface: Surface,
    mesh_settings: MeshSettings,
    conditions: FlowConditions,
    flow_settings: FlowSettings | None = None,
    passes: int = 2,
    progress: Progress | None = None,
) -> Solution:
    """Solve on a coarse mesh, adapt it to the flow, and again; all conditions share each mesh, see `adapt_mesh`.

    Args:
        surface: closed surface, m.
        mesh_settings: `target_cells` is the number of cells of the last mesh; the wall cell follows from it.
        conditions: free streams.
        flow_settings: numerics; the solutions before the last need not converge as far.
        passes: how many times the mesh is adapted; 0 solves on the mesh of the settings.
        progress: called with (phase, done, total, text).

    Returns:
        The last solution. Its statistics tell the cells of every mesh under "adaptation", and the seconds of all.

    Raises:
        InputError: as `generate` and `solve`, or passes that are not allowed.
    """
    settings, say = flow_settings or FlowSettings(), progress or silent
    begin(settings, conditions)
    if not check_passes("adapt", passes):
        say("mesh", 0, 1, "")
        return solve(generate(surface, mesh_settings, progress), conditions, settings, progress)
    return solve_last(
        adapt_mesh(surface, mesh_settings, conditions, settings, passes, progress), conditions, settings, progress
    )


def solve_last(
    adapted: Adapted, conditions: FlowConditions, settings: FlowSettings, progress: Progress | None = None
) -> Solution:
    """The flow on the last mesh; its statistics tell the cells of every mesh under "adaptation", and all seconds.

    It begins on coarse levels as ever: from the solution on the mesh before, forces settle no sooner.

    Args:
        adapted: of `adapt_mesh`.
        conditions: free streams, those that the mesh follows or others near to them.
        settings: numerics.
        progress: called with (phase, done, total, text).
    """
    solution = solve(adapted.mesh, conditions, settings, progress)
    seconds = adapted.seconds + solution.statistics["seconds"]
    return replace(solution, statistics={**solution.statistics, "seconds": seconds, "adaptation": list(adapted.cells)})


def adapt_mesh(
    surface: Surface,
    mesh_settings: MeshSettings,
    conditions: FlowConditions,
    settings: FlowSettings,
    passes: int,
    progress: Progress | None = None,
) -> Adapted:
    """Solve on a coarse mesh, split the cells with the largest errors, join those with the smallest, and again.

    The first mesh has one layer of cells of each size and no finer edges; what more the flow needs, the passes add. The
    numbers of cells form a geometric sequence up to the target.

    Args:
        surface, mesh_settings, conditions, settings, progress: as for `solve_adapted`.
        passes: at least 1.

    Raises:
        InputError: as `solve_adapted`.
    """
    if mesh_settings.target_cells is None:
        raise InputError(f"adapt: {passes}, needs target_cells, the number of cells of the last mesh")
    say, budget = progress or silent, mesh_settings.target_cells
    growth = min(GROWTH**passes, LARGEST_GROWTH, max(budget / LEAST_CELLS, 2.0))
    loose = replace(follower(mesh_settings), target_cells=max(1000, round(budget / growth)))
    say("mesh", 0, 1, "")
    mesh = generate(surface, loose, progress)
    fixed = follower(loose, mesh.record["wall_cell_m"])
    rough = replace(
        settings,
        residual_drop=min(settings.residual_drop, 2.0),
        force_tolerance=max(settings.force_tolerance, 2e-3),
    )
    cells, seconds, missed = [mesh.cells], 0.0, ()
    for number in range(1, passes + 1):
        phase = f"adapt {number}/{passes}"
        solution = solve(mesh, conditions, rough, _under(say, phase))
        seconds += solution.statistics["seconds"]
        say(f"{phase}: mesh", 0, 1, "")
        mesh = refined_mesh(surface, fixed, solution, budget / growth ** (1.0 - number / passes), progress)
        cells.append(mesh.cells)
    if abs(mesh.cells - budget) > 0.15 * budget:
        missed = (f"target_cells: {budget} asked, {mesh.cells} reached in {passes} passes",)
        mesh.record["warnings"] += missed
    return Adapted(mesh, fixed, solution, tuple(cells), seconds, missed)


def follower(settings: MeshSettings, wall_cell: float | None = None) -> MeshSettings:
    """Settings of meshes that follow the flow: one layer of cells of each size and no finer edges.

    Args:
        settings: the user's.
        wall_cell: that the first mesh was made with, m; None leaves it and the target to the settings.
    """
    bare = replace(settings, wall_layers=1, growth_layers=1, fine_edges=False, edge_levels=0, edge_cells=0.0)
    return bare if wall_cell is None else replace(bare, target_cells=None, wall_cell=wall_cell)


def refined_mesh(
    surface: Surface, settings: MeshSettings, solution: Solution, target: float, progress: Progress | None = None
) -> Mesh:
    """A mesh of about `target` cells: that of the solution with the cells of the largest errors split.

    Cells whose error, eightfold when eight become one, stays well below that of those split are joined, as far as the
    settings' own mesh is coarser than the solution's.

    Args:
        surface, settings: of the solution's mesh.
    """
    old, error = solution.mesh, error_indicator(solution)
    count, best, last = max(1, round((target - old.cells) / PER_SPLIT)), old, (0, old.cells)
    for _ in range(TRIES):
        count = max(1, min(count, old.cells))
        marked = largest_errors(error, count)
        mesh = generate(surface, settings, progress, split(old, marked, smallest_errors(error, marked)))
        if best is old or abs(math.log(mesh.cells / target)) < abs(math.log(best.cells / target)):
            best = mesh
        if abs(math.log(mesh.cells / target)) < CLOSE or (count == old.cells and mesh.cells < target):
            break
        gained = (mesh.cells - last[1]) / (count - last[0]) if count != last[0] else PER_SPLIT
        last = (count, mesh.cells)
        count += round((target - mesh.cells) / max(gained, 0.5))
    return best


def _under(say: Progress, name: str) -> Progress:
    """Tell phases with `name` before them."""
    return lambda phase, done, total, text: say(f"{name}: {phase}", done, total, text)
