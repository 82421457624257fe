"""Validation case: the sphere from Mach 0.5 to 10, and its stagnation region up to Mach 25."""

from __future__ import annotations

import math

import numpy as np

from spaceplane.aero.exact.blunt_sphere import sphere_flow
from spaceplane.aero.exact.stagnation import normal_shock_pressure, stagnation_cp
from spaceplane.aero.increments.add import integrate_with
from spaceplane.aero.increments.settings import IncrementSettings
from spaceplane.aero.integrate import integrate
from spaceplane.flow.solution import FlowConditions, Solution
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies, sphere_nose
from spaceplane.validation.blunt import DRAG_LOTH
from spaceplane.validation.cases import Progress
from spaceplane.validation.flowcase import part_of_wall, reference_of, solve_body
from spaceplane.validation.records import Record

CASE = "sphere"
MACHS = (0.5, 1.5, 2.0, 3.0, 5.0, 10.0)
WALL_LAYERS = 6
"""Layers of the finest cells: enough to hold the bow shock from Mach 2 up."""
RAYLEIGH = "Rayleigh's pitot formula (NACA 1135)"
LOTH = "Loth et al. (2021), Re 1e6"
FITTED = sphere_nose.FITTED
DRAG_NOTE = (
    "The pressure of the base is that of a separated, viscous wake: the published C_D is judged with the package's "
    "correlation of it on what looks aft by 30 deg and more; the row without is shown."
)
PARADOX = "d'Alembert's paradox"
PARADOX_NOTE = (
    "Mach 0.5: an inviscid attached flow has no drag (d'Alembert), so what remains is numerical error; the measured "
    "0.484 is viscous separation."
)


def run(fine: bool, progress: Progress) -> list[Record]:
    """Stagnation Cp, shock stand-off and drag of a sphere of radius 1 m.

    Args:
        fine: 48 wall cells per diameter instead of 24, and three meshes of the nose instead of one.
        progress: told what runs.
    """
    progress(f"Mach {', '.join(f'{mach:g}' for mach in MACHS)}", 0.0)
    zero = np.zeros(len(MACHS))
    conditions = FlowConditions(np.array(MACHS), zero, zero)
    solution = solve_body(bodies.sphere(), mesh_settings(fine), conditions, progress)
    return sphere_records(solution) + sphere_nose.run(CASE, fine, progress)


def mesh_settings(fine: bool) -> MeshSettings:
    """Mesh of the whole sphere, see `run`."""
    return MeshSettings(wall_cell=2.0 / (48 if fine else 24), wall_layers=WALL_LAYERS)


def sphere_records(solution: Solution) -> list[Record]:
    """Records of every condition of a solution past `bodies.sphere()`."""
    reference = reference_of(math.pi, 2.0)
    coefficients = integrate(solution, reference).sel(part="total")
    with_base = integrate_with(solution, reference, IncrementSettings(base="correlation")).sel(part="total")
    nose = _nose_cp(solution)
    records: list[Record] = []
    for index, mach in enumerate(solution.conditions.mach):
        values = coefficients.isel(condition=index)
        good = solution.records[index].good
        where = f"Mach {mach:g}"

        def row(quantity, published, computed, band, source, kind="relative", where=where, good=good, **more) -> Record:
            """A record of this condition; without a computed value where the flow did not converge."""
            return Record(
                case=CASE,
                quantity=quantity,
                condition=where,
                unit="-",
                published=published,
                computed=float(computed) if good else None,
                band=band,
                kind=kind,
                source=source,
                **more,
            )

        records.append(row("stagnation Cp", stagnation_cp(mach), nose[index], 0.03, RAYLEIGH))
        if mach > 1.0:
            found = standoff(solution, index) if good else None
            records += sphere_nose.standoff_rows(CASE, where, float(mach), found, (0.05, 0.1))
            exact = sphere_flow(float(mach), angles=20, last_angle=0.5 * math.pi).front_drag()
            front, base = float(values.CA_forebody), float(values.CA_base)
            share = f"{where}: inviscid C_D {front:.3f} of the front half and {base:.3f} of the back."
            drag = DRAG_LOTH[float(mach)]
            records.append(row("C_D of the front half", exact, front, 0.02, FITTED))
            based = float(with_base.isel(condition=index).CD)
            records.append(row("C_D, base by correlation", drag, based, 0.1, LOTH, note=DRAG_NOTE))
            records.append(row("C_D, inviscid", drag, values.CD, 0.1, LOTH, gate=False, note=share))
        else:
            records.append(row("C_D", 0.0, values.CD, 0.02, PARADOX, kind="absolute", note=PARADOX_NOTE))
    return records


def standoff(solution: Solution, condition: int) -> float:
    """Distance from the nose to the bow shock over the radius of a sphere of radius 1 m about (1, 0, 0).

    The shock is where the pressure on the stagnation line crosses the mean of its values ahead of and behind a normal
    shock, interpolated linearly between cell centres.
    """
    center, mesh = solution.mesh.cell_center, solution.mesh
    near = (np.hypot(center[:, 1], center[:, 2]) < 1.01 * mesh.cell_size) & (center[:, 0] < 0.0)
    x, first = np.unique(np.round(center[near, 0], 9), return_inverse=True)
    pressure = solution.state[near, 4, condition].astype(float)
    pressure = np.bincount(first, pressure) / np.bincount(first)
    gamma = solution.conditions.gamma
    middle = 0.5 * (1.0 + normal_shock_pressure(float(solution.conditions.mach[condition]), gamma)) / gamma
    above = np.flatnonzero(pressure > middle)
    if not len(above) or above[0] == 0:
        return math.nan
    k = above[0]
    crossing = x[k - 1] + (x[k] - x[k - 1]) * (middle - pressure[k - 1]) / (pressure[k] - pressure[k - 1])
    return float(-crossing)


def _nose_cp(solution: Solution) -> np.ndarray:
    """[condition] mean Cp of the four wall faces nearest to the stagnation point."""
    center = solution.mesh.wall_center
    distance = np.hypot(center[:, 1], center[:, 2]) + 1e6 * ~part_of_wall(solution.mesh, "forebody")
    return solution.wall_cp()[np.argsort(distance)[:4]].mean(axis=0)
