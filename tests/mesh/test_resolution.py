"""Meshes too coarse for their body are refused, and costs quoted only where they were measured."""

from __future__ import annotations

import re

import pytest

from mesh import bodies
from spaceplane.errors import InputError
from spaceplane.mesh.generate import generate
from spaceplane.mesh.resolution import is_resolved, require_resolved
from spaceplane.mesh.settings import MeshSettings


def test_a_sphere_of_two_cells_is_refused_with_a_cell_that_would_do():
    body, settings = bodies.sphere(), MeshSettings(wall_cell=0.9)
    mesh = generate(body, settings)
    assert mesh.record["cells_across"] == pytest.approx(2.0 / 0.9, rel=0.02)
    assert mesh.record["doubled_share"] < 0.1
    with pytest.raises(InputError, match=r"wall_cell: 0\.9 m too coarse.*\(2\.2 cells across") as error:
        require_resolved(body, settings, mesh)
    cell, cells = re.search(r"([\d.]+) m \((\d+) cells\) would do", str(error.value)).groups()
    would_do = generate(body, MeshSettings(wall_cell=float(cell)))
    assert is_resolved(would_do) and would_do.cells == int(cells) and 0.5 < float(cell) < 2.0 / 3.0
    assert "no accuracy has been measured" in would_do.record["warnings"][0]


def test_a_number_of_cells_is_named_where_it_was_asked_for():
    body, settings = bodies.sphere(), MeshSettings(target_cells=1000)
    with pytest.raises(InputError, match=r"target_cells: 1000 gives wall cells of .* would do"):
        require_resolved(body, settings, generate(body, settings))


def test_a_wall_whose_both_sides_share_their_cells_is_refused():
    """A wing of one and a half cells of chord: most cells hold an edge and both sides beside it."""
    body = bodies.diamond_wing(3.0, 9.0, 0.3)
    settings = MeshSettings(wall_cell=2.0, offset=(0.25, 0.5), symmetric=False)
    mesh = generate(bodies.rotated(body, 1), settings)
    assert mesh.record["cells_across"] > 3.0 and mesh.record["doubled_share"] > 1.0 / 6.0
    assert not is_resolved(mesh)


def test_a_thin_wing_with_enough_cells_along_its_chord_is_not_refused():
    """It keeps its lift on cells four times as large as it is thick (docs, method)."""
    body, settings = bodies.diamond_wing(), MeshSettings(wall_cell=1.6, fine_edges=True, far_field=1.5)
    mesh = generate(body, settings)
    require_resolved(body, settings, mesh)
    assert mesh.record["cells_across"] > 5.0 and mesh.record["doubled_share"] < 0.02


def test_costs_are_quoted_where_they_were_measured_only():
    plate = bodies.from_trimesh(bodies.box(4.0, 0.6, 0.04))
    fine, coarse = (generate(plate, MeshSettings(wall_cell=cell, far_field=1.0)) for cell in (0.05, 0.07))
    assert "HORUS-2B loses" in fine.record["warnings"][0]
    assert "HORUS-2B" not in coarse.record["warnings"][0] and "no accuracy has been" in coarse.record["warnings"][0]
    assert len(fine.record["warnings"]) == len(coarse.record["warnings"]) == 1


def test_a_body_with_many_cells_across_says_nothing():
    assert not generate(bodies.sphere(), MeshSettings(wall_cell=0.2, far_field=1.5)).record["warnings"]
