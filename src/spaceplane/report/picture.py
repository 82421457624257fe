"""A still picture of the coloured surface for places without WebGL, such as print."""

from __future__ import annotations

import io

import numpy as np

from spaceplane.report.surface_data import ColouredSurface, cp_range

# Colour stops of Cp from low to high; the viewer uses the same.
COLOUR_STOPS = (
    "#1b2a6b",
    "#2b5bb5",
    "#3b93c9",
    "#74c3c4",
    "#cfe3c0",
    "#f6df94",
    "#f2ac5b",
    "#dd6b3f",
    "#a8283a",
    "#5e0f3a",
)


def still(
    surface: ColouredSurface, values: np.ndarray, azimuth_deg: float = -128.0, elevation_deg: float = 24.0
) -> bytes:
    """PNG (transparent ground) of the surface coloured by `values` [triangle], seen from ahead, the left and above.

    Painter's algorithm over the triangles that face the viewer: no graphics driver needed.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import LinearSegmentedColormap, Normalize
    from matplotlib.figure import Figure

    azimuth, elevation = np.radians([azimuth_deg, elevation_deg])
    toward = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    right = np.cross([0.0, 0.0, 1.0], toward)
    right /= np.linalg.norm(right)
    up = np.cross(toward, right)
    corners = surface.points[surface.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-30)[:, None]
    facing = np.flatnonzero(normal @ toward > 0)
    order = facing[np.argsort(corners[facing].mean(axis=1) @ toward)]
    light = toward + 0.5 * up - 0.35 * right
    light /= np.linalg.norm(light)
    shade = 0.55 + 0.45 * np.clip(normal[order] @ light, 0, 1)
    low, high = cp_range(values)
    colours = LinearSegmentedColormap.from_list("cp", COLOUR_STOPS)(Normalize(low, high, clip=True)(values[order]))
    colours[:, :3] *= shade[:, None]
    flat = np.stack([corners[order] @ right, corners[order] @ up], axis=-1)
    figure = Figure(figsize=(11, 6), dpi=100)
    figure.patch.set_alpha(0.0)
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.96))
    axes.add_collection(PolyCollection(flat, facecolors=colours, edgecolors=colours, linewidths=0.35))
    axes.set_xlim(flat[..., 0].min(), flat[..., 0].max())
    axes.set_ylim(flat[..., 1].min(), flat[..., 1].max())
    axes.set_aspect("equal")
    axes.axis("off")
    buffer = io.BytesIO()
    FigureCanvasAgg(figure).print_png(buffer)
    return buffer.getvalue()
