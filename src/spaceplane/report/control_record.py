"""Controllability of one flight point as plain JSON types: angles in degrees, moments in N m."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.analysis.control_demand import HORIZON, Demand
from spaceplane.analysis.controllability import SLOW, Controllability, ModeControl
from spaceplane.analysis.feedback_settings import FeedbackSettings
from spaceplane.analysis.time_responses import Response
from spaceplane.control.effort import Effort
from spaceplane.dynamics.modes import to_record as mode_record
from spaceplane.plain import finite
from spaceplane.qualities.verdict import to_record as verdict_record

if TYPE_CHECKING:
    import xarray as xr

DEGREE = math.degrees(1.0)


def control_record(found: Controllability | None, histories: bool = True) -> dict | None:
    """Everything that was found, see docs/formats.md; None for None.

    Args:
        found: at one flight point.
        histories: whether the time responses are in it.
    """
    if found is None:
        return None
    inputs, regulator, closed = found.inputs, found.regulator, found.closed
    record = {
        "reason": found.reason,
        "settings": settings_record(found.settings),
        "surfaces": list(inputs.surfaces) if inputs else [],
        "thrusters": dict(inputs.stand_ins) if inputs else {},
        "unknown": list(found.unknown),
        "states": found.states,
        "states_moved": found.moved[0],
        "states_moved_by_surfaces": found.moved[1],
        "uncontrolled_by_surfaces": list(found.uncontrolled),
        "modes": [_mode(one) for one in found.modes],
        "held_deg": {axis: [_degrees(held.low), _degrees(held.high)] for axis, held in found.held.items()},
        "held_faster_than": SLOW,
        "energy_s": {axis: finite(value) for axis, value in found.energy.items()},
        "inputs": list(regulator.limits.inputs) if regulator else [],
        "gain": regulator.gain.tolist() if regulator else None,
        "within": found.within,
        "horizon_s": HORIZON,
        "disturbances": [_demand(one) for one in found.demands],
        "closed_loop": {
            "modes": [mode_record(mode) for mode in closed.modes] if closed else [],
            "verdicts": [verdict_record(verdict) for verdict in closed.verdicts] if closed else [],
        },
    }
    return record | ({"responses": [_response(one) for one in found.responses]} if histories else {})


def settings_record(settings: FeedbackSettings) -> dict:
    """What the feedback was put to, unit in the names."""
    return {
        "gust_ms": settings.gust,
        "offset_deg": DEGREE * settings.offset,
        "decay_per_s": settings.decay,
        "rate_limit_degs": DEGREE * settings.rate_limit,
        "thruster_Nm": settings.thruster,
    }


def _degrees(angle: float) -> float | None:
    return finite(DEGREE * angle)


def _mode(one: ModeControl) -> dict:
    entry, alone = one.by_all, one.by_surfaces
    unit, factor = in_degrees(entry.unit)
    return {
        "name": entry.mode.name,
        "eigenvalue": [entry.mode.eigenvalue.real, entry.mode.eigenvalue.imag],
        "growing": one.growing,
        "double_time_s": entry.mode.double_time,
        "state": entry.state,
        "unit": unit,
        "reach": {name: finite(factor * value) for name, value in entry.reach.items()},
        "share": dict(entry.share),
        "distance": entry.distance,
        "distance_by_surfaces": alone.distance if alone else None,
    }


def in_degrees(unit: str) -> tuple[str, float]:
    """A unit with degrees in place of radians, and the factor to it."""
    return (unit.replace("rad", "deg"), DEGREE) if unit.startswith("rad") else (unit, 1.0)


def _demand(one: Demand) -> dict:
    return {
        "name": one.disturbance.name,
        "within": one.within,
        "efforts": [_effort(effort) for effort in one.efforts],
        "thrusters_Nm": dict(one.thrusters),
        "lost": one.lost,
    }


def _effort(one: Effort) -> dict:
    """Peaks; a thruster has no limit to be held against."""
    unit, factor = in_degrees(one.unit)
    peaks = {name: factor * getattr(one, name) for name in ("least", "greatest", "rate", "jump")}
    if unit != "deg":
        return {"name": one.name, "unit": unit, **peaks}
    limits = {name: factor * getattr(one, name) for name in ("low", "high", "rate_limit", "margin")}
    return {"name": one.name, "unit": unit, **peaks, **limits, "within": one.within}


def _response(one: Response) -> dict:
    shown = (*one.states, *one.inputs)
    units = {name: in_degrees(one.open_loop[name].attrs.get("units", ""))[0] for name in shown}
    return {
        "name": one.name,
        "states": list(one.states),
        "inputs": list(one.inputs),
        "units": units,
        "time_s": _rounded(one.open_loop["time"].values),
        "open": _histories(one.open_loop, shown),
        "closed": _histories(one.closed_loop, shown),
    }


def _histories(run: xr.Dataset, names: tuple[str, ...]) -> Mapping[str, list[float]]:
    factors = {name: in_degrees(run[name].attrs.get("units", ""))[1] for name in names}
    return {name: _rounded(factors[name] * run[name].values) for name in names}


def _rounded(values: np.ndarray) -> list[float]:
    """Five digits, as a picture needs."""
    return [float(f"{value:.5g}") for value in values]
