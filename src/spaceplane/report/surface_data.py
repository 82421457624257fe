"""The coloured surface packed small enough to travel inside the report."""

from __future__ import annotations

import base64
import gzip
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spaceplane.errors import InputError

CREASE_COSINE = np.cos(np.radians(32.0))  # edges sharper than this keep their corner in the shading
FIELD_PREFIX = "Cp_"

PART_COLOURS = {
    "fuselage": "#c9ced6",
    "nose": "#9aa7b8",
    "wing_left": "#aeb9c7",
    "wing_right": "#aeb9c7",
    "winglet_left": "#7f93ad",
    "winglet_right": "#7f93ad",
    "elevon_left": "#f28e2b",
    "elevon_right": "#f28e2b",
    "rudder_left": "#e15759",
    "rudder_right": "#e15759",
    "body_flap": "#3fa796",
}
OTHER_COLOURS = ("#b5bcc8", "#edc948", "#b07aa1", "#76b7b2", "#59a14f")


@dataclass(frozen=True)
class ColouredSurface:
    """A triangulated surface with Cp for every flight point.

    Attributes:
        points: [vertex, xyz] m, geometry axes.
        triangles: [triangle, 3] vertex indices.
        part: [triangle] index into `part_names`.
        part_names: names of the parts.
        cp: {flight point name: [triangle] pressure coefficient}.
    """

    points: np.ndarray
    triangles: np.ndarray
    part: np.ndarray
    part_names: tuple[str, ...]
    cp: dict[str, np.ndarray]


def read_surface(path: Path) -> ColouredSurface:
    """Read a `surface.vtp` with `Cp_<flight point>` and `part` on its triangles (or vertices).

    Raises:
        InputError: missing or unreadable file, or one without triangles.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    import pyvista
    from vtkmodules.vtkCommonCore import vtkObject

    shown = vtkObject.GetGlobalWarningDisplay()
    vtkObject.SetGlobalWarningDisplay(0)  # what is wrong with the file is said below, on one line
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            body = pyvista.read(path)
    finally:
        vtkObject.SetGlobalWarningDisplay(shown)
    if not isinstance(body, pyvista.PolyData) or body.n_cells == 0:
        raise InputError(f"{path}: damaged or empty, not a surface of triangles")
    if not body.is_all_triangles:
        body = body.triangulate()
    triangles = np.asarray(body.faces).reshape(-1, 4)[:, 1:].astype(np.int64)
    cp = {}
    for name in body.cell_data:
        if name.startswith(FIELD_PREFIX):
            cp[name[len(FIELD_PREFIX) :]] = np.asarray(body.cell_data[name], float)
    for name in body.point_data:
        if name.startswith(FIELD_PREFIX) and name[len(FIELD_PREFIX) :] not in cp:
            cp[name[len(FIELD_PREFIX) :]] = np.asarray(body.point_data[name], float)[triangles].mean(axis=1)
    part, names = _parts(body, triangles)
    return ColouredSurface(np.asarray(body.points, float), triangles, part, names, cp)


def _parts(body, triangles: np.ndarray) -> tuple[np.ndarray, tuple[str, ...]]:
    if "part" in body.cell_data:
        tags = np.asarray(body.cell_data["part"])
    elif "part" in body.point_data:
        tags = np.asarray(body.point_data["part"])[triangles[:, 0]]
    else:
        return np.zeros(len(triangles), np.int64), ("body",)
    if tags.dtype.kind in "US":
        names, index = np.unique(tags.astype(str), return_inverse=True)
        return index, tuple(names)
    listed = next((k for k in ("part_names", "part_name") if k in body.field_data), None)
    if listed:
        names = tuple(str(n) for n in body.field_data[listed])
    else:
        names = tuple(f"part {k}" for k in range(int(tags.max()) + 1))
    return tags.astype(np.int64), names


@dataclass(frozen=True)
class ShadedMesh:
    """Vertices split where the surface has a crease or changes part, ready to be drawn.

    Attributes:
        points: [vertex, xyz] m; normals: [vertex, xyz] unit; part: [vertex]; triangles: [triangle, 3].
        cp: {flight point: [vertex]} area-weighted mean of the triangles around.
    """

    points: np.ndarray
    normals: np.ndarray
    part: np.ndarray
    triangles: np.ndarray
    cp: dict[str, np.ndarray]


def shade(surface: ColouredSurface) -> ShadedMesh:
    """Split vertices at creases and part borders and average normals and Cp around each."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    points, triangles = _weld(surface.points, surface.triangles)
    keep = (
        (triangles[:, 0] != triangles[:, 1])
        & (triangles[:, 1] != triangles[:, 2])
        & (triangles[:, 2] != triangles[:, 0])
    )
    triangles, part = triangles[keep], surface.part[keep]
    c = points[triangles]
    vectors = 0.5 * np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])
    areas = np.linalg.norm(vectors, axis=1)
    normals = vectors / np.maximum(areas, 1e-30)[:, None]

    # Corners (triangle, k) are joined across an edge when it is smooth and within one part.
    count = len(triangles)
    tail = triangles.ravel()
    head = np.roll(triangles, -1, axis=1).ravel()
    key = np.minimum(tail, head) * (len(points) + 1) + np.maximum(tail, head)
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order][1:] == key[order][:-1])
    a, b = order[same], order[same + 1]
    ta, tb = a // 3, b // 3
    tiny = np.minimum(areas[ta], areas[tb]) < 1e-8
    smooth = ((np.einsum("ij,ij->i", normals[ta], normals[tb]) > CREASE_COSINE) | tiny) & (part[ta] == part[tb])
    a, b, ta, tb = a[smooth], b[smooth], ta[smooth], tb[smooth]
    a_next, b_next = ta * 3 + (a % 3 + 1) % 3, tb * 3 + (b % 3 + 1) % 3
    crosses = tail[a] == head[b]  # the two half-edges run against each other
    rows = np.concatenate([a, a_next])
    columns = np.concatenate([np.where(crosses, b_next, b), np.where(crosses, b, b_next)])
    graph = coo_matrix((np.ones(len(rows), np.int8), (rows, columns)), shape=(3 * count, 3 * count))
    vertices, group = connected_components(graph, directed=False)

    weight = np.repeat(areas, 3)
    total = np.bincount(group, weight, vertices) + 1e-30
    normal = np.stack([np.bincount(group, np.repeat(vectors[:, k], 3), vertices) for k in range(3)], axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-30)[:, None]
    where = np.empty((vertices, 3))
    where[group] = points[tail]
    tags = np.empty(vertices, np.int64)
    tags[group] = np.repeat(part, 3)
    cp = {}
    for name, values in surface.cp.items():
        values = np.nan_to_num(values[keep])
        cp[name] = np.bincount(group, weight * np.repeat(values, 3), vertices) / total
    return ShadedMesh(where, normal, tags, group.reshape(-1, 3), cp)


