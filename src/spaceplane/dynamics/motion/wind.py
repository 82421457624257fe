"""Air that moves against the planet: a steady wind by altitude, north, east and down in the planetocentric horizon.

The wind blows the same at all longitudes and latitudes of an altitude. It moves the air as a whole: the turning of the
air by its shear is not in the aerodynamic rates.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from spaceplane.dynamics import frames
from spaceplane.dynamics.motion.forces import Air
from spaceplane.dynamics.planet import Planet, geodetic_meridian, spherical
from spaceplane.environment.atmosphere import Ambient, us1976
from spaceplane.errors import InputError

Wind = Callable[[float], np.ndarray]
"""[3] velocity of the air north, east and down, m/s, at an altitude, m; raises InputError where it knows none."""

_STEP = 1e-3  # s of flight, for the change of the wind on the way


@dataclass(frozen=True)
class MovingAir:
    """The air by altitude, with its wind: takes the place of the still air wherever one is asked for.

    Attributes:
        wind: velocity against the planet by altitude.
        air: its state by altitude.
    """

    wind: Wind
    air: Air = us1976

    def __call__(self, altitude: float) -> Ambient:
        """The state of the air at an altitude, m."""
        return self.air(altitude)


def constant_wind(north: float = 0.0, east: float = 0.0, down: float = 0.0) -> Wind:
    """The same wind everywhere; where it blows to, m/s, not where it comes from.

    Raises:
        InputError: a component is not finite.
    """
    velocity = _velocity("wind", (north, east, down))
    return lambda altitude: velocity


def wind_profile(
    altitudes: Sequence[float], north: Sequence[float], east: Sequence[float], down: Sequence[float] | None = None
) -> Wind:
    """A wind linear between altitudes, and known only between the first and the last.

    Args:
        altitudes: two or more, increasing, m.
        north, east, down: where it blows to at each, m/s; nothing down by default.

    Raises:
        InputError: altitudes that do not increase, another number of components, or one that is not finite.
    """
    heights = np.array(altitudes, dtype=float)
    if heights.ndim != 1 or len(heights) < 2 or not np.isfinite(heights).all() or not (np.diff(heights) > 0).all():
        raise InputError("altitudes: must be two or more finite, increasing numbers, m")
    rows = []
    for name, values in (("north", north), ("east", east), ("down", np.zeros(len(heights)) if down is None else down)):
        row = np.array(values, dtype=float)
        if row.shape != heights.shape or not np.isfinite(row).all():
            raise InputError(f"{name}: must be {len(heights)} finite numbers, m/s, one for each altitude")
        rows.append(row)

    def wind(altitude: float) -> np.ndarray:
        """North, east and down, m/s, at an altitude, m."""
        if not heights[0] <= altitude <= heights[-1]:
            raise InputError(f"altitude = {altitude:.6g} m: the wind is known from {heights[0]:g} to {heights[-1]:g} m")
        return np.array([np.interp(altitude, heights, row) for row in rows])

    return wind


def air_velocity(air: Air, planet: Planet, position: np.ndarray) -> np.ndarray:
    """[3] wind against the planet, m/s, in the axes of the position [3], m: planet-fixed or inertial ones."""
    if not isinstance(air, MovingAir):
        return np.zeros(3)
    _, longitude, latitude = spherical(position)
    altitude = geodetic_meridian(planet, math.hypot(position[0], position[1]), float(position[2]))[0]
    velocity = _velocity(f"wind at {altitude:.6g} m", air.wind(altitude))
    return frames.planet_to_horizon(longitude, latitude).T @ velocity


def air_acceleration(air: Air, planet: Planet, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """[3] change of the wind met on the way, m/s2, in the axes of the position: central difference over 2 ms.

    Args:
        air: with its wind.
        planet: its figure.
        position: [3] m.
        velocity: [3] of the flight in the same axes, m/s.
    """
    if not isinstance(air, MovingAir):
        return np.zeros(3)
    ahead, behind = (air_velocity(air, planet, position + sign * _STEP * velocity) for sign in (1.0, -1.0))
    return (ahead - behind) / (2.0 * _STEP)


def _velocity(name: str, values: object) -> np.ndarray:
    velocity = np.array(values, dtype=float)
    if velocity.shape != (3,) or not np.isfinite(velocity).all():
        raise InputError(f"{name} = {values} m/s: must be three finite numbers, north, east and down")
    return velocity
