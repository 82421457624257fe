"""The surface that travels inside the report."""

from __future__ import annotations

import base64
import gzip
import io

import numpy as np
import pytest

from spaceplane.errors import InputError
from spaceplane.report.picture import stills
from spaceplane.report.surface_data import ColouredSurface, pack, read_surface, shade

from .example_result import PARTS, lifting_body


def cube() -> ColouredSurface:
    """Unit cube of twelve triangles without shared vertices, its top another part; Cp is the face's number."""
    quads = [
        ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)), ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
        ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)), ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)),
        ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)), ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)),
    ]  # fmt: skip
    corners = np.array([[q[0], q[1], q[2], q[0], q[2], q[3]] for q in quads], float).reshape(-1, 3)
    part = np.repeat([0, 1, 0, 0, 0, 0], 2)
    return ColouredSurface(
        corners, np.arange(36).reshape(-1, 3), part, ("side", "top"), {"M": np.repeat(np.arange(6.0), 2)}
    )


def unpack(text: str, dtype: type, columns: int) -> np.ndarray:
    return np.frombuffer(gzip.decompress(base64.b64decode(text)), dtype).reshape(-1, columns)


def test_creases_keep_their_corners():
    mesh = shade(cube())
    assert len(mesh.points) == 24  # four for each face: nothing is averaged over an edge of the cube
    assert np.abs(mesh.normals).max(axis=1) == pytest.approx(1.0)
    assert sorted(mesh.cp["M"]) == pytest.approx(np.repeat(np.arange(6.0), 4))


def test_smooth_surfaces_share_vertices_and_normals_point_out():
    points, triangles, part = lifting_body(40, 48)
    surface = ColouredSurface(points, triangles, part, PARTS, {})
    mesh = shade(surface)
    assert len(mesh.points) < 0.75 * len(triangles)
    c = mesh.points[mesh.triangles]
    flat = np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])
    outward = np.einsum("ij,ij->i", flat, mesh.normals[mesh.triangles[:, 0]]) > 0
    assert outward[np.linalg.norm(flat, axis=1) > 1e-6].all()


def test_packed_buffers_give_the_surface_back():
    surface = cube()
    packed = pack(surface)
    vertices = unpack(packed["vertices"], np.uint16, 4)
    triangles = unpack(packed["triangles"], np.uint32, 3)
    lower, upper = np.array(packed["lower"]), np.array(packed["upper"])
    points = lower + vertices[:, :3] / 65535 * (upper - lower)
    c = points[triangles]
    assert np.einsum("ij,ij->", c[:, 0], np.cross(c[:, 1], c[:, 2])) / 6 == pytest.approx(1.0)  # volume
    field = packed["fields"][0]
    values = field["least"] + unpack(field["data"], np.uint16, 1)[:, 0] / 65535 * (field["most"] - field["least"])
    assert sorted(set(values.round(3))) == pytest.approx(range(6))
    parts = unpack(packed["normals"], np.int8, 4)[:, 3]
    assert set(points[parts == 1][:, 2]) == {1.0}


def test_read_gives_parts_and_fields_back(out_dir):
    surface = read_surface(out_dir / "surface.vtp")
    assert surface.part_names == PARTS
    assert set(surface.cp) == {"Mach 0.8", "Mach 1.5", "Mach 2.5"}
    assert len(surface.cp["Mach 2.5"]) == len(surface.triangles) == len(surface.part)


def test_point_data_and_missing_parts_are_read(tmp_path):
    import pyvista

    sphere = pyvista.Sphere()
    sphere.point_data["Cp_Mach 2"] = np.asarray(sphere.points)[:, 0]
    sphere.save(tmp_path / "surface.vtp")
    surface = read_surface(tmp_path / "surface.vtp")
    assert surface.part_names == ("body",)
    assert surface.cp["Mach 2"] == pytest.approx(surface.points[surface.triangles].mean(axis=1)[:, 0], abs=1e-6)


@pytest.mark.parametrize("content", [b"", b"no xml", b"<VTKFile></VTKFile>"])
def test_damaged_surface_is_named(tmp_path, content):
    path = tmp_path / "surface.vtp"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"surface\.vtp"):
        read_surface(path)


def test_stills_show_the_colours_of_the_field(out_dir):
    from PIL import Image

    surface = read_surface(out_dir / "surface.vtp")
    pictures = stills(surface, {"low": np.zeros(len(surface.triangles)), "cp": surface.cp["Mach 2.5"]})
    image = np.asarray(Image.open(io.BytesIO(pictures["cp"])))
    assert image.shape[2] == 4
    covered = image[..., 3] == 255
    assert 0.08 < covered.mean() < 0.7
    assert (image[..., 3] == 0).mean() > 0.2
    assert np.ptp(image[covered][:, 0].astype(int)) > 120  # from suction's blue to the stagnation point's red
