"""Forces and moments of a solution as coefficients, in total and by part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.axes import FORCES_AND_MOMENTS, wind_axes
from spaceplane.aero.loads import Reference, coefficients_of
from spaceplane.flow.solution import ConvergenceRecord, FlowConditions, Solution
from spaceplane.mesh.mesh import Mesh

if TYPE_CHECKING:
    import xarray as xr

TOTAL = "total"
COEFFICIENTS = (*FORCES_AND_MOMENTS, "CA", "CN", "CA_forebody", "CA_base")
WITH_SPREAD = (*FORCES_AND_MOMENTS, "CA", "CN")
"""Coefficients whose wandering is known or estimated, see `integrate`."""
PRESSURES = ("Cp_max", "Cp_min")
LATERAL = ("CY", "Cl", "Cn")
BY_SOURCE = "_by_source"
"""Ending of the variables that hold a coefficient by where it comes from, see `spaceplane.aero.increments`."""

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
    "CA_forebody": ("axial pressure force on wall that faces upstream (n_x < 0)", _GEOMETRY, "aft", _FORCE),
    "CA_base": ("axial pressure force on wall that faces downstream (n_x >= 0)", _GEOMETRY, "aft", _FORCE),
    "Cp_max": ("highest pressure coefficient on the wall", "none", "above free-stream pressure", "q_inf"),
    "Cp_min": ("lowest pressure coefficient on the wall", "none", "above free-stream pressure", "q_inf"),
}


@dataclass(frozen=True)
class WallPieces:
    """Flat pieces of wall that carry one pressure each.

    Attributes:
        area: [piece, xyz] area vector pointing into the body, m2.
        center: [piece, xyz] centroid, m, geometry axes.
        part: [piece] index into `part_names`.
        part_names: names of the parts.
    """

    area: np.ndarray
    center: np.ndarray
    part: np.ndarray
    part_names: tuple[str, ...]


@dataclass(frozen=True)
class Judgement:
    """Whether the numbers of each condition may be trusted.

    Attributes:
        verdict: [condition] "converged", "oscillating" or "failed".
        reason: [condition] why it is not "converged"; empty when it is.
    """

    verdict: Sequence[str]
    reason: Sequence[str]


def integrate(solution: Solution, reference: Reference) -> xr.Dataset:
    """Coefficients of every condition, in total and by part.

    The force on a piece of wall is the gauge pressure (p - p_inf) at the centroid of its wall face times the area
    vector of the piece; its moment arm runs to the piece's own centroid. Parts sum to the total exactly.

    Args:
        solution: flow of every condition on one mesh.
        reference: area, chord, span and moment centre, SI.

    Returns:
        As `coefficients` gives; `<name>_spread` is half the peak-to-peak in the solver's final window, for moments the
        estimate that the forces' wandering acts at the wall's root-mean-square distance from the moment centre.
    """
    mesh, conditions = solution.mesh, solution.conditions
    pieces = WallPieces(mesh.piece_area, mesh.piece_center, mesh.piece_part, mesh.part_names)
    gauge = solution.wall_pressure.astype(float) - 1.0 / conditions.gamma
    cp = gauge / (0.5 * np.asarray(conditions.mach, dtype=float) ** 2)
    judgement = Judgement([r.verdict for r in solution.records], [r.reason for r in solution.records])
    return coefficients(pieces, cp[mesh.piece_wall], conditions, reference, judgement, _spread(solution, reference))


def coefficients(
    pieces: WallPieces,
    cp: np.ndarray,
    conditions: FlowConditions,
    reference: Reference,
    judgement: Judgement,
    spread: Mapping[str, np.ndarray],
) -> xr.Dataset:
    """Coefficients of pressures on pieces of wall, in total and by part, from whatever method they come.

    Args:
        pieces: the wall, closed.
        cp: [piece, condition] pressure coefficient.
        conditions: free streams.
        reference: area, chord, span and moment centre, SI.
        judgement: verdict and reason of each condition.
        spread: name in WITH_SPREAD -> [condition] how far the coefficient wanders.

    Returns:
        Dataset with dims (condition, part); `part` holds "total" first and then the parts of the surface. Each of
        COEFFICIENTS and PRESSURES has the attributes units, axes, positive and reference; so has `<name>_spread`
        (condition) of WITH_SPREAD. The dataset's own attributes are the reference lengths, and [xyz] `wall_reach_m`,
        the farthest wall from the moment centre along each axis, and `wall_rms_m`, its root mean square by area.
        Coordinates along `condition`: mach, alpha, beta (rad), reduced rates p_hat, q_hat, r_hat, verdict, reason. A
        condition that failed has NaN everywhere.
    """
    pieces, cp = _sorted(pieces, cp)
    center = np.asarray(reference.moment_center, dtype=float)
    force, moment, forebody = _loads(pieces, cp, center)
    values = coefficients_of(force, moment, conditions, reference)
    forebody = forebody / reference.area
    values |= {"CA_forebody": forebody, "CA_base": values["CA"] - forebody}
    values["Cp_max"], values["Cp_min"] = _extrema(pieces, cp)
    values |= {f"{name}_spread": value for name, value in spread.items()}
    found = _dataset(conditions, judgement, reference, values, (TOTAL, *pieces.part_names))
    reach, rms = _arms(pieces.center - center, np.linalg.norm(pieces.area, axis=1))
    return found.assign_attrs(wall_reach_m=reach.tolist(), wall_rms_m=rms.tolist())


def _loads(pieces: WallPieces, cp: np.ndarray, center: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Forces m2, moments m3 [condition, total and parts, xyz] and x-force on upstream wall, on q_inf; geometry axes."""
    arm_area = np.cross(pieces.center - center, pieces.area)
    upstream = np.where(pieces.area[:, 0] > 0.0, pieces.area[:, 0], 0.0)
    weights = np.column_stack([pieces.area, arm_area, upstream])
    sums = np.zeros((cp.shape[1], len(pieces.part_names) + 1, weights.shape[1]))
    for part, chosen in enumerate(_runs(pieces)):
        sums[:, part + 1] = cp[chosen].T @ weights[chosen]
    sums[:, 0] = sums[:, 1:].sum(axis=1)
    return sums[..., :3], sums[..., 3:6], sums[..., 6]


