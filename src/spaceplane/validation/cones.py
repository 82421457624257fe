"""Validation case: pointed cones at zero and small incidence against the exact conical solution."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr

from spaceplane.aero.exact.conical import center_of_pressure, taylor_maccoll
from spaceplane.aero.exact.inclined_cone import normal_force_slope
from spaceplane.aero.integrate import integrate
from spaceplane.flow.solution import FlowConditions, Solution
from spaceplane.mesh.frustum import RefinementFrustum
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies
from spaceplane.validation.cases import Progress
from spaceplane.validation.flowcase import part_of_wall, reference_of, solve_body
from spaceplane.validation.records import Record

CASE = "cones"
MACHS = (1.5, 3.0, 10.0)
HALF_ANGLES_DEG = (10.0, 20.0, 30.0)
STEP = math.radians(1.0)
LAYERS, NEAR_LAYERS = (10, 4), (6, 1)
"""Layers of the finest cells at the wall and of each coarser size, where the shock has no cells of its own: they should
hold half of the air between cone and shock, for where they leave it C_N_alpha falls by 0.8 % (20 deg, Mach 3, 60 cells
along). The second where cells are so small because the shock is near."""
THIN, FAR = 0.15, 0.3
"""Thickness of the air between cone and shock a metre behind the apex, m: up to the first, at Mach 10, cells are
stretched along x; up to the second, at Mach 3 as well, the shock has cells of its own."""
INSIDE, OUTSIDE, MOVING_OUTSIDE = 5.0, 2.0, 4.0
"""Reach of those cells from the exact shock, in their own edges. A captured shock takes two on either side. The last is
for Mach 3: there the shock moves at incidence (`shock_tilt`), by 0.6 cells at 20 deg and 1.1 at 10 deg, and where but
two are outside its foot enters coarser cells on the lee side: C_N_alpha then stays 1.3 % low at 20 deg, the more cells
there are the more of them the shock moves. At Mach 10, where 1 deg moves it by 0.1 to 0.8 cells, two do as well."""
ACROSS, MOST_AT_SHOCK = 20, 450_000
"""Cells at the shock to the thickness of the air behind it, and how many of them there may be."""
SLANT, LONGEST = 0.9, 1.0 / 40
"""Where the air is thin, cells are stretched along x: the tangent of the shock's angle to them comes near the one, and
a wall cell's length, m, stays below the other."""
TAIL = 0.05
"""Length by which the cone goes on behind the metre that is measured, m: the exact cone has no base, and the cell that
holds the rim of one has a pressure between those of cone and base."""
EXACT = "Taylor and Maccoll (1933), solved here"
STONE = "Stone (1948), solved here; the same to four digits as tabulated by Kopal (1947) and Sims (1964)"
SUBSONIC_NOTE = (
    "Mach 1.5, half angle 30 deg: the flow on the cone is subsonic (surface Mach number 0.81), so the base of a finite "
    "cone acts upstream and the flow is not conical; the exact value belongs to an infinite cone. Shown, not judged."
)
BANDS = {"surface Cp": 0.01, "C_N_alpha": 0.01, "C_m_alpha": 0.025, "C_Y_beta": 0.01, "C_n_beta": 0.025}
"""Relative bands; those of the moments hold the force's 1 % and a hundredth of the length in its place."""


@dataclass(frozen=True)
class Plan:
    """How a cone is meshed.

    Attributes:
        settings: of the mesh about the cone squeezed along x by `stretch`.
        stretch: length of the cells along x on their other edges.
    """

    settings: MeshSettings
    stretch: float = 1.0


def run(fine: bool, progress: Progress) -> list[Record]:
    """Surface Cp, C_N_alpha, C_m_alpha and their lateral twins on nine cones.

    Args:
        fine: at Mach 3 and 10, 40 wall cells or more along the cone (30 deg, Mach 3: 39) and, at the shock, cells of
            half their size, 14 to 20 to the thickness; at Mach 1.5 80 wall cells along. Else 30 along, 4 across.
        progress: told what runs.
    """
    # One mesh for the Mach numbers that ask for the same one.
    meshes: dict[tuple[float, Plan], list[float]] = {}
    for angle_deg in HALF_ANGLES_DEG:
        for mach in MACHS:
            meshes.setdefault((angle_deg, mesh_plan(mach, math.radians(angle_deg), fine)), []).append(mach)
    records = []
    for index, ((angle_deg, plan), machs) in enumerate(meshes.items()):
        done = index / len(meshes)
        progress(f"half angle {angle_deg:g} deg, Mach {', '.join(f'{m:g}' for m in machs)}", done)
        records += cone_records(math.radians(angle_deg), tuple(machs), plan, progress, done)
    return records


def layer(mach: float, half_angle: float) -> float:
    """Thickness of the air between a cone of `half_angle` rad and its shock, one metre behind the apex, m."""
    return math.tan(taylor_maccoll(mach, half_angle).shock_angle) - math.tan(half_angle)


