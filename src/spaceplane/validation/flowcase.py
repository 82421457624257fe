"""What every flow case does: mesh a body, solve its conditions, find its walls."""

from __future__ import annotations

import numpy as np

from spaceplane.flow.coarsen import Sequence, sequence
from spaceplane.flow.compilation import begin
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions, Solution
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings
from spaceplane.mesh.sizing import Sizing
from spaceplane.mesh.stretch import squeezed, stretched
from spaceplane.validation.cases import Progress
from spaceplane.vehicle.properties import ReferenceLengths
from spaceplane.vehicle.surface import Surface

ITERATIONS = 250
"""More patience than an analysis has: a validation case should not fail for want of iterations."""


def solve_body(
    surface: Surface,
    mesh: MeshSettings,
    conditions: FlowConditions,
    progress: Progress | None = None,
    done: float = 0.0,
    sizing: Sizing | None = None,
    stretch: float = 1.0,
) -> Solution:
    """Mesh the body and solve every condition; default flow settings but for the number of iterations allowed.

    Args:
        surface: closed surface, m.
        mesh: how to mesh.
        conditions: free streams.
        progress: told when kernels are compiled, which only a first run does.
        done: fraction of the case (0 to 1) that lies behind it.
        sizing: cells wanted smaller than `mesh` makes them.
        stretch: length of the cells along x on their other edges; `mesh` and `sizing` are of the body squeezed by it.
    """

    def say(phase: str, _done: int, _total: int, text: str) -> None:
        if progress and phase.startswith("compile"):
            progress(f"{phase}: {text}", done)

    settings = FlowSettings(iterations=ITERATIONS)
    begin(settings, conditions)
    if stretch == 1.0:
        return solve(generate(surface, mesh, say, sizing), conditions, settings, say)
    levels = sequence(generate(squeezed(surface, stretch), mesh, say, sizing), settings.coarse_levels)
    meshes = tuple(stretched(level, stretch) for level in levels.meshes)
    return solve(Sequence(meshes, levels.parents), conditions, settings, say)


def reference_of(
    area: float, length: float, moment_center: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> ReferenceLengths:
    """Reference lengths with one length for chord and span; area m2, length m, moment centre m."""
    return ReferenceLengths(area=area, chord=length, span=length, moment_center=moment_center)


def part_of_wall(mesh: Mesh, part: str) -> np.ndarray:
    """[wall] whether every piece of the wall face belongs to the part."""
    foreign = mesh.piece_part != mesh.part_names.index(part)
    whole = np.ones(len(mesh.wall_cell), bool)
    whole[mesh.piece_wall[foreign]] = False
    return whole
