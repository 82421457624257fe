"""Where a finer mesh helps the forces most: an error indicator from a solution, and the cells to split."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from spaceplane.flow.freestream import velocity
from spaceplane.flow.solution import Solution

SIZE_POWER = 2.0
"""Power of the cell size on the differences: an error in a face's flux acts on the face's area."""
DECAY = 0.5
"""Distance from the wall, in body lengths, at which an error counts half."""
DEAD_DECAY = 0.05
"""The same behind the body, downstream of what can reach it."""


def error_indicator(solution: Solution) -> np.ndarray:
    """[cell] share of the error in the forces that each cell is held to have, the largest over the conditions.

    Undivided differences of pressure (on the dynamic pressure) and velocity (on the flight speed) over a cell's faces,
    times the square of its size and a weight for what reaches the body. Each condition is scaled to a sum of 1, so that
    none starves; failed ones do not count. Differences times a power of the cell size keep shocks, where differences do
    not fall with the size, from taking every cell (Warren, Anderson, Thomas and Krist, AIAA 91-1592).

    Args:
        solution: on a mesh of `mesh.generate`.
    """
    mesh = solution.mesh
    distance, _ = cKDTree(mesh.wall_center[mesh.body_wall]).query(mesh.cell_center)
    largest = np.zeros(mesh.cells)
    for condition, record in enumerate(solution.records):
        if record.verdict == "failed":
            continue
        error = differences(solution, condition) * influence(solution, condition, distance)
        error *= mesh.cell_size**SIZE_POWER
        total = error.sum()
        if total > 0.0:
            largest = np.maximum(largest, error / total)
    return largest


def differences(solution: Solution, condition: int) -> np.ndarray:
    """[cell] largest difference to a neighbour, of pressure on q_inf or of velocity on the flight speed."""
    mesh, mach = solution.mesh, float(solution.conditions.mach[condition])
    state = solution.state[:, :, condition].astype(np.float64)
    a, b = mesh.face_cells.T
    pressure = np.abs(state[a, 4] - state[b, 4]) / (0.5 * mach**2)
    speed = np.linalg.norm(state[a, 1:4] - state[b, 1:4], axis=1) / mach
    jump = np.maximum(pressure, speed)
    found = np.zeros(mesh.cells)
    np.maximum.at(found, a, jump)
    np.maximum.at(found, b, jump)
    return found


def influence(solution: Solution, condition: int, distance: np.ndarray) -> np.ndarray:
    """[cell] weight from 0 to 1 of what happens in a cell for the forces on the body.

    It falls with the distance from the wall. Where the flow is supersonic, a disturbance leaves along Mach lines (of
    the local Mach number, at most the free stream's): those that pass behind the body's end weigh nothing.

    Args:
        distance: [cell] from the wall, m.
    """
    mesh, conditions = solution.mesh, solution.conditions
    mach = float(conditions.mach[condition])
    wind = velocity(conditions.mach, conditions.alpha, conditions.beta)[condition] / mach
    wall = mesh.wall_center[mesh.body_wall]
    length = float(np.ptp(wall, axis=0).max())
    rho, u, v, w, p = solution.state[:, :, condition].astype(np.float64).T
    square = (u * u + v * v + w * w) * rho / (conditions.gamma * p)
    slope = np.sqrt(np.clip(square - 1.0, 0.0, max(mach**2 - 1.0, 0.0)))
    arrival = mesh.cell_center @ wind + distance * slope
    beyond = np.maximum(arrival - (wall @ wind).max() - mesh.cell_size, 0.0)
    behind = np.where(square > 1.0, beyond <= 0.0, 1.0 / (1.0 + (beyond / (DEAD_DECAY * length)) ** 2))
    return behind / (1.0 + (distance / (DECAY * length)) ** 2)


def smallest_errors(error: np.ndarray, marked: np.ndarray) -> np.ndarray:
    """[cell] whether a cell may become part of one twice as large: its error is small beside those that are split.

    With differences that grow as the size and the indicator's power of it, eight cells joined have eight times the
    error of one. That stays below half of the smallest error that is split, so that no cell is joined now to be split
    next (equidistribution).

    Args:
        error: [cell] of `error_indicator`.
        marked: [cell] the cells to split; without any, none is joined.
    """
    if not marked.any():
        return np.zeros(len(error), bool)
    return error < error[marked].min() / (2.0 * 2.0 ** (1.0 + SIZE_POWER))


def largest_errors(error: np.ndarray, count: int) -> np.ndarray:
    """[cell] whether a cell is among the `count` with the largest error; cells without error never are."""
    marked = np.zeros(len(error), bool)
    marked[np.argsort(-error, kind="stable")[:count]] = True
    return marked & (error > 0.0)
