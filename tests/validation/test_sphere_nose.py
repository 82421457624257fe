"""The measures of the sphere's nose, and its coarsest mesh."""

from types import SimpleNamespace

import numpy as np
import pytest

from spaceplane.aero.exact.blunt_sphere import sphere_flow
from spaceplane.aero.exact.stagnation import normal_shock_pressure, stagnation_cp
from spaceplane.flow.solution import FlowConditions
from spaceplane.validation import bodies, sphere_nose
from spaceplane.validation.blunt import standoff_seiff
from spaceplane.validation.flowcase import solve_body


@pytest.mark.parametrize("place", [0.1301, 0.1345, 0.1377, 0.1424])
def test_standoff_is_found_within_a_cell(place):
    """Averages over cells of 0.02 of a shock with a linear rise behind it, smeared over its neighbours."""
    edges = np.linspace(-0.4, 0.0, 21)
    behind = normal_shock_pressure(10.0, 1.4) / 1.4
    fine = np.linspace(-0.4, 0.0, 20001)
    middle = 0.5 * (fine[1:] + fine[:-1])
    exact = np.where(middle < -place, 1.0 / 1.4, behind * (1.0 + 0.5 * (middle + place)))
    mean = exact.reshape(20, -1).mean(axis=1)
    shocked = np.flatnonzero(mean > 2.0)[0]
    smeared = mean.copy()
    smeared[shocked] -= 0.1 * mean[shocked]  # what leaves the cell of the shock is found in the next one behind
    smeared[shocked + 1] += 0.1 * mean[shocked]
    center = np.column_stack([0.5 * (edges[1:] + edges[:-1]), np.zeros((20, 2))])
    state = np.zeros((20, 5, 1))
    state[:, 4, 0] = smeared
    mesh = SimpleNamespace(cell_center=center, cell_size=np.full(20, 0.02))
    solution = SimpleNamespace(mesh=mesh, state=state, conditions=FlowConditions(*np.array([[10.0], [0.0], [0.0]])))
    assert sphere_nose.standoff(solution, 0) == pytest.approx(place, abs=0.0025)  # an eighth of a cell


def test_seiff_and_the_density_ratio():
    """At unlimited speed the density ratio of a perfect gas of 1.4 is 6."""
    assert standoff_seiff(1e6) == pytest.approx(0.13, rel=1e-6)


def test_billig_is_judged_where_the_exact_flow_agrees_with_him():
    """The exact flow lies 3 % below his fit at Mach 5 and 8 % at Mach 10."""
    rows = {mach: sphere_nose.standoff_rows("c", "w", mach, 0.15, (0.05, 0.05)) for mach in (5.0, 10.0)}
    assert [[row.gate for row in pair] for pair in rows.values()] == [[True, True], [True, False]]
    assert rows[10.0][0].published == pytest.approx(0.13571, abs=1e-5)
    assert "-8.1 %" in rows[10.0][1].note


@pytest.mark.parametrize("mach", [5.0, 25.0])
def test_nose_cp_of_the_exact_wall_pressure(mach):
    """The parabola ends within 0.1 % of the pitot pressure on the exact flow, and averages what scatters."""
    theta, around = (a.ravel() for a in np.meshgrid(np.linspace(0.01, 0.6, 40), np.linspace(0.0, 6.0, 31)))
    center = np.column_stack([1.0 - np.cos(theta), np.sin(theta) * np.cos(around), np.sin(theta) * np.sin(around)])
    ones = np.ones(len(theta), int)
    mesh = SimpleNamespace(
        wall_center=center,
        wall_cell=np.arange(len(theta)),
        piece_part=0 * ones,
        piece_wall=np.arange(len(theta)),
        part_names=("forebody", "base"),
    )
    cp = sphere_flow(mach).wall_cp(theta)
    scatter = 0.02 * np.random.default_rng(1).standard_normal(len(theta))
    for more, band in ((0.0, 1e-3), (scatter, 5e-3)):
        solution = SimpleNamespace(mesh=mesh, wall_cp=lambda more=more: (cp + more)[:, None])
        assert sphere_nose.nose_cp(solution, 0) == pytest.approx(stagnation_cp(mach), rel=band)


def test_coarsest_nose_lies_in_the_bands():
    cell = sphere_nose.CELLS[0]
    settings = sphere_nose.MeshSettings(wall_cell=4.0 * cell, growth_layers=1, domain=sphere_nose.DOMAIN)
    mach = np.array([5.0, 10.0])
    sizing = sphere_nose.shock_layer(cell)
    solution = solve_body(
        bodies.sphere(segments=192), settings, FlowConditions(mach, 0 * mach, 0 * mach), sizing=sizing
    )
    wall = solution.mesh.wall_center[:, 0] < 0.03
    assert np.allclose(solution.mesh.cell_size[solution.mesh.wall_cell[wall]], cell)
    for index in range(2):
        assert solution.records[index].good
        assert sphere_nose.standoff(solution, index) == pytest.approx(sphere_flow(mach[index]).standoff, rel=0.05)
        assert sphere_nose.nose_cp(solution, index) == pytest.approx(stagnation_cp(mach[index]), rel=0.02)
