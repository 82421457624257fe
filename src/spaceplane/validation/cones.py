"""Validation case: pointed cones at zero and small incidence against the exact conical solution."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import xarray as xr

from spaceplane.aero.exact.conical import CN_ALPHA_STONE, center_of_pressure, taylor_maccoll
from spaceplane.aero.integrate import integrate
from spaceplane.flow.solution import FlowConditions, Solution
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies
from spaceplane.validation.cases import Progress
from spaceplane.validation.flowcase import part_of_wall, reference_of, solve_body
from spaceplane.validation.records import Record

CASE = "cones"
MACHS = (1.5, 3.0, 10.0)
HALF_ANGLES_DEG = (10.0, 20.0, 30.0)
STEP = math.radians(1.0)
FEWEST_LAYERS, MOST_LAYERS, GROWTH_LAYERS = 6, 10, 4
"""Layers of the finest cells, which should hold half of the shock layer: where it leaves them C_N_alpha falls by 0.8 %
(20 deg, Mach 3, 60 cells along). Layers of each coarser size: a single one where the finest hold half of it anyway."""
TAIL = 0.05
"""Length by which the cone goes on behind the metre that is measured, m: the exact cone has no base, and the cell that
holds the rim of one has a pressure between those of cone and base."""
EXACT = "Taylor and Maccoll (1933), solved here"
STONE = "Stone (1948), as tabulated by Kopal (1947) and Sims (1964)"
SUBSONIC_NOTE = (
    "Mach 1.5, half angle 30 deg: the flow on the cone is subsonic (surface Mach number 0.81), so the base of a finite "
    "cone acts upstream and the flow is not conical; the exact value belongs to an infinite cone. Shown, not judged."
)
EXTRAPOLATED = ", extrapolated"
EXTRAPOLATED_NOTE = (
    "Extrapolated: twice the value on the mesh less that on one of doubled cells, as an error of first order in the "
    "cell, which that of a captured shock is, would have it. Shown, not judged."
)
BANDS = {"surface Cp": 0.01, "C_N_alpha": 0.01, "C_m_alpha": 0.025, "C_Y_beta": 0.01, "C_n_beta": 0.025}
"""Relative bands; those of the moments hold the force's 1 % and a hundredth of the length in its place."""


def run(fine: bool, progress: Progress) -> list[Record]:
    """Surface Cp, C_N_alpha, C_m_alpha and their lateral twins on nine cones.

    Args:
        fine: 80 wall cells along the cone and 8 across the layer between cone and shock, and the values extrapolated
            from a mesh of doubled cells too; else 30 and 4.
        progress: told what runs.
    """
    # One mesh for the Mach numbers that ask for the same cell: at Mach 10 the shock lies close to the wall.
    meshes: dict[tuple[float, float], list[float]] = {}
    for angle_deg in HALF_ANGLES_DEG:
        for mach in MACHS:
            meshes.setdefault((angle_deg, wall_cell(mach, math.radians(angle_deg), fine)), []).append(mach)
    records = []
    for index, ((angle_deg, cell), machs) in enumerate(meshes.items()):
        done = index / len(meshes)
        progress(f"half angle {angle_deg:g} deg, Mach {', '.join(f'{m:g}' for m in machs)}", done)
        records += cone_records(math.radians(angle_deg), tuple(machs), cell, fine, progress, done)
    return records


def wall_cell(mach: float, half_angle: float, fine: bool) -> float:
    """Wall cell, m, of a cone of 1 m and `half_angle` rad: a share of its length or of the shock layer at the base."""
    along, across = (80, 8) if fine else (30, 4)
    return min(1.0 / along, layer(mach, half_angle) / across)


def layer(mach: float, half_angle: float) -> float:
    """Thickness of the air between a cone of `half_angle` rad and its shock, one metre behind the apex, m."""
    return math.tan(taylor_maccoll(mach, half_angle).shock_angle) - math.tan(half_angle)


def cone_records(
    half_angle: float,
    machs: tuple[float, ...],
    cell: float,
    extrapolate: bool = False,
    progress: Progress | None = None,
    done: float = 0.0,
) -> list[Record]:
    """Records of one cone at each Mach number, measured over its first metre.

    Args:
        half_angle: of the cone, rad.
        machs: Mach numbers.
        cell: wall cell, m.
        extrapolate: whether to solve on doubled cells as well and to add extrapolated values.
        progress, done: see `flowcase.solve_body`.
    """
    values = measured(half_angle, machs, cell, False, progress, done)
    coarse = measured(half_angle, machs, cell, True, progress, done) if extrapolate else [{} for _ in machs]
    records = []
    for mach, own, wide in zip(machs, values, coarse, strict=True):
        records += _of_one(mach, half_angle, own)
        better = {name: 2.0 * own[name] - wide[name] for name in own if name in wide}
        if extrapolate:
            records += _of_one(mach, half_angle, better, ("surface Cp", "C_N_alpha"), EXTRAPOLATED)
    return records