def cone_records(
    half_angle: float,
    machs: tuple[float, ...],
    plan: Plan,
    progress: Progress | None = None,
    done: float = 0.0,
) -> list[Record]:
    """Records of one cone at each Mach number, measured over its first metre.

    Args:
        half_angle: of the cone, rad.
        machs: Mach numbers.
        plan: of the mesh.
        progress, done: see `flowcase.solve_body`.
    """
    records = []
    for mach, values in zip(machs, measured(half_angle, machs, plan, progress, done), strict=True):
        records += _of_one(mach, half_angle, values)
    return records


def mesh_plan(mach: float, half_angle: float, fine: bool) -> Plan:
    """Mesh of a cone of 1 m and `half_angle` rad: see `run`."""
    thickness = layer(mach, half_angle)
    if not fine or thickness > FAR:
        along, across = 1.0 / (80 if fine else 30), thickness / 4
        return Plan(_at_wall(along, *LAYERS) if fine or along <= across else _at_wall(across, *NEAR_LAYERS))
    slope = math.tan(half_angle) + thickness
    if thickness > THIN:
        return Plan(_at_shock(slope, 1.0, thickness / ACROSS, MOVING_OUTSIDE, TAIL))
    area = math.pi * slope * math.hypot(1.0, slope)  # of the shock, m2
    cell = thickness / ACROSS
    stretch = max(1, min(round(SLANT / slope), math.floor(LONGEST / (2.0 * cell))))
    cell = max(cell, math.sqrt((INSIDE + OUTSIDE) * area / (stretch * MOST_AT_SHOCK)))
    return Plan(_at_shock(stretch * slope, 1.0 / stretch, cell, OUTSIDE), stretch)


def _at_wall(cell: float, wall_layers: int, growth_layers: int) -> MeshSettings:
    """Wall cells of `cell`, m, and larger ones by distance from the wall."""
    # The base and what lies behind it have cells of twice the size: nothing of them is measured.
    return MeshSettings(
        wall_cell=2.0 * cell,
        fine_parts=("forebody",),
        wall_layers=wall_layers,
        growth_layers=growth_layers,
        far_field=1.0,
    )


def _at_shock(slope: float, length: float, cell: float, outside: float, tail: float = 0.0) -> MeshSettings:
    """Cells of `cell`, m, about a shock of `slope` along `length`, m, and up to `outside` cells from it; twice that up
    to the wall, for another `tail` m along it; four times behind."""
    room = outside * cell
    end, wall_end = length + room, length + tail + room
    split = INSIDE * cell / slope  # where what lies INSIDE the shock begins to leave the axis out

    def reach(x: float) -> float:
        return slope * x + room

    ahead, rest = (-room, 0.0, 0.0), slope * end - INSIDE * cell
    return MeshSettings(
        wall_cell=4.0 * cell,
        frustums=(
            RefinementFrustum(ahead, (split, 0.0, 0.0), room, reach(split), cell),
            RefinementFrustum((split, 0.0, 0.0), (end, 0.0, 0.0), reach(split), reach(end), cell, 0.0, rest),
            RefinementFrustum(ahead, (wall_end, 0.0, 0.0), room, reach(wall_end), 2.0 * cell),
        ),
        wall_layers=1,
        growth_layers=1,
        far_field=1.0,
    )


def measured(
    half_angle: float,
    machs: tuple[float, ...],
    plan: Plan,
    progress: Progress | None = None,
    done: float = 0.0,
) -> list[dict[str, float]]:
    """Surface Cp and derivatives per rad on one mesh, by Mach number; those of unconverged conditions are left out."""
    surface = bodies.cone(half_angle, tail=TAIL)
    mach = np.repeat(machs, 3)
    alpha, beta = np.tile([0.0, STEP, 0.0], len(machs)), np.tile([0.0, 0.0, STEP], len(machs))
    conditions = FlowConditions(mach, alpha, beta)
    solution = solve_body(surface, plan.settings, conditions, progress, done, stretch=plan.stretch)
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


def _of_one(mach: float, half_angle: float, computed: dict[str, float]) -> list[Record]:
    """Rows of one cone at one Mach number."""
    angle_deg = math.degrees(half_angle)
    exact = taylor_maccoll(mach, half_angle)
    slope = normal_force_slope(mach, half_angle)
    moment = -slope * center_of_pressure(half_angle)
    supersonic = exact.surface_mach > 1.0
    published = {"surface Cp": exact.surface_cp, "C_N_alpha": slope, "C_m_alpha": moment}
    published |= {"C_Y_beta": -slope, "C_n_beta": -moment}
    return [
        Record(
            case=CASE,
            quantity=name,
            condition=f"Mach {mach:g}, half angle {angle_deg:g} deg",
            unit="-" if name == "surface Cp" else "1/rad",
            published=published[name],
            computed=computed.get(name),
            band=BANDS[name],
            kind="relative",
            source=EXACT if name == "surface Cp" else STONE,
            gate=supersonic,
            note="" if supersonic else SUBSONIC_NOTE,
        )
        for name in BANDS
    ]


def _side_force(values: xr.Dataset) -> float:
    """Side force along the body's y axis; `CY` lies across the wind, turned by the sideslip."""
    return float((values.CY - values.CA * math.sin(STEP)) / math.cos(STEP))
