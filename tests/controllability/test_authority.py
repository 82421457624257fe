"""What the controls may do: limits from trim, pairs of surfaces, rudders outboard only."""

import math

import numpy as np
import pytest

from spaceplane.control.authority import authority, chosen, surface_positions
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.errors import InputError

DEG = math.radians(1.0)


def degrees(limits):
    return [(float(np.degrees(a)), float(np.degrees(b))) for a, b in zip(limits.low, limits.high, strict=True)]


def test_limits_from_zero_trim():
    limits = authority(["elevator", "aileron", "rudder", "body_flap", "elevon_left"][:4])
    assert np.allclose(degrees(limits), [(-40, 40), (-40, 40), (-20, 20), (-20, 30)])
    assert np.allclose(np.degrees(limits.scale()), [40, 40, 20, 20])


def test_trim_takes_away():
    trim = {"elevon_left": -12.5 * DEG, "elevon_right": -12.5 * DEG, "body_flap": 5 * DEG, "rudder_left": 10 * DEG}
    limits = authority(["elevator", "aileron", "body_flap", "rudder"], trim)
    # aileron: left up to 52.5 more, but right down only 27.5 more
    assert np.allclose(degrees(limits), [(-27.5, 52.5), (-27.5, 27.5), (-25, 25), (-25, 15)])
    with pytest.raises(InputError, match="body_flap: its trim leaves nothing"):
        authority(["body_flap"], {"body_flap": -20 * DEG}).scale()


def test_every_surface_ends_at_its_limit_with_the_input_at_its():
    rng = np.random.default_rng(3)
    for _ in range(20):
        trim = {
            "elevon_left": rng.uniform(-40, 40) * DEG,
            "elevon_right": rng.uniform(-40, 40) * DEG,
            "rudder_left": rng.uniform(0, 40) * DEG,
            "rudder_right": rng.uniform(0, 40) * DEG,
        }
        for name in ("elevator", "aileron", "rudder"):
            limits = authority([name], trim)
            for value in (limits.low[0], limits.high[0]):
                positions = {k: np.degrees(v) for k, v in surface_positions(limits, {name: value}).items()}
                bounds = (-40.0, 40.0) if name != "rudder" else (0.0, 40.0)
                assert all(bounds[0] - 1e-9 <= x <= bounds[1] + 1e-9 for x in positions.values())
                assert any(min(abs(x - b) for b in bounds) < 1e-9 for x in positions.values())


def test_rudders_move_outboard_only_and_keep_their_difference():
    values = np.radians(np.linspace(-20, 20, 41))
    for trim in ({}, {"rudder_left": 8 * DEG, "rudder_right": 3 * DEG}):
        limits = authority(["rudder"], trim)
        inside = values[(values >= limits.low[0]) & (values <= limits.high[0])]
        moved = surface_positions(limits, {"rudder": inside})
        left, right = moved["rudder_left"], moved["rudder_right"]
        assert left.min() >= 0 and right.min() >= 0
        before = trim.get("rudder_left", 0.0) - trim.get("rudder_right", 0.0)
        assert np.allclose((left - right - before) / 2, inside, atol=1e-12)


def test_elevator_and_aileron_share_the_elevons():
    limits = authority(["elevator", "aileron", "moment_z"], moments={"moment_z": 5e3})
    moved = surface_positions(limits, {"elevator": np.array([0.1]), "aileron": np.array([0.03]), "moment_z": 7.0})
    assert moved["elevon_left"] == pytest.approx([0.13]) and moved["elevon_right"] == pytest.approx([0.07])
    assert set(moved) == {"elevon_left", "elevon_right"}
    assert (limits.low[2], limits.high[2]) == (-5e3, 5e3)


def test_chosen_inputs():
    system = StateSpace(np.eye(2), np.array([[1.0, 2, 3], [4, 5, 6]]), ("p", "r"), ("aileron", "rudder", "moment_z"))
    assert chosen(system, ["moment_z", "aileron"]).B.tolist() == [[3, 1], [6, 4]]
    with pytest.raises(InputError, match="unknown input 'elevator'"):
        chosen(system, ["elevator"])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: authority([]), "inputs = none"),
        (lambda: authority(["rudder", "rudder"]), "each once"),
        (lambda: authority(["flap"]), "unknown input 'flap'"),
        (lambda: authority(["elevator", "elevon_left"]), "elevator moves elevon_left"),
        (lambda: authority(["moment_x"]), "moment_x = None"),
        (lambda: authority(["moment_x"], moments={"moment_x": -1.0}), "moment_x = -1"),
        (lambda: authority(["elevator"], moments={"moment": 1.0}), "unknown moment 'moment'"),
        (lambda: authority(["elevator"], {"elevator": 0.1}), "unknown control surface 'elevator'"),
        (lambda: authority(["rudder"], {"rudder_left": -0.1}), "trim of rudder_left = -5.73 deg"),
        (lambda: authority(["elevator"], {"elevon_left": math.nan}), "trim of elevon_left"),
    ],
)
def test_refuses(call, message):
    with pytest.raises(InputError, match=message):
        call()
