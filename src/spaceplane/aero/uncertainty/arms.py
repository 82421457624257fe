"""Errors of forces and of the moments that they make, tied by how far the wall lies from the moment centre.

A moment's error comes from pressures on the wall, none of which has a longer arm than the farthest wall: forces are off
by no less than what makes it there. Near the speed of sound shocks stand on the wall itself. A coarser mesh shifts the
load along the body as well as it changes it: there a pitching moment is off by no less than the lift's error acting at
the wall's root-mean-square distance. And a body that turns meets the stream at an angle that grows with the distance
from the moment centre, q x / V: there the derivatives by a rate are off by no less than those by the angle, times the
angle that the rate makes at the farthest wall along x.

Axial force is the sum of what looks upstream and what looks downstream. That a mesh errs on them in opposite ways is
chance, so it and drag are off by no less than both shares as if these were independent.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.uncertainty.grid import transonic

if TYPE_CHECKING:
    import xarray as xr

ANGLE_OF_RATE = {"q": "alpha", "r": "beta"}
"""The angle at which a turning body meets the stream ahead of and behind the moment centre."""


@dataclass(frozen=True)
class Arms:
    """How far the wall lies from the moment centre, in the reference lengths of the moments.

    Attributes:
        pitch: farthest wall along x or z on the chord.
        yaw: farthest wall along x or y on the span.
        mean_pitch: root mean square along x, by area, on the chord.
        along_chord: farthest wall along x on the chord.
        along_span: the same on the span.
    """

    pitch: float
    yaw: float
    mean_pitch: float
    along_chord: float
    along_span: float


def arms_of(coefficients: xr.Dataset) -> Arms:
    """Arms of the body that `integrate` gave these coefficients of."""
    head = coefficients.attrs
    x, y, z = (float(v) for v in head["wall_reach_m"])
    chord, span = head["c_ref_m"], head["b_ref_m"]
    mean = float(head["wall_rms_m"][0])
    return Arms(max(x, z) / chord, max(x, y) / span, mean / chord, x / chord, x / span)


def floors(groups: Sequence[str], arms: Arms, mach: np.ndarray) -> dict[str, list[tuple[str, np.ndarray]]]:
    """Group to others and the share of the mean error [condition] of each that is the least of its own.

    Args:
        groups: "lift", "drag", "shares", "side", "pitch", "roll" or "yaw", a space, and the quantity of a derivative.
        arms: of the body.
        mach: [condition] Mach number.
    """
    always, near = np.ones(len(mach)), transonic(mach).astype(float)
    shares = {
        "lift": ("pitch", always / arms.pitch),
        "side": ("yaw", always / arms.yaw),
        # the root of the sum of the squares of both: sqrt(2) of their root mean square
        "drag": ("shares", math.sqrt(2.0) * always),
        "pitch": ("lift", near * arms.mean_pitch),
    }
    # rates are reduced by half the length, q c / 2V: at x the angle is 2 x / c of them
    angles = {"q": near * 2.0 * arms.along_chord, "r": near * 2.0 * arms.along_span}
    found: dict[str, list[tuple[str, np.ndarray]]] = {}
    for group in dict.fromkeys(groups):
        kind, space, quantity = group.partition(" ")
        ties = []
        if kind in shares:
            other, share = shares[kind]
            ties.append((f"{other}{space}{quantity}", share))
        if quantity in angles:
            ties.append((f"{kind} {ANGLE_OF_RATE[quantity]}", angles[quantity]))
        if ties:
            found[group] = ties
    return found
