"""What hides what: closed forms for two bodies, none for a convex one, and a brute-force ray through everything."""

import math

import numpy as np
import pytest

from spaceplane.aero.inclination.panels import panels_of
from spaceplane.aero.inclination.settings import InclinationSettings
from spaceplane.aero.inclination.shadow import hidden
from spaceplane.aero.inclination.solve import local_inclination
from spaceplane.flow.freestream import direction
from spaceplane.flow.solution import FlowConditions
from spaceplane.validation import bodies
from spaceplane.vehicle.properties import ReferenceLengths
from spaceplane.vehicle.surface import Surface

AHEAD = np.array([1.0, 0.0, 0.0])
REFERENCE = ReferenceLengths(math.pi, 1.0, 1.0, (0.0, 0.0, 0.0))


def moved(body: Surface, shift) -> Surface:
    return Surface(body.points + np.asarray(shift, dtype=float), body.triangles, body.part, body.part_names)


def together(front: Surface, rear: Surface) -> Surface:
    """Two separate bodies as one surface with the parts front and rear."""
    triangles = np.concatenate([front.triangles, rear.triangles + len(front.points)])
    part = np.repeat(np.arange(2, dtype=np.int32), [len(front.triangles), len(rear.triangles)])
    return Surface(np.concatenate([front.points, rear.points]), triangles, part, ("front", "rear"))


def drag(body: Surface, part: str, **settings) -> float:
    conditions = FlowConditions(np.array([8.0]), np.zeros(1), np.zeros(1))
    chosen = InclinationSettings(leeward="free_stream", **settings)
    return local_inclination(body, conditions, REFERENCE, chosen).CD.sel(part=part).item()


def test_a_body_right_behind_another_feels_nothing():
    sphere = bodies.sphere(segments=48)
    pair = together(sphere, moved(sphere, (5.0, 0.0, 0.0)))
    assert drag(pair, "rear") == 0.0
    assert drag(pair, "front") == pytest.approx(drag(sphere, "total"), rel=1e-12)
    assert drag(pair, "rear", shadow=False) == pytest.approx(drag(sphere, "total"), rel=1e-12)


def test_a_body_beside_another_is_not_hidden():
    sphere = bodies.sphere(segments=48)
    pair = together(sphere, moved(sphere, (5.0, 2.5, 0.0)))
    assert drag(pair, "rear") == pytest.approx(drag(sphere, "total"), rel=1e-12)


@pytest.mark.parametrize("distance", [0.4, 1.0, 1.6])
def test_two_spheres_side_by_side_hide_the_lens_of_their_circles(distance):
    """Seen along the stream, two unit circles share 2 acos(d / 2) - (d / 2) sqrt(4 - d^2)."""
    sphere = bodies.sphere(segments=96)
    pair = together(sphere, moved(sphere, (5.0, 0.6 * distance, 0.8 * distance)))
    panels = panels_of(pair, 0.02)
    dark = hidden(panels, AHEAD)
    assert not dark[panels.part == 0].any()
    seen = -(panels.area * panels.normal[:, 0])[dark].sum()
    lens = 2.0 * math.acos(0.5 * distance) - 0.5 * distance * math.sqrt(4.0 - distance**2)
    assert seen == pytest.approx(lens, rel=0.01)


@pytest.mark.parametrize("alpha", [0.0, 0.3, 1.2])
@pytest.mark.parametrize("beta", [0.0, -0.4, 1.5])
def test_a_convex_body_is_unchanged_to_the_last_bit(alpha, beta):
    conditions = FlowConditions(np.array([6.0]), np.array([alpha]), np.array([beta]))
    for body in (bodies.sphere(segments=48), bodies.cone(0.3, segments=48, base_rings=3)):
        with_it, without = (
            local_inclination(body, conditions, REFERENCE, InclinationSettings(shadow=on)) for on in (True, False)
        )
        assert with_it.identical(without)
        assert not hidden(panels_of(body, 0.05), direction(alpha, beta)).any()


def test_the_grid_finds_what_a_ray_through_every_triangle_finds():
    """HB-2 at incidence: nose and flare hide each other; brute force with no grid, triangle by triangle."""
    body = bodies.hb2(segments=24, arc_points=6)
    panels = panels_of(body, 0.3)
    for alpha, beta in ((0.0, 0.0), (0.25, 0.1), (-0.6, 0.3), (1.2, 0.0)):
        wind = direction(alpha, beta)
        found, expected = hidden(panels, wind), brute(panels, wind)
        np.testing.assert_array_equal(found, expected)
    assert found.any() or hidden(panels, direction(0.25, 0.1)).any()


def brute(panels, wind) -> np.ndarray:
    """[panel] whether a ray from the centroid against the stream meets any triangle (Moeller and Trumbore 1997)."""
    corners = panels.surface.corners
    origin, edge_1, edge_2 = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(-wind, edge_2)
    determinant = np.einsum("tx,tx->t", edge_1, across)
    safe = np.where(np.abs(determinant) < 1e-14, np.nan, determinant)
    result = np.zeros(len(panels), dtype=bool)
    for i in np.flatnonzero(panels.normal @ wind < 0.0):
        offset = panels.center[i] - origin
        u = np.einsum("tx,tx->t", offset, across) / safe
        lift = np.cross(offset, edge_1)
        v = lift @ -wind / safe
        distance = np.einsum("tx,tx->t", edge_2, lift) / safe
        result[i] = ((u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (distance > 1e-5)).any()
    return result
