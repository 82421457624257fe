"""Body-fitted meshes from files: exact integrals, both formats, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from spaceplane.errors import InputError
from spaceplane.mesh.elements import Elements
from spaceplane.mesh.imported import build, read_mesh
from spaceplane.mesh.markers import assign, guessed

from .body_fitted import boundary, box, cone, mixed, write_msh, write_su2

KINDS = ("hexahedron", "tetra", "wedge", "pyramid")
ROLES = {"floor": "wall", "farfield": "far"}


def meshes() -> dict[str, Elements]:
    """A box of each kind, warped inside, and one of all kinds."""
    return {kind: box(kind) for kind in KINDS} | {"mixed": mixed()}


@pytest.mark.parametrize("name", [*KINDS, "mixed"])
def test_integrals_are_exact_with_warped_faces(name):
    mesh, surface = build(meshes()[name], ROLES)
    assert np.abs(mesh.closure()).max() < 1e-16
    assert (mesh.cell_volume > 0).all()
    assert mesh.cell_volume.sum() == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose(mesh.cell_volume @ mesh.cell_center, 0.5, atol=1e-14)
    np.testing.assert_allclose(mesh.wall_area.sum(axis=0), [0, 0, -1], atol=1e-15)
    np.testing.assert_allclose(mesh.far_area.sum(axis=0), [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(mesh.wall_center[:, 2], 0.0, atol=1e-15)
    # Seen from the air above it, the floor looks up.
    np.testing.assert_allclose(surface.area_vectors.sum(axis=0), [0, 0, 1], atol=1e-14)
    assert surface.area == pytest.approx(1.0, abs=1e-14)
    assert mesh.part_names == ("floor",) and mesh.record["warnings"] == []


def test_warped_faces_are_warped():
    """The boxes above would not test much if they were flat."""
    elements = box("hexahedron")
    corners = elements.points[elements.cells["hexahedron"][:, [0, 3, 2, 1]]]
    a, b, c, d = (corners[:, k] for k in range(4))
    lift = np.abs(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a))
    assert lift.max() > 0.05 * 0.25**3


def test_tetrahedra_have_their_centroids():
    elements = box("tetra")
    mesh, _ = build(elements, ROLES)
    corners = elements.points[elements.cells["tetra"]]
    np.testing.assert_allclose(mesh.cell_center, corners.mean(axis=1), atol=1e-15)
    edges = corners[:, 1:] - corners[:, :1]
    np.testing.assert_allclose(mesh.cell_volume, np.abs(np.linalg.det(edges)) / 6, atol=1e-16)


def test_faces_point_from_their_first_to_their_second_cell():
    mesh, _ = build(mixed(), ROLES)
    a, b = mesh.cell_center[mesh.face_cells.T]
    assert (np.einsum("ij,ij->i", b - a, mesh.face_area) > 0).all()
    assert mesh.face_cells.min() == 0 and mesh.face_cells.max() == mesh.cells - 1
    assert len(mesh.face_cells) == len(np.unique(np.sort(mesh.face_cells, axis=1), axis=0))


@pytest.mark.parametrize("name", [*KINDS, "mixed"])
def test_the_other_hand_is_turned(name):
    """Elements numbered left-handed, as VTK's wedges are, make the same mesh."""
    elements = meshes()[name]
    mirror = {
        "tetra": [0, 2, 1, 3],
        "hexahedron": [0, 3, 2, 1, 4, 7, 6, 5],
        "wedge": [0, 2, 1, 3, 5, 4],
        "pyramid": [0, 3, 2, 1, 4],
    }
    turned = replace(elements, cells={kind: c[:, mirror[kind]] for kind, c in elements.cells.items()})
    right, left = build(elements, ROLES)[0], build(turned, ROLES)[0]
    np.testing.assert_allclose(left.cell_volume, right.cell_volume, rtol=1e-13)
    np.testing.assert_allclose(left.cell_center, right.cell_center, atol=1e-14)
    np.testing.assert_allclose(left.wall_area.sum(axis=0), right.wall_area.sum(axis=0), atol=1e-15)
    assert np.abs(left.closure()).max() < 1e-16


