"""Multilinear interpolation that refuses to leave its tables, and takes complex arguments.

A complex argument with a tiny imaginary part gives the exact slope of the interpolation (complex-step derivative;
Squire and Trapp, SIAM Review 40, 1998). At a node the slope jumps; `side` says which interval is meant.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spaceplane.errors import InputError

ROUND_OFF = 1e-10
"""Arguments this close to a node, relative to the larger of 1 and its size, are taken to lie on it."""

SIDES = ("right", "left")


class OutsideTables(InputError):  # noqa: N818  (what is wrong, not that something is)
    """A quantity lies outside the tables, or where they are empty.

    Attributes:
        quantity: its name.
        value: in its own unit: rad, or a Mach number.
        limits: least and greatest value of the tables; (nan, nan) inside them where they are empty.
    """

    def __init__(self, message: str, quantity: str, value: float, limits: tuple[float, float]) -> None:
        super().__init__(message)
        self.quantity, self.value, self.limits = quantity, value, limits


@dataclass(frozen=True)
class Place:
    """Where an argument lies on an axis.

    Attributes:
        index: of the interval's lower node.
        weight: of its upper node, 0 to 1; complex for a complex argument.
    """

    index: int
    weight: complex


def locate(axis: np.ndarray, value: complex, quantity: str, side: str = "right") -> Place:
    """The interval of an axis that holds a value.

    Args:
        axis: [node] increasing; rad or Mach number.
        value: real or, for a slope, with a tiny imaginary part.
        quantity: its name, for the error.
        side: at a node, the interval to its "right" or "left"; at an end there is only one.

    Raises:
        OutsideTables: the value lies outside the axis.
        InputError: it is not finite.
    """
    real = value.real
    if not math.isfinite(real):
        raise InputError(f"{quantity} = {real}: must be a finite number")
    near = int(np.argmin(np.abs(axis - real)))
    on_node = abs(axis[near] - real) <= ROUND_OFF * max(1.0, abs(axis[near]))
    if on_node:
        value = value - real + axis[near]
        index = near if side == "right" else near - 1
    elif axis[0] < real < axis[-1]:
        index = int(np.searchsorted(axis, real)) - 1
    else:
        raise OutsideTables(_outside(axis, real, quantity), quantity, float(real), (float(axis[0]), float(axis[-1])))
    index = min(max(index, 0), len(axis) - 2)
    return Place(index, (value - axis[index]) / (axis[index + 1] - axis[index]))


def is_node(axis: np.ndarray, value: float) -> bool:
    """Whether a value, rad or Mach number, is an inner node of an axis, where slopes jump."""
    inner = axis[1:-1]
    return bool(np.any(np.abs(inner - value) <= ROUND_OFF * np.maximum(1.0, np.abs(inner))))


def interpolate(table: np.ndarray, places: Sequence[Place]) -> complex | np.ndarray:
    """Value of a table at places on its first axes; NaN where a node that counts is empty.

    Args:
        table: [node of the first axis, node of the second axis, ...] in any unit.
        places: one for each of the first axes. What axes remain, the result has.
    """
    cell = table[tuple(slice(place.index, place.index + 2) for place in places)]
    for place in places:
        # A node without weight does not count, even if it is empty.
        if place.weight == 0:
            cell = cell[0]
        elif place.weight == 1:
            cell = cell[1]
        else:
            cell = cell[0] * (1 - place.weight) + cell[1] * place.weight
    return cell


def node_slope(axis: np.ndarray, values: np.ndarray, at: float) -> float:
    """Slope of values [node] between the nodes of an axis, per unit of the axis (rad or Mach number).

    At a node the mean of both sides, or the slope of the one that is known; NaN where none is.
    """
    quotients = np.diff(values) / np.diff(axis)
    right, left = (locate(axis, at, "argument", side).index for side in SIDES)
    known = [quotient for quotient in quotients[sorted({left, right})] if not np.isnan(quotient)]
    return float(sum(known) / len(known)) if known else math.nan


def in_user_units(quantity: str, value: float) -> str:
    """A value as text: a Mach number as it is, an angle in rad as degrees."""
    return f"{value:.6g}" if quantity == "mach" else f"{math.degrees(value):.6g} deg"


def _outside(axis: np.ndarray, value: float, quantity: str) -> str:
    lower, upper = (in_user_units(quantity, float(end)).removesuffix(" deg") for end in (axis[0], axis[-1]))
    unit = "" if quantity == "mach" else " deg"
    return f"{quantity} = {in_user_units(quantity, value)}: outside the tables, which run from {lower} to {upper}{unit}"
