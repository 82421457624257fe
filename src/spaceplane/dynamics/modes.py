"""Eigenmodes of a linear system: how they move, how fast, and what they are called.

Participation factors (Perez-Arriaga, Verghese and Schweppe 1982) say what moves: the product of the components of the
left and right eigenvectors at a state, which does not depend on the units of the states, unlike the eigenvector.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig

from spaceplane.dynamics.mode_names import PITCH_APERIODIC, Naming, name_mode, without_pitch_stiffness
from spaceplane.dynamics.statespace import StateSpace

# An imaginary part below this fraction of the modulus is round-off of a double real eigenvalue.
REAL_TOLERANCE = 1e-8
# An eigenvalue below this fraction of the largest is zero: beyond what double precision can tell.
NEUTRAL_TOLERANCE = 1e-11


@dataclass(frozen=True)
class Mode:
    """One real eigenvalue or one conjugate pair.

    Attributes:
        name: what it is, by what takes part in it; textbook names only where they hold.
        kind: key of the name, see `spaceplane.dynamics.mode_names.KINDS`.
        eigenvalue: 1/s, the one with the positive imaginary part of a pair.
        oscillatory: whether it is a pair.
        period: s; None if aperiodic.
        half_time: s in which the amplitude halves; None if it does not decay.
        double_time: s in which the amplitude doubles; None if it does not grow.
        damping_ratio: -Re / |eigenvalue|; None if aperiodic.
        natural_frequency: |eigenvalue|, rad/s.
        eigenvector: [state] SI units and rad, Euclidean norm 1, largest component real and positive.
        participation: [state] shares, adding to 1.
        states: names of the components.
        group: "longitudinal", "lateral" or "coupled".
        explanation: one sentence on why it has its name.
    """

    name: str
    kind: str
    eigenvalue: complex
    oscillatory: bool
    period: float | None
    half_time: float | None
    double_time: float | None
    damping_ratio: float | None
    natural_frequency: float
    eigenvector: np.ndarray
    participation: np.ndarray
    states: tuple[str, ...]
    group: str
    explanation: str

    @property
    def stable(self) -> bool:
        """Whether its amplitude decays."""
        return self.half_time is not None

    def share(self, *states: str) -> float:
        """Participation of some states together, 0 to 1; states that the system lacks count nothing."""
        return float(sum(self.participation[self.states.index(s)] for s in states if s in self.states))


def identify(system: StateSpace) -> tuple[Mode, ...]:
    """Eigenmodes of any system with named states, fastest first.

    Names are given by participation; the states that count are V, u, w, gamma, theta, R, h, q, alpha (longitudinal)
    and p, r, beta, v, sigma, phi, psi, chi (lateral).
    """
    values, left, right = eig(system.A, left=True, right=True)
    largest = float(np.abs(values).max(initial=0.0))
    found = []
    for k in np.argsort(-np.abs(values), kind="stable"):
        value = complex(values[k])
        if abs(value.imag) <= REAL_TOLERANCE * abs(value):
            value = complex(value.real, 0.0)
        if abs(value) <= NEUTRAL_TOLERANCE * largest:
            value = 0j
        if value.imag < 0:
            continue
        share = _participation(left[:, k], right[:, k])
        found.append((value, right[:, k], share, name_mode(value, dict(zip(system.states, share, strict=True)))))
    if any(value.real > 0 and naming.kind in PITCH_APERIODIC for value, _, _, naming in found):
        found = [(value, vector, share, without_pitch_stiffness(naming)) for value, vector, share, naming in found]
    return tuple(_mode(value, vector, share, naming, system.states) for value, vector, share, naming in found)


def _participation(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """[state] shares, adding to 1.

    The left and right eigenvectors of a defective eigenvalue (a double zero, say) have no state in common; there the
    mean of their own shares stands in.
    """
    share = np.abs(left.conj() * right)
    if share.sum() > 1e-12 * np.linalg.norm(left) * np.linalg.norm(right):
        return share / share.sum()
    own = [np.abs(vector) ** 2 / np.linalg.norm(vector) ** 2 for vector in (left, right)]
    return 0.5 * (own[0] + own[1])


def _mode(value: complex, right: np.ndarray, share: np.ndarray, naming: Naming, states: tuple[str, ...]) -> Mode:
    vector = right / np.linalg.norm(right)
    vector = vector * np.exp(-1j * np.angle(vector[np.argmax(np.abs(vector))]))
    growth, oscillatory = value.real, value.imag > 0
    return Mode(
        name=naming.name,
        kind=naming.kind,
        eigenvalue=value,
        oscillatory=oscillatory,
        period=2 * math.pi / value.imag if oscillatory else None,
        half_time=math.log(2) / -growth if growth < 0 else None,
        double_time=math.log(2) / growth if growth > 0 else None,
        damping_ratio=-growth / abs(value) if oscillatory else None,
        natural_frequency=abs(value),
        eigenvector=vector,
        participation=share,
        states=states,
        group=naming.group,
        explanation=naming.explanation,
    )


def to_record(mode: Mode) -> dict:
    """The mode as plain JSON types; missing numbers are None, phases in degrees relative to the largest component."""
    return {
        "name": mode.name,
        "kind": mode.kind,
        "group": mode.group,
        "eigenvalue": [mode.eigenvalue.real, mode.eigenvalue.imag],
        "oscillatory": mode.oscillatory,
        "stable": mode.stable,
        "period_s": mode.period,
        "half_time_s": mode.half_time,
        "double_time_s": mode.double_time,
        "damping_ratio": mode.damping_ratio,
        "natural_frequency_rads": mode.natural_frequency,
        "eigenvector": {
            state: {"magnitude": float(abs(z)), "phase_deg": float(np.degrees(np.angle(z)))}
            for state, z in zip(mode.states, mode.eigenvector, strict=True)
        },
        "participation": {state: float(x) for state, x in zip(mode.states, mode.participation, strict=True)},
        "explanation": mode.explanation,
    }
