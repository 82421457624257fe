"""What the mesh has to say about itself: counts, errors against the surface, warnings."""

from __future__ import annotations

import dataclasses
import time

import numpy as np

from spaceplane.mesh.cutcells import CutCells
from spaceplane.mesh.grid import Grid
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.surface import Surface

# A part is called thin when more than this share of the grid lines through it leave it within two cells; below that it
# is the rim near a sharp edge, which every wing has.
THIN_SHARE = 0.25
# Least mean wall cells along a body at which costs are quoted: they were measured at 100 (0.25 m, and 0.3 m with finer
# edges), 77 (75 974 cells with finer edges) and about 75 (adapted to the flow).
MEASURED_ALONG = 70.0
# Fewer wall cells than this across a body: a sphere's axial force is 8 % off on 5.7, 2 % on 8.
FEW_ACROSS = 8.0
UNMEASURED = "no accuracy has been measured on cells this coarse, use smaller ones (--cell, --cells)"
# Measured at wall cells of 0.25 m and on as many cells adapted to the flow, against 0.11 m (docs/method.md); at 0.3 m
# with two levels at edges, against 0.08 m (docs/uncertainty.md).
THIN_COST = "3 % (Mach 2.5) to 10 % (Mach 0.8) of its lift slope and 16 to 31 % of its C_m slope"
THIN_COST_ADAPTED = "1 % of its lift slope and 10 to 12 % of its C_m slope"
THIN_COST_WITH_EDGES = (
    "6 % of its lift slope at Mach 0.8, below 1 % from Mach 1.5 up, and its C_m slope is 2 to 17 % off up to Mach 2.5"
)


def describe(
    mesh: Mesh,
    surface: Surface,
    settings: MeshSettings,
    grid: Grid,
    cut: CutCells,
    wetted: np.ndarray,
    body: float,
    merged: int,
    enclosed: float,
    thin: list[dict],
    seconds: dict,
    adapted: bool = False,
) -> dict:
    """The mesh's record.

    Args:
        wetted: [part] wetted area, m2.
        body: volume of the domain that the cells leave out, m3.
        merged: control volumes merged into a neighbour.
        enclosed: volume of air, m3, that the far field cannot reach and that was left out.
        thin: parts with thin walls, see `thin_walls`.
        seconds: by phase.
        adapted: whether a sizing of the user's made cells smaller.
    """
    begin = time.perf_counter()
    sides = 2 if grid.half else 1
    by_part = _part_errors(mesh, surface, wetted)
    cost = THIN_COST_WITH_EDGES if settings.edge_levels >= 2 else THIN_COST_ADAPTED if adapted else THIN_COST
    across, along, doubled = coarseness(mesh, surface)
    if along < MEASURED_ALONG:
        cost = None
    warnings = [thin_warning(thin, cost)] if thin else []
    if across < FEW_ACROSS and not (thin and cost is None):
        warnings.append(f"only {across:.2g} wall cells across the body: {UNMEASURED}")
    if enclosed > 0.0:
        warnings.append(f"{enclosed:.4g} m3 of air enclosed by the body cannot be reached from outside and is left out")
    if cut.folded_edges:
        warnings.append(f"the surface folds over itself at {cut.folded_edges} cell edges")
    closure = np.abs(mesh.closure()).max()
    record = {
        "cells": mesh.cells,
        "faces": len(mesh.face_cells),
        "wall_faces": len(mesh.wall_cell),
        "pieces": len(mesh.piece_wall),
        "far_faces": len(mesh.far_cell),
        "cut_cells": sides * int(cut.cut.sum()),
        "split_cells": sides * cut.split_cells,
        "merged_cells": merged,
        "wall_cell": grid.wall_cell,
        "wall_cell_m": grid.wall_cell,
        "grid_cell_m": grid.cell,
        "cells_across": across,
        "doubled_share": doubled,
        "levels": grid.levels + 1,
        "symmetric": grid.half,
        "grid_corner": [float(x) for x in grid.corner],
        "domain": [
            [float(x) for x in grid.lower],
            [float(x) for x in grid.upper],
        ],
        "volume": body,
        "enclosed_volume": enclosed,
        "volume_error": abs(body - surface.volume) / surface.volume,
        "area_error": max(errors["area"] for errors in by_part.values()),
        "projected_area_error": max(max(errors["projected"]) for errors in by_part.values()),
        "errors_by_part": by_part,
        "closure": float(closure),
        "gauss_error": cut.gauss_error,
        "smallest_volume_fraction": float((mesh.cell_volume / mesh.cell_size**3).min()),
        "thin_walls": thin,
        "settings": dataclasses.asdict(settings),
        "warnings": warnings,
    }
    seconds = {**seconds, "checks": time.perf_counter() - begin}
    record["seconds_by_phase"] = seconds
    record["seconds"] = float(sum(seconds.values()))
    return record


