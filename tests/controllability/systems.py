"""Systems for the tests of this folder."""

from __future__ import annotations

import numpy as np
from tests.dynamics import horus

from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.statespace import STATES, StateSpace

NAMES = ("alpha", "q", "p", "beta", "r", "sigma", "V", "gamma", "R")
CONTROLS = ("elevator", "aileron", "rudder", "moment_x", "moment_y", "moment_z")


def system(A, B, states=NAMES, inputs=CONTROLS) -> StateSpace:
    """A system from plain lists."""
    A, B = np.atleast_2d(np.asarray(A, dtype=float)), np.asarray(B, dtype=float)
    B = B.reshape(len(A), -1)
    return StateSpace(A, B, tuple(states[: len(A)]), tuple(inputs[: B.shape[1]]))


def random_system(seed: int, n: int = 5, m: int = 2, unstable: int = 2) -> StateSpace:
    """Random A with a given number of unstable eigenvalues (an even one may hold pairs), random B."""
    rng = np.random.default_rng(seed)
    blocks = np.zeros((n, n))
    for k in range(n):
        blocks[k, k] = rng.uniform(0.2, 1.5) * (1 if k < unstable else -1)
    if unstable >= 2 and seed % 2:
        blocks[0, 0] = blocks[1, 1]
        blocks[0, 1], blocks[1, 0] = 1.7, -1.7
    T = rng.normal(size=(n, n)) + 2 * np.eye(n)
    return system(T @ blocks @ np.linalg.inv(T), rng.normal(size=(n, m)))


def horus_system(**changes) -> StateSpace:
    """HORUS-2B at the TAEM interface, every derivative at its usual size, so with all controls."""
    point = {key: changes.pop(key) for key in ("bank_deg", "alpha_deg") if key in changes}
    values = {**horus.EXTRA, **changes}
    return linearise(horus.point(**point), horus.MASS, horus.REFERENCE, horus.derivatives(**values))


def scaled(given: StateSpace, scale) -> StateSpace:
    """The same system with other units of the states: x_new = scale x."""
    scale = np.asarray(scale, dtype=float)
    A = scale[:, None] * given.A / scale[None, :]
    return StateSpace(A, scale[:, None] * given.B, given.states, given.inputs)


UNITS = dict(zip(STATES, [3e-3, 57.3, 1e-3, 57.3, 0.2, 7.0, 4.0, 90.0, 0.5], strict=True))
