"""The planet a vehicle flies over: figure, gravity and rotation.

A planet is a sphere or an ellipsoid of revolution about its polar axis z, at rest or turning about it at a constant
rate. Positions are Cartesian in metres from the centre, x at longitude 0 in the equator, z through the north pole;
these axes turn with the planet (inertial and planet-fixed axes coincide at time 0). Gravity is that of the mass and of
the oblateness J2 (Vallado, Fundamentals of Astrodynamics and Applications, 4th ed., section 8.7.1), without the
centrifugal acceleration, which belongs to the rotating axes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np

from spaceplane.environment import constants as c
from spaceplane.errors import InputError, unknown_name

# A point of the Earth nearer to the centre than this share of the polar radius has no useful geodetic height.
_DEEPEST = 0.5


@dataclass(frozen=True)
class Planet:
    """Figure, gravity and rotation of a planet.

    Attributes:
        name: label.
        mu: gravitational parameter, m3/s2.
        radius: equatorial radius, m; heights are counted from the ellipsoid that it spans with the flattening.
        flattening: 1 - polar radius / equatorial radius; 0 for a sphere.
        J2: second zonal harmonic on `radius`, dimensionless; 0 for a central field.
        rotation: rate about the polar axis, rad/s, positive towards the east; 0 for a planet at rest.

    Raises:
        InputError: a value is not finite or outside its limits.
    """

    name: str
    mu: float
    radius: float
    flattening: float = 0.0
    J2: float = 0.0
    rotation: float = 0.0

    def __post_init__(self) -> None:
        for item in fields(self):
            if item.name != "name" and not math.isfinite(getattr(self, item.name)):
                raise InputError(f"{item.name} = {getattr(self, item.name)}: must be a finite number")
        for name in ("mu", "radius"):
            if getattr(self, name) <= 0:
                raise InputError(f"{name} = {getattr(self, name)}: must be above 0")
        if not 0.0 <= self.flattening <= 0.2:
            raise InputError(f"flattening = {self.flattening}: must lie between 0 and 0.2")
        if abs(self.J2) > 0.1:
            raise InputError(f"J2 = {self.J2}: must lie between -0.1 and 0.1")
        if self.rotation**2 * self.radius**3 >= self.mu:
            raise InputError(f"rotation = {self.rotation} rad/s: the equator would fly off")

    @property
    def polar_radius(self) -> float:
        """m."""
        return self.radius * (1.0 - self.flattening)

    def turning(self, rotation: float | None = None) -> Planet:
        """The same planet turning at another rate, rad/s; at rest by default."""
        return replace(self, rotation=0.0 if rotation is None else rotation)


EARTH_SPHERE = Planet("sphere at rest", c.STANDARD_GRAVITY * c.EARTH_RADIUS**2, c.EARTH_RADIUS)
"""The Earth of `spaceplane.dynamics.equations`: at rest, radius and gravity of the US 1976 atmosphere."""

EARTH_RATE = 7.292115e-5
"""Rotation of the Earth, rad/s (WGS 84, NIMA TR8350.2, table 3.1)."""

EARTH_SPHERE_ROTATING = replace(EARTH_SPHERE, name="rotating sphere", rotation=EARTH_RATE)
"""`EARTH_SPHERE` with the Earth's rotation: isolates what the rotation does."""

WGS84 = Planet("WGS 84", 3.986004418e14, 6_378_137.0, 1.0 / 298.257223563, 1.08262982131e-3, EARTH_RATE)
"""Rotating ellipsoid (NIMA TR8350.2, 3rd ed. 2000, tables 3.1 and 3.3)."""

PLANETS: dict[str, Planet] = {
    "sphere": EARTH_SPHERE,
    "rotating-sphere": EARTH_SPHERE_ROTATING,
    "wgs84": WGS84,
}
"""The planets that can be chosen by name."""


def planet_named(name: str) -> Planet:
    """One of `PLANETS`.

    Raises:
        InputError: unknown name, with the nearest valid one.
    """
    if name not in PLANETS:
        raise InputError(unknown_name("planet", name, PLANETS))
    return PLANETS[name]


def gravity(planet: Planet, position: np.ndarray) -> np.ndarray:
    """[..., 3] gravitational acceleration, m/s2, at Cartesian positions [..., 3], m, in the axes of the position."""
    position = np.asarray(position, dtype=float)
    square = np.sum(position**2, axis=-1, keepdims=True)
    central = -planet.mu / (square * np.sqrt(square))
    bulge = 1.5 * planet.J2 * planet.radius**2 / square
    height = 5.0 * position[..., 2:3] ** 2 / square
    return central * position * (1.0 + bulge * (np.array([1.0, 1.0, 3.0]) - height))


