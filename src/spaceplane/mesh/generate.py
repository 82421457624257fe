"""From a surface to the mesh around it."""

from __future__ import annotations

import dataclasses
import math
import time

import numpy as np

from spaceplane.errors import InputError
from spaceplane.mesh import assembly, octree
from spaceplane.mesh.checks import describe, thin_walls
from spaceplane.mesh.coarsen import coarsen
from spaceplane.mesh.compiled import CACHE
from spaceplane.mesh.cutcells import CutCells, cut_cells
from spaceplane.mesh.grid import Grid, boxes_in_cells, place_grid, refined
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings
from spaceplane.mesh.sizing import Sizing, both, finer_levels, frustum_cells, round_edges, split, split_cells
from spaceplane.mesh.square_edges import cells_at_square_edges
from spaceplane.mesh.symmetry import is_symmetric, mirrored_parts
from spaceplane.mesh.thickness import Thickness, cells_on_thin_walls, thickness_of
from spaceplane.mesh.walls import fine_parts, fine_walls, join_coarse_walls, wall_sizes
from spaceplane.progress import Progress, silent
from spaceplane.vehicle.lofts import box
from spaceplane.vehicle.surface import Surface

# Cells of the dense window round the body that fit into memory with all its companions.
LARGEST_WINDOW = 400_000_000
# Room round the body in that window, cells below and above.
PAD_BELOW, PAD_ABOVE = 2, 3


def generate(
    surface: Surface,
    settings: MeshSettings | None = None,
    progress: Progress | None = None,
    sizing: Sizing | None = None,
) -> Mesh:
    """Mesh the air around a closed surface with an octree whose cells the body cuts.

    The wall is exact: wetted area, projected areas and volume equal the surface's, whatever the cell size. A surface
    that mirrors itself in y = 0 is meshed as right half and mirror image, so that the mesh is exactly symmetric.

    Args:
        surface: closed triangulated surface, m.
        settings: cell size and grading; None for the defaults.
        progress: told when kernels must be compiled first, see `compile_kernels`.
        sizing: cells wanted smaller than the settings make them, at walls as well; the grid of the settings stays.

    Raises:
        InputError: empty, open or folded surface; cells too many for memory; body too large for the domain; a sizing
            together with `target_cells`.
    """
    settings = settings or MeshSettings()
    _check(surface)
    fine_parts(surface.part_names, settings)
    half = _symmetric(surface, settings)
    if settings.target_cells is None:
        place_grid(surface, settings, half)  # refuses a domain before anything is compiled
    elif sizing is not None:
        raise InputError(f"target_cells: {settings.target_cells}, must be None with a sizing")
    compile_kernels(progress)
    if settings.target_cells is None:
        return _with_edges(surface, settings, half, sizing)
    return _meet_target(surface, settings, half)


def compile_kernels(progress: Progress | None = None) -> None:
    """Compile the mesh kernels, or do nothing where an earlier run left all of them in the cache.

    Args:
        progress: told with the phase "compile mesh", when there is something to compile.
    """
    if CACHE.is_complete("mesh"):
        return
    (progress or silent)("compile mesh", 0, 1, "compiling mesh kernels (once, ~15 s)")
    corners = np.stack(np.meshgrid((0.0, 1.0), (-0.5, 0.5), (0.0, 1.0), indexing="ij"), axis=-1)
    shell = box(corners)
    cube = Surface(shell.points, shell.triangles, np.zeros(len(shell.triangles), np.int32), ("cube",))
    for half in (True, False):  # every kernel, with the types of either kind of mesh
        mesh, _ = _generate(cube, MeshSettings(wall_cell=0.3, far_field=1.0, fine_edges=True), half)
        coarsen(mesh)
    CACHE.mark_complete("mesh")


