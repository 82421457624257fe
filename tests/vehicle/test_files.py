"""STL in and out, GLB, PNG and STEP files."""

import json
import struct
import sys

import numpy as np
import pytest

from spaceplane.errors import InputError
from spaceplane.vehicle import export
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.shape import ShapeParameters
from spaceplane.vehicle.step import write_step
from spaceplane.vehicle.stl import read_stl
from spaceplane.vehicle.surface import Surface

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
CUBE_TRIANGLES = np.array(
    [t for a, b, c, d in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
     for t in ((a, b, c), (a, c, d))]
)  # fmt: skip


def ascii_stl(corners: np.ndarray) -> str:
    facets = [
        "facet normal 0 0 0\n outer loop\n"
        + "".join(f"  vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in triangle)
        + " endloop\nendfacet\n"
        for triangle in corners
    ]
    return "solid test\n" + "".join(facets) + "endsolid test\n"


@pytest.fixture(scope="module")
def vehicle() -> Surface:
    return build(ShapeParameters(), ControlDeflections.from_degrees(elevon_left=-20, rudder_right=30), spacing=0.25)


def test_stl_round_trip_keeps_body(tmp_path, vehicle):
    surface = read_stl(export.write_stl(vehicle, tmp_path / "new" / "body.stl"))
    assert surface.part_names == ("body",)
    assert surface.volume == pytest.approx(vehicle.volume, rel=1e-6)
    assert surface.area == pytest.approx(vehicle.area, rel=1e-6)
    assert np.allclose(surface.bounds, vehicle.bounds, atol=1e-5)


def test_ascii_with_other_units_and_inside_out(tmp_path):
    path = tmp_path / "cube.stl"
    for order in (slice(None), slice(None, None, -1)):
        path.write_text(ascii_stl(1000 * CUBE[CUBE_TRIANGLES[:, order]]))
        surface = read_stl(path, scale=0.001)
        assert surface.volume == pytest.approx(1.0)
        assert len(surface.points) == 8 and len(surface.triangles) == 12


def test_corners_apart_by_rounding_are_welded(tmp_path):
    path = tmp_path / "cube.stl"
    noise = np.random.default_rng(0).uniform(-1e-8, 1e-8, (12, 3, 3))
    path.write_text(ascii_stl(CUBE[CUBE_TRIANGLES] + noise))
    assert len(read_stl(path).points) == 8


def test_solids_of_an_ascii_file_are_parts_where_asked_for(tmp_path):
    """A sliver without area, dropped, does not shift the parts of what follows."""
    sliver = CUBE[[[0, 0, 1]]]
    corners = np.concatenate([sliver, CUBE[CUBE_TRIANGLES]])
    first, second, third = (ascii_stl(corners[k]) for k in (slice(0, 3), slice(3, 5), slice(5, None)))
    named = first.replace("test", "fore wing") + second.replace("solid test", "solid") + third.replace("test", "tail")
    (path := tmp_path / "cube.stl").write_text(named)
    surface = read_stl(path, by_solid=True)
    assert surface.part_names == ("fore wing", "body", "tail")
    assert np.bincount(surface.part).tolist() == [2, 2, 8]
    assert np.allclose(surface.area_vectors[surface.part == 0].sum(axis=0), [-1, 0, 0])
    assert read_stl(path).part_names == ("body",)
    assert read_stl(export.write_stl(surface, tmp_path / "b.stl"), by_solid=True).part_names == ("body",)


def bad_files() -> dict[str, tuple[bytes, str]]:
    cube = CUBE[CUBE_TRIANGLES]
    one_turned = CUBE_TRIANGLES.copy()
    one_turned[0] = one_turned[0, ::-1]
    flat = np.concatenate([cube[:1], cube[:1, ::-1]])
    return {
        "empty": (b"", "is empty"),
        "no_triangles": (b"solid a\nendsolid a\n", "holds no triangles"),
        "hole": (ascii_stl(cube[1:]).encode(), r"not watertight, 3 edges open, the first near x = "),
        "turned": (ascii_stl(CUBE[one_turned]).encode(), "3 edges between triangles of opposite orientation"),
        "nan": (ascii_stl(cube).replace("vertex 1 1 1", "vertex nan 1 1", 1).encode(), "must be finite"),
        "word": (ascii_stl(cube).replace("vertex 1 1 1", "vertex one 1 1", 1).encode(), "not a number"),
        "cut_ascii": (ascii_stl(cube)[:-120].encode(), "damaged"),
        "flat": (ascii_stl(flat).encode(), "encloses no volume"),
        "cut_binary": (b"x" * 80 + struct.pack("<I", 12) + b"\0" * 100, "expected 684 bytes for its 12 triangles"),
        "short": (b"abc", "neither ASCII nor whole binary"),
        "fin": (ascii_stl(np.concatenate([cube, [[[0, 0, 0], [0, 0, 1], [-1, 0, 0]]]])).encode(), "not watertight"),
    }


@pytest.mark.parametrize("case", sorted(bad_files()))
def test_bad_stl_is_refused_in_one_line(tmp_path, case):
    content, message = bad_files()[case]
    path = tmp_path / f"{case}.stl"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        read_stl(path)
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


def test_missing_file_and_bad_scale(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        read_stl(tmp_path / "none.stl")
    with pytest.raises(InputError, match="cannot be read"):
        read_stl(tmp_path)
    with pytest.raises(InputError, match="scale = -1"):
        read_stl(tmp_path / "none.stl", scale=-1)


def test_glb_holds_every_part_by_name(tmp_path, vehicle):
    data = export.write_glb(vehicle, tmp_path / "a.glb").read_bytes()
    magic, version, size = struct.unpack("<4sII", data[:12])
    length = struct.unpack("<I", data[12:16])[0]
    document = json.loads(data[20 : 20 + length])
    assert (magic, version, size) == (b"glTF", 2, len(data))
    assert {n["name"] for n in document["nodes"]} == set(vehicle.part_names)
    indices = [document["accessors"][m["primitives"][0]["indices"]]["count"] for m in document["meshes"]]
    assert sum(indices) == 3 * len(vehicle.triangles)


def test_glb_opens_in_another_library_with_the_same_volume(tmp_path, vehicle):
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.load(export.write_glb(vehicle, tmp_path / "a.glb"))
    assert set(scene.geometry) == set(vehicle.part_names)
    whole = trimesh.util.concatenate(list(scene.geometry.values()))
    assert whole.volume == pytest.approx(vehicle.volume, rel=1e-4)  # turned, not mirrored: still positive
    assert whole.bounds[1, 2] == pytest.approx(0.0, abs=1e-5)  # the nose looks along +z


def test_png_shows_flaps_in_their_colours(tmp_path, vehicle):
    from matplotlib.image import imread

    path = export.write_png(vehicle, tmp_path / "a.png", ["top"], (600, 400))
    pixels = imread(path)[..., :3]
    assert pixels.shape == (400, 600, 3)
    orange = (pixels[..., 0] > 0.5) & (pixels[..., 2] < 0.2) & (pixels[..., 1] > 0.15)
    blue = (pixels[..., 2] > 0.5) & (pixels[..., 0] < 0.2)
    assert orange.sum() > 150 and blue.sum() > 150


def test_unknown_view_is_refused(tmp_path, vehicle):
    with pytest.raises(InputError, match="view 'inside'"):
        export.write_png(vehicle, tmp_path / "a.png", ["inside"])


def test_unwritable_outputs_are_refused(tmp_path, vehicle):
    (tmp_path / "file").write_text("in the way")
    for write, suffix in ((export.write_stl, "stl"), (export.write_glb, "glb"), (export.write_png, "png")):
        with pytest.raises(InputError, match="cannot be written"):
            write(vehicle, tmp_path / "file" / f"a.{suffix}")
        with pytest.raises(InputError, match=f"must end in .{suffix}"):
            write(vehicle, tmp_path / "a.txt")


def test_step_without_the_extra_says_how_to_get_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "OCP", None)
    with pytest.raises(InputError, match=r"pip install 'spaceplane\[step\]'"):
        write_step(ShapeParameters(), None, tmp_path / "a.step")
    assert not list(tmp_path.iterdir())


def test_step_holds_every_solid_by_name(tmp_path):
    pytest.importorskip("OCP")
    text = write_step(ShapeParameters(), None, tmp_path / "a.step").read_text()
    for name in ("fuselage", "wing_left", "wing_right", "elevon_left", "rudder_right", "body_flap"):
        assert f"PRODUCT('{name}'" in text
    assert text.count("MANIFOLD_SOLID_BREP") >= 8
