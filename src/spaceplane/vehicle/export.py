"""Files from a surface: STL, GLB with named parts, PNG views."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from spaceplane.errors import InputError
from spaceplane.vehicle.appearance import VIEWS, part_colour
from spaceplane.vehicle.surface import Surface


def prepare_output(path: str | Path, suffix: str) -> Path:
    """Make the parent folder and check that a file can be written there.

    Raises:
        InputError: wrong suffix, a folder of that name, or not writable.
    """
    path = Path(path)
    if path.suffix.lower() != suffix:
        raise InputError(f"output file '{path}': must end in {suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        new = not path.exists()
        with path.open("ab"):
            pass
        if new:  # a later failure must not leave an empty file behind
            path.unlink()
    except OSError as err:
        raise InputError(f"output file '{path}': cannot be written ({err.strerror})") from err
    return path


def write_stl(surface: Surface, path: str | Path) -> Path:
    """Binary STL in metres; part tags are lost.

    Raises:
        InputError: the file cannot be written.
    """
    path = prepare_output(path, ".stl")
    areas = surface.area_vectors
    length = np.linalg.norm(areas, axis=1, keepdims=True)
    records = np.zeros(len(surface.triangles), dtype=[("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")])
    records["n"] = areas / np.maximum(length, 1e-300)
    records["c"] = surface.corners
    header = b"spaceplane, metres, x aft, y right, z up".ljust(80)
    path.write_bytes(header + struct.pack("<I", len(records)) + records.tobytes())
    return path


def write_glb(surface: Surface, path: str | Path) -> Path:
    """Binary glTF 2.0 with one named, coloured mesh per part.

    glTF has y up and its front towards +z: x aft, y right, z up becomes -z, -x and y, a turn, not a mirror image.

    Raises:
        InputError: the file cannot be written.
    """
    path = prepare_output(path, ".glb")
    blob = bytearray()
    views: list[dict] = []
    accessors: list[dict] = []
    nodes: list[dict] = []
    meshes: list[dict] = []
    materials: list[dict] = []

    def add(array: np.ndarray, target: int, kind: str, component: int, bounds: bool = False) -> int:
        """Append an array to the buffer, aligned; the index of its accessor."""
        while len(blob) % 4:
            blob.append(0)
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": array.nbytes, "target": target})
        accessor = {"bufferView": len(views) - 1, "componentType": component, "count": len(array), "type": kind}
        if bounds:
            accessor |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
        accessors.append(accessor)
        blob.extend(array.tobytes())
        return len(accessors) - 1

    for i, name in enumerate(surface.part_names):
        chosen = surface.part == i
        if not chosen.any():
            continue
        used, local = np.unique(surface.triangles[chosen], return_inverse=True)
        points = np.ascontiguousarray((surface.points[used][:, [1, 2, 0]] * [-1.0, 1.0, -1.0]).astype("<f4"))
        positions = add(points, 34962, "VEC3", 5126, bounds=True)
        indices = add(local.ravel().astype("<u4"), 34963, "SCALAR", 5125)
        primitive = {"attributes": {"POSITION": positions}, "indices": indices, "material": len(materials)}
        colour = [*part_colour(name), 1.0]
        materials.append({"name": name, "pbrMetallicRoughness": {"baseColorFactor": colour, "roughnessFactor": 0.6}})
        meshes.append({"name": name, "primitives": [primitive]})
        nodes.append({"name": name, "mesh": len(meshes) - 1})
    while len(blob) % 4:
        blob.append(0)
    document = {
        "asset": {"version": "2.0", "generator": "spaceplane"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(blob)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(blob)
    path.write_bytes(
        struct.pack("<4sII", b"glTF", 2, size)
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(blob), b"BIN\0")
        + bytes(blob)
    )
    return path


DEFAULT_VIEWS = ("perspective", "top", "side", "front")


def write_png(
    surface: Surface, path: str | Path, views: Sequence[str] = DEFAULT_VIEWS, size: tuple[int, int] = (1600, 1040)
) -> Path:
    """A picture of one or several views with the parts in their colours.

    Args:
        surface: what to draw.
        path: file that ends in .png.
        views: names from `VIEWS`; more than one share the picture.
        size: width and height of the picture, pixels.

    Raises:
        InputError: unknown view, file not writable, or no means to render on this machine.
    """
    unknown = [v for v in views if v not in VIEWS]
    if unknown or not views:
        raise InputError(f"view '{', '.join(unknown)}': must be among {', '.join(VIEWS)}")
    path = prepare_output(path, ".png")
    try:
        import pyvista
    except ImportError as err:
        raise InputError(
            f"output file '{path}': pictures need pyvista and the system's OpenGL library ({err})"
        ) from err
    from spaceplane.vehicle.pictures import draw

    try:
        draw(pyvista, surface, path, tuple(views), size)
    except RuntimeError as err:
        raise InputError(f"output file '{path}': no off-screen rendering on this machine ({err})") from err
    return path
