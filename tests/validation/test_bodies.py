"""Test bodies: closed, outward, symmetric and of the published size."""

import math

import numpy as np
import pytest

from spaceplane.errors import InputError
from spaceplane.validation import bodies

BODIES = {
    "cone": lambda: bodies.cone(math.radians(10.0), segments=64),
    "sphere": lambda: bodies.sphere(segments=64),
    "hb2": lambda: bodies.hb2(segments=64),
    "basic_finner": lambda: bodies.basic_finner(segments=64),
    "m6": bodies.m6,
}


@pytest.mark.parametrize("name", BODIES)
def test_closed_and_outward(name):
    surface = BODIES[name]()
    edges = np.concatenate([surface.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    directed = {tuple(edge) for edge in edges.tolist()}
    assert len(directed) == len(edges), "an edge is used twice in the same direction"
    assert all((b, a) in directed for a, b in directed)
    assert surface.volume > 0.0
    assert np.abs(surface.area_vectors.sum(axis=0)).max() < 1e-12 * surface.area


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("axis", [1, 2])
def test_mirror_images_are_exact(name, axis):
    points = BODIES[name]().points
    mirrored = points * np.where(np.arange(3) == axis, -1.0, 1.0)
    # The union of body and fins rounds each intersection by itself.
    digits = 9 if name == "basic_finner" else 15
    key = lambda p: {tuple(row) for row in (np.round(p, digits) + 0.0).tolist()}  # noqa: E731
    assert key(points) == key(mirrored)


def test_volumes_are_exact():
    cone = bodies.cone(math.radians(20.0), length=2.0, segments=48)
    radius = 2.0 * math.tan(math.radians(20.0))
    assert cone.volume == pytest.approx(math.pi * radius**2 * 2.0 / 3.0, rel=1e-12)
    base = cone.area_vectors[cone.part == 1].sum(axis=0)
    assert base == pytest.approx([math.pi * radius**2, 0.0, 0.0], abs=1e-12)
    assert bodies.sphere(0.5, 32).volume == pytest.approx(math.pi / 6.0, rel=1e-12)


def test_basic_finner_has_the_published_fins():
    surface = bodies.basic_finner(segments=96)
    fins = surface.part == surface.part_names.index("fins")
    # Four wedges of 1 x 1 calibre, 0.08 thick: two of them show both flanks in y, and all their bases in x.
    assert np.abs(surface.area_vectors[fins, 1]).sum() == pytest.approx(2 * 2 * 1.0 + 2 * 0.5 * 0.08, rel=0.01)
    base = surface.area_vectors[:, 0][surface.area_vectors[:, 0] > 0].sum()
    assert base == pytest.approx(math.pi / 4.0 + 4 * 0.08, rel=1e-3)
    body = math.pi / 4.0 * (10.0 - 2.0 / 3.0 * 0.5 / math.tan(math.radians(10.0)))
    assert surface.volume == pytest.approx(body + 4 * 0.5 * 0.08, rel=2e-3)


def test_hb2_tangencies_are_the_published_ones():
    """Tangency stations in diameters from the nose (AEDC-TDR-64-137).

    The printed set is overdetermined: a 10 deg flare to a base diameter of 1.6 starts 0.01 ahead of the printed 3.553.
    """
    points = bodies.hb2(1.0, segments=64, arc_points=9).points
    stations = np.unique(np.round(points[:, 0], 9))
    for published, rounding in ((0.173, 6e-4), (0.521, 1e-3), (0.818, 6e-4), (2.857, 1e-2), (3.553, 1e-2), (4.9, 1e-9)):
        assert np.abs(stations - published).min() < rounding
    # A 64-gon of the circle's area reaches 0.16 % beyond it at its corners.
    assert np.hypot(points[:, 1], points[:, 2]).max() == pytest.approx(0.8, rel=1e-3)


def test_m6_is_the_published_wing():
    """Semi-span 1.1963 m, root chord 0.8059 m, trailing edge swept 15.8 deg, 9.8 % thick (AGARD AR-138, B1)."""
    wing = bodies.m6()
    x, z = bodies.M6_ORDINATES.T
    chords = 0.8059**2 * (1 + 0.562 + 0.562**2) / 3  # mean of the chord squared
    assert wing.volume == pytest.approx(2 * np.trapezoid(z, x) * chords * 2 * 1.1963, rel=1e-12)
    assert wing.bounds[:, 1] == pytest.approx([-1.1963, 1.1963])
    assert wing.bounds[1, 2] == pytest.approx(0.5 * 0.098 * 0.8059, rel=2e-3)
    tip = wing.points[wing.points[:, 1] > 1.1962]
    assert tip[:, 0].min() == pytest.approx(1.1963 * math.tan(math.radians(30.0)))
    assert math.degrees(math.atan((tip[:, 0].max() - 0.8059) / 1.1963)) == pytest.approx(15.8, abs=0.05)
    assert (np.diff(x) > 0).all() and z.argmax() == 36


def test_bad_profile_is_refused():
    with pytest.raises(InputError, match="radius must be zero at both ends"):
        bodies.revolve(np.array([[0.0, 0.1], [1.0, 0.0]]), 16)
    with pytest.raises(InputError, match="segments = 10"):
        bodies.sphere(segments=10)
