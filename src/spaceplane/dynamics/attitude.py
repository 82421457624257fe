"""Attitudes as unit quaternions.

A quaternion is [w, x, y, z], scalar first, with Hamilton's product. The attitude q of axes B against axes A turns
components in B into components in A: v_A = q v_B q*; so `matrix(q)` is the [3, 3] matrix that gives A components of
a vector known in B, and `matrix(q).T` the other way, which is the sense of the turns in `spaceplane.dynamics.frames`.
q and -q are the same attitude. Attitudes chain as `multiply(q_AB, q_BC) = q_AC`. See Stevens, Lewis and Johnson,
Aircraft Control and Simulation, 3rd ed. (2016), section 1.8.

Functions take any leading axes: quaternions [..., 4], vectors [..., 3]. A quaternion need not be normalised for
`matrix`, `rotate` and `euler_angles`: its length cancels there, so that round-off of an integration does no harm.
"""

from __future__ import annotations

import numpy as np

from spaceplane.errors import InputError

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])
"""The attitude of axes that coincide."""


def normalised(q: np.ndarray) -> np.ndarray:
    """The quaternion with length 1.

    Raises:
        InputError: a component is not finite or all are zero.
    """
    q = np.asarray(q, dtype=float)
    length = np.linalg.norm(q, axis=-1, keepdims=True)
    if not (np.all(np.isfinite(length)) and np.all(length > 0)):
        raise InputError(f"quaternion = {q.tolist()}: must be finite and not zero")
    return q / length


def multiply(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Hamilton's product a b, [..., 4]."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    aw, ax, ay, az = (a[..., k] for k in range(4))
    bw, bx, by, bz = (b[..., k] for k in range(4))
    return np.stack(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ],
        axis=-1,
    )


def conjugate(q: np.ndarray) -> np.ndarray:
    """The opposite turn: [w, -x, -y, -z]."""
    return np.asarray(q, dtype=float) * np.array([1.0, -1.0, -1.0, -1.0])


def about_axis(axis: np.ndarray, angle: float) -> np.ndarray:
    """[4] attitude of axes turned by an angle, rad, right-handed about an axis [3] of any length.

    Raises:
        InputError: the axis is zero or not finite.
    """
    axis = np.asarray(axis, dtype=float)
    length = np.linalg.norm(axis)
    if not (np.isfinite(length) and length > 0):
        raise InputError(f"axis = {axis.tolist()}: must be finite and not zero")
    return np.array([np.cos(angle / 2), *(np.sin(angle / 2) / length * axis)])


def matrix(q: np.ndarray) -> np.ndarray:
    """[..., 3, 3] components in A of a vector given in B, from the attitude of B against A."""
    q = np.asarray(q, dtype=float)
    w, x, y, z = (q[..., k] for k in range(4))
    square = w * w + x * x + y * y + z * z
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2) / square[..., None, None]


def from_matrix(turn: np.ndarray) -> np.ndarray:
    """[4] attitude, with w >= 0, from the [3, 3] matrix that gives A components of a vector in B.

    The largest component is found first, so that no digits are lost at any attitude (Shepperd 1978).

    Raises:
        InputError: the matrix is not orthogonal with determinant 1, to 1e-6.
    """
    R = np.asarray(turn, dtype=float)
    if R.shape != (3, 3) or not (np.allclose(R @ R.T, np.eye(3), atol=1e-6) and np.linalg.det(R) > 0):
        raise InputError("attitude matrix: must be 3 x 3 and orthogonal with determinant 1")
    trace = np.trace(R)
    squares = np.array([1 + trace, *(1 + 2 * np.diag(R) - trace)])  # four times the square of each component
    k = int(np.argmax(squares))
    twice = np.sqrt(squares[k])
    across = (R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1])
    if k == 0:
        q = np.array([squares[0], *across])
    else:
        i, j, n = k - 1, k % 3, (k + 1) % 3
        q = np.zeros(4)
        q[0] = across[i]
        q[1 + i] = squares[k]
        q[1 + j] = R[i, j] + R[j, i]
        q[1 + n] = R[i, n] + R[n, i]
    q = q / (2 * twice)
    return normalised(q if q[0] >= 0 else -q)


def rotate(q: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """[..., 3] components in A of vectors [..., 3] given in B."""
    return np.einsum("...ij,...j->...i", matrix(q), np.asarray(vector, dtype=float))


def rate(q: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """[4] dq/dt, 1/s, of axes B that turn against A with the angular velocity omega [3], rad/s, in B components."""
    w, x, y, z = (float(value) for value in q)
    p, q_, r = (float(value) for value in omega)
    return 0.5 * np.array(
        [
            -x * p - y * q_ - z * r,
            w * p + y * r - z * q_,
            w * q_ + z * p - x * r,
            w * r + x * q_ - y * p,
        ]
    )


def from_euler(yaw: float, pitch: float, roll: float) -> np.ndarray:
    """[4] attitude from yaw about z, then pitch about the new y, then roll about the new x, rad."""
    first = multiply(about_axis((0, 0, 1), yaw), about_axis((0, 1, 0), pitch))
    return multiply(first, about_axis((1, 0, 0), roll))


def euler_angles(q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(yaw, pitch, roll), rad, of attitudes [..., 4]: yaw and roll in (-pi, pi], pitch in [-pi/2, pi/2].

    At a pitch of 90 deg yaw and roll are one turn; all of it is then given to yaw or shared in some way, and the
    attitude is still the right one.
    """
    R = matrix(q)
    pitch = np.arctan2(-R[..., 2, 0], np.hypot(R[..., 0, 0], R[..., 1, 0]))
    steep = np.hypot(R[..., 0, 0], R[..., 1, 0]) < 1e-12
    yaw = np.where(steep, np.arctan2(-R[..., 0, 1], R[..., 1, 1]), np.arctan2(R[..., 1, 0], R[..., 0, 0]))
    roll = np.where(steep, 0.0, np.arctan2(R[..., 2, 1], R[..., 2, 2]))
    return yaw, pitch, roll


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """[...] least angle, rad, by which one attitude is turned against the other."""
    turn = multiply(conjugate(normalised(a)), normalised(b))
    return 2 * np.arctan2(np.linalg.norm(turn[..., 1:], axis=-1), np.abs(turn[..., 0]))
