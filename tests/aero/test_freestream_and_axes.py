import numpy as np

from spaceplane.aero.axes import geometry_to_body, wind_axes
from spaceplane.flow.freestream import direction, velocity


def test_angle_of_attack_brings_air_from_below_and_sideslip_from_the_right():
    np.testing.assert_allclose(direction(0.0, 0.0), [1.0, 0.0, 0.0])
    assert direction(0.2, 0.0)[2] > 0.0
    assert direction(0.0, 0.2)[1] < 0.0


def test_angles_follow_from_body_axis_velocity_by_their_definitions():
    alpha, beta = np.array([0.3, -0.1, 1.0]), np.array([0.1, 0.4, -0.7])
    u, v, w = -geometry_to_body(direction(alpha, beta)).T
    np.testing.assert_allclose(np.arctan2(w, u), alpha)
    np.testing.assert_allclose(np.arcsin(v), beta)


def test_wind_axes_are_orthonormal_and_reduce_to_geometry_axes():
    alpha, beta = np.array([0.0, 0.3, 1.2]), np.array([0.0, -0.5, 0.2])
    axes = wind_axes(alpha, beta)
    frame = np.stack([axes.drag, axes.side, axes.lift], axis=1)
    np.testing.assert_allclose(frame @ frame.transpose(0, 2, 1), np.tile(np.eye(3), (3, 1, 1)), atol=1e-15)
    np.testing.assert_allclose(np.linalg.det(frame), 1.0)
    np.testing.assert_allclose(frame[0], np.eye(3), atol=1e-15)


def test_velocity_has_the_mach_number_as_length():
    speeds = np.linalg.norm(velocity(np.array([0.5, 10.0]), np.array([0.1, 0.4]), np.array([0.2, 0.0])), axis=1)
    np.testing.assert_allclose(speeds, [0.5, 10.0])
