"""Walls thinner than a cell keep planform and lift."""

from __future__ import annotations

import numpy as np
import pytest

from mesh import bodies
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings

THICKNESS, CHORD, SPAN = 0.4, 5.0, 6.0
FINER_EDGES = {"fine_edges": True, "edge_levels": 2}
"""As `analyse` has them by default."""
WINGS = {
    "diamond": bodies.diamond_wing(CHORD, SPAN, THICKNESS),
    "plate": bodies.flat_plate(CHORD, SPAN, THICKNESS),
}
HALF = 0.5 * THICKNESS
SQUARE_PLATE = bodies.wing([(0.0, -HALF), (CHORD, -HALF), (CHORD, HALF), (0.0, HALF)], SPAN)


def planform_and_lift(surface, cell, **mesh_settings):
    """m2, and normal-force coefficient at Mach 2, 5 deg."""
    mesh = generate(surface, MeshSettings(wall_cell=cell, far_field=1.5, **mesh_settings))
    assert max(mesh.record["area_error"], mesh.record["projected_area_error"]) < 1e-10
    alpha = np.radians([5.0])
    solution = solve(mesh, FlowConditions(np.array([2.0]), alpha, 0 * alpha))
    # The blunt trailing edge of the resolved plate sheds vortices: a mean that wanders by half a per cent will do.
    force = np.linalg.norm(solution.records[0].window_mean)
    assert solution.records[0].verdict != "failed" and solution.records[0].window_spread.max() < 0.01 * force
    planform = 0.5 * np.abs(mesh.piece_area[:, 2]).sum()
    return planform, float(solution.wall_cp()[:, 0].astype(float) @ mesh.wall_area[:, 2]) / (CHORD * SPAN)


@pytest.fixture(scope="module")
def fine_lift():
    """Lift of each wing at four cells of thickness."""
    return {name: planform_and_lift(wing, 0.25 * THICKNESS)[1] for name, wing in WINGS.items()}


def square_plate_lift(cell, **mesh_settings):
    """Mean normal-force coefficient at Mach 2, 5 deg: behind its square base the air swings on some meshes."""
    mesh = generate(SQUARE_PLATE, MeshSettings(wall_cell=cell, far_field=1.5, **mesh_settings))
    assert 0.5 * np.abs(mesh.piece_area[:, 2]).sum() == pytest.approx(CHORD * SPAN, rel=1e-10)
    alpha = np.radians([5.0])
    record = solve(mesh, FlowConditions(np.array([2.0]), alpha, 0 * alpha)).records[0]
    assert record.verdict != "failed" and record.window_spread[2] < 0.02 * record.window_mean[2]
    return record.window_mean[2] * np.linalg.norm(mesh.wall_area, axis=1).sum() / (CHORD * SPAN)


@pytest.fixture(scope="module")
def fine_square_lift():
    """Lift of the plate with square edges at four cells of thickness."""
    return square_plate_lift(0.25 * THICKNESS)


@pytest.mark.parametrize("name", WINGS)
def test_a_wing_as_thin_as_a_cell_keeps_planform_and_lift(fine_lift, name):
    """Lift within 5 % of that at four cells of thickness, which lies below that of linear theory without tips."""
    planform, lift = planform_and_lift(WINGS[name], THICKNESS, **FINER_EDGES)
    assert planform == pytest.approx(CHORD * SPAN, rel=1e-10)
    assert lift == pytest.approx(fine_lift[name], rel=0.05)
    assert 0.6 < fine_lift[name] / (4.0 * np.radians(5.0) / np.sqrt(3.0)) < 1.0


@pytest.mark.parametrize("symmetric", [None, False])
@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.25, 0.25), (0.382, 0.5), (0.7, 0.3), (0.5, 0.75)])
@pytest.mark.parametrize("name", WINGS)
def test_a_wing_half_a_cell_thick_keeps_its_lift_wherever_it_lies_in_the_grid(fine_lift, name, offset, symmetric):
    """In planes of the grid too, where no cell holds both sides of an edge."""
    cell = 2.0 * THICKNESS
    _, lift = planform_and_lift(WINGS[name], cell, offset=offset, symmetric=symmetric, **FINER_EDGES)
    assert lift == pytest.approx(fine_lift[name], rel=0.05)


PLACES = [(o, s) for o in [(0.0, 0.0), (0.25, 0.25), (0.382, 0.5), (0.7, 0.3), (0.5, 0.75)] for s in (None, False)]
OTHER_PLACES = [(o, None) for o in [(0.1, 0.1), (0.6, 0.6), (0.85, 0.15), (0.05, 0.45)]]


@pytest.mark.parametrize(("offset", "symmetric"), PLACES + OTHER_PLACES)
def test_a_square_plate_half_a_cell_thick_keeps_its_lift_with_cells_across_its_edges(
    fine_square_lift, offset, symmetric
):
    lift = square_plate_lift(2.0 * THICKNESS, offset=offset, symmetric=symmetric, **FINER_EDGES, edge_cells=4.0)
    assert lift == pytest.approx(fine_square_lift, rel=0.05)


def test_without_them_a_square_plate_lifts_too_much(fine_square_lift):
    assert square_plate_lift(2.0 * THICKNESS, offset=(0.25, 0.25), **FINER_EDGES) > 1.08 * fine_square_lift


def test_a_wing_inside_one_layer_of_cells_keeps_its_lift_with_finer_edges(fine_lift):
    """Half a cell thick and between two planes of the grid: cells at its edges, two of six along the chord, have one
    pressure above and below. Halved twice they give the lift back."""
    inside = {"symmetric": False, "offset": (0.382, 0.5)}
    _, lost = planform_and_lift(WINGS["diamond"], 2.0 * THICKNESS, **inside)
    planform, kept = planform_and_lift(WINGS["diamond"], 2.0 * THICKNESS, **inside, edge_levels=2)
    assert planform == pytest.approx(CHORD * SPAN, rel=1e-10)
    assert lost < 0.75 * fine_lift["diamond"]
    assert kept == pytest.approx(fine_lift["diamond"], rel=0.05)