def test_collapsed_hexahedra_are_prisms_and_pyramids():
    """A quarter of a cone of hexahedra whose faces at the apex have no area."""
    half, outer = np.radians([20.0, 38.0])
    mesh, _ = build(
        cone(6, 5, 4, half, outer)[0], dict.fromkeys(("cone", "sym_y", "sym_z"), "wall") | {"farfield": "far"}
    )
    polygon = 0.5 * 4 * np.sin(np.pi / 8)  # area of a quarter of the inscribed polygon, on the radius squared
    assert mesh.cell_volume.sum() == pytest.approx(polygon * (np.tan(outer) ** 2 - np.tan(half) ** 2) / 3, rel=1e-13)
    assert np.abs(mesh.closure()).max() < 1e-16


@pytest.mark.parametrize("name", [*KINDS, "mixed"])
def test_su2_round_trip(tmp_path, name):
    elements = meshes()[name]
    read = read_mesh(write_su2(elements, tmp_path / "box.su2"))
    assert read.roles == ROLES
    np.testing.assert_array_equal(read.elements.points, elements.points)
    for kind, corners in elements.cells.items():
        np.testing.assert_array_equal(read.elements.cells[kind], corners)
    for marker, faces in elements.boundary.items():
        order = np.argsort(faces[:, 3] >= 0, kind="stable")  # the reader has triangles first
        np.testing.assert_array_equal(read.elements.boundary[marker], faces[order])


@pytest.mark.parametrize("version", ["2.2", "2.2 binary", "4.1"])
@pytest.mark.parametrize("name", [*KINDS, "mixed"])
def test_gmsh_round_trip(tmp_path, name, version):
    elements = meshes()[name]
    read = read_mesh(write_msh(elements, tmp_path / "box.msh", version))
    direct, _ = build(elements, ROLES)
    assert read.roles == ROLES and read.mesh.cells == direct.cells
    assert read.mesh.cell_volume.sum() == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(np.sort(read.mesh.cell_volume), np.sort(direct.cell_volume), atol=1e-12)
    np.testing.assert_allclose(read.mesh.wall_area.sum(axis=0), [0, 0, -1], atol=1e-12)
    assert {m: len(f) for m, f in read.elements.boundary.items()} == {m: len(f) for m, f in elements.boundary.items()}


def test_planes_of_symmetry_are_walls_without_pieces():
    elements = box("hexahedron", name=lambda m: "hull" if m[2] < 1e-9 else "sym" if m[1] < 1e-9 else "far")
    mesh, surface = build(elements, assign(list(elements.boundary), {}))
    assert mesh.part_names == ("hull",) and surface.part_names == ("hull",)
    assert mesh.body_wall.sum() == 16 and (~mesh.body_wall).sum() == 16
    np.testing.assert_allclose(mesh.wall_area[~mesh.body_wall].sum(axis=0), [0, -1, 0], atol=1e-15)
    assert mesh.body_wall[mesh.piece_wall].all() and len(mesh.piece_wall) == 16
    assert mesh.record["symmetry_faces"] == 16 and mesh.record["markers"]["sym"]["role"] == "symmetry"
    assert mesh.record["markers"]["sym"]["area_m2"] == pytest.approx(1.0)


# Markers.


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("farfield", "far"), ("FarField", "far"), ("far_field_2", "far"), ("INLET", "far"), ("outlet.1", "far"),
        ("sym", "symmetry"), ("Symmetry", "symmetry"), ("symmetry-plane", "symmetry"), ("SYM1", "symmetry"),
        ("wing", "wall"), ("wing_far", "wall"), ("WALL", "wall"), ("3", "wall"), ("symbol", "wall"),
    ],
)  # fmt: skip
def test_usual_names_are_guessed(name, role):
    assert guessed(name) == role