def coarseness(mesh: Mesh, surface: Surface) -> tuple[float, float, float]:
    """How coarse the wall's cells are for the body.

    Returns:
        Wall cells, of their mean size over the wetted area, across the body: along the second largest edge of the box
        round it, since a thin plate needs none within its thickness. The same along the largest edge. And the share of
        the wall, by its projections, that has its opposite within the same cell, where one pressure acts on both.
    """
    wetted = mesh.wall_wetted
    size = float(mesh.cell_size[mesh.wall_cell] @ wetted / wetted.sum())
    low, high = surface.bounds
    _, middle, longest = np.sort(high - low)
    whole = np.abs(surface.area_vectors).sum() * wetted.sum() / surface.area  # without walls of enclosed air
    return float(middle) / size, float(longest) / size, max(0.0, float(1.0 - np.abs(mesh.wall_area).sum() / whole))


def _part_errors(mesh: Mesh, surface: Surface, wetted: np.ndarray) -> dict:
    """Wetted and projected area by part against the surface's, relative to the whole wetted area.

    The projected areas are the part's summed area vectors, and for x also the share that faces upstream.
    """
    total = surface.area
    size = np.linalg.norm(surface.area_vectors, axis=1)
    upstream = surface.area_vectors[:, 0] < 0.0
    mesh_upstream = mesh.piece_area[:, 0] > 0.0
    errors = {}
    for k, name in enumerate(surface.part_names):
        theirs = surface.part == k
        ours = mesh.piece_part == k
        vector = mesh.piece_area[ours].sum(axis=0) + surface.area_vectors[theirs].sum(axis=0)
        front = mesh.piece_area[ours & mesh_upstream, 0].sum() + surface.area_vectors[theirs & upstream, 0].sum()
        errors[name] = {
            "projected": [float(abs(x) / total) for x in (*vector, front)],
            "area": float(abs(wetted[k] - size[theirs].sum()) / total),
        }
    return errors


def thin_walls(cut: CutCells, shift: np.ndarray, surface: Surface, grid: Grid, sizes: np.ndarray) -> list[dict]:
    """Parts that are mostly thinner than two of their cells; of a body meshed as half, those of that half.

    Args:
        shift: [xyz] cell of the domain that the window of `cut` begins with.
        sizes: [place of `cut.thin`] edge of the cube of wall there, in finest cells.

    Returns:
        For each such part "part", the "share" of it that is thin, and of a typical place "thickness_m", "cell_m" (of
        the wall there) and "at_m" (x, y, z).
    """
    found = []
    parts = len(surface.part_names)
    examined = np.bincount(surface.part[cut.lines.astype(np.int64)], minlength=parts)
    part = surface.part[cut.thin[:, 4].astype(np.int64)]
    for k in range(parts):
        at = (part == k) & (cut.thin[:, 3] < 2.0 * sizes)
        here, cells = cut.thin[at], sizes[at] * grid.cell
        if len(here) == 0 or len(here) < THIN_SHARE * examined[k]:
            continue
        middle = np.argsort(here[:, 3])[len(here) // 2]
        place = grid.corner + (here[middle, :3] + shift) * grid.cell
        found.append(
            {
                "part": surface.part_names[k],
                "share": float(len(here) / examined[k]),
                "thickness_m": float(here[middle, 3] * grid.cell),
                "cell_m": float(cells[middle]),
                "at_m": [float(x) for x in place],
            }
        )
    return found


def thin_warning(thin: list[dict], cost: str | None) -> str:
    """One sentence on thin walls: which parts, where one is, what they cost and what helps.

    Args:
        thin: as of `thin_walls`, at least one part; twins on the left and right are told as one, by the thinner.
        cost: what HORUS-2B loses on such a mesh; None for one coarser than that was measured on.
    """
    told: dict[str, dict] = {}
    for one in sorted(thin, key=lambda one: one["thickness_m"]):
        told.setdefault(one["part"].removesuffix("_left").removesuffix("_right"), one)
    named = [
        f"{name.replace('_', ' ')} over {100 * one['share']:.0f} % ({one['thickness_m']:.2g} m)"
        for name, one in sorted(told.items(), key=lambda item: -item[1]["share"])
    ]
    sizes = {one["cell_m"] for one in thin}
    cells = " to ".join(f"{size:.3g}" for size in sorted({min(sizes), max(sizes)}))
    x, y, z = next(iter(told.values()))["at_m"]
    known = (
        UNMEASURED if cost is None else f"so meshed HORUS-2B loses {cost}, less with smaller cells (--cell, --cells)"
    )
    return (
        f"walls thinner than two cells of {cells} m: {', '.join(named)}, the thinnest at "
        f"x={x:.3f} y={y:.3f} z={z:.3f} m; {known}"
    )