def _weld(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Join vertices that lie within a tenth of a millimetre of each other (on a grid of that width)."""
    _, first, inverse = np.unique(
        np.round(points * 1e4).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    return points[first], inverse.reshape(-1)[triangles]


def cp_range(values: np.ndarray) -> tuple[float, float]:
    """Colour range: the middle 99 % of the surface, so that one hot spot does not hide the rest."""
    low, high = np.quantile(values, [0.004, 0.996])
    if high - low < 1e-6:
        low, high = low - 0.05, high + 0.05
    return float(low), float(high)


def pack(surface: ColouredSurface) -> dict:
    """JSON-ready record for the viewer: quantised, compressed and base64-coded vertex buffers."""
    mesh = shade(surface)
    lower, upper = mesh.points.min(axis=0), mesh.points.max(axis=0)
    extent = np.maximum(upper - lower, 1e-9)
    order = _draw_order(mesh)
    position = np.round((mesh.points - lower) / extent * 65535).astype(np.uint16)
    vertices = np.zeros((len(position), 4), np.uint16)
    vertices[:, :3] = position
    normal = np.zeros((len(position), 4), np.int8)
    normal[:, :3] = np.round(mesh.normals * 127)
    normal[:, 3] = np.minimum(mesh.part, 127)
    fields = []
    for name, values in mesh.cp.items():
        low, high = cp_range(values)
        least, most = float(values.min()), float(values.max())
        steps = np.round((values - least) / max(most - least, 1e-12) * 65535).astype(np.uint16)
        fields.append({"name": name, "low": low, "high": high, "least": least, "most": most, "data": _code(steps)})
    spare = iter(OTHER_COLOURS * 8)
    colours = [PART_COLOURS.get(name) or next(spare) for name in surface.part_names]
    return {
        "lower": lower.tolist(),
        "upper": upper.tolist(),
        "vertices": _code(vertices),
        "normals": _code(normal),
        "triangles": _code(mesh.triangles[order].astype(np.uint32)),
        "triangle_count": len(mesh.triangles),
        "fields": fields,
        "parts": [{"name": n, "colour": c} for n, c in zip(surface.part_names, colours, strict=True)],
    }


def _draw_order(mesh: ShadedMesh) -> np.ndarray:
    """Triangles sorted by their first vertex: neighbours in the buffer compress better."""
    return np.argsort(mesh.triangles.min(axis=1), kind="stable")


def _code(array: np.ndarray) -> str:
    return base64.b64encode(gzip.compress(np.ascontiguousarray(array).tobytes(), 6, mtime=0)).decode()