def _extrema(pieces: WallPieces, cp: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Highest and lowest Cp, [condition, total and parts]; NaN for a part without wall."""
    high = np.full((cp.shape[1], len(pieces.part_names) + 1), np.nan)
    low = high.copy()
    high[:, 0], low[:, 0] = cp.max(axis=0), cp.min(axis=0)
    for part, chosen in enumerate(_runs(pieces)):
        own = cp[chosen]
        if len(own):
            high[:, part + 1], low[:, part + 1] = own.max(axis=0), own.min(axis=0)
    return high, low


def _runs(pieces: WallPieces) -> list[slice]:
    """[part] where its pieces are, which follow each other."""
    bounds = np.searchsorted(pieces.part, np.arange(len(pieces.part_names) + 1))
    return [slice(*pair) for pair in pairwise(bounds)]


def _sorted(pieces: WallPieces, cp: np.ndarray) -> tuple[WallPieces, np.ndarray]:
    """Pieces and their pressures in the order of the parts, as they are where they come so."""
    if (np.diff(pieces.part) >= 0).all():
        return pieces, cp
    order = np.argsort(pieces.part, kind="stable")
    return WallPieces(pieces.area[order], pieces.center[order], pieces.part[order], pieces.part_names), cp[order]


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
    _, arm = _arms(mesh.piece_center - np.asarray(reference.moment_center), size)
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


def _arms(distance: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """[xyz] largest and root-mean-square distance [piece, xyz] along each axis, of pieces with areas `size` [piece]."""
    return np.abs(distance).max(axis=0), np.sqrt(np.average(distance**2, axis=0, weights=size))


def _wander(record: ConvergenceRecord) -> np.ndarray:
    """[3] half peak-to-peak of the recorded forces along x, y, z."""
    spread = np.asarray(record.window_spread, dtype=float)
    history = np.asarray(record.force_history, dtype=float)
    if record.good or len(history) < 3:
        return spread
    return np.maximum(spread, 0.5 * np.ptp(history[-(len(history) // 3) :], axis=0))


def _dataset(
    conditions: FlowConditions, judgement: Judgement, reference: Reference, values: dict, parts: tuple[str, ...]
) -> xr.Dataset:
    failed = np.array([verdict == "failed" for verdict in judgement.verdict], dtype=bool)
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
        **_reduced_rates(conditions, reference),
        "verdict": ("condition", np.array(judgement.verdict, dtype=str)),
        "reason": ("condition", np.array(judgement.reason, dtype=str)),
    }
    attributes = {
        "reference_area_m2": float(reference.area),
        "c_ref_m": float(reference.chord),
        "b_ref_m": float(reference.span),
        "moment_center_m": [float(v) for v in reference.moment_center],
        "gamma": float(conditions.gamma),
        "gas": conditions.gas,
    }
    import xarray as xr  # slow to import, and needed at the end only

    return xr.Dataset(variables, coordinates, attributes)


def _reduced_rates(conditions: FlowConditions, reference: Reference) -> dict[str, tuple]:
    """Coordinates p_hat = p b/2V, q_hat = q c/2V and r_hat = r b/2V of each condition."""
    lengths = np.array([reference.span, reference.chord, reference.span])
    rates = np.zeros((len(conditions), 3)) if conditions.rates is None else np.asarray(conditions.rates, dtype=float)
    reduced = rates * lengths / (2.0 * np.asarray(conditions.mach, dtype=float)[:, None])
    scale = ("p b/2V", "q c/2V", "r b/2V")
    return {
        name: ("condition", reduced[:, k], {"units": "1", "long_name": f"reduced rate {scale[k]}"})
        for k, name in enumerate(("p_hat", "q_hat", "r_hat"))
    }


def mirrored(coefficients: xr.Dataset) -> xr.Dataset:
    """The coefficients of the mirrored vehicle in the mirrored wind: left and right parts swapped, CY, Cl, Cn reversed.

    For a vehicle that is its own mirror image this is its answer to the opposite sideslip, roll and yaw rate.
    """
    names = [mirrored_name(str(part)) for part in coefficients.part.values]
    result = coefficients.assign_coords(part=names).sel(part=coefficients.part.values)
    result = result.assign_coords({name: -coefficients[name] for name in ("beta", "p_hat", "r_hat")})
    lateral = [name for name in (*LATERAL, *(f"{n}{BY_SOURCE}" for n in LATERAL)) if name in result]
    return result.assign({name: result[name].copy(data=-result[name].values) for name in lateral})


def mirrored_name(part: str) -> str:
    """Name of the part on the other side: wing_left for wing_right; a centre part is its own."""
    for here, there in (("_left", "_right"), ("_right", "_left")):
        if part.endswith(here):
            return part.removesuffix(here) + there
    return part
