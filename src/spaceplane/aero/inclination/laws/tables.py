"""Exact curves tabulated once and read for many panels."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from spaceplane.aero.inclination.compiled import kernel

KNOTS = 4096
"""Steps of a table of an attached shock; between them Cp is linear, good to 1e-6."""


def even_table(values: np.ndarray, most: float) -> Callable[[np.ndarray], np.ndarray]:
    """Interpolation in values at even steps of an angle from 0 to `most`, rad: [panel] angle -> [panel] value."""
    return lambda angle: _read_even(np.ascontiguousarray(angle, dtype=float), values, most)


def places() -> np.ndarray:
    """[knot] t from 0 to 1 at which `shock_law` wants Cp; the inclination there is (1 - t^2) of that at detachment.

    Cp rises to detachment like a square root; in t it is smooth.
    """
    return np.linspace(0.0, 1.0, KNOTS + 1)


def shock_law(attached: np.ndarray, most: float, stagnation: float) -> Callable[[np.ndarray], np.ndarray]:
    """A law by attached shocks up to detachment and a Newtonian one beyond.

    Past detachment the shock stands off and no tangent body exists. There Cp grows with sin^2 of the inclination, as in
    Newtonian theory, from the value at detachment to the stagnation value at a right angle: continuous and monotonic.

    Args:
        attached: [knot] Cp at `places`.
        most: inclination at detachment, rad.
        stagnation: Cp at a right angle.

    Returns:
        [panel] inclination, rad, 0 to pi/2 -> [panel] Cp.
    """
    return lambda inclination: _read_shock(np.ascontiguousarray(inclination, dtype=float), attached, most, stagnation)


@kernel
def _read_even(angle, values, most):
    steps = len(values) - 1
    out = np.empty(len(angle))
    for i in range(len(angle)):
        place = min(max(angle[i] / most, 0.0), 1.0) * steps
        left = min(int(place), steps - 1)
        out[i] = values[left] + (place - left) * (values[left + 1] - values[left])
    return out


@kernel
def _read_shock(inclination, attached, most, stagnation):
    steps = len(attached) - 1
    start = math.sin(most) ** 2
    growth = (stagnation - attached[0]) / (1.0 - start)
    out = np.empty(len(inclination))
    for i in range(len(inclination)):
        if inclination[i] < most:
            place = min(math.sqrt(1.0 - inclination[i] / most), 1.0) * steps
            left = min(int(place), steps - 1)
            out[i] = attached[left] + (place - left) * (attached[left + 1] - attached[left])
        else:
            out[i] = attached[0] + growth * (math.sin(inclination[i]) ** 2 - start)
    return out