def mesh_settings(half_angle: float, machs: tuple[float, ...], cell: float, doubled: bool = False) -> MeshSettings:
    """Mesh for these Mach numbers; `doubled` has cells of twice the size everywhere, by half as many layers of each."""
    half_thickness = 0.5 * max(layer(mach, half_angle) for mach in machs) / cell
    layers = min(max(math.ceil(half_thickness), FEWEST_LAYERS), MOST_LAYERS)
    growth = 1 if half_thickness < FEWEST_LAYERS else GROWTH_LAYERS
    factor = 2 if doubled else 1
    # The base and what lies behind it have cells of twice the size: nothing of them is measured.
    return MeshSettings(
        wall_cell=2.0 * factor * cell,
        fine_parts=("forebody",),
        wall_layers=layers // factor,
        growth_layers=max(growth // factor, 1),
        far_field=1.0,
    )


def measured(
    half_angle: float,
    machs: tuple[float, ...],
    cell: float,
    doubled: bool = False,
    progress: Progress | None = None,
    done: float = 0.0,
) -> list[dict[str, float]]:
    """Surface Cp and derivatives per rad on one mesh, by Mach number; those of unconverged conditions are left out."""
    surface = bodies.cone(half_angle, tail=TAIL)
    mach = np.repeat(machs, 3)
    alpha, beta = np.tile([0.0, STEP, 0.0], len(machs)), np.tile([0.0, 0.0, STEP], len(machs))
    settings = mesh_settings(half_angle, machs, cell, doubled)
    solution = solve_body(surface, settings, FlowConditions(mach, alpha, beta), progress, done)
    area = math.pi * math.tan(half_angle) ** 2
    coefficients = integrate(solution, reference_of(area, 1.0)).sel(part="forebody")
    cp = surface_cp(solution)
    found = []
    for row in range(len(machs)):
        zero, pitch, yaw = (coefficients.isel(condition=3 * row + k) for k in range(3))
        slopes = {
            "C_N_alpha": float(pitch.CN - zero.CN) / STEP,
            "C_m_alpha": float(pitch.Cm - zero.Cm) / STEP,
            "C_Y_beta": _side_force(yaw) / STEP,
            "C_n_beta": float(yaw.Cn - zero.Cn) / STEP,
        }
        good = [solution.records[3 * row + k].good for k in range(3)]
        found.append(({"surface Cp": float(cp[3 * row])} if good[0] else {}) | (slopes if all(good) else {}))
    return found


def surface_cp(solution: Solution, window: tuple[float, float] = (0.4, 0.9)) -> np.ndarray:
    """[condition] area-weighted mean Cp on the forebody between two stations, m from the apex of a cone of 1 m."""
    wall_x = solution.mesh.wall_center[:, 0]
    chosen = part_of_wall(solution.mesh, "forebody") & (wall_x > window[0]) & (wall_x < window[1])
    weight = np.linalg.norm(solution.mesh.wall_area[chosen], axis=1)
    return np.average(solution.wall_cp()[chosen], axis=0, weights=weight)


def _of_one(
    mach: float, half_angle: float, computed: dict[str, float], names: Sequence[str] = tuple(BANDS), kind: str = ""
) -> list[Record]:
    """Rows of the quantities `names` at one Mach number; those of a `kind` of value, as EXTRAPOLATED, not judged."""
    angle_deg = math.degrees(half_angle)
    exact = taylor_maccoll(mach, half_angle)
    slope = CN_ALPHA_STONE[mach, round(angle_deg, 6)]
    moment = -slope * center_of_pressure(half_angle)
    supersonic = exact.surface_mach > 1.0
    published = {"C_N_alpha": slope, "C_m_alpha": moment, "C_Y_beta": -slope, "C_n_beta": -moment}
    published["surface Cp"] = exact.surface_cp
    return [
        Record(
            case=CASE,
            quantity=name + kind,
            condition=f"Mach {mach:g}, half angle {angle_deg:g} deg",
            unit="-" if name == "surface Cp" else "1/rad",
            published=published[name],
            computed=computed.get(name),
            band=BANDS[name],
            kind="relative",
            source=EXACT if name == "surface Cp" else STONE,
            gate=supersonic and not kind,
            note=EXTRAPOLATED_NOTE if kind else "" if supersonic else SUBSONIC_NOTE,
        )
        for name in names
    ]


def _side_force(values: xr.Dataset) -> float:
    """Side force along the body's y axis; `CY` lies across the wind, turned by the sideslip."""
    return float((values.CY - values.CA * math.sin(STEP)) / math.cos(STEP))
