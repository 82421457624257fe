"""The state of flight and its coordinates in the forms of the equations of motion.

`FlightState` is the form-free record: planet-fixed position and velocity, attitude against the planet-fixed axes, body
rates against inertial space. The coordinates of each form follow from it and lead back to it:

- trajectory: V, gamma, chi, R, lon, lat, p, q, r, alpha, beta, sigma (twelve numbers, singular straight up or down, at
  the poles and at 90 deg of sideslip),
- body-fixed: position, velocity and attitude quaternion against the planet-fixed axes, body rates (thirteen),
- body-inertial: the same against inertial axes, which coincide with the planet-fixed ones at time 0.

Velocity, angle of attack, sideslip, bank, flight-path angle and heading are those against the air, which turns with the
planet. Horizon, gamma, chi and lat are planetocentric, as in section 3.1.1 of the thesis.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spaceplane.dynamics import attitude, frames
from spaceplane.dynamics.planet import Planet, cartesian, planet_rate, spherical
from spaceplane.errors import InputError, unknown_name

TRAJECTORY_UNITS = {
    "V": "m/s",
    "gamma": "rad",
    "chi": "rad",
    "R": "m",
    "lon": "rad",
    "lat": "rad",
    "p": "rad/s",
    "q": "rad/s",
    "r": "rad/s",
    "alpha": "rad",
    "beta": "rad",
    "sigma": "rad",
}
TRAJECTORY_STATES = tuple(TRAJECTORY_UNITS)
"""Order of the coordinates in the trajectory form."""

# Closer than this to 90 deg, gamma, beta or lat leave the other angles without meaning.
_STEEPEST = math.radians(89.99)


@dataclass(frozen=True)
class FlightState:
    """Where the vehicle is, how it moves and how it stands.

    Attributes:
        position: [3] from the planet's centre, planet-fixed axes, m.
        velocity: [3] against the planet, planet-fixed axes, m/s.
        attitude: [4] quaternion of the body axes against the planet-fixed axes, scalar first; normalised here.
        rates: [3] p, q, r against inertial space, body axes, rad/s.

    Raises:
        InputError: a wrong length, a value that is not finite, or a position at the centre.
    """

    position: np.ndarray
    velocity: np.ndarray
    attitude: np.ndarray
    rates: np.ndarray

    def __post_init__(self) -> None:
        for name, count in (("position", 3), ("velocity", 3), ("attitude", 4), ("rates", 3)):
            value = np.array(getattr(self, name), dtype=float)
            if value.shape != (count,) or not np.all(np.isfinite(value)):
                raise InputError(f"{name} = {getattr(self, name)}: must be {count} finite numbers")
            object.__setattr__(self, name, value)
        object.__setattr__(self, "attitude", attitude.normalised(self.attitude))
        if not np.any(self.position):
            raise InputError("position = 0 m from the centre: must be above 0")


def from_trajectory(values: Mapping[str, float]) -> FlightState:
    """The state from the coordinates of the trajectory form by name, SI and rad.

    chi, lon, lat, p, q, r and beta are 0 where they are not given.

    Raises:
        InputError: a name is unknown, V, gamma, R, alpha or sigma is missing, or a value is outside its limits.
    """
    optional = dict.fromkeys(("chi", "lon", "lat", "p", "q", "r", "beta"), 0.0)
    for name in values:
        if name not in TRAJECTORY_STATES:
            raise InputError(unknown_name("state", name, TRAJECTORY_STATES))
    given = optional | dict(values)
    missing = [name for name in TRAJECTORY_STATES if name not in given]
    if missing:
        raise InputError(f"state: missing {', '.join(missing)}")
    return from_trajectory_array(np.array([float(given[name]) for name in TRAJECTORY_STATES]))


def from_trajectory_array(values: np.ndarray) -> FlightState:
    """The state from the [12] coordinates of the trajectory form, SI and rad.

    Raises:
        InputError: V or R is not above 0, a value is not finite, or gamma, beta or lat is beyond 90 deg.
    """
    for name, value in zip(TRAJECTORY_STATES, values, strict=True):
        if not math.isfinite(value):
            raise InputError(f"{name} = {value}: must be a finite number")
        if name in ("V", "R") and value <= 0:
            raise InputError(f"{name} = {value}: must be above 0")
        if name in ("gamma", "beta", "lat") and abs(value) > math.pi / 2:
            raise InputError(f"{name}_deg = {math.degrees(value):.6g}: must lie between -90 and 90")
    V, gamma, chi, R, lon, lat, p, q, r, alpha, beta, sigma = (float(value) for value in values)
    to_horizon = frames.planet_to_horizon(lon, lat)
    to_body = frames.horizon_to_body(gamma, chi, sigma, alpha, beta) @ to_horizon
    return FlightState(
        position=cartesian(R, lon, lat),
        velocity=to_horizon.T @ frames.velocity_horizon(V, gamma, chi),
        attitude=attitude.from_matrix(to_body.T),
        rates=np.array([p, q, r]),
    )


def to_trajectory(state: FlightState) -> np.ndarray:
    """[12] coordinates of the trajectory form, SI and rad; chi, lon, alpha and sigma in (-pi, pi].

    Raises:
        InputError: the velocity is zero.
    """
    R, lon, lat = spherical(state.position)
    to_horizon = frames.planet_to_horizon(lon, lat)
    V, gamma, chi = frames.path_angles(to_horizon @ state.velocity)
    to_body = attitude.matrix(state.attitude).T
    _, alpha, beta = frames.air_angles(to_body @ state.velocity)
    sigma = frames.bank_angle(to_body @ to_horizon.T, gamma, chi, alpha, beta)
    return np.array([V, gamma, chi, R, lon, lat, *state.rates, alpha, beta, sigma])


def check_regular(values: np.ndarray) -> None:
    """Refuse coordinates of the trajectory form at which its equations are singular.

    Raises:
        InputError: gamma, beta or lat is within 0.01 deg of 90 deg, or V or R is not above 0.
    """
    V, gamma, _, R, _, lat = (float(value) for value in values[:6])
    for name, value in (("gamma", gamma), ("lat", lat), ("beta", float(values[10]))):
        if not abs(value) < _STEEPEST:
            raise InputError(
                f"{name}_deg = {math.degrees(value):.6g}: the trajectory form is singular at 90 deg; take a body form"
            )
    for name, value in (("V", V), ("R", R)):
        if not value > 0:
            raise InputError(f"{name} = {value:.6g}: must be above 0")


def to_fixed(state: FlightState) -> np.ndarray:
    """[13] position m, velocity m/s, attitude, rates rad/s in the body-fixed form."""
    return np.concatenate([state.position, state.velocity, state.attitude, state.rates])


def from_fixed(values: np.ndarray) -> FlightState:
    """The state from the [13] numbers of the body-fixed form."""
    return FlightState(values[:3], values[3:6], values[6:10], values[10:13])


def to_inertial(state: FlightState, planet: Planet, time: float) -> np.ndarray:
    """[13] position m, velocity m/s, attitude, rates rad/s against inertial axes at a time, s."""
    angle = planet.rotation * time
    to_planet = frames.inertial_to_planet(angle)
    velocity = state.velocity + np.cross(planet_rate(planet), state.position)
    turn = attitude.about_axis((0.0, 0.0, 1.0), angle)
    return np.concatenate(
        [to_planet.T @ state.position, to_planet.T @ velocity, attitude.multiply(turn, state.attitude), state.rates]
    )


def from_inertial(values: np.ndarray, planet: Planet, time: float) -> FlightState:
    """The state from the [13] numbers of the body-inertial form at a time, s."""
    angle = planet.rotation * time
    to_planet = frames.inertial_to_planet(angle)
    position = to_planet @ values[:3]
    turn = attitude.about_axis((0.0, 0.0, 1.0), -angle)
    return FlightState(
        position=position,
        velocity=to_planet @ values[3:6] - np.cross(planet_rate(planet), position),
        attitude=attitude.multiply(turn, values[6:10]),
        rates=values[10:13],
    )
