"""Cells at the square edges of thin walls."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from mesh import bodies
from spaceplane.errors import InputError
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.mesh.square_edges import SHARP, _sharp_edges, cells_at_square_edges
from spaceplane.mesh.thickness import Thickness
from spaceplane.vehicle.build import build
from spaceplane.vehicle.presets import horus_2b

PLATE = bodies.wing([(0.0, -0.2), (5.0, -0.2), (5.0, 0.2), (0.0, 0.2)], 6.0)


def places(spacing):
    """Thickness of the plate along vertical lines of this spacing."""
    x, y = np.meshgrid(np.arange(0.5 * spacing, 5.0, spacing), np.arange(0.5 * spacing - 3.0, 3.0, spacing))
    point = np.stack([x.ravel(), y.ravel(), np.full(x.size, -0.2)], axis=1)
    return Thickness(point, np.full(x.size, 2), np.full(x.size, 0.4), spacing)


def test_sharp_edges_are_those_that_another_program_finds():
    surface = build(horus_2b().shape)
    body = trimesh.Trimesh(surface.points, surface.triangles, process=False)
    theirs = body.face_adjacency_edges[(body.face_adjacency_angles > SHARP) & body.face_adjacency_convex]
    ours = _sharp_edges(surface)
    assert len(ours) == len(theirs) > 1000
    assert {tuple(edge) for edge in ours.tolist()} == {tuple(edge) for edge in np.sort(theirs, axis=1).tolist()}


def test_cells_are_asked_for_along_the_rim_and_nowhere_else():
    sizing = cells_at_square_edges(PLATE, places(0.4), 2.0, 0.05, 0.8)
    assert np.allclose(sizing.cell, 0.2)
    # Distances along x and y from the rim: at least one is that of half a cell asked for.
    to_rim = np.abs(np.abs(sizing.point[:, :2] - [2.5, 0.0]) - [2.5, 3.0])
    assert (to_rim.min(axis=1) < 0.11).all()
    for corner in PLATE.points:
        assert np.linalg.norm(sizing.point - corner, axis=1).min() < 0.2


@pytest.mark.parametrize(("cells", "smallest", "largest"), [(2.0, 0.05, 0.2), (0.5, 0.05, 0.8), (4.0, 0.05, 0.1)])
def test_nothing_is_asked_for_where_cells_are_small_enough(cells, smallest, largest):
    assert not len(cells_at_square_edges(PLATE, places(0.4), cells, smallest, largest).cell)


def test_an_inner_corner_is_no_edge():
    """An L in section has five convex edges along it and one concave one, and six on each end."""
    corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)]
    points = np.array([(x, y, z) for z in (0.0, 3.0) for x, y in corners])
    end = [(0, 1, 2), (0, 2, 3), (0, 3, 5), (3, 4, 5)]
    sides = [t for k in range(6) for n in [(k + 1) % 6] for t in ((k, n, n + 6), (k, n + 6, k + 6))]
    triangles = [(c, b, a) for a, b, c in end] + [(a + 6, b + 6, c + 6) for a, b, c in end] + sides
    surface = bodies.from_trimesh(trimesh.Trimesh(points, triangles, process=False))
    assert surface.volume == pytest.approx(9.0)
    lengths = np.linalg.norm(np.diff(surface.points[_sharp_edges(surface)], axis=1)[:, 0], axis=1)
    assert lengths.sum() == pytest.approx(5 * 3.0 + 2 * 8.0)


def test_more_cells_across_more_cells():
    counts = [
        generate(PLATE, MeshSettings(wall_cell=0.8, far_field=1.5, fine_edges=True, edge_levels=2, edge_cells=n)).cells
        for n in (0.0, 2.0, 4.0)
    ]
    assert counts[0] < counts[1] < counts[2]


@pytest.mark.parametrize("value", [-1.0, 17.0, float("nan")])
def test_a_number_that_makes_no_sense_is_refused(value):
    with pytest.raises(InputError, match="edge_cells"):
        MeshSettings(edge_levels=2, edge_cells=value)


def test_cells_across_edges_go_with_halvings():
    with pytest.raises(InputError, match="edge_cells: 4, goes with edge_levels"):
        MeshSettings(edge_cells=4.0)
