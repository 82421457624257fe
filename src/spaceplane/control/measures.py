"""What the inputs can reach: controllable rank, distance to an uncontrollable mode, control of each mode."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig

from spaceplane.control.authority import Authority, chosen
from spaceplane.control.subspaces import balancing
from spaceplane.dynamics.modes import Mode, identify
from spaceplane.dynamics.response import unit_of
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.errors import InputError


@dataclass(frozen=True)
class ModalControl:
    """What each input can do to one mode.

    Attributes:
        mode: the mode.
        state: the state that takes the greatest part in it.
        unit: of `reach`.
        reach: {input: how far, in `state`, the motion may be displaced along the mode for the input at its limit to
            balance it, |x| |y* b| u / |eigenvalue|, twice that of a pair}; infinite for a neutral mode that the input
            moves. The displacement that can just be held if the mode is real and grows.
        share: {input: its part in the sum of all}, 0 to 1; zero throughout for a mode out of reach.
        distance: least singular value of [A - eigenvalue I, B], 1/s, in balanced states and inputs in units of their
            limits divided by the norm of that B: 0 is uncontrollable (Popov, Belevitch, Hautus).
    """

    mode: Mode
    state: str
    unit: str
    reach: Mapping[str, float]
    share: Mapping[str, float]
    distance: float


def controllable_rank(system: StateSpace, limits: Authority, tolerance: float = 1e-10) -> int:
    """Dimension of what the inputs can move, by the staircase of orthogonal transformations (Paige 1981).

    States are balanced and inputs in units of their limits. A rank says yes or no; `modal_control` says how well.

    Args:
        system: the system.
        limits: inputs and what they may do.
        tolerance: a singular value below this fraction of the norm of A, or at the first step of B, is zero.

    Raises:
        InputError: the tolerance is not between 0 and 1.
    """
    if not 0.0 < tolerance < 1.0:
        raise InputError(f"tolerance = {tolerance}: must lie between 0 and 1")
    A, B = _balanced(system, limits)
    size, rank = np.linalg.norm(A, 2), 0
    bound = tolerance * np.linalg.norm(B, 2)
    while len(A):
        U, values, _ = np.linalg.svd(B)
        r = int((values > bound).sum())
        rank += r
        if r in (0, len(A)):
            break
        A = U.T @ A @ U
        A, B = A[r:, r:], A[r:, :r]
        bound = tolerance * size
    return rank


def modal_control(system: StateSpace, limits: Authority) -> tuple[ModalControl, ...]:
    """What each input can do to each mode, fastest first.

    Reach and share do not depend on the units of the states, nor on how eigenvectors are normalised.

    Args:
        system: the system.
        limits: inputs and what they may do.
    """
    plant = chosen(system, limits.inputs)
    scale = limits.scale()
    values, left, right = eig(plant.A, left=True, right=True)
    A, B = _balanced(system, limits)
    out = []
    for mode in identify(plant):
        k = int(np.argmin(np.abs(values - mode.eigenvalue)))
        x, y = right[:, k], left[:, k]
        lead = int(np.argmax(mode.participation))
        with np.errstate(divide="ignore", invalid="ignore"):
            forcing = np.abs(x[lead] * (y.conj() @ plant.B) / (y.conj() @ x)) * scale
            reach = np.where(forcing > 0, (2.0 if mode.oscillatory else 1.0) * forcing / abs(mode.eigenvalue), 0.0)
        total = forcing.sum()
        share = forcing / total if total > 0 else np.zeros_like(forcing)
        distance = np.linalg.svd(np.hstack([A - mode.eigenvalue * np.eye(len(A)), B]), compute_uv=False)[-1]
        out.append(
            ModalControl(
                mode=mode,
                state=plant.states[lead],
                unit=unit_of(plant.states[lead]),
                reach=dict(zip(limits.inputs, reach.tolist(), strict=True)),
                share=dict(zip(limits.inputs, share.tolist(), strict=True)),
                distance=float(distance),
            )
        )
    return tuple(out)


def _balanced(system: StateSpace, limits: Authority) -> tuple[np.ndarray, np.ndarray]:
    """A in balanced states, and B with inputs in units of their limits, divided by its norm."""
    scales = balancing(system)
    A = system.A / scales[:, None] * scales[None, :]
    B = chosen(system, limits.inputs).B * limits.scale() / scales[:, None]
    norm = np.linalg.norm(B, 2)
    return A, B / norm if norm > 0 else B
