"""Gusts and offsets, and the exact response of a regulated vehicle to them.

A gust is a uniform change of the air's direction, in angle of attack (air rising) or sideslip (wind from the right). It
acts on the aerodynamics only, while `alpha` and `beta` of the model stay those of the velocity against the Earth, which
the feedback is taken to know. Strengths are the user's: a gust of w m/s at V m/s is an angle of w / V.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.model.derivatives import Derivatives
from spaceplane.control.regulator import Regulator
from spaceplane.dynamics.flightpoint import FlightPoint
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.response import Propagator, checked_state, checked_times, unit_of
from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

if TYPE_CHECKING:
    import xarray as xr

SHAPES = ("sharp", "one-cosine", "ramp")
AXES = {"alpha": ("CL_alpha", "CD_alpha", "Cm_alpha"), "beta": ("CY_beta", "Cl_beta", "Cn_beta")}


@dataclass(frozen=True)
class Gust:
    """A gust from t = 0 on.

    Attributes:
        shape: "sharp" (at once, and stays), "one-cosine" (A/2 (1 - cos(2 pi t/T)), then nothing) or "ramp"
            (A/2 (1 - cos(pi t/T)), then stays: the discrete gust of MIL-F-8785C, section 3.7).
        axis: "alpha" or "beta".
        angle: A, rad.
        duration: T, s; 0 for a sharp one.
        column: [state] what 1 rad of it adds to the time derivatives, see `gust_column`.
    """

    shape: str
    axis: str
    angle: float
    column: np.ndarray
    duration: float = 0.0

    def __post_init__(self) -> None:
        if self.shape not in SHAPES:
            raise InputError(unknown_name("gust", self.shape, SHAPES))
        if self.axis not in AXES:
            raise InputError(unknown_name("gust axis", self.axis, AXES))
        if not math.isfinite(self.angle):
            raise InputError(f"angle = {self.angle}: must be a finite number, rad")
        if self.shape != "sharp" and not (math.isfinite(self.duration) and self.duration > 0):
            raise InputError(f"duration = {self.duration}: a {self.shape} gust needs one above 0 s")

    def at(self, time: float) -> float:
        """Its angle, rad, at a time, s."""
        if time < 0:
            return 0.0
        if self.shape == "sharp":
            return self.angle
        if time >= self.duration:
            return 0.0 if self.shape == "one-cosine" else self.angle
        return self.angle / 2 * (1 - math.cos(self._frequency() * time))

    def _frequency(self) -> float:
        return (2 if self.shape == "one-cosine" else 1) * math.pi / self.duration

    def pieces(self) -> list[tuple[float, np.ndarray, np.ndarray, np.ndarray]]:
        """(from time s, start of [1, cos, sin], its matrix, the angle's row): each piece solves a linear equation."""
        still = np.zeros((3, 3))
        one = np.array([1.0, 0.0, 0.0])
        if self.shape == "sharp":
            return [(0.0, one, still, np.array([self.angle, 0.0, 0.0]))]
        w = self._frequency()
        swing = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -w], [0.0, w, 0.0]])
        last = 0.0 if self.shape == "one-cosine" else self.angle
        return [
            (0.0, np.array([1.0, 1.0, 0.0]), swing, self.angle / 2 * np.array([1.0, -1.0, 0.0])),
            (self.duration, one, still, np.array([last, 0.0, 0.0])),
        ]


def gust_column(
    axis: str,
    point: FlightPoint,
    mass: MassProperties,
    reference: ReferenceLengths,
    derivatives: Derivatives,
) -> np.ndarray:
    """[state] time derivatives per rad of gust: the part of A's column that is aerodynamics.

    Of the rigid-body form. Angular rates and accelerations of the air, so its delay along the body too, are left out.

    Args:
        axis: "alpha" or "beta".
        point: flight point with CL and CD.
        mass: kg, kg m2.
        reference: m2, m.
        derivatives: per rad.

    Raises:
        InputError: unknown axis.
    """
    if axis not in AXES:
        raise InputError(unknown_name("gust axis", axis, AXES))
    calm = replace(derivatives, **dict.fromkeys(AXES[axis], 0.0))
    with_air, without = (linearise(point, mass, reference, d) for d in (derivatives, calm))
    column = with_air.index(axis)
    return with_air.A[:, column] - without.A[:, column]


def disturbed(
    regulator: Regulator,
    times: Sequence[float],
    offsets: Mapping[str, float] | None = None,
    gust: Gust | None = None,
) -> xr.Dataset:
    """Response of the closed loop, without limits, exact at every time.

    Args:
        regulator: the feedback.
        times: from 0 on, s.
        offsets: {"alpha": at t = 0, ...}, SI units and rad. The feedback answers an offset at once: its inputs jump.
        gust: or none.

    Returns:
        Dims (time): states, inputs, `<input>_rate` (of the time after a jump), `gust` in rad.

    Raises:
        InputError: unknown states, bad times, a gust whose column does not fit.
    """
    import xarray as xr

    moments = checked_times(times)
    closed, K = regulator.closed(), regulator.gain
    n = len(closed.states)
    x = checked_state(closed, offsets or {})
    column = np.zeros(n) if gust is None else np.asarray(gust.column, dtype=float)
    if column.shape != (n,):
        raise InputError(f"gust: its column has {column.size} entries, the system {n} states")
    states, winds = np.zeros((len(moments), n)), np.zeros(len(moments))
    pieces = [(0.0, np.array([1.0, 0.0, 0.0]), np.zeros((3, 3)), np.zeros(3))] if gust is None else gust.pieces()
    for k, (start, seed, matrix, row) in enumerate(pieces):
        end = pieces[k + 1][0] if k + 1 < len(pieces) else math.inf
        both = np.block([[closed.A, np.outer(column, row)], [np.zeros((3, n)), matrix]])
        carry, state, now = Propagator(both), np.concatenate([x, seed]), start
        for j in np.flatnonzero((moments >= start) & (moments < end)):
            state, now = carry(state, moments[j] - now) if moments[j] > now else state, moments[j]
            states[j], winds[j] = state[:n], row @ state[n:]
        if math.isfinite(end):
            x = (carry(state, end - now) if end > now else state)[:n]
    inputs = -states @ K.T
    rates = -(states @ closed.A.T + np.outer(winds, column)) @ K.T
    variables = {
        name: ("time", states[:, k], {"units": unit_of(name), "role": "state"}) for k, name in enumerate(closed.states)
    }
    for k, name in enumerate(closed.inputs):
        variables[name] = ("time", inputs[:, k], {"units": unit_of(name), "role": "input"})
        variables[f"{name}_rate"] = ("time", rates[:, k], {"units": f"{unit_of(name)}/s", "role": "rate"})
    variables["gust"] = ("time", winds, {"units": "rad", "role": "gust"})
    return xr.Dataset(variables, coords={"time": ("time", moments, {"units": "s"})})
