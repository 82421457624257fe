from dataclasses import replace

import numpy as np
import pytest
import pyvista

from spaceplane.errors import InputError
from spaceplane.flow.export import condition_labels, cube_centers, surface_cp, write_vtp, write_vtu
from spaceplane.flow.freestream import velocity
from spaceplane.flow.solution import ConvergenceRecord, FlowConditions, Solution
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation.bodies import sphere


@pytest.fixture(scope="module")
def body():
    return sphere(0.5, segments=48)


@pytest.fixture(scope="module")
def solution(body) -> Solution:
    """Free stream in the field; on the wall a Cp that is a smooth function of place."""
    mesh = generate(body, MeshSettings(wall_cell=0.05, far_field=2.0))
    conditions = FlowConditions(np.array([2.0, 0.5]), np.array([0.1, 0.0]), np.array([0.0, 0.05]))
    count = len(conditions)
    state = np.empty((mesh.cells, 5, count))
    state[:, 0] = 1.0
    state[:, 1:4] = velocity(conditions.mach, conditions.alpha, conditions.beta).T
    state[:, 4] = 1.0 / 1.4
    cp = np.stack([place(mesh.wall_center), -place(mesh.wall_center)], axis=1)
    wall = 1.0 / 1.4 + cp * 0.5 * conditions.mach**2
    one = ConvergenceRecord("converged", 3.0, 9, np.zeros(9), np.zeros((9, 3)), np.zeros(3), np.zeros(3))
    return Solution(mesh, conditions, state, wall, (one,) * count)


def place(center):
    return 0.3 + 1.5 * center[:, 0] - center[:, 1] + 0.5 * center[:, 2]


def test_vtu_reads_back_with_the_cells_and_the_flow(solution, tmp_path):
    write_vtu(solution, tmp_path / "flow.vtu")
    grid = pyvista.read(tmp_path / "flow.vtu")
    mesh = solution.mesh
    assert grid.n_cells == mesh.cells
    assert set(grid.celltypes) == {pyvista.CellType.HEXAHEDRON}
    first, second = condition_labels(solution.conditions)
    assert (first, second) == ("M2_a5.72958_b0", "M0.5_a0_b2.86479")
    np.testing.assert_allclose(grid.cell_data[f"Mach_{first}"], 2.0, rtol=1e-6)
    np.testing.assert_allclose(grid.cell_data[f"Cp_{second}"], 0.0, atol=1e-6)
    np.testing.assert_allclose(grid.cell_data[f"velocity_{first}"][0], [2 * np.cos(0.1), 0, 2 * np.sin(0.1)], rtol=1e-6)
    sizes = grid.compute_cell_sizes(length=False, area=False)
    np.testing.assert_allclose(sizes.cell_data["Volume"], mesh.cell_size**3, rtol=1e-5)
    np.testing.assert_allclose(
        grid.cell_data["fluid_fraction"] * mesh.cell_size**3, mesh.cell_volume, rtol=1e-5, atol=1e-12
    )
    assert list(grid.field_data["condition_verdict"]) == ["converged"] * 2


def test_cubes_fill_the_domain_without_overlap(solution):
    mesh = solution.mesh
    center = cube_centers(mesh)
    assert (np.abs(mesh.cell_center - center).max(axis=1) < 0.5001 * mesh.cell_size).all()
    finest = mesh.cell_size.min()
    corner = np.rint((center - 0.5 * mesh.cell_size[:, None] - center.min(axis=0)) / finest)
    owner = np.unique(np.column_stack([corner, mesh.cell_size]), axis=0)
    lower = (mesh.far_center).min(axis=0)
    extent = mesh.far_center.max(axis=0) - lower
    filled = (owner[:, 3] ** 3).sum()
    inside = extent.prod() - filled
    assert 0.0 < inside < 4.0 / 3.0 * np.pi * 0.5**3


def test_a_mesh_that_is_no_octree_is_refused(solution, tmp_path):
    skewed = replace(solution.mesh, cell_center=solution.mesh.cell_center * [1.0, 1.1, 1.0])
    with pytest.raises(InputError, match="octree"):
        write_vtu(replace(solution, mesh=skewed), tmp_path / "flow.vtu")


def test_vtp_reads_back_with_parts_and_cp_of_each_condition(body, solution, tmp_path):
    write_vtp(body, solution, tmp_path / "surface.vtp", {"Mach 2": 0, "slow": 1})
    data = pyvista.read(tmp_path / "surface.vtp")
    assert data.n_cells == len(body.triangles)
    assert list(data.field_data["part_names"]) == list(body.part_names)
    np.testing.assert_array_equal(data.cell_data["part"], body.part)
    np.testing.assert_allclose(data.cell_data["Cp_Mach 2"], -data.cell_data["Cp_slow"], atol=1e-6)
    assert data.is_manifold


def test_surface_pressure_follows_the_wall(body, solution):
    found = surface_cp(body, solution)[:, 0]
    assert np.abs(found - place(body.centroids)).max() < 0.06
    assert np.sqrt(np.mean((found - place(body.centroids)) ** 2)) < 0.02


@pytest.mark.parametrize("write", [write_vtu, lambda solution, path: write_vtp(None, solution, path)])
@pytest.mark.parametrize("name", ["flow.txt", "nowhere/flow.vtu", "nowhere/flow.vtp"])
def test_bad_names_are_refused(solution, tmp_path, write, name):
    with pytest.raises(InputError, match=r"must end in|does not exist"):
        write(solution, tmp_path / name)
