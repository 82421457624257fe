"""JSBSim flies a deck of our own database as this package flies its model."""

import math

import pytest

from spaceplane.analysis.tables.assemble import model_of
from spaceplane.analysis.tables.settings import default_settings
from spaceplane.analysis.tables.solve import blocks, evaluate, inputs_of
from spaceplane.decks.jsbsim import INSIDE, write
from spaceplane.vehicle.controls import CONTROLS
from spaceplane.vehicle.presets import horus_2b

from . import fly
from .test_jsbsim import accelerations, off, put, random_states


@pytest.fixture(scope="module")
def model():
    vehicle = horus_2b()
    moved = {"elevon_left": (-0.3, 0.3), "rudder_left": (0.5,), "body_flap": (-0.3, 0.3)}
    settings = default_settings("fast", machs=(3.0, 6.0, 12.0), alphas=(0.2, 0.4, 0.6), deflections=moved)
    asked = blocks(settings)
    return model_of(vehicle, settings, asked, [evaluate(inputs_of(vehicle, settings, block)) for block in asked])


@pytest.fixture(scope="module")
def fdm(model, tmp_path_factory):
    folder = tmp_path_factory.mktemp("deck")
    write(model, horus_2b().mass, folder, "ours")
    return fly.load(folder, "ours")


def test_accelerations_at_random_states(model, fdm):
    assert model.unknown() == () and set(model.surfaces) == set(CONTROLS)
    worst = 0.0
    for state in random_states(model, 50):
        put(fdm, state)
        force, acceleration, turning = accelerations(model, **state)
        for found, expected in (
            (fly.force(fdm) / fly.mass(fdm), force),
            (fly.acceleration(fdm), acceleration),
            (fly.angular_acceleration(fdm), turning),
        ):
            worst = max(worst, off(found, expected))
        assert fdm[INSIDE] == 1.0
    assert worst < 0.005 and math.isfinite(worst)
