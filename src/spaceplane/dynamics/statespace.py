"""A linear time-invariant system with named states and inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from spaceplane.errors import InputError

STATES = ("V", "gamma", "R", "p", "q", "r", "alpha", "beta", "sigma")
STATE_UNITS = {
    "V": "m/s",
    "gamma": "rad",
    "R": "m",
    "p": "rad/s",
    "q": "rad/s",
    "r": "rad/s",
    "alpha": "rad",
    "beta": "rad",
    "sigma": "rad",
}
MOMENT_INPUTS = ("moment_x", "moment_y", "moment_z")


@dataclass(frozen=True)
class StateSpace:
    """dx/dt = A x + B u, for perturbations x and u.

    Attributes:
        A: [state, state] SI units and rad.
        B: [state, input] deflections in rad, moments (`moment_x`, ...) in N m.
        states: names of the rows.
        inputs: names of the columns of B.
        form: "rigid-body", "thesis" or a free label.
        reference: values of the states at the flight point; empty if unknown.
    """

    A: np.ndarray
    B: np.ndarray
    states: tuple[str, ...]
    inputs: tuple[str, ...] = ()
    form: str = "given"
    reference: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        n, m = len(self.states), len(self.inputs)
        if np.shape(self.A) != (n, n) or np.shape(self.B) != (n, m):
            raise InputError(
                f"state space: A is {np.shape(self.A)}, B is {np.shape(self.B)}, {n} states and {m} inputs named"
            )
        if len(set(self.states)) != n or len(set(self.inputs)) != m:
            raise InputError("state space: every state and input needs a name of its own")
        if not (np.all(np.isfinite(self.A)) and np.all(np.isfinite(self.B))):
            raise InputError("state space: A and B must be finite")

    def index(self, state: str) -> int:
        """Row of a state."""
        return self.states.index(state)


def from_matrix(A: np.ndarray, states: tuple[str, ...], form: str = "given") -> StateSpace:
    """A system without inputs: A [state, state], SI units and rad, its states by name."""
    matrix = np.asarray(A, dtype=float)
    return StateSpace(matrix, np.zeros((len(states), 0)), tuple(states), (), form)
