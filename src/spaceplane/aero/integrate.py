"""Forces and moments of a solution as coefficients, in total and by part."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import xarray as xr

from spaceplane.aero.axes import FORCES_AND_MOMENTS, geometry_to_body, wind_axes
from spaceplane.flow.solution import ConvergenceRecord, Solution
from spaceplane.mesh.mesh import Mesh

TOTAL = "total"
COEFFICIENTS = (*FORCES_AND_MOMENTS, "CA", "CN", "CA_forebody", "CA_base")
WITH_SPREAD = (*FORCES_AND_MOMENTS, "CA", "CN")
"""Coefficients whose wandering is known or estimated, see `integrate`."""
PRESSURES = ("Cp_max", "Cp_min")
LATERAL = ("CY", "Cl", "Cn")

_WIND = "wind axes: drag along the free stream, side force right, lift in the plane of symmetry"
_BODY = "body axes: x forward, y right, z down"
_GEOMETRY = "geometry axes: x aft, y right, z up"
_FORCE = "q_inf * reference area"
_ROLL_YAW = "q_inf * reference area * b_ref, about the moment centre"
_PITCH = "q_inf * reference area * c_ref, about the moment centre"
DESCRIPTION = {
    "CL": ("lift coefficient", _WIND, "up", _FORCE),
    "CD": ("drag coefficient", _WIND, "downstream", _FORCE),
    "CY": ("side-force coefficient", _WIND, "right", _FORCE),
    "Cl": ("rolling-moment coefficient", _BODY, "right wing down", _ROLL_YAW),
    "Cm": ("pitching-moment coefficient", _BODY, "nose up", _PITCH),
    "Cn": ("yawing-moment coefficient", _BODY, "nose right", _ROLL_YAW),
    "CA": ("axial-force coefficient", _GEOMETRY, "aft", _FORCE),
    "CN": ("normal-force coefficient", _GEOMETRY, "up", _FORCE),
    "CA_forebody": ("axial force on wall that faces upstream (n_x < 0)", _GEOMETRY, "aft", _FORCE),
    "CA_base": ("axial force on wall that faces downstream (n_x >= 0)", _GEOMETRY, "aft", _FORCE),
    "Cp_max": ("highest pressure coefficient on the wall", "none", "above free-stream pressure", "q_inf"),
    "Cp_min": ("lowest pressure coefficient on the wall", "none", "above free-stream pressure", "q_inf"),
}


class Reference(Protocol):
    """Reference lengths, SI: area m2, chord m, span m, moment_center [xyz] m in geometry axes."""

    area: float
    chord: float
    span: float
    moment_center: tuple[float, float, float]


def integrate(solution: Solution, reference: Reference) -> xr.Dataset:
    """Coefficients of every condition, in total and by part.

    The force on a piece of wall is the gauge pressure (p - p_inf) at the centroid of its wall face times the area
    vector of the piece; its moment arm runs to the piece's own centroid. Parts sum to the total exactly.

    Args:
        solution: flow of every condition on one mesh.
        reference: area, chord, span and moment centre, SI.

    Returns:
        Dataset with dims (condition, part); `part` holds "total" first and then the parts of the surface. Each of
        COEFFICIENTS and PRESSURES has the attributes units, axes, positive and reference; `<name>_spread`
        (condition) of WITH_SPREAD is half the peak-to-peak in the solver's final window, for moments the estimate that
        the forces' wandering acts at the wall's root-mean-square distance from the moment centre. Coordinates along
        `condition`: mach, alpha, beta (rad), verdict, reason. A condition that failed has NaN everywhere.
    """
    mesh, conditions = solution.mesh, solution.conditions
    force, moment, forebody = _loads(solution, np.asarray(reference.moment_center, dtype=float))
    dynamic_pressure = 0.5 * np.asarray(conditions.mach, dtype=float) ** 2
    force = force / (dynamic_pressure * reference.area)[:, None, None]
    forebody = forebody / (dynamic_pressure * reference.area)[:, None]
    lengths = np.array([reference.span, reference.chord, reference.span])
    moment = geometry_to_body(moment) / ((dynamic_pressure * reference.area)[:, None, None] * lengths)
    axes = wind_axes(conditions.alpha, conditions.beta)
    values = {
        "CL": np.einsum("cpx,cx->cp", force, axes.lift),
        "CD": np.einsum("cpx,cx->cp", force, axes.drag),
        "CY": np.einsum("cpx,cx->cp", force, axes.side),
        "Cl": moment[..., 0],
        "Cm": moment[..., 1],
        "Cn": moment[..., 2],
        "CA": force[..., 0],
        "CN": force[..., 2],
        "CA_forebody": forebody,
        "CA_base": force[..., 0] - forebody,
    }
    values["Cp_max"], values["Cp_min"] = _extrema(solution)
    values |= {f"{name}_spread": value for name, value in _spread(solution, reference).items()}
    return _dataset(solution, reference, values, (TOTAL, *mesh.part_names))


def _loads(solution: Solution, center: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Forces, moments [condition, total and parts, xyz] and x-force on upstream wall; geometry axes, solver's scale."""
    mesh = solution.mesh
    gauge = solution.wall_pressure.astype(float) - 1.0 / solution.conditions.gamma
    pressure = gauge[mesh.piece_wall]
    arm_area = np.cross(mesh.piece_center - center, mesh.piece_area)
    upstream = np.where(mesh.piece_area[:, 0] > 0.0, mesh.piece_area[:, 0], 0.0)
    weights = np.column_stack([mesh.piece_area, arm_area, upstream])
    parts = len(mesh.part_names)
    sums = np.zeros((pressure.shape[1], parts + 1, weights.shape[1]))
    for part in range(parts):
        chosen = mesh.piece_part == part
        sums[:, part + 1] = pressure[chosen].T @ weights[chosen]
    sums[:, 0] = sums[:, 1:].sum(axis=1)
    return sums[..., :3], sums[..., 3:6], sums[..., 6]


