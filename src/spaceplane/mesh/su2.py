"""Reader of the native mesh format of SU2 (.su2)."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np

from spaceplane.errors import InputError
from spaceplane.mesh.elements import CORNERS, Elements

# Element types of VTK, which the format uses.
_CELLS = {10: "tetra", 12: "hexahedron", 13: "wedge", 14: "pyramid"}
_SIDES = {5: "triangle", 9: "quad"}
_KEYWORD = re.compile(rb"^[ \t]*([A-Z_]+)[ \t]*=[ \t]*([^\r\n%]*)[^\n]*\n?", re.MULTILINE)


def read_su2(path: str | Path) -> Elements:
    """Points, elements and markers of a three-dimensional SU2 mesh.

    Coordinates are taken as metres in axes x aft, y right, z up. Comments (%) and the optional number that ends a line
    are skipped; markers of the same name are joined.

    Args:
        path: the file.

    Raises:
        InputError: a file that is empty, damaged, two-dimensional or in several zones, or has elements of other kinds
            than tetrahedra, hexahedra, prisms and pyramids.

    Source: SU2 documentation, "Mesh File", su2code.github.io/docs_v7/Mesh-File.
    """
    data = Path(path).read_bytes()
    file = _File(path)
    if not data.strip():
        raise file.error("is empty")
    found = list(_KEYWORD.finditer(data))
    ends = [*(match.start() for match in found), len(data)][1:]
    sections = [(m[1].decode(), m[2].strip(), data[m.end() : end]) for m, end in zip(found, ends, strict=True)]
    first = {name: (value, block) for name, value, block in reversed(sections)}
    missing = [name for name in ("NDIME", "NELEM", "NPOIN", "NMARK") if name not in first]
    if missing:
        raise file.error(f"not an SU2 mesh, {' and '.join(missing)} missing")
    if "NZONE" in first and file.count("NZONE", first["NZONE"][0]) != 1:
        raise file.error(f"NZONE= {file.count('NZONE', first['NZONE'][0])}, allowed is one zone")
    dimensions = file.count("NDIME", first["NDIME"][0])
    if dimensions != 3:
        raise file.error(f"NDIME= {dimensions}, allowed is 3 (three dimensions)")
    points = file.points(file.count("NPOIN", first["NPOIN"][0]), first["NPOIN"][1])
    cells = file.connectivity("NELEM", file.count("NELEM", first["NELEM"][0]), first["NELEM"][1], _CELLS)
    return Elements(points, cells, _markers(file, sections, file.count("NMARK", first["NMARK"][0])))


def _markers(file: _File, sections: list[tuple[str, bytes, bytes]], expected: int) -> dict[str, np.ndarray]:
    """Marker -> [face, 4] corners."""
    faces: dict[str, list[np.ndarray]] = {}
    tags = 0
    name = ""
    for keyword, value, block in sections:
        if keyword == "MARKER_TAG":
            name = value.decode(errors="replace")
            tags += 1
        elif keyword == "MARKER_ELEMS":
            if not name:
                raise file.error("MARKER_ELEMS before the first MARKER_TAG")
            title = f"marker '{name}': MARKER_ELEMS"
            rows = file.connectivity(title, file.count(title, value), block, _SIDES)
            faces.setdefault(name, []).extend(padded(rows[kind]) for kind in rows)
    if tags != expected:
        raise file.error(f"NMARK= {expected}, but {tags} markers follow")
    none = np.zeros((0, 4), dtype=np.int64)
    return {marker: np.concatenate([none, *parts]) for marker, parts in faces.items()}


def padded(corners: np.ndarray) -> np.ndarray:
    """[face, 4] corners of triangles or quadrilaterals, -1 last for triangles."""
    return np.pad(corners, ((0, 0), (0, 4 - corners.shape[1])), constant_values=-1)


class _File:
    """Texts of one file as numbers, with its name in every complaint."""

    def __init__(self, path: str | Path):
        self.path = path

    def error(self, text: str) -> InputError:
        return InputError(f"SU2 file '{self.path}': {text}")

    def count(self, keyword: str, value: bytes) -> int:
        words = value.split()
        if not words or not words[0].isdigit():
            raise self.error(f"{keyword}= {value.decode(errors='replace')!r} is not a whole number")
        return int(words[0])

    def points(self, count: int, block: bytes) -> np.ndarray:
        """[point, xyz]; the number that may follow the coordinates is dropped."""
        values = self._numbers("NPOIN", block, float)
        if not count or len(values) not in (3 * count, 4 * count):
            raise self.error(f"NPOIN= {count}, but {len(values)} numbers follow (3 or 4 for each point are needed)")
        return np.ascontiguousarray(values.reshape(count, -1)[:, :3])

    def connectivity(self, keyword: str, count: int, block: bytes, kinds: dict[int, str]) -> dict[str, np.ndarray]:
        """Kind -> [element, corner] of a list of lines `type corners... [number]`."""
        block = _without_comments(block).strip()
        # A negative number marks the ends of lines, so that all are read at once.
        values = self._numbers(keyword, block.replace(b"\n", b" -1 ") + b" -1", np.int64)
        end = np.flatnonzero(values == -1)
        start = np.concatenate([[0], end[:-1] + 1])
        length = end - start
        start, length = start[length > 0], length[length > 0]
        if len(start) != count:
            raise self.error(f"{keyword}= {count}, but {len(start)} lines follow")
        types = values[start]
        strange = ~np.isin(types, list(kinds))
        if strange.any():
            allowed = ", ".join(f"{number} ({name})" for number, name in kinds.items())
            raise self.error(f"{keyword}: {strange.sum()} of type {types[strange][0]}, allowed are the types {allowed}")
        result, whole = {}, np.zeros(count, dtype=bool)
        for number, kind in kinds.items():
            corners = CORNERS[kind]
            own = (types == number) & ((length == corners + 1) | (length == corners + 2))
            whole |= own
            if own.any():
                result[kind] = values[start[own][:, None] + 1 + np.arange(corners)]
        if not whole.all():
            raise self.error(f"{keyword}: {(~whole).sum()} lines have too few or too many numbers for their type")
        return result

    def _numbers(self, keyword: str, block: bytes, kind: type) -> np.ndarray:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # numpy only warns of text that is no number
            try:
                return np.fromstring(_without_comments(block), dtype=kind, sep=" ")
            except (ValueError, DeprecationWarning) as err:
                raise self.error(f"{keyword}: damaged, something that is not a number stands in its list") from err


def _without_comments(block: bytes) -> bytes:
    return re.sub(rb"%[^\n]*", b"", block) if b"%" in block else block