def _check(surface: Surface) -> None:
    """Refuse surfaces that bound no body."""
    if len(surface.triangles) < 4 or len(surface.points) < 4:
        raise InputError(f"surface: {len(surface.triangles)} triangles, a closed surface is needed")
    if not np.isfinite(surface.points).all():
        raise InputError("surface: a vertex coordinate is not a finite number")
    if not surface.volume > 0.0:
        raise InputError(
            f"surface: volume {surface.volume:.6g} m3, must be above 0 (normals must point out of the body)"
        )


def _symmetric(surface: Surface, settings: MeshSettings) -> bool:
    if settings.symmetric is False:
        return False
    found = is_symmetric(surface, 1)
    if settings.symmetric and not found:
        raise InputError("symmetric: True, but the surface does not mirror itself in y = 0 part by part")
    return found


def _meet_target(surface: Surface, settings: MeshSettings, half: bool) -> Mesh:
    """Choose the wall cell by secant steps on log(cells) over log(wall cell), from a cheap first mesh."""
    goal = math.log(settings.target_cells)
    trial = math.log(math.sqrt(surface.area / max(settings.target_cells / 12.0, 20.0)))
    small, large = -math.inf, math.inf  # log wall cells known to give too many and too few cells
    slope = -1.7
    best = previous = None
    for _ in range(10):
        mesh = _with_edges(surface, dataclasses.replace(settings, wall_cell=math.exp(trial), target_cells=None), half)
        miss = math.log(mesh.cells) - goal
        if best is None or abs(miss) < abs(best[0]):
            best = (miss, mesh)
        if abs(miss) <= 0.1:
            break
        small, large = (max(small, trial), large) if miss > 0.0 else (small, min(large, trial))
        if previous is not None and abs(trial - previous[0]) > 1e-6:
            slope = min(max((miss - previous[1]) / (trial - previous[0]), -3.0), -0.7)
        previous = (trial, miss)
        trial -= miss / slope
        if not small < trial < large:
            trial = 0.5 * (small + large)
    miss, mesh = best
    if abs(math.expm1(miss)) > 0.15:
        mesh.record["warnings"].append(f"target_cells: {settings.target_cells} asked, {mesh.cells} reached")
    return mesh


def _cut(surface: Surface, grid: Grid, thin: float) -> tuple[CutCells, np.ndarray]:
    """Cut the cells round the body; also the domain cell that the window begins with.

    Args:
        thin: thickness in finest cells up to which thin walls are listed.
    """
    scaled = (surface.points - grid.corner) / grid.cell
    lowest = np.floor(scaled.min(axis=0)).astype(np.int64) - PAD_BELOW
    if grid.half:
        lowest[1] = -PAD_BELOW
    shape = np.floor(scaled.max(axis=0)).astype(np.int64) + 1 + PAD_ABOVE - lowest
    cells = float(np.prod(shape.astype(np.float64)))
    if cells > LARGEST_WINDOW:
        raise InputError(
            f"wall_cell: {grid.cell:.6g} m spans the body's box with {cells:.3g} cells, "
            f"at most {LARGEST_WINDOW:.3g} allowed"
        )
    right_of = PAD_BELOW if grid.half else None
    cut = cut_cells(scaled - lowest, surface.triangles, tuple(int(n) for n in shape), right_of, thin)
    return cut, lowest


def _with_edges(surface: Surface, settings: MeshSettings, half: bool, sizing: Sizing | None = None) -> Mesh:
    """Mesh with the given wall cell, cells at the edges of thin walls halved as often as the settings ask for."""
    mesh, walls = _generate(surface, settings, half, sizing)
    smallest = settings.wall_cell / (2.0 if settings.graded_wall else 1.0)
    for _ in range(settings.edge_levels):
        smallest *= 0.5
        edges = round_edges(mesh)
        thin = cells_on_thin_walls(walls, smallest, settings.wall_cell)
        if settings.edge_cells:
            thin = both(thin, cells_at_square_edges(surface, walls, settings.edge_cells, smallest, settings.wall_cell))
        if not edges.any() and not len(thin.cell):
            break
        mesh, walls = _generate(surface, settings, half, both(split(mesh, edges), thin))
    return mesh


