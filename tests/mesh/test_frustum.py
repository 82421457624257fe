"""Refinement in truncated cones: what lies inside, and which cells of a mesh get smaller."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spaceplane.errors import InputError
from spaceplane.mesh.frustum import RefinementFrustum
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings

from . import bodies
from .test_generate import check_body, check_shape

OBLIQUE = RefinementFrustum((0.3, -0.2, 0.1), (1.1, 0.5, 0.9), 0.2, 0.7, 0.1, 0.1, 0.4)


def test_points_inside_fill_the_exact_volume():
    """Volume of a truncated cone less that of its hole, along an axis oblique to all coordinates."""
    low, high = OBLIQUE.bounds()
    points = low + (high - low) * np.random.default_rng(2).random((400_000, 3))
    inside = OBLIQUE.contains(points)

    def volume(a: float, b: float) -> float:
        """Of a truncated cone of these radii."""
        return math.pi / 3.0 * math.dist(OBLIQUE.start, OBLIQUE.end) * (a * a + a * b + b * b)

    exact = volume(0.2, 0.7) - volume(0.1, 0.4)
    assert inside.mean() * np.prod(high - low) == pytest.approx(exact, rel=0.01)


def test_bounds_touch_both_rims():
    axis = np.subtract(OBLIQUE.end, OBLIQUE.start) / math.dist(OBLIQUE.start, OBLIQUE.end)
    across = np.linalg.svd(axis[None])[2][1:]
    angle = np.linspace(0.0, 2.0 * math.pi, 721)
    circle = np.cos(angle)[:, None] * across[0] + np.sin(angle)[:, None] * across[1]
    rims = np.concatenate([OBLIQUE.start + 0.2 * circle, OBLIQUE.end + 0.7 * circle])
    low, high = OBLIQUE.bounds()
    assert rims.min(axis=0) == pytest.approx(low, abs=1e-4)
    assert rims.max(axis=0) == pytest.approx(high, abs=1e-4)


def test_cells_inside_are_no_larger_than_asked():
    """Air and wall: cells in the frustum, those of its hole left as they were."""
    frustum = RefinementFrustum((-2.5, 0.0, 0.0), (0.5, 0.0, 0.0), 0.3, 1.6, 0.1, 0.0, 1.2)
    settings = MeshSettings(wall_cell=0.4, far_field=1.5, wall_layers=1, growth_layers=1)
    plain = generate(bodies.sphere(), settings)
    mesh = generate(bodies.sphere(), replace(settings, frustums=(frustum,)))
    inside = frustum.contains(mesh.cell_cube_center)
    assert inside.sum() > 1000 and mesh.cell_size[inside].max() <= 0.1 + 1e-12
    wall = mesh.cell_size[mesh.wall_cell]
    assert np.isclose(wall, 0.1).sum() > 100 and np.isclose(wall, 0.4).sum() > 10
    far = np.linalg.norm(mesh.cell_cube_center - [2.0, 0.0, 0.0], axis=1) < 0.9
    assert mesh.cell_size[far].min() == pytest.approx(plain.cell_size.min())
    check_body(mesh, bodies.sphere())
    check_shape(mesh)


def test_a_frustum_on_one_side_of_a_symmetric_body_acts_on_both():
    frustum = RefinementFrustum((0.0, 1.5, 0.0), (0.5, 2.5, 0.5), 0.6, 0.2, 0.1)
    settings = {"wall_cell": 0.4, "far_field": 1.5, "frustums": (frustum,)}
    mesh = generate(bodies.sphere(), MeshSettings(**settings))
    for one in (frustum, frustum.mirrored()):
        inside = one.contains(mesh.cell_cube_center)
        assert inside.sum() > 100 and mesh.cell_size[inside].max() <= 0.1 + 1e-12
    whole = generate(bodies.sphere(), MeshSettings(**settings, symmetric=False))
    assert whole.cell_size[frustum.contains(whole.cell_cube_center)].max() <= 0.1 + 1e-12
    assert whole.cell_size[frustum.mirrored().contains(whole.cell_cube_center)].max() > 0.15
    check_shape(mesh)
    check_shape(whole)


def test_a_frustum_outside_the_domain_changes_nothing():
    frustum = RefinementFrustum((50.0, 0.0, 0.0), (60.0, 0.0, 0.0), 1.0, 2.0, 0.2)
    plain = generate(bodies.sphere(), MeshSettings(wall_cell=0.2, far_field=1.5))
    mesh = generate(bodies.sphere(), MeshSettings(wall_cell=0.2, far_field=1.5, frustums=(frustum,)))
    assert np.array_equal(plain.cell_center, mesh.cell_center)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"cell": 0.0}, "frustums: cell 0.0 m"),
        ({"cell": math.nan}, "frustums: cell nan m"),
        ({"start": (0.0, 0.0)}, "three finite coordinates"),
        ({"end": (0.0, math.inf, 0.0)}, "frustums: end"),
        ({"end": (0.0, 0.0, 0.0)}, "two points"),
        ({"end_radius": -1.0}, "end_radius -1.0 m"),
        ({"start_hole": 1.5}, "start_hole 1.5 m, allowed 0 to start_radius 1.0 m"),
        ({"start_hole": 1.0, "end_hole": 2.0}, "nothing is left"),
    ],
)
def test_what_is_no_frustum_is_refused(values, message):
    good = {"start": (0.0, 0.0, 0.0), "end": (1.0, 0.0, 0.0), "start_radius": 1.0, "end_radius": 2.0, "cell": 0.1}
    RefinementFrustum(**good)
    with pytest.raises(InputError, match=message):
        RefinementFrustum(**(good | values))


def test_cells_too_many_to_mark_are_refused():
    frustum = RefinementFrustum((-3.0, 0.0, 0.0), (3.0, 0.0, 0.0), 3.0, 3.0, 0.2 / 32)
    with pytest.raises(InputError, match="frustums: cell"):
        generate(bodies.sphere(), MeshSettings(wall_cell=0.2, far_field=2.0, frustums=(frustum,)))
