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


WIDTH, HEIGHT, OVERSAMPLING = 1100, 600, 2


def stills(
    surface: ColouredSurface, fields: dict[str, np.ndarray], azimuth_deg: float = -142.0, elevation_deg: float = 24.0
) -> dict[str, bytes]:
    """PNG (transparent ground) of the surface for each field [triangle], seen from ahead, the left and above.

    Triangles are drawn once, by the painter's algorithm and without a graphics driver, as numbers; each field then
    colours the pixels.
    """
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
    seen = _draw_numbers(np.stack([corners[order] @ right, corners[order] @ up], axis=-1))
    light = toward + 0.5 * up - 0.35 * right
    light /= np.linalg.norm(light)
    shade = 0.6 + 0.4 * np.clip(normal[order] @ light, 0, 1)
    return {name: _colour(seen, values[order], cp_range(values), shade) for name, values in fields.items()}


def _draw_numbers(flat: np.ndarray) -> np.ndarray:
    """[row, column] triangle seen at each pixel, -1 for none; `flat` is [triangle, corner, (right, up)]."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure

    number = np.arange(1, len(flat) + 1)
    colours = np.stack([number >> 16, (number >> 8) & 255, number & 255], axis=-1) / 255.0
    figure = Figure(figsize=(WIDTH * OVERSAMPLING / 100, HEIGHT * OVERSAMPLING / 100), dpi=100, facecolor="black")
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.96))
    # Edges of the triangles' own number close the gaps that drawing without blending leaves between neighbours.
    axes.add_collection(
        PolyCollection(flat, facecolors=colours, edgecolors=colours, linewidths=0.5, antialiaseds=False)
    )
    axes.set_xlim(flat[..., 0].min(), flat[..., 0].max())
    axes.set_ylim(flat[..., 1].min(), flat[..., 1].max())
    axes.set_aspect("equal")
    axes.axis("off")
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba()).astype(np.int64)
    return (pixels[..., 0] << 16) + (pixels[..., 1] << 8) + pixels[..., 2] - 1


def _colour(seen: np.ndarray, values: np.ndarray, limits: tuple[float, float], shade: np.ndarray) -> bytes:
    """PNG of the triangles' values at the pixels where they are seen, averaged over the oversampling."""
    from PIL import Image

    stops = np.array([[int(c[k : k + 2], 16) for k in (1, 3, 5)] for c in COLOUR_STOPS], float)
    low, high = limits
    place = np.clip((np.nan_to_num(values) - low) / (high - low), 0, 1)
    colour = np.stack([np.interp(place, np.linspace(0, 1, len(stops)), stops[:, k]) for k in range(3)], axis=-1)
    colour *= shade[:, None]
    inside = seen >= 0
    image = np.zeros((*seen.shape, 4))
    image[inside, :3] = colour[seen[inside]]
    image[inside, 3] = 255.0
    rows, columns = seen.shape[0] // OVERSAMPLING, seen.shape[1] // OVERSAMPLING
    blocks = image.reshape(rows, OVERSAMPLING, columns, OVERSAMPLING, 4).mean(axis=(1, 3))
    covered = np.maximum(blocks[..., 3:] / 255.0, 1e-9)
    blocks[..., :3] = np.minimum(blocks[..., :3] / covered, 255.0)
    buffer = io.BytesIO()
    Image.fromarray(np.round(blocks).astype(np.uint8), "RGBA").save(buffer, "PNG")
    return buffer.getvalue()
