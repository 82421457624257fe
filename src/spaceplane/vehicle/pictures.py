"""Off-screen views of a surface with pyvista, parts in their colours."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from spaceplane.vehicle.appearance import VIEWS, part_colour
from spaceplane.vehicle.surface import Surface

CREASE_DEG = 25.0  # neighbouring triangles that meet at more than this are shaded as a sharp edge


def draw(pyvista, surface: Surface, path: Path, views: tuple[str, ...], size: tuple[int, int]) -> None:
    """Draw the views side by side into a PNG file.

    Args:
        pyvista: the module, imported by the caller.
        surface: what to draw.
        path: the file.
        views: names from `appearance.VIEWS`.
        size: width and height, pixels.
    """
    from vtkmodules.vtkCommonCore import vtkObject

    columns = 1 if len(views) == 1 else 2
    rows = -(-len(views) // columns)
    meshes = [(mesh, part_colour(name)) for name, mesh in part_meshes(pyvista, surface)]
    centre = surface.bounds.mean(axis=0)
    vtkObject.GlobalWarningDisplayOff()  # VTK reports a missing X server before it falls back to software
    plotter = pyvista.Plotter(shape=(rows, columns), off_screen=True, window_size=size, border=False)
    try:
        for index, view in enumerate(views):
            plotter.subplot(index // columns, index % columns)
            plotter.set_background("#b7c7dc", top="#f4f7fb")
            for mesh, colour in meshes:
                plotter.add_mesh(mesh, color=colour, smooth_shading=True, ambient=0.28, diffuse=0.75, specular=0.15)
            direction, up = (np.array(v) for v in VIEWS[view])
            direction = direction / np.linalg.norm(direction)
            plotter.camera_position = [tuple(centre + 80 * direction), tuple(centre), tuple(up)]
            plotter.enable_parallel_projection()
            plotter.camera.parallel_scale = _half_height(
                surface.points - centre, direction, up, size[0] * rows / (size[1] * columns)
            )
            plotter.reset_camera_clipping_range()
            if len(views) > 1:
                plotter.add_text(view, font_size=11, color="#2b3442")
        plotter.screenshot(str(path))
    finally:
        plotter.close()
        vtkObject.GlobalWarningDisplayOn()


def part_meshes(pyvista, surface: Surface) -> list[tuple[str, object]]:
    """Name and shaded mesh (`pyvista.PolyData`, m) of every part."""
    meshes = []
    for index, name in enumerate(surface.part_names):
        triangles = surface.triangles[surface.part == index]
        if not len(triangles):
            continue
        used, local = np.unique(triangles, return_inverse=True)
        faces = np.hstack([np.full((len(triangles), 1), 3), local.reshape(-1, 3)]).ravel()
        mesh = pyvista.PolyData(surface.points[used], faces)
        meshes.append((name, mesh.compute_normals(feature_angle=CREASE_DEG, split_vertices=True)))
    return meshes


def _half_height(points: np.ndarray, direction: np.ndarray, up: np.ndarray, aspect: float) -> float:
    """Half the height of a window of that width over height which shows all points with a margin."""
    right = np.cross(up, direction)
    right = right / np.linalg.norm(right)
    upward = np.cross(direction, right)
    return 1.12 * max(float(np.abs(points @ upward).max()), float(np.abs(points @ right).max()) / aspect)
