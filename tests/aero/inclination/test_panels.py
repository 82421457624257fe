"""Cutting keeps area, moments and normals; bluntness is a radius of curvature."""

import math

import numpy as np
import pytest

from spaceplane.aero.inclination.panels import blunt_triangles, panels_of
from spaceplane.validation import bodies


def test_cutting_keeps_area_and_first_moment_and_leaves_the_surface_alone():
    body = bodies.cone(0.3, segments=16)
    before = body.corners.copy()
    panels = panels_of(body, 0.1)
    assert len(panels) > 4 * len(body.triangles)
    np.testing.assert_array_equal(body.corners, before)
    vector = panels.area[:, None] * panels.normal
    whole = body.area_vectors
    for axis in range(3):
        summed = np.bincount(panels.triangle, vector[:, axis], minlength=len(whole))
        np.testing.assert_allclose(summed, whole[:, axis], atol=1e-15)
    moment = np.cross(panels.center, vector).sum(axis=0)
    np.testing.assert_allclose(moment, np.cross(body.centroids, whole).sum(axis=0), atol=1e-14)
    assert (panels.area > 0.0).all()
    assert math.sqrt(panels.area.max()) < 0.1


def test_uncut_panels_are_the_triangles():
    body = bodies.sphere(segments=16)
    panels = panels_of(body, 10.0)
    np.testing.assert_array_equal(panels.triangle, np.arange(len(body.triangles)))
    np.testing.assert_allclose(panels.area, np.linalg.norm(body.area_vectors, axis=1))


@pytest.mark.parametrize("radius", [0.3, 1.0])
def test_a_sphere_is_blunt_below_its_radius_of_curvature_only(radius):
    body = bodies.sphere(radius, segments=48)
    assert blunt_triangles(body, 1.05 * radius).all()
    assert not blunt_triangles(body, 0.95 * radius).any()


def test_sharp_edges_are_not_blunt_and_the_nose_of_hb2_is():
    """A 17 deg cone of 96 facets has a sharp base; HB-2 has a nose of radius 0.3 and a shoulder of radius 0.5."""
    cone = bodies.cone(0.3, segments=96, base_rings=3)
    blunt = blunt_triangles(cone, 1e-3)
    assert not blunt.any()
    hb2 = bodies.hb2()
    blunt = blunt_triangles(hb2, 0.4)
    ahead = hb2.centroids[:, 0]
    cap = 0.3 * (1.0 - math.sin(math.radians(25.0)))
    assert blunt[ahead < 0.9 * cap].all()
    assert not blunt[(ahead > 1.6) & (ahead < 4.8)].any()
