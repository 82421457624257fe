"""Errors of forces and of the moments that they make, tied by how far the wall lies from the moment centre.

A moment's error comes from pressures on the wall, none of which has a longer arm than the farthest wall: forces are off
by no less than what makes it there. Near the speed of sound shocks stand on the wall itself, and a coarser mesh shifts
the load along the body as well as it changes it: there a pitching moment is off by no less than the lift's error acting
at the wall's root-mean-square distance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

TRANSONIC = 0.3
"""Largest distance of a transonic Mach number from one."""


@dataclass(frozen=True)
class Arms:
    """How far the wall lies from the moment centre, in the reference lengths of the moments.

    Attributes:
        pitch: farthest wall along x or z on the chord.
        lateral: farthest wall along any axis on the span.
        mean_pitch: root mean square along x, by area, on the chord.
    """

    pitch: float
    lateral: float
    mean_pitch: float


def arms_of(coefficients: xr.Dataset) -> Arms:
    """Arms of the body that `integrate` gave these coefficients of."""
    head = coefficients.attrs
    x, y, z = (float(v) for v in head["wall_reach_m"])
    chord, span = head["c_ref_m"], head["b_ref_m"]
    return Arms(max(x, z) / chord, max(x, y, z) / span, float(head["wall_rms_m"][0]) / chord)


def floors(groups: Sequence[str], arms: Arms, mach: np.ndarray) -> dict[str, tuple[str, np.ndarray]]:
    """Group to another group and the share of that one's mean error [condition] that is the least of its own.

    Args:
        groups: "lift", "drag", "side", "pitch" or "lateral", a space, and the quantity of a derivative.
        arms: of the body.
        mach: [condition] Mach number.
    """
    mach = np.asarray(mach, dtype=float)
    always = np.ones_like(mach)
    shares = {
        "lift": ("pitch", always / arms.pitch),
        "side": ("lateral", always / arms.lateral),
        "pitch": ("lift", np.where(np.abs(mach - 1.0) < TRANSONIC, arms.mean_pitch, 0.0)),
    }
    found = {}
    for group in dict.fromkeys(groups):
        kind, space, quantity = group.partition(" ")
        if kind in shares:
            other, share = shares[kind]
            found[group] = (f"{other}{space}{quantity}", share)
    return found
