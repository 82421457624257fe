"""Where the centre of mass would have to lie for a descent to be trimmed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spaceplane.aero.model.model import AeroModel
from spaceplane.analysis.descent import DescentSettings
from spaceplane.dynamics.trim.longitudinal import schedule_at, trim_elevator

REACH, STEP = 0.15, 0.01
"""How far from the model's moment centre is looked, and in which steps, shares of the reference chord."""


@dataclass(frozen=True)
class TrimmingCenter:
    """Places of the centre of mass about which most flight points have a trim.

    Attributes:
        lower, upper: ends of the longest run of them, m aft of the nose.
        count: flight points with a trim there.
    """

    lower: float
    upper: float
    count: int


def trimming_center(model: AeroModel, settings: DescentSettings) -> TrimmingCenter | None:
    """Look along the body for the places about which most flight points of a descent have a trim.

    None where the model's moments are known about its own centre only.

    Args:
        model: aerodynamics, whose moment centre is the middle of the search.
        settings: Mach numbers, angles of attack and body flap.
    """
    if not model.movable:
        return None
    x, y, z = model.reference.moment_center
    places = x + model.reference.chord * np.arange(-REACH, REACH + 0.5 * STEP, STEP)
    counts = np.array([_trimmed(model.moved((float(place), y, z)), settings) for place in places])
    most = counts == counts.max()
    starts = np.flatnonzero(most & ~np.r_[False, most[:-1]])
    ends = np.flatnonzero(most & ~np.r_[most[1:], False])
    longest = int(np.argmax(ends - starts))
    return TrimmingCenter(float(places[starts[longest]]), float(places[ends[longest]]), int(counts.max()))


def _trimmed(model: AeroModel, settings: DescentSettings) -> int:
    flap = settings.body_flap
    count = 0
    for point in settings.flight_points():
        held = schedule_at(flap, point.mach) if isinstance(flap, Mapping) else flap
        count += trim_elevator(model, point.mach, point.alpha, held).best is not None
    return count
