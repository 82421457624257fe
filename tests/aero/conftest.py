"""A box in given pressures: wall faces without a flow around them, on which everything is known by hand."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from spaceplane.flow.solution import ConvergenceRecord, FlowConditions, Solution
from spaceplane.mesh.mesh import Mesh

from .walls import wall_mesh

PARTS = ("fuselage", "wing_left", "wing_right")


@dataclass(frozen=True)
class Lengths:
    area: float = 8.0
    chord: float = 4.0
    span: float = 2.0
    moment_center: tuple[float, float, float] = (0.0, 0.0, 0.0)


def make_box_mesh(size=(4.0, 2.0, 1.0), cells=(8, 4, 3), parts=PARTS) -> Mesh:
    """Walls of a box centred on the origin; the part is told by y: wing_left y < -0.5, wing_right y > 0.5."""
    centers, areas = [], []
    for axis in range(3):
        others = [a for a in range(3) if a != axis]
        steps = [size[a] / cells[a] for a in others]
        lines = [(np.arange(cells[a]) + 0.5) * size[a] / cells[a] - size[a] / 2 for a in others]
        grid = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
        for sign in (-1.0, 1.0):
            center = np.zeros((len(grid), 3))
            center[:, others] = grid
            center[:, axis] = sign * size[axis] / 2
            area = np.zeros_like(center)
            area[:, axis] = -sign * steps[0] * steps[1]
            centers.append(center)
            areas.append(area)
    center, area = np.concatenate(centers), np.concatenate(areas)
    part = np.zeros(len(center), dtype=np.int32)
    if len(parts) == 3:
        part = np.select([center[:, 1] < -0.5, center[:, 1] > 0.5], [1, 2], 0).astype(np.int32)
    return replace(wall_mesh(center, area, np.zeros((0, 2)), part), part_names=parts)


def solve_by_hand(mesh, pressure_cp, mach=2.0, alpha=0.0, beta=0.0, verdicts=None, spread=0.0) -> Solution:
    """A solution whose wall Cp is `pressure_cp(center, mach, alpha, beta)`."""
    mach, alpha, beta = (np.atleast_1d(np.asarray(v, dtype=float)) for v in np.broadcast_arrays(mach, alpha, beta))
    cp = np.stack([pressure_cp(mesh.wall_center, *c) for c in zip(mach, alpha, beta, strict=True)], axis=1)
    pressure = 1.0 / 1.4 + cp * 0.5 * mach**2
    verdicts = verdicts or ["converged"] * len(mach)
    records = tuple(
        ConvergenceRecord(v, 3.0, 10, np.zeros(10), np.zeros((10, 3)), np.zeros(3), np.full(3, spread))
        for v in verdicts
    )
    state = np.ones((mesh.cells, 5, len(mach)))
    return Solution(mesh, FlowConditions(mach, alpha, beta), state, pressure, records)


@pytest.fixture
def box_mesh():
    return make_box_mesh


@pytest.fixture
def make_solution():
    return solve_by_hand


@pytest.fixture
def make_lengths():
    return Lengths


@pytest.fixture
def box() -> Mesh:
    return make_box_mesh()


@pytest.fixture
def lengths() -> Lengths:
    return Lengths()
