"""A small database of the fast tier, which several tests look at from different sides."""

from __future__ import annotations

import math
from functools import cache

from spaceplane.aero.model.model import AeroModel
from spaceplane.analysis.tables.assemble import model_of
from spaceplane.analysis.tables.settings import TableSettings, default_settings
from spaceplane.analysis.tables.solve import blocks, evaluate, inputs_of
from spaceplane.vehicle.presets import horus_2b

VEHICLE = horus_2b()
MACHS, ALPHAS_DEG = (3.0, 6.0, 12.0), (10.0, 20.0, 30.0)
DEFLECTIONS_DEG = {"elevon_left": (-20.0, 20.0), "rudder_left": (30.0,), "body_flap": (-15.0, 15.0)}


def radians(*degrees: float) -> tuple[float, ...]:
    return tuple(math.radians(d) for d in degrees)


@cache
def small_settings() -> TableSettings:
    moved = {name: radians(*values) for name, values in DEFLECTIONS_DEG.items()}
    return default_settings("fast", machs=MACHS, alphas=radians(*ALPHAS_DEG), deflections=moved)


@cache
def small_results() -> tuple[dict, ...]:
    return tuple(evaluate(inputs_of(VEHICLE, small_settings(), block)) for block in blocks(small_settings()))


@cache
def small_model() -> AeroModel:
    return model_of(VEHICLE, small_settings(), blocks(small_settings()), small_results())
