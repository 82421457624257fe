"""Steady rotation: the equations in axes that turn with the body, with velocities that do not.

The state keeps the air's velocity relative to the turning centre, which is the free stream's everywhere far away. Faces
move at omega x r: a face flux is taken in axes that move with the face and carried back, and turning the axes adds
rho omega x (u - u_inf) to the momentum of a volume. M. Vinokur, J. Comput. Phys. 81 (1989) 1-52, on moving volumes;
A. C. Limache, E. M. Cliff, J. Aircraft 37 (2000) 676-683, on derivatives from steady rotation.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from spaceplane.flow.compiled import LANES, PRS, RHO, VX, VY, VZ, distinct
from spaceplane.flow.freestream import velocity
from spaceplane.flow.solution import FlowConditions


class Frame(NamedTuple):
    """Rotation of the lanes of an ensemble, geometry axes, solver's units.

    Attributes:
        spin: [xyz, lane] angular velocity omega, 1/m.
        drift: [xyz, lane] velocity of the axes' origin, -omega x centre.
        still: [xyz, lane] free-stream velocity: air at rest, seen from the turning centre.
        turns: 1 where any lane turns, else 0.
    """

    spin: np.ndarray
    drift: np.ndarray
    still: np.ndarray
    turns: np.ndarray


def frame_of(conditions: FlowConditions, lanes: np.ndarray, dtype: type) -> Frame:
    """Frame of the conditions in `lanes` [lane]."""
    spin = conditions.angular_velocity()[lanes]
    drift = -np.cross(spin, np.asarray(conditions.center, dtype=float))
    still = velocity(conditions.mach, conditions.alpha, conditions.beta)[lanes]
    turns = np.array([spin.any()], dtype=np.int32)
    return Frame(*(np.ascontiguousarray(value.T, dtype=dtype) for value in (spin, drift, still)), turns)


@distinct
def face_speed(frame, sx, sy, sz, nx, ny, nz, speed):
    """Fill `speed` [lane] with the normal velocity of a face with normal n and swirl s = centroid x normal."""
    spin = frame.spin
    drift = frame.drift
    for n in range(LANES):
        turned = spin[0, n] * sx + spin[1, n] * sy + spin[2, n] * sz
        speed[n] = turned + drift[0, n] * nx + drift[1, n] * ny + drift[2, n] * nz


@distinct
def follow(side, speed, nx, ny, nz):
    """Take the velocity of a face, `speed` [lane] along its normal, from the state on one side of it."""
    for n in range(LANES):
        side[VX + n] -= speed[n] * nx
        side[VY + n] -= speed[n] * ny
        side[VZ + n] -= speed[n] * nz


@distinct
def carry_back(f, speed, nx, ny, nz):
    """Turn area * flux in axes that move with the face at `speed` [lane] into that in axes at rest.

    Momentum grows by the mass times the face's velocity, energy by the work of the momentum and the kinetic energy of
    the mass; the gauge pressure's share of the work cancels over a closed volume and is left out everywhere.
    """
    for n in range(LANES):
        s = speed[n]
        mass = f[RHO + n]
        push = f[VX + n] * nx + f[VY + n] * ny + f[VZ + n] * nz
        f[PRS + n] += s * (push + type(s)(0.5) * s * mass)
        f[VX + n] += s * mass * nx
        f[VY + n] += s * mass * ny
        f[VZ + n] += s * mass * nz


@distinct
def add_turning(frame, rows, residual, i, volume):
    """Add to the residual of cell i what turning the axes does to momentum and energy."""
    spin = frame.spin
    still = frame.still
    for n in range(LANES):
        weight = volume * rows[i, RHO + n]
        ox, oy, oz = spin[0, n], spin[1, n], spin[2, n]
        u = rows[i, VX + n] - still[0, n]
        v = rows[i, VY + n] - still[1, n]
        w = rows[i, VZ + n] - still[2, n]
        fx = weight * (oy * w - oz * v)
        fy = weight * (oz * u - ox * w)
        fz = weight * (ox * v - oy * u)
        residual[i, VX + n] += fx
        residual[i, VY + n] += fy
        residual[i, VZ + n] += fz
        residual[i, PRS + n] += fx * still[0, n] + fy * still[1, n] + fz * still[2, n]