def _extrema(solution: Solution) -> tuple[np.ndarray, np.ndarray]:
    """Highest and lowest wall Cp, [condition, total and parts]; NaN for a part without wall."""
    mesh = solution.mesh
    cp = solution.wall_cp().astype(float)
    body = cp[mesh.body_wall]
    high = np.full((cp.shape[1], len(mesh.part_names) + 1), np.nan)
    low = high.copy()
    high[:, 0], low[:, 0] = body.max(axis=0), body.min(axis=0)
    for part in range(len(mesh.part_names)):
        own = mesh.piece_wall[mesh.piece_part == part]
        if len(own):
            high[:, part + 1], low[:, part + 1] = cp[own].max(axis=0), cp[own].min(axis=0)
    return high, low


def wetted_area(mesh: Mesh) -> float:
    """Sum of the body's wall faces' areas, m2: the scale of ConvergenceRecord's forces."""
    return float(np.linalg.norm(mesh.wall_area[mesh.body_wall], axis=1).sum())


def _spread(solution: Solution, reference: Reference) -> dict[str, np.ndarray]:
    """Half the peak-to-peak of each coefficient in the solver's final window, [condition].

    Forces that still wander may do so more slowly than the window is long: theirs is the last third of the iterations.
    The solver records forces only. What a force spread means for a moment is estimated by letting it act at the wall's
    root-mean-square distance from the moment centre; no bound, since forces that wander against each other on two
    parts of the wall turn the body without showing in their sum.
    """
    mesh, conditions = solution.mesh, solution.conditions
    raw = np.array([_wander(record) for record in solution.records]).reshape(-1, 3)
    spread = raw * wetted_area(mesh) / reference.area
    axes = wind_axes(conditions.alpha, conditions.beta)
    size = np.linalg.norm(mesh.piece_area, axis=1)
    arm = np.sqrt(np.average((mesh.piece_center - np.asarray(reference.moment_center)) ** 2, axis=0, weights=size))
    side, up = spread[:, 1], spread[:, 2]
    return {
        "CL": np.linalg.norm(spread * axes.lift, axis=1),
        "CD": np.linalg.norm(spread * axes.drag, axis=1),
        "CY": np.linalg.norm(spread * axes.side, axis=1),
        "Cl": np.hypot(up * arm[1], side * arm[2]) / reference.span,
        "Cm": np.hypot(up * arm[0], spread[:, 0] * arm[2]) / reference.chord,
        "Cn": np.hypot(side * arm[0], spread[:, 0] * arm[1]) / reference.span,
        "CA": spread[:, 0],
        "CN": up,
    }


def _wander(record: ConvergenceRecord) -> np.ndarray:
    """[3] half peak-to-peak of the recorded forces along x, y, z."""
    spread = np.asarray(record.window_spread, dtype=float)
    history = np.asarray(record.force_history, dtype=float)
    if record.good or len(history) < 3:
        return spread
    return np.maximum(spread, 0.5 * np.ptp(history[-(len(history) // 3) :], axis=0))


def _dataset(solution: Solution, reference: Reference, values: dict, parts: tuple[str, ...]) -> xr.Dataset:
    conditions, records = solution.conditions, solution.records
    failed = np.array([record.verdict == "failed" for record in records], dtype=bool)
    variables = {}
    for name, value in values.items():
        value = np.array(value, dtype=float)
        value[failed] = np.nan
        coefficient = name.removesuffix("_spread")
        long_name, axes, positive, scale = DESCRIPTION[coefficient]
        if name != coefficient:
            long_name, positive = f"half peak-to-peak of {coefficient} in the solver's final window", "always"
        attributes = {"long_name": long_name, "units": "1", "axes": axes, "positive": positive, "reference": scale}
        variables[name] = (("condition", "part")[: value.ndim], value, attributes)
    angle = {"units": "rad"}
    coordinates = {
        "part": list(parts),
        "mach": ("condition", np.asarray(conditions.mach, dtype=float), {"units": "1"}),
        "alpha": ("condition", np.asarray(conditions.alpha, dtype=float), angle | {"positive": "nose up"}),
        "beta": ("condition", np.asarray(conditions.beta, dtype=float), angle | {"positive": "wind from the right"}),
        "verdict": ("condition", np.array([r.verdict for r in records], dtype=str)),
        "reason": ("condition", np.array([r.reason for r in records], dtype=str)),
    }
    attributes = {
        "reference_area_m2": float(reference.area),
        "c_ref_m": float(reference.chord),
        "b_ref_m": float(reference.span),
        "moment_center_m": [float(v) for v in reference.moment_center],
        "gamma": float(conditions.gamma),
    }
    return xr.Dataset(variables, coordinates, attributes)


def mirrored(coefficients: xr.Dataset) -> xr.Dataset:
    """The coefficients of the mirrored vehicle in the mirrored wind: left and right parts swapped, CY, Cl, Cn reversed.

    For a vehicle that is its own mirror image this is its answer to the opposite sideslip.
    """
    names = [mirrored_name(str(part)) for part in coefficients.part.values]
    result = coefficients.assign_coords(part=names).sel(part=coefficients.part.values)
    result = result.assign_coords(beta=-coefficients.beta)
    return result.assign({name: result[name].copy(data=-result[name].values) for name in LATERAL})


def mirrored_name(part: str) -> str:
    """Name of the part on the other side: wing_left for wing_right; a centre part is its own."""
    for here, there in (("_left", "_right"), ("_right", "_left")):
        if part.endswith(here):
            return part.removesuffix(here) + there
    return part