def gravity_north_down(planet: Planet, radius: float, latitude: float) -> tuple[float, float]:
    """(north, down) gravity, m/s2, at a distance from the centre, m, and a planetocentric latitude, rad.

    North and down are those of the planetocentric horizon; the north component is that of the oblateness.
    """
    sine, cosine = math.sin(latitude), math.cos(latitude)
    weight = planet.mu / radius**2
    bulge = 1.5 * planet.J2 * (planet.radius / radius) ** 2
    return -2.0 * bulge * weight * sine * cosine, weight * (1.0 - bulge * (3.0 * sine**2 - 1.0))


def potential(planet: Planet, position: np.ndarray) -> np.ndarray:
    """[...] gravitational potential energy per mass, J/kg, negative, at Cartesian positions [..., 3], m."""
    position = np.asarray(position, dtype=float)
    square = np.sum(position**2, axis=-1)
    bulge = 0.5 * planet.J2 * planet.radius**2 / square
    return -planet.mu / np.sqrt(square) * (1.0 - bulge * (3.0 * position[..., 2] ** 2 / square - 1.0))


def cartesian(radius: float, longitude: float, latitude: float) -> np.ndarray:
    """[3] position, m, from the distance to the centre, m, longitude and planetocentric latitude, rad."""
    return radius * np.array(
        [
            math.cos(latitude) * math.cos(longitude),
            math.cos(latitude) * math.sin(longitude),
            math.sin(latitude),
        ]
    )


def spherical(position: np.ndarray) -> tuple[float, float, float]:
    """(distance from the centre m, longitude rad in (-pi, pi], planetocentric latitude rad) of a position [3], m.

    Raises:
        InputError: the position is the centre.
    """
    x, y, z = (float(value) for value in position)
    radius = math.sqrt(x * x + y * y + z * z)
    if not radius > 0.0:
        raise InputError("position = 0 m from the centre: must be above 0")
    return radius, math.atan2(y, x), math.atan2(z, math.hypot(x, y))


def geodetic(planet: Planet, position: np.ndarray) -> tuple[float, float, float]:
    """(altitude m, longitude rad, geodetic latitude rad) above the planet's ellipsoid of a position [3], m.

    Raises:
        InputError: the position lies deeper than half the polar radius from the centre.
    """
    x, y, z = (float(value) for value in position)
    altitude, latitude = geodetic_meridian(planet, math.hypot(x, y), z)
    return altitude, math.atan2(y, x), latitude


def geodetic_meridian(planet: Planet, axis_distance: float, z: float) -> tuple[float, float]:
    """(altitude m, geodetic latitude rad) of a point given by its distances from the polar axis and the equator, m.

    Bowring's iteration of the parametric latitude (Survey Review 23, 1976), which converges by about four digits a step
    near the Earth; on a sphere the answer is direct.

    Raises:
        InputError: the point lies deeper than half the polar radius from the centre.
    """
    a, b = planet.radius, planet.polar_radius
    distance = math.hypot(axis_distance, z)
    if not distance > _DEEPEST * b:
        raise InputError(f"radius = {distance:.6g} m: must be above {_DEEPEST * b:.6g} m, half the polar radius")
    if planet.flattening == 0.0:
        return distance - a, math.atan2(z, axis_distance)
    square = 1.0 - (b / a) ** 2
    parametric = math.atan2(a * z, b * axis_distance)
    for _ in range(20):
        latitude = math.atan2(
            z + square / (1.0 - square) * b * math.sin(parametric) ** 3,
            axis_distance - square * a * math.cos(parametric) ** 3,
        )
        following = math.atan2((b / a) * math.sin(latitude), math.cos(latitude))
        if abs(following - parametric) < 1e-15:
            break
        parametric = following
    sine, cosine = math.sin(latitude), math.cos(latitude)
    return axis_distance * cosine + z * sine - a * math.sqrt(1.0 - square * sine**2), latitude


def geodetic_to_cartesian(planet: Planet, altitude: float, longitude: float, latitude: float) -> np.ndarray:
    """[3] position, m, from the altitude above the ellipsoid, m, longitude and geodetic latitude, rad."""
    square = 1.0 - (planet.polar_radius / planet.radius) ** 2
    normal = planet.radius / math.sqrt(1.0 - square * math.sin(latitude) ** 2)
    across = (normal + altitude) * math.cos(latitude)
    return np.array(
        [
            across * math.cos(longitude),
            across * math.sin(longitude),
            (normal * (1.0 - square) + altitude) * math.sin(latitude),
        ]
    )


def planet_rate(planet: Planet) -> np.ndarray:
    """[3] angular velocity of the planet, rad/s, in inertial or planet-fixed axes."""
    return np.array([0.0, 0.0, planet.rotation])