def test_chosen_names_stop_the_guess():
    names = ["hull", "outer", "sym", "inlet"]
    assert assign(names, {}) == {"hull": "wall", "outer": "far", "sym": "symmetry", "inlet": "far"}
    assert assign(names, {"far": ["outer"]}) == {"hull": "wall", "outer": "far", "sym": "symmetry", "inlet": "wall"}
    assert assign(names, {"symmetry": ["hull"], "wall": ["sym"]})["hull"] == "symmetry"


@pytest.mark.parametrize(
    ("chosen", "words"),
    [
        ({"far": ["outr"]}, ["--far", "'outr'", "did you mean 'outer'"]),
        ({"symmetry": ["zzz"]}, ["--symmetry", "valid are hull, outer, base"]),
        ({"far": ["outer"], "symmetry": ["outer"]}, ["'outer' is given twice"]),
        ({"wall": ["hull"]}, ["--wall", "'base' is left over"]),
        ({"wall": ["hull", "base", "outer"]}, ["--far", "no far field"]),
        ({"symmetry": ["hull", "base"]}, ["--wall", "no wall"]),
    ],
)
def test_wrong_markers(chosen, words):
    with pytest.raises(InputError) as error:
        assign(["hull", "outer", "base"], chosen)
    assert all(word in str(error.value) for word in words), error.value


# Meshes that are none.


def refused(elements: Elements, *words: str) -> None:
    with pytest.raises(InputError) as error:
        build(elements, ROLES)
    assert all(word in str(error.value) for word in words), error.value
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("kind", KINDS)
def test_inverted_elements(kind):
    """A point moved through the elements beyond it."""
    elements = box(kind, warp=0.0)
    points = elements.points.copy()
    middle = np.argmin(np.linalg.norm(points - 0.5, axis=1))
    points[middle] += [0.6, 0.55, 0.5]
    refused(replace(elements, points=points), "both their elements on one side", "inverted", "near x = ")


def test_degenerate_elements():
    elements = box("tetra", warp=0.0)
    corners = elements.cells["tetra"].copy()
    corners[7, 3] = corners[7, 0]
    corners[9] = corners[9, 0]
    refused(replace(elements, cells={"tetra": corners}), "2 of 384 elements are degenerate, fewer than 4 faces")
    flat = box("pyramid", 1, 0.0)
    points = flat.points.copy()
    points[-1] = [0.5, 0.5, 0.0]  # the common top of the six, moved into the floor
    refused(replace(flat, points=points), "1 of 6 elements are degenerate, without volume", "z = 0")


def test_an_element_twice():
    elements = box("hexahedron")
    corners = elements.cells["hexahedron"]
    # Its three faces inside have three elements now; those on the boundary look like inner ones.
    refused(replace(elements, cells={"hexahedron": np.concatenate([corners, corners[:1]])}), "3 faces", "more than two")


def test_tangled_corners():
    elements = box("hexahedron")
    corners = elements.cells["hexahedron"].copy()
    corners[0, [1, 2]] = corners[0, [2, 1]]
    refused(replace(elements, cells={"hexahedron": corners}), "faces have corners", "different orders")


def test_points_twice():
    """Two halves that touch without sharing points."""
    one, two = box("hexahedron", 2, 0.0), box("hexahedron", 2, 0.0)
    cells = np.concatenate([one.cells["hexahedron"], two.cells["hexahedron"] + len(one.points)])
    points = np.concatenate([one.points, two.points + np.array([1.0, 0.0, 0.0])])
    faces = np.concatenate([f for f in one.boundary.values()] + [f + len(one.points) for f in two.boundary.values()])
    middle = points[faces].mean(axis=1)
    faces = faces[np.abs(middle[:, 0] - 1.0) > 1e-9]
    refused(
        Elements(points, {"hexahedron": cells}, {"floor": faces[:1], "farfield": faces[1:]}),
        "8 of 48 boundary faces have no marker", "9 points coincide", "merge", "x = 1,",
    )  # fmt: skip


def test_missing_markers():
    elements = box("hexahedron")
    short = elements.boundary | {"farfield": elements.boundary["farfield"][5:]}
    refused(replace(elements, boundary=short), "5 of 96 boundary faces have no marker", "near x = ")


