"""Eigenvalues of uncertain derivatives, drawn: how far each scatters and how often it changes its kind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import REAL_TOLERANCE, Mode
from spaceplane.dynamics.sensitivity import moved_by
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.probability import Uncertainty


@dataclass(frozen=True)
class Spread:
    """How far the eigenvalue of one mode scatters.

    Attributes:
        real, imaginary: standard deviations of the parts of the eigenvalue, 1/s.
        same_kind: share of the draws in which it oscillates, or does not, as the nominal one; a ratio.
    """

    real: float
    imaginary: float
    same_kind: float


def eigenvalue_cloud(
    airframe: Airframe, uncertainty: Uncertainty, samples: int, seed: int = 0, form: str = "rigid-body"
) -> np.ndarray:
    """[draw, state] eigenvalues, 1/s, of the draws that `probability.outlooks` takes with the same seed.

    Args:
        airframe: vehicle at its flight point, with nominal derivatives.
        uncertainty: of the derivatives.
        samples: number of draws.
        seed: of the random numbers.
        form: as for `spaceplane.dynamics.linearise.linearise`.
    """
    a = airframe
    found = []
    for deviation in uncertainty.draw(samples, seed):
        changes = dict(zip(uncertainty.names, (float(x) for x in deviation), strict=True))
        point, derivatives = moved_by(changes, a.point, a.derivatives)
        found.append(np.linalg.eigvals(linearise(point, a.mass, a.reference, derivatives, form).A))
    return np.array(found, dtype=complex)


def spreads(cloud: np.ndarray, modes: Sequence[Mode]) -> tuple[Spread, ...]:
    """Spread of every mode; eigenvalues are paired with the nominal ones by the least sum of distances.

    Args:
        cloud: [draw, state] eigenvalues, 1/s.
        modes: nominal ones, all of them.
    """
    nominal = np.array([value for mode in modes for value in _pair(mode)])
    first = np.cumsum([0, *(2 if mode.oscillatory else 1 for mode in modes)])[:-1]
    paired = np.empty_like(cloud)
    for k, values in enumerate(cloud):
        _, order = linear_sum_assignment(np.abs(nominal[:, None] - values[None, :]))
        paired[k] = values[order]
    found = []
    for k, mode in zip(first, modes, strict=True):
        own = paired[:, k]
        oscillates = np.abs(own.imag) > REAL_TOLERANCE * np.abs(own)
        found.append(
            Spread(float(own.real.std()), float(np.abs(own.imag).std()), float(np.mean(oscillates == mode.oscillatory)))
        )
    return tuple(found)


def _pair(mode: Mode) -> tuple[complex, ...]:
    value = complex(mode.eigenvalue)
    return (value, value.conjugate()) if mode.oscillatory else (value,)
