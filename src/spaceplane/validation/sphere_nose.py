"""The stagnation region of the sphere at Mach 5 to 25 on nested meshes: stagnation pressure and shock stand-off."""

from __future__ import annotations

import math

import numpy as np

from spaceplane.aero.exact.blunt_sphere import sphere_flow
from spaceplane.aero.exact.stagnation import normal_shock_pressure, stagnation_cp
from spaceplane.flow.solution import FlowConditions, Solution
from spaceplane.mesh.settings import MeshSettings
from spaceplane.mesh.sizing import Sizing
from spaceplane.validation import bodies
from spaceplane.validation.blunt import standoff_billig
from spaceplane.validation.cases import Progress
from spaceplane.validation.flowcase import part_of_wall, solve_body
from spaceplane.validation.records import Record

MACHS = (5.0, 10.0, 25.0)
CELLS = (1.0 / 48.0, 1.0 / 68.0, 1.0 / 88.0)
"""Cells at the nose, radii: about six, nine and twelve between shock and wall."""
NOSE, SONIC = math.radians(20.0), math.radians(60.0)
"""Angles from the nose within which the shock layer has such cells, and cells twice as large: to beyond the sonic line,
behind which nothing acts on the nose. The rest of the sphere has cells four times as large."""
DOMAIN = ((-1.0, -2.5, -2.5), (3.0, 2.5, 2.5))
RAYLEIGH = "Rayleigh's pitot formula (NACA 1135)"
FITTED = "Perfect gas with fitted shock, solved here"
BILLIG = "Billig (1967)"


def run(case: str, fine: bool, progress: Progress) -> list[Record]:
    """Records of every mesh and Mach number.

    Args:
        case: name of the validation case they belong to.
        fine: all three meshes, else the coarsest.
        progress: told what runs.
    """
    records: list[Record] = []
    zero = np.zeros(len(MACHS))
    for cell in CELLS if fine else CELLS[:1]:
        progress(f"nose with cells of 1/{1 / cell:g} radius", 0.5)
        settings = MeshSettings(wall_cell=4.0 * cell, growth_layers=1, domain=DOMAIN)
        conditions = FlowConditions(np.array(MACHS), zero, zero)
        solution = solve_body(
            bodies.sphere(segments=192), settings, conditions, progress, 0.5, sizing=shock_layer(cell)
        )
        for index, mach in enumerate(MACHS):
            records += _rows(case, solution, index, mach, cell)
    return records


def shock_layer(cell: float) -> Sizing:
    """`cell`, m, from wall to shock ahead of a sphere of radius 1 m about (1, 0, 0), and twice that further out."""
    points, sizes = [], []
    for size, angle in ((cell, NOSE), (2.0 * cell, SONIC)):
        x, y = np.arange(-0.5, 1.0, size), np.arange(-1.4, 1.4, size)
        lattice = np.stack(np.meshgrid(x, y, y, indexing="ij"), axis=-1).reshape(-1, 3)
        radius = np.linalg.norm(lattice - [1.0, 0.0, 0.0], axis=1)
        cosine = (1.0 - lattice[:, 0]) / radius
        layer = (radius > 1.0 - size) & (radius < 1.2 + 0.35 * (1.0 - cosine)) & (cosine > math.cos(angle))
        points.append(lattice[layer])
        sizes.append(np.full(int(layer.sum()), size))
    return Sizing(np.concatenate(points), np.concatenate(sizes))


def standoff_rows(
    case: str, where: str, mach: float, computed: float | None, bands: tuple[float, float]
) -> list[Record]:
    """Records of a shock stand-off over the radius: beside the exact flow of a perfect gas, and beside Billig's fit.

    Billig's row is judged where the exact flow itself lies in its band.

    Args:
        case, where: of the records.
        mach: free-stream Mach number.
        computed: stand-off over the radius; None where the flow did not converge.
        bands: relative bands of the two rows.
    """
    exact, billig = sphere_flow(mach).standoff, standoff_billig(mach)
    off = exact / billig - 1.0
    judged = abs(off) <= bands[1]
    note = f"Mach {mach:g}: the exact flow of a perfect gas lies {100.0 * off:+.1f} % from Billig's fit to experiments"
    note += "." if judged else ", outside the band: his row is shown, not judged."
    name = "shock stand-off / radius"
    return [
        Record(case, name, where, "-", exact, computed, bands[0], "relative", FITTED),
        Record(
            case,
            f"{name}, beside Billig's fit",
            where,
            "-",
            billig,
            computed,
            bands[1],
            "relative",
            BILLIG,
            gate=judged,
            note=note,
        ),
    ]


def _rows(case: str, solution: Solution, index: int, mach: float, cell: float) -> list[Record]:
    where = f"Mach {mach:g}, cells of 1/{1 / cell:g} radius"
    good = solution.records[index].good
    cp = nose_cp(solution, index) if good else None
    return [
        Record(case, "stagnation Cp", where, "-", stagnation_cp(mach), cp, 0.02, "relative", RAYLEIGH),
        *standoff_rows(case, where, mach, standoff(solution, index) if good else None, (0.05, 0.05)),
    ]


def nose_cp(solution: Solution, condition: int) -> float:
    """Cp at the stagnation point: a parabola in the distance from the axis through the wall within `NOSE` of it.

    Single faces scatter by where in a cell the shock ahead of them stands; on the exact flow the parabola ends 0.05 %
    off.
    """
    mesh = solution.mesh
    radius = np.hypot(mesh.wall_center[:, 1], mesh.wall_center[:, 2])
    near = part_of_wall(mesh, "forebody") & (radius < math.sin(NOSE))
    powers = np.stack([np.ones(int(near.sum())), radius[near] ** 2], axis=1)
    return float(np.linalg.lstsq(powers, solution.wall_cp()[near, condition].astype(float), rcond=None)[0][0])


def standoff(solution: Solution, condition: int) -> float:
    """Distance from the nose to the bow shock over the radius of a sphere of radius 1 m about (1, 0, 0).

    A captured shock is smeared over two or three cells. It stands where a jump to the pressure behind a normal shock,
    then a straight line to the pressure two cells further on, hold the same integral of pressure along the axis.
    """
    mesh, gamma = solution.mesh, solution.conditions.gamma
    center = mesh.cell_center
    near = (np.hypot(center[:, 1], center[:, 2]) < 1.01 * mesh.cell_size) & (center[:, 0] < 0.0)
    x, first = np.unique(np.round(center[near, 0], 9), return_inverse=True)
    pressure = np.bincount(first, solution.state[near, 4, condition].astype(float)) / np.bincount(first)
    ahead = 1.0 / gamma
    behind = ahead * normal_shock_pressure(float(solution.conditions.mach[condition]), gamma)
    above = np.flatnonzero(pressure > 0.5 * (ahead + behind))
    if not len(above) or above[0] == 0 or above[0] + 1 >= len(x):
        return math.nan
    last = min(above[0] + 2, len(x) - 1)
    integral = float(np.trapezoid(pressure[: last + 1], x[: last + 1]))
    level = 0.5 * (behind + pressure[last])
    return float((integral + ahead * x[0] - level * x[last]) / (level - ahead))