def test_markers_inside_and_twice():
    elements = box("hexahedron")
    inner = elements.cells["hexahedron"][:3, [1, 2, 6, 5]]
    faces = elements.boundary["floor"]
    wrong = elements.boundary | {"floor": np.concatenate([faces, inner])}
    refused(replace(elements, boundary=wrong), "3 faces of floor are not on the boundary")
    double = elements.boundary | {"floor": np.concatenate([faces, elements.boundary["farfield"][:2]])}
    refused(replace(elements, boundary=double), "2 boundary faces have two markers")


def test_numbers_that_are_none():
    elements = box("hexahedron", 2)
    points = elements.points.copy()
    points[[3, 5], 1] = np.nan
    refused(replace(elements, points=points), "2 points", "finite")
    refused(replace(elements, points=elements.points[:-1]), "'hexahedron'", "do not exist", "26 points")
    refused(replace(elements, cells={}), "0 elements")


# Files that are none.


def read_refused(path, *words: str) -> None:
    with pytest.raises(InputError) as error:
        read_mesh(path)
    assert path.name in str(error.value)
    assert all(word in str(error.value) for word in words), error.value
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("ending", [".su2", ".msh"])
def test_empty_and_noisy_files(tmp_path, ending):
    path = tmp_path / f"m{ending}"
    path.write_bytes(b"")
    read_refused(path, "is empty")
    path.write_bytes(bytes(range(256)) * 40)
    read_refused(path)
    path.write_text("solid none\nendsolid none\n")
    read_refused(path)


def test_other_endings(tmp_path):
    path = tmp_path / "m.cgns"
    path.write_text("x")
    read_refused(path, ".su2 or .msh")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("NDIME= 3", "NDIME= 2", ["NDIME= 2", "three dimensions"]),
        ("NDIME= 3\n", "", ["NDIME missing"]),
        ("NDIME= 3", "NZONE= 2\nNDIME= 3", ["NZONE= 2", "one zone"]),
        ("NELEM= 8", "NELEM= 9", ["NELEM= 9", "8 lines"]),
        ("NELEM= 8", "NELEM= many", ["NELEM", "whole number"]),
        ("NPOIN= 27", "NPOIN= 28", ["NPOIN= 28", "108 numbers"]),
        ("NMARK= 2", "NMARK= 3", ["NMARK= 3", "2 markers"]),
        ("MARKER_TAG= floor\n", "", ["MARKER_ELEMS before"]),
        ("\n12 0", "\n24 0", ["1 of type 24", "12 (hexahedron)"]),
        ("\n12 0", "\n10 0", ["1 lines have too few or too many numbers"]),
        ("\n12 0", "\n12 x", ["NELEM", "not a number"]),
        ("0.5", "half", ["NPOIN", "not a number"]),
    ],
)
def test_damaged_su2(tmp_path, old, new, words):
    path = write_su2(box("hexahedron", 2, 0.0), tmp_path / "m.su2")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    read_refused(path, *words)


def test_flat_and_curved_gmsh(tmp_path):
    import meshio

    path, points = tmp_path / "m.msh", np.random.default_rng(0).random((10, 3))
    tags = {"gmsh:physical": [np.array([1])], "gmsh:geometrical": [np.array([1])]}
    meshio.write(path, meshio.Mesh(points[:3], [("triangle", [[0, 1, 2]])], cell_data=tags), file_format="gmsh22")
    read_refused(path, "three dimensions")
    meshio.write(path, meshio.Mesh(points, [("tetra10", [list(range(10))])], cell_data=tags), file_format="gmsh22")
    read_refused(path, "1 elements of kind tetra10", "first order")


def test_truncated_gmsh(tmp_path):
    path = write_msh(box("tetra", 2), tmp_path / "m.msh")
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    read_refused(path)


def test_boundary_of_test_meshes_is_whole():
    elements = mixed()
    assert len(boundary(elements.cells)) == sum(len(f) for f in elements.boundary.values())
