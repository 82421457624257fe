"""Figure and gravity of the planet against published and exact values."""

import math

import numpy as np
import pytest

from spaceplane.dynamics.planet import (
    EARTH_SPHERE,
    PLANETS,
    WGS84,
    Planet,
    cartesian,
    geodetic,
    geodetic_to_cartesian,
    gravity,
    gravity_north_down,
    planet_named,
    potential,
    spherical,
)
from spaceplane.environment import constants
from spaceplane.errors import InputError

PLACES = [
    (h, lon, lat) for h in (-5e3, 0.0, 25e3, 400e3, 2e7) for lon in (-3.0, 0.4) for lat in (-1.5707, -0.6, 0.0, 1.2)
]


def test_sphere_is_the_earth_of_the_equations_of_motion():
    for altitude in (0.0, 25e3, 80e3):
        radius = constants.EARTH_RADIUS + altitude
        for lat in (-0.7, 0.0, 1.1):
            position = cartesian(radius, 0.3, lat)
            assert np.linalg.norm(gravity(EARTH_SPHERE, position)) == pytest.approx(
                constants.gravity(radius), rel=1e-14
            )
            assert geodetic(EARTH_SPHERE, position) == pytest.approx((altitude, 0.3, lat), abs=1e-8)


@pytest.mark.parametrize("planet", PLANETS.values(), ids=PLANETS)
@pytest.mark.parametrize(("altitude", "lon", "lat"), PLACES)
def test_round_trips(planet, altitude, lon, lat):
    position = geodetic_to_cartesian(planet, altitude, lon, lat)
    found = geodetic(planet, position)
    assert found[0] == pytest.approx(altitude, abs=1e-7)
    assert found[1:] == pytest.approx((lon, lat), abs=1e-14)
    assert cartesian(*spherical(position)) == pytest.approx(position, abs=1e-8)


def test_known_places():
    assert geodetic(WGS84, [6_378_137.0, 0, 0]) == pytest.approx((0, 0, 0), abs=1e-8)
    assert geodetic(WGS84, [0, 0, 6_356_752.314245]) == pytest.approx((0, 0, math.pi / 2), abs=1e-6)
    # Vallado, Fundamentals of Astrodynamics and Applications, example 3-3: 34.352496 deg, 5085.22 km
    altitude, lon, lat = geodetic(WGS84, np.array([6524.834, 6862.875, 6448.296]) * 1e3)
    assert math.degrees(lat) == pytest.approx(34.352496, abs=2e-6)
    assert math.degrees(lon) == pytest.approx(46.4464, abs=5e-5)
    assert altitude == pytest.approx(5_085_220.0, abs=10.0)


J4, J6 = -2.37091222e-6, 6.08347e-9
"""Of the level ellipsoid WGS 84 (NIMA TR8350.2): what its exact field has beyond J2."""


def test_normal_gravity():
    """Gravity and centrifugal acceleration: 9.7803253359 at the equator, 9.8321849378 m/s2 at the pole.

    The published values are those of the exact field, so what J4 and J6 add, (n + 1) J_n P_n, is added here.
    """
    equator, pole = [WGS84.radius, 0.0, 0.0], [0.0, 0.0, WGS84.polar_radius]
    g = -gravity(WGS84, equator)[0] - WGS84.rotation**2 * WGS84.radius
    g -= (5 * J4 * 3 / 8 - 7 * J6 * 5 / 16) * WGS84.mu / WGS84.radius**2
    assert g == pytest.approx(9.7803253359, rel=1e-9)
    ratio = WGS84.radius / WGS84.polar_radius
    g = -gravity(WGS84, pole)[2] - (5 * J4 * ratio**4 + 7 * J6 * ratio**6) * WGS84.mu / WGS84.polar_radius**2
    assert g == pytest.approx(9.8321849378, rel=1e-9)


def test_the_ellipsoid_is_level():
    """With the J4 of its exact field the surface of the ellipsoid is an equipotential, within 0.1 m."""
    levels = []
    for lat in np.linspace(0, math.pi / 2, 10):
        position = geodetic_to_cartesian(WGS84, 0.0, 0.2, lat)
        r = np.linalg.norm(position)
        sine = position[2] / r
        fourth = WGS84.mu / r * J4 * (WGS84.radius / r) ** 4 * (35 * sine**4 - 30 * sine**2 + 3) / 8
        spin = 0.5 * WGS84.rotation**2 * (position[0] ** 2 + position[1] ** 2)
        levels.append(potential(WGS84, position) + fourth - spin)
    assert np.ptp(levels) / 9.8 < 0.1
    central = Planet("central", WGS84.mu, WGS84.radius, WGS84.flattening, 0.0, WGS84.rotation)
    ends = [potential(central, geodetic_to_cartesian(central, 0, 0, lat)) for lat in (0, math.pi / 2)]
    assert abs(ends[0] - ends[1]) / 9.8 > 20_000  # the polar radius is 21 km shorter


def test_gravity_is_the_gradient_of_the_potential():
    rng = np.random.default_rng(1)
    for _ in range(20):
        position = rng.normal(size=3) * 6e6
        step = 10.0
        slope = [
            (potential(WGS84, position + step * e) - potential(WGS84, position - step * e)) / (2 * step)
            for e in np.eye(3)
        ]
        assert gravity(WGS84, position) == pytest.approx(-np.array(slope), rel=1e-6, abs=1e-6)


def test_north_and_down_are_the_vector():
    from spaceplane.dynamics.frames import planet_to_horizon

    for R, lon, lat in ((6.4e6, 0.3, 0.7), (7e6, -2.0, -1.2), (6.5e6, 1.0, 0.0)):
        north, east, down = planet_to_horizon(lon, lat) @ gravity(WGS84, cartesian(R, lon, lat))
        assert (north, down) == pytest.approx(gravity_north_down(WGS84, R, lat), rel=1e-12, abs=1e-15)
        assert east == pytest.approx(0.0, abs=1e-14)
    assert gravity_north_down(WGS84, 6.4e6, 0.7)[0] < 0  # the bulge draws to the equator
    assert gravity_north_down(WGS84, 6.4e6, -0.7)[0] > 0


@pytest.mark.parametrize(
    ("field", "values"),
    [
        ("mu", {"mu": 0.0}),
        ("radius", {"radius": -1.0}),
        ("flattening", {"flattening": 0.5}),
        ("J2", {"J2": 1.0}),
        ("rotation", {"rotation": 0.01}),
        ("mu", {"mu": math.nan}),
    ],
)
def test_bad_planets(field, values):
    with pytest.raises(InputError, match=field):
        Planet(**{"name": "x", "mu": 4e14, "radius": 6.4e6, **values})


def test_bad_places():
    with pytest.raises(InputError, match="wgs84"):
        planet_named("wgs48")
    with pytest.raises(InputError, match="radius"):
        geodetic(WGS84, [1e6, 0, 0])
    with pytest.raises(InputError, match="centre"):
        spherical([0, 0, 0])
    assert EARTH_SPHERE.turning(1e-5).rotation == 1e-5 and WGS84.turning().rotation == 0.0