def _generate(
    surface: Surface, settings: MeshSettings, half: bool, sizing: Sizing | None = None
) -> tuple[Mesh, Thickness]:
    """Mesh with the given wall cell, and the thickness of the body where it is thin."""
    clock = time.perf_counter
    begin = clock()
    grid = place_grid(surface, settings, half)
    finer = finer_levels(sizing, (*settings.boxes, *settings.frustums), grid.cell)
    grid = refined(grid, finer)
    expected = 3.0 * surface.area / grid.wall_cell**2
    if expected > settings.max_cells:
        raise InputError(
            f"wall_cell: {grid.wall_cell:.6g} m gives more than {expected:.3g} cells, "
            f"at most {settings.max_cells} allowed"
        )
    cut, shift = _cut(surface, grid, 4.0 * grid.wall_cell / grid.cell)
    cut_done = clock()

    skip = -shift[1] if half else 0
    window = octree.Window(shift + np.array([0, skip, 0]), np.ascontiguousarray(cut.cut[:, skip:]))
    extent = grid.size * 2**grid.levels
    if (window.origin < 0).any() or (window.origin + window.array.shape > extent).any():
        raise InputError("domain: the body is larger than the domain")
    fine = fine_walls(octree.ancestors(window, finer), finer, cut, shift, surface, settings)
    layers = (settings.wall_layers, settings.growth_layers)
    wanted = split_cells(sizing, grid)
    for level, cells in frustum_cells(settings.frustums, grid).items():
        wanted[level] = octree.union(wanted[level], cells) if level in wanted else cells
    refined_cells, blocks = octree.refined_levels(
        window, fine, finer, grid.size, grid.levels, *layers, boxes_in_cells(settings, grid), wanted
    )
    expected = octree.count_leaves(refined_cells) * (2 if half else 1)
    if expected > settings.max_cells:
        raise InputError(
            f"wall_cell: {grid.wall_cell:.6g} m gives {expected} cells, at most {settings.max_cells} allowed"
        )
    leaves = octree.build_leaves(refined_cells, octree.Window(shift, cut.fluid))
    octree_done = clock()

    # in wall cells the leaves' volumes are integers and their sum exact
    leaf_volume = int((8 ** leaves.level.astype(np.int64)).sum())
    body = float(int(np.prod(extent)) - leaf_volume) - float(cut.volume.sum())

    upstream = surface.area_vectors[:, 0] < 0.0
    whole = assembly.assemble(cut, leaves, shift, surface.part.astype(np.int64), upstream, half)
    whole = assembly.joined(whole, join_coarse_walls(whole, blocks))
    root = assembly.join_small(whole, settings.merge_fraction)
    if half:
        n = len(root)
        whole = assembly.mirror(whole, mirrored_parts(surface.part_names))
        root = assembly.join_small(whole, settings.merge_fraction, np.concatenate([root, root + n]))
    kept = assembly.reachable(whole, root)
    merge_done = clock()
    mesh, _ = assembly.finish(whole, root, kept, grid.cell, grid.corner, surface.part_names)
    end = clock()
    seconds = {
        **cut.seconds,
        "grid and symmetry": cut_done - begin - sum(cut.seconds.values()),
        "octree": octree_done - cut_done,
        "merging": merge_done - octree_done,
        "assembly": end - merge_done,
    }
    body *= grid.cell**3 * (2 if half else 1)
    wetted = np.bincount(whole.polygon_part, whole.polygon_size, minlength=len(surface.part_names)) * grid.cell**2
    enclosed = float(whole.volume[~kept].sum()) * grid.cell**3
    merged = int((root != np.arange(len(root))).sum())
    sizes = wall_sizes(np.floor(cut.thin[:, :3]).astype(np.int64) + shift, blocks)
    adapted = sizing is not None and not settings.edge_levels
    thin = thin_walls(cut, shift, surface, grid, sizes)
    mesh.record.update(
        describe(mesh, surface, settings, grid, cut, wetted, body, merged, enclosed, thin, seconds, adapted)
    )
    return mesh, thickness_of(cut, shift, grid)
