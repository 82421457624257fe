"""Turns between the frames and quaternion attitudes: round trips and rotations that are known."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from spaceplane.dynamics import attitude, frames
from spaceplane.errors import InputError

RIGHT = math.pi / 2
rng = np.random.default_rng(4)
ANGLES = [tuple(rng.uniform(-1.4, 1.4, 5)) for _ in range(10)]


def test_known_turns():
    x, y, z = np.eye(3)
    # an old x axis lies along the new -y after the axes turned by 90 deg about z
    assert frames.turn_z(RIGHT) @ x == pytest.approx(-y, abs=1e-15)
    assert frames.turn_x(RIGHT) @ y == pytest.approx(-z, abs=1e-15)
    assert frames.turn_y(RIGHT) @ z == pytest.approx(-x, abs=1e-15)


def test_horizon_at_known_places():
    """Components are (north, east, down)."""
    x, y, z = np.eye(3)
    equator = frames.planet_to_horizon(0.0, 0.0)
    assert equator @ z == pytest.approx([1, 0, 0], abs=1e-15)  # the pole lies north
    assert equator @ y == pytest.approx([0, 1, 0], abs=1e-15)
    assert equator @ x == pytest.approx([0, 0, -1], abs=1e-15)
    pacific = frames.planet_to_horizon(RIGHT, 0.0)
    assert pacific @ x == pytest.approx([0, -1, 0], abs=1e-15)
    pole = frames.planet_to_horizon(0.0, RIGHT)
    assert pole @ z == pytest.approx([0, 0, -1], abs=1e-15)
    assert pole @ x == pytest.approx([-1, 0, 0], abs=1e-15)
    assert frames.inertial_to_planet(0.1) @ [math.cos(0.1), math.sin(0.1), 0] == pytest.approx(x)


def test_known_paths_and_attitudes():
    assert frames.velocity_horizon(10, 0, 0) == pytest.approx([10, 0, 0])
    assert frames.velocity_horizon(10, 0, RIGHT) == pytest.approx([0, 10, 0], abs=1e-14)
    assert frames.velocity_horizon(10, 0.1, 0)[2] < 0  # climbing is up
    assert frames.velocity_body(10, 0.1, 0)[2] > 0  # nose up: the air comes from below
    assert frames.velocity_body(10, 0, 0.1)[1] > 0  # wind from the right
    # level to the north, right wing straight down: body y is down, body z is west
    banked = frames.horizon_to_body(0, 0, RIGHT, 0, 0)
    assert banked @ [0, 0, 1] == pytest.approx([0, 1, 0], abs=1e-15)
    assert banked @ [0, -1, 0] == pytest.approx([0, 0, 1], abs=1e-15)
    # nose up by the angle of attack
    nose = frames.horizon_to_body(0, 0, 0, 0.2, 0).T @ [1, 0, 0]
    assert nose == pytest.approx([math.cos(0.2), 0, -math.sin(0.2)])
    # wind from the right: nose left of the path
    assert (frames.horizon_to_body(0, 0, 0, 0, 0.2).T @ [1, 0, 0])[1] < 0


@pytest.mark.parametrize(("gamma", "chi", "bank", "alpha", "beta"), ANGLES)
def test_round_trips(gamma, chi, bank, alpha, beta):
    chi, bank, alpha = 2 * chi, 2 * bank, 2 * alpha
    assert frames.path_angles(frames.velocity_horizon(50, gamma, chi)) == pytest.approx((50, gamma, chi))
    assert frames.air_angles(frames.velocity_body(50, alpha, beta)) == pytest.approx((50, alpha, beta))
    to_body = frames.horizon_to_body(gamma, chi, bank, alpha, beta)
    assert to_body @ to_body.T == pytest.approx(np.eye(3), abs=1e-14) and np.linalg.det(to_body) == pytest.approx(1)
    assert frames.bank_angle(to_body, gamma, chi, alpha, beta) == pytest.approx(bank)
    # the velocity has the same body components by both routes
    direct = frames.velocity_body(50, alpha, beta)
    assert to_body @ frames.velocity_horizon(50, gamma, chi) == pytest.approx(direct)
    assert frames.wind_to_body(alpha, beta) @ [50, 0, 0] == pytest.approx(direct)
    for there, back in (
        (frames.wind_to_body(alpha, beta), frames.body_to_wind(alpha, beta)),
        (frames.trajectory_to_wind(bank), frames.wind_to_trajectory(bank)),
    ):
        assert there @ back == pytest.approx(np.eye(3), abs=1e-14)


def test_quaternions_against_an_independent_library():
    for _ in range(20):
        a, b = rng.normal(size=4), rng.normal(size=4)
        ours = attitude.matrix(a)
        assert ours == pytest.approx(Rotation.from_quat(a[[1, 2, 3, 0]]).as_matrix(), abs=1e-14)
        assert attitude.matrix(attitude.multiply(a, b)) == pytest.approx(ours @ attitude.matrix(b), abs=1e-14)
        yaw, pitch, roll = attitude.euler_angles(a)
        assert (yaw, pitch, roll) == pytest.approx(Rotation.from_matrix(ours).as_euler("ZYX"), abs=1e-12)
        assert attitude.matrix(attitude.from_euler(yaw, pitch, roll)) == pytest.approx(ours, abs=1e-14)
        vector = rng.normal(size=3)
        assert attitude.rotate(attitude.conjugate(a), attitude.rotate(a, vector)) == pytest.approx(vector)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, RIGHT, math.pi - 1e-9, math.pi, 4.0])
@pytest.mark.parametrize("axis", [*np.eye(3), (1, 1, 1), (-1, 2, 0.1)])
def test_matrix_and_back_at_every_angle(angle, axis):
    q = attitude.about_axis(axis, angle)
    back = attitude.from_matrix(attitude.matrix(q))
    assert attitude.angle_between(q, back) < 1e-14
    assert back[0] >= 0
    assert attitude.angle_between(q, attitude.IDENTITY) == pytest.approx(min(angle, 2 * math.pi - angle), abs=1e-15)


def test_quaternion_of_body_axes_is_the_transpose_of_the_turn():
    """Yawed by 90 deg, the nose points east."""
    q = attitude.from_euler(RIGHT, 0, 0)
    assert attitude.rotate(q, [1, 0, 0]) == pytest.approx([0, 1, 0], abs=1e-15)
    assert np.allclose(attitude.matrix(attitude.about_axis((0, 0, 1), 0.3)).T, frames.turn_z(0.3), atol=1e-15)
    assert attitude.rotate(attitude.from_euler(0, 0.2, 0), [1, 0, 0])[2] < 0  # nose up
    assert attitude.rotate(attitude.from_euler(0, 0, 0.2), [0, 1, 0])[2] > 0  # right wing down


def test_rate_is_the_derivative():
    q, omega = attitude.normalised([0.5, -0.2, 0.7, 0.1]), np.array([0.3, -0.4, 0.2])
    step = 1e-5
    turned = [attitude.multiply(q, attitude.about_axis(omega, sign * np.linalg.norm(omega) * step)) for sign in (-1, 1)]
    assert attitude.rate(q, omega) == pytest.approx((turned[1] - turned[0]) / (2 * step), abs=1e-10)


def test_euler_angles_straight_up_give_the_attitude_back():
    q = attitude.from_euler(0.4, RIGHT, 0.0)
    assert attitude.angle_between(attitude.from_euler(*attitude.euler_angles(q)), q) < 1e-7


def test_bad_input():
    with pytest.raises(InputError, match="quaternion"):
        attitude.normalised([0, 0, 0, 0])
    with pytest.raises(InputError, match="axis"):
        attitude.about_axis([0, 0, 0], 1.0)
    with pytest.raises(InputError, match="orthogonal"):
        attitude.from_matrix(2 * np.eye(3))
    with pytest.raises(InputError, match="orthogonal"):
        attitude.from_matrix(np.diag([1, 1, -1]))
    for function in (frames.path_angles, frames.air_angles):
        with pytest.raises(InputError, match="V"):
            function([0, 0, 0])
