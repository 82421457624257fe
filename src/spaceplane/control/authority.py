"""What the controls may still do from their trim: limits of deflection and rate, of surfaces and of their combinations.

Limits of surfaces: `spaceplane.vehicle.controls.CONTROL_LIMITS_DEG`. The combined controls move pairs of surfaces: an
elevator or aileron both elevons, a rudder the two rudders, each of which moves outboard only. A rudder of 20 deg is one
rudder alone at 40 deg: with symmetric derivatives it does as much as both at 20 deg, one of them inboard, would.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from spaceplane.aero.model.derivatives import CONTROLS as AERODYNAMIC
from spaceplane.aero.model.derivatives import PAIRS
from spaceplane.dynamics.statespace import MOMENT_INPUTS, StateSpace
from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle.controls import CONTROL_LIMITS_DEG
from spaceplane.vehicle.controls import CONTROLS as SURFACES

RATE_LIMIT = math.radians(20.0)
"""rad/s for every surface: this project's assumption, of the size of a large elevon's actuator; HORUS-2B's are not
published."""


@dataclass(frozen=True)
class Authority:
    """What some inputs may do from trim.

    Attributes:
        inputs: names.
        low, high: [input] least and greatest value, rad or N m, as differences from trim.
        trim: deflection of each surface in trimmed flight, rad.
    """

    inputs: tuple[str, ...]
    low: np.ndarray
    high: np.ndarray
    trim: Mapping[str, float] = field(default_factory=dict)

    def scale(self) -> np.ndarray:
        """[input] the smaller of what is left on either side: what counts as 1 of an input.

        Raises:
            InputError: an input has nothing left on one side.
        """
        least = np.minimum(-self.low, self.high)
        for name, value in zip(self.inputs, least, strict=True):
            if not value > 0:
                raise InputError(f"{name}: its trim leaves nothing on one side; no symmetric feedback can use it")
        return least


def authority(
    inputs: Sequence[str], trim: Mapping[str, float] | None = None, moments: Mapping[str, float] | None = None
) -> Authority:
    """Limits of some inputs from trim.

    Args:
        inputs: names of controls, surfaces or moments.
        trim: deflections of surfaces in trimmed flight, rad; zero where not named.
        moments: greatest moment of thrusters, N m, for each of `moment_x`, `moment_y`, `moment_z` among the inputs.

    Raises:
        InputError: an unknown name, a control named with its surfaces, a trim outside its limits, a moment without a
            limit.
    """
    _check_inputs(inputs)
    at = _checked_trim(trim or {})
    given = moments or {}
    for name in given:
        if name not in MOMENT_INPUTS:
            raise InputError(unknown_name("moment", name, MOMENT_INPUTS))
    bounds = [_moment(name, given) if name in MOMENT_INPUTS else _deflection(name, at) for name in inputs]
    low, high = (np.array(values, dtype=float) for values in zip(*bounds, strict=True))
    return Authority(tuple(inputs), low, high, at)


def chosen(system: StateSpace, inputs: Sequence[str]) -> StateSpace:
    """The system with some of its inputs only, in the order given.

    Raises:
        InputError: none or an unknown one, one named twice, or a control named with its surfaces.
    """
    for name in inputs:
        if name not in system.inputs:
            raise InputError(unknown_name("input", name, system.inputs))
    _check_inputs(inputs)
    columns = [system.inputs.index(name) for name in inputs]
    return StateSpace(system.A, system.B[:, columns], system.states, tuple(inputs), system.form, system.reference)


def surface_positions(limits: Authority, inputs: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Deflection of every surface that some inputs move, rad: {surface: [...]}, trim included.

    Args:
        limits: with the trim.
        inputs: {input: values from trim, rad}; moments are passed over.
    """
    at = {name: np.asarray(limits.trim.get(name, 0.0), dtype=float) for name in SURFACES}
    moved: dict[str, np.ndarray] = {}
    for name, values in inputs.items():
        values = np.asarray(values, dtype=float)
        if name == "rudder":
            left, right = _rudders(float(at["rudder_left"]), float(at["rudder_right"]), values)
            moved["rudder_left"], moved["rudder_right"] = left, right
        elif name in PAIRS:
            first, second, sign = PAIRS[name]
            moved[first] = moved.get(first, at[first]) + values
            moved[second] = moved.get(second, at[second]) + sign * values
        elif name in SURFACES:
            moved[name] = moved.get(name, at[name]) + values
    return moved


def surface_limits(surface: str) -> tuple[float, float]:
    """Least and greatest deflection of a surface, rad."""
    low, high = CONTROL_LIMITS_DEG[surface]
    return math.radians(low), math.radians(high)


def _rudders(left: float, right: float, rudder: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both rudders for a combined one: each takes half until one is at a limit, then the other does the rest."""
    low, high = surface_limits("rudder_left")
    half = np.clip(left + rudder, low, high), np.clip(right - rudder, low, high)
    lacking = left + rudder - half[0], half[1] - (right - rudder)
    return half[0] + lacking[1], half[1] - lacking[0]


def _deflection(name: str, trim: Mapping[str, float]) -> tuple[float, float]:
    if name not in PAIRS:
        low, high = surface_limits(name)
        return low - trim[name], high - trim[name]
    first, second, sign = PAIRS[name]
    (low1, high1), (low2, high2) = ([x - trim[s] for x in surface_limits(s)] for s in (first, second))
    if name == "rudder":
        return (low1 - high2) / 2, (high1 - low2) / 2
    if sign > 0:
        return max(low1, low2), min(high1, high2)
    return max(low1, -high2), min(high1, -low2)


def _moment(name: str, given: Mapping[str, float]) -> tuple[float, float]:
    value = given.get(name)
    if value is None or not (math.isfinite(value) and value > 0):
        raise InputError(f"{name} = {value}: needs the greatest moment of its thrusters, N m, above 0")
    return -float(value), float(value)


def _check_inputs(inputs: Sequence[str]) -> None:
    if not inputs or len(set(inputs)) != len(inputs):
        raise InputError(f"inputs = {', '.join(inputs) or 'none'}: one or more are needed, each once")
    for name in inputs:
        if name not in (*AERODYNAMIC, *MOMENT_INPUTS):
            raise InputError(unknown_name("input", name, (*AERODYNAMIC, *MOMENT_INPUTS)))
    for combined, (first, second, _) in PAIRS.items():
        if combined in inputs and (first in inputs or second in inputs):
            raise InputError(f"inputs: {combined} moves {first} and {second}; name the one or the others")


def _checked_trim(trim: Mapping[str, float]) -> dict[str, float]:
    for name in trim:
        if name not in SURFACES:
            raise InputError(unknown_name("control surface", name, SURFACES))
    at = {name: float(trim.get(name, 0.0)) for name in SURFACES}
    for name, value in at.items():
        low, high = surface_limits(name)
        if not low - 1e-9 <= value <= high + 1e-9:
            raise InputError(f"trim of {name} = {math.degrees(value):.4g} deg: must lie in {CONTROL_LIMITS_DEG[name]}")
    return at
