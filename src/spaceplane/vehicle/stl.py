"""A user's body from an STL file, checked before anything is computed with it."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np

from spaceplane.errors import InputError
from spaceplane.vehicle.surface import Surface
from spaceplane.vehicle.validity import edge_faults

BODY = "body"
WELD_TOLERANCE = 1e-6  # of the body's size; STL stores 32-bit floats, good to 1e-7


def read_stl(path: str | Path, scale: float = 1.0, by_solid: bool = False) -> Surface:
    """Read a binary or ASCII STL file as one closed body with the single part `body`, or one part for each solid.

    STL has no unit: coordinates are taken as metres times `scale` (0.001 for a file in millimetres), in axes x aft,
    y right, z up. Equal corners are welded; triangles without area after that are dropped; a body that is inside out
    is turned.

    Args:
        path: the file.
        scale: metres per unit of the file.
        by_solid: make the solids of an ASCII file parts by their names; those without one are `body`.

    Returns:
        Closed, consistently oriented surface with outward normals; several separate closed pieces are accepted.

    Raises:
        InputError: file missing, unreadable, empty, damaged, not finite, not watertight (with the number of open edges
            and the place of the first), inconsistently oriented, or without volume.
    """
    path = Path(path)
    if not np.isfinite(scale) or scale <= 0:
        raise InputError(f"scale = {scale}: must be a positive number, metres per unit of the STL file")
    try:
        data = path.read_bytes()
    except FileNotFoundError as err:
        raise InputError(f"STL file '{path}': does not exist") from err
    except OSError as err:
        raise InputError(f"STL file '{path}': cannot be read ({err.strerror})") from err
    corners = _corners(path, data).astype(float) * scale
    if not len(corners):
        raise InputError(f"STL file '{path}': holds no triangles")
    if not np.isfinite(corners).all():
        raise InputError(f"STL file '{path}': coordinates must be finite numbers")
    points, triangles, kept = weld(corners)
    if not len(triangles):
        raise InputError(f"STL file '{path}': all triangles are without area")
    _require_closed(path, points, triangles)
    names, part = _solids(data, len(corners)) if by_solid else ((BODY,), np.zeros(len(corners), np.int32))
    return _outward(path, Surface(points, triangles, part[kept], names))


def _solids(data: bytes, count: int) -> tuple[tuple[str, ...], np.ndarray]:
    """Names of an ASCII file's solids, and the one that each of its `count` facets is of."""
    _, *rest = re.split(rb"^[ \t]*solid\b[ \t]*([^\r\n]*)", data, flags=re.IGNORECASE | re.MULTILINE)
    facets = [len(re.findall(rb"endfacet", text, flags=re.IGNORECASE)) for text in rest[1::2]]
    if sum(facets) != count:  # binary
        return (BODY,), np.zeros(count, np.int32)
    of_solid = [name.decode("utf-8", "replace").strip() or BODY for name in rest[::2]]
    names = tuple(dict.fromkeys(name for name, n in zip(of_solid, facets, strict=True) if n))
    of_facet = [names.index(name) for name, n in zip(of_solid, facets, strict=True) for _ in range(n)]
    return names, np.array(of_facet, np.int32)


def _corners(path: Path, data: bytes) -> np.ndarray:
    """[triangle, corner, xyz] of a binary or ASCII file; told apart by the length a binary file must have."""
    if not data.strip():
        raise InputError(f"STL file '{path}': is empty")
    count = struct.unpack("<I", data[80:84])[0] if len(data) >= 84 else -1
    if len(data) == 84 + 50 * count:
        records = np.frombuffer(data, dtype=_RECORD, offset=84, count=count)
        return records["corners"]
    if data.lstrip()[:5].lower() == b"solid":
        return _ascii_corners(path, data)
    expected = f"{84 + 50 * count} bytes for its {count} triangles" if count >= 0 else "at least 84 bytes"
    raise InputError(f"STL file '{path}': neither ASCII nor whole binary STL ({len(data)} bytes, expected {expected})")


_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def _ascii_corners(path: Path, data: bytes) -> np.ndarray:
    found = re.findall(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", data, flags=re.IGNORECASE)
    if len(found) % 3 or len(found) != 3 * len(re.findall(rb"endfacet", data, flags=re.IGNORECASE)):
        raise InputError(f"STL file '{path}': damaged, {len(found)} vertices do not make whole facets")
    try:
        return np.array([[float(x) for x in vertex] for vertex in found]).reshape(-1, 3, 3)
    except ValueError as err:
        raise InputError(f"STL file '{path}': damaged, a coordinate is not a number ({err})") from err


def weld(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Merge corners closer than `WELD_TOLERANCE` times the body's size and drop triangles that lose their area by it.

    Args:
        corners: [triangle, corner, xyz], m.

    Returns:
        points [vertex, xyz], triangles [triangle, 3], and [triangle of `corners`] bool, which were kept.
    """
    flat = corners.reshape(-1, 3)
    points, index = np.unique(flat, axis=0, return_inverse=True)
    index = index.ravel()
    size = float(np.ptp(flat, axis=0).max())
    if size > 0:
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import connected_components
        from scipy.spatial import cKDTree

        pairs = cKDTree(points).query_pairs(WELD_TOLERANCE * size, output_type="ndarray")
        if len(pairs):
            graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
            label = connected_components(graph, directed=False)[1]
            _, first = np.unique(label, return_index=True)
            points, index = points[first], label[index]
    triangles = index.reshape(-1, 3).astype(np.int64)
    t = triangles
    keep = (t[:, 0] != t[:, 1]) & (t[:, 1] != t[:, 2]) & (t[:, 2] != t[:, 0])
    used, compact = np.unique(t[keep], return_inverse=True)
    return points[used], compact.reshape(-1, 3).astype(np.int64), keep


def _require_closed(path: Path, points: np.ndarray, triangles: np.ndarray) -> None:
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    open_edges, crowded = unique[count == 1], unique[(count > 2) & (count % 2 == 1)]
    for name, bad in (("open", open_edges), ("shared by an odd number of triangles", crowded)):
        if len(bad):
            x, y, z = points[bad[0]].mean(axis=0)
            raise InputError(
                f"STL file '{path}': not watertight, {len(bad)} edges {name}, "
                f"the first near x = {x:.3f}, y = {y:.3f}, z = {z:.3f} m"
            )
    unpaired, _ = edge_faults(triangles)
    directed = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    forward = directed[:, 0] < directed[:, 1]
    key, inverse = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True)
    balance = np.bincount(inverse.ravel(), np.where(forward, 1, -1), minlength=len(key))
    wrong = key[balance != 0]
    if len(wrong) or len(unpaired):
        x, y, z = points[(wrong if len(wrong) else unpaired)[0]].mean(axis=0)
        raise InputError(
            f"STL file '{path}': {max(len(wrong), len(unpaired))} edges between triangles of opposite orientation, "
            f"the first near x = {x:.3f}, y = {y:.3f}, z = {z:.3f} m"
        )


def _outward(path: Path, surface: Surface) -> Surface:
    size = float(np.ptp(surface.points, axis=0).max())
    if abs(surface.volume) < 1e-12 * size**3:
        raise InputError(f"STL file '{path}': encloses no volume")
    if surface.volume < 0:
        turned = np.ascontiguousarray(surface.triangles[:, ::-1])
        surface = Surface(surface.points, turned, surface.part, surface.part_names)
    return surface
