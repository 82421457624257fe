"""Controllability of a flight point: measures, least-effort feedback, its demands, both loops in time."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are
from tests.dynamics import horus

from spaceplane.analysis.control_inputs import AXES, usable_inputs
from spaceplane.analysis.controllability import controllability
from spaceplane.analysis.feedback_settings import FeedbackSettings
from spaceplane.control.disturbance import disturbed
from spaceplane.control.saturation import takeover
from spaceplane.dynamics.linearise import linearise
from spaceplane.errors import InputError
from spaceplane.qualities.airframe import Airframe
from spaceplane.report.control_record import control_record

TRIM = {"elevon_left": math.radians(-3.0), "elevon_right": math.radians(-3.0), "body_flap": math.radians(-20.0)}
ELEVONS = {"Cm_elevon_left": -0.0127, "Cm_elevon_right": -0.0127, "CL_elevon_left": 0.0362, "CL_elevon_right": 0.0362}
LOOSE = {"rate_limit": math.radians(1e4)}


def study(settings=None, trim=TRIM, bank_deg=55.0, form="rigid-body", **changes):
    """HORUS-2B at the TAEM interface with elevons of the published pitching moment, and changes per rad."""
    derivatives = horus.derivatives(**{**ELEVONS, **changes})
    point = horus.point(bank_deg=bank_deg)
    airframe = Airframe(point, horus.MASS, horus.REFERENCE, derivatives)
    system = linearise(point, horus.MASS, horus.REFERENCE, derivatives, form)
    return controllability(airframe, system, trim, settings), system


@pytest.fixture(scope="module")
def found():
    return study()[0]


def test_thrusters_stand_in_where_no_surface_is_known(found):
    assert found.inputs.surfaces == ("elevator",)
    assert set(found.inputs.stand_ins) == {"moment_x", "moment_z"}
    assert "rolling moment of the aileron" in found.inputs.stand_ins["moment_x"]
    assert found.unknown == ("CL_q", "Cm_q", "CY_p", "Cl_p", "Cn_p", "CY_r", "Cl_r", "Cn_r")
    complete, _ = study(trim={}, **horus.EXTRA)
    assert complete.inputs.surfaces == ("elevator", "aileron", "rudder")
    assert not complete.inputs.stand_ins and not complete.unknown and not complete.uncontrolled
    none, _ = study(Cm_elevon_left=0.0, Cm_elevon_right=0.0)
    assert not none.inputs.surfaces and set(none.inputs.stand_ins) == {moment for *_, moment in AXES}
    assert none.within is None and none.moved == (9, 0)


def test_one_rudder_of_two_is_no_rudder():
    found, _ = study(Cn_rudder_left=-0.02)
    assert found.inputs.surfaces == ("elevator",) and "moment_z" in found.inputs.stand_ins


def test_a_trim_at_the_limit_leaves_nothing_to_feed_back():
    up = {"elevon_left": math.radians(-40.0), "elevon_right": math.radians(-40.0)}
    inputs = usable_inputs(horus.derivatives(**ELEVONS), up, 1e4)
    assert inputs.surfaces == () and "one side" in inputs.stand_ins["moment_y"]


def test_without_a_rudder_upright_the_lateral_modes_are_out_of_reach():
    """An elevator moves V, gamma, R, q and alpha in symmetric flight and nothing else; a bank couples all nine."""
    upright, _ = study(bank_deg=0.0)
    assert upright.moved == (9, 5)
    groups = {one.by_all.mode.name: one.by_all.mode.group for one in upright.modes}
    assert set(upright.uncontrolled) == {name for name, group in groups.items() if group == "lateral"}
    assert len(upright.uncontrolled) == 3
    banked, _ = study()
    assert banked.moved == (9, 9) and not banked.uncontrolled


def test_what_grows_is_told_with_the_reach_of_each_input(found):
    """For one real root l the displacement balanced is |x| |y b| u / l: it goes with the input's effect."""
    divergence = next(one for one in found.modes if one.by_all.mode.name == "aperiodic pitch divergence")
    assert divergence.growing
    stronger, _ = study(**{name: 2.0 * value for name, value in ELEVONS.items()})
    again = next(one for one in stronger.modes if one.by_all.mode.name == "aperiodic pitch divergence")
    assert again.by_all.reach["elevator"] == pytest.approx(2.0 * divergence.by_all.reach["elevator"], rel=1e-6)
    assert max(divergence.by_all.share, key=divergence.by_all.share.get) == "elevator"
    assert found.held["alpha"].high > 0 > found.held["alpha"].low and "beta" not in found.held
    assert stronger.held["alpha"].high > 1.5 * found.held["alpha"].high


@pytest.mark.parametrize("axis", ["alpha", "beta"])
def test_the_feedback_spends_what_the_riccati_equation_says(found, axis):
    """x0' P x0 of A'P + P A - P B B' P = 0, of the Gramian, and of the simulated history are one number."""
    plant, scale = found.regulator.system, found.regulator.limits.scale()
    P = solve_continuous_are(plant.A, plant.B * scale, 1e-15 * np.eye(9), np.eye(len(scale)))
    x0 = np.zeros(9)
    x0[plant.index(axis)] = found.settings.offset
    times = np.linspace(0.0, 900.0, 90_001)
    run = disturbed(found.regulator, times, {axis: found.settings.offset})
    spent = sum(
        np.trapezoid((run[name].values / one) ** 2, times)
        for name, one in zip(found.regulator.limits.inputs, scale, strict=True)
    )
    assert spent == pytest.approx(found.energy[axis], rel=2e-3)
    assert x0 @ P @ x0 == pytest.approx(found.energy[axis], rel=1e-4)


def test_the_closed_loop_is_the_open_one_mirrored(found):
    plant = found.regulator.system
    opened, closed = (np.linalg.eigvals(s.A) for s in (plant, found.closed.system))
    mirrored = np.where(opened.real > 0, -opened.conj(), opened)
    assert np.allclose(np.sort_complex(closed), np.sort_complex(mirrored), atol=1e-7)
    assert all(mode.stable for mode in found.closed.modes) and found.closed.verdicts
    faster, _ = study(FeedbackSettings(decay=0.2))
    assert np.linalg.eigvals(faster.closed.system.A).real.max() <= -0.2 + 1e-9
    assert faster.demands[0].efforts[0].greatest > found.demands[0].efforts[0].greatest


def of(found, name):
    return next(one for one in found.demands if one.disturbance.name.startswith(name))


def elevon(demand):
    return next(one for one in demand.efforts if one.name == "elevon_left")


def test_a_gust_twice_as_strong_asks_twice_the_deflection():
    small, large = (study(FeedbackSettings(gust=gust, **LOOSE))[0] for gust in (20.0, 40.0))
    for side in ("gust of 20 m/s from below", "gust of 20 m/s from the right"):
        one, two = (elevon(of(found, name)) for found, name in ((small, side), (large, side.replace("20", "40"))))
        trim = TRIM["elevon_left"]
        assert two.greatest - trim == pytest.approx(2.0 * (one.greatest - trim), rel=1e-9)
        assert two.rate == pytest.approx(2.0 * one.rate, rel=1e-6) and two.margin < one.margin


def test_limits_are_reached_where_the_gust_doubles():
    """Weak elevons: one gust is met, twice the gust is not, and a pitch thruster supplies what is missing."""
    weak = {name: 0.15 * value for name, value in ELEVONS.items()}
    peak = elevon(of(study(FeedbackSettings(gust=10.0, **LOOSE), **weak)[0], "gust of 10 m/s from below"))
    room = math.radians(40.0) - TRIM["elevon_left"]
    gust = 10.0 * 0.7 * room / (peak.greatest - TRIM["elevon_left"])
    met, beyond = (study(FeedbackSettings(gust=k * gust, **LOOSE), **weak)[0] for k in (1.0, 2.0))
    met, beyond = met.demands[2], beyond.demands[2]
    assert met.within and not met.thrusters
    assert not beyond.within and set(beyond.thrusters) == {"moment_y"}
    assert elevon(beyond).greatest - TRIM["elevon_left"] == pytest.approx(1.4 * room, rel=1e-6)


def test_the_thruster_supplies_what_the_surface_lacks_at_once():
    """After an offset the deflection is largest at t = 0: moment = ratio (k offset - what is left)."""
    weak = {name: 0.15 * value for name, value in ELEVONS.items()}
    for degrees in (8.0, 12.0):
        found, system = study(FeedbackSettings(offset=math.radians(degrees), **LOOSE), **weak)
        demand = of(found, "offset")
        wanted = -found.regulator.gain[0, system.index("alpha")] * math.radians(degrees)
        left = math.radians(40.0) - TRIM["elevon_left"]
        ratio = takeover(system, "elevator", "moment_y").ratio
        assert wanted > left and not demand.lost
        assert demand.thrusters["moment_y"] == pytest.approx(abs(ratio) * (wanted - left), rel=1e-6)


def test_the_rate_limit_decides_too():
    rate = elevon(of(study(FeedbackSettings())[0], "offset")).rate
    slow, quick = (study(FeedbackSettings(rate_limit=k * rate))[0] for k in (0.9, 1.1))
    assert slow.within is False and quick.within is True


def test_the_thrusters_weight_moves_effort_between_inputs():
    """A larger moment counts less: the thrusters then do more of the work in yaw, the elevator less."""
    light, heavy = (of(study(FeedbackSettings(thruster=t))[0], "offset of 1 deg in sides") for t in (1e3, 1e5))
    moved = [
        max(abs(e.least - TRIM["elevon_left"]), abs(e.greatest - TRIM["elevon_left"]))
        for e in map(elevon, (light, heavy))
    ]
    assert moved[0] > 2.0 * moved[1]


def test_motions_are_those_of_the_vehicle(found):
    """Recorded states and inputs satisfy dx/dt = A x + B u of the open loop; the gust and pulse act in both loops."""
    plant = found.regulator.system
    for one in (found.responses[0], found.responses[1], found.responses[4]):
        for run in (one.open_loop, one.closed_loop):
            x = np.stack([run[name].values for name in plant.states])
            u = np.stack([run[name].values for name in plant.inputs])
            times = run["time"].values
            slope = np.gradient(x, times, axis=1, edge_order=2)
            wanted = plant.A @ x + plant.B @ u
            k = plant.index("alpha")  # alpha has no jump: even a pulse enters it through lift alone
            assert np.allclose(slope[k, 2:-2], wanted[k, 2:-2], atol=0.03 * np.abs(wanted[k]).max())
    names = [one.name for one in found.responses]
    assert len(names) == 5 and names[-1].startswith("elevator 1 deg")
    pitch = found.responses[0]
    assert abs(pitch.open_loop["alpha"].values[-1]) > 5.0 * abs(pitch.closed_loop["alpha"].values[-1])
    gust = found.responses[2]
    assert gust.open_loop["q"].values[5] > 0  # unstable in pitch: air from below turns the nose up


def test_fast_growth_is_shown_for_less_time(found):
    """Three time constants of the growth in pitch; ten of it at most in roll and yaw."""
    faster, _ = study(Cm_alpha=100.0 * horus.derivatives().Cm_alpha)
    for one in (found, faster):
        growth = np.linalg.eigvals(one.regulator.system.A).real.max()
        ends = [response.open_loop["time"].values[-1] for response in one.responses[:2]]
        assert ends == pytest.approx([3.0 / growth, min(12.0, 10.0 / growth)], rel=1e-9)
        assert np.isfinite([run[name].values for run in (one.responses[1].open_loop,) for name in run]).all()


def test_an_elevator_down_pitches_down_at_once(found):
    pulse = found.responses[-1]
    assert pulse.open_loop["elevator"].values[0] == pytest.approx(math.radians(1.0))
    assert pulse.open_loop["q"].values[3] < 0 and pulse.closed_loop["q"].values[3] < 0
    assert abs(pulse.closed_loop["alpha"].values[-1]) < abs(pulse.open_loop["alpha"].values[-1])


def test_what_cannot_be_done_has_its_reason():
    thesis, _ = study(form="thesis")
    assert "rigid-body form" in thesis.reason and thesis.regulator is None and thesis.within is None
    outside, _ = study(trim={"elevon_left": math.radians(-50.0)})
    assert "trim of elevon_left = -50 deg" in outside.reason and outside.inputs is None
    for one in (thesis, outside):
        assert json.loads(json.dumps(control_record(one)))["gain"] is None


def test_the_record_is_plain_and_in_degrees(found):
    record = json.loads(json.dumps(control_record(found), allow_nan=False))
    trim = math.degrees(TRIM["elevon_left"])
    effort = next(e for e in record["disturbances"][0]["efforts"] if e["name"] == "elevon_left")
    assert effort["unit"] == "deg" and (effort["low"], effort["high"]) == pytest.approx((-40.0, 40.0))
    assert effort["greatest"] - trim == pytest.approx(effort["jump"])
    thruster = next(e for e in record["disturbances"][0]["efforts"] if e["name"] == "moment_z")
    assert thruster["unit"] == "N m" and "margin" not in thruster
    assert record["held_deg"]["alpha"][1] == pytest.approx(math.degrees(found.held["alpha"].high))
    assert np.shape(record["gain"]) == (3, 9) and len(record["responses"]) == 5
    assert record["responses"][0]["closed"]["alpha"][0] == pytest.approx(1.0)
    assert "responses" not in control_record(found, histories=False)


def test_the_pin(found):
    """HORUS-2B at the TAEM interface, as the page on modes and control has it for an elevator with forces."""
    offset, gust = elevon(of(found, "offset")), elevon(of(found, "gust of 9 m/s from below"))
    assert math.degrees(offset.jump) == pytest.approx(2.82531, rel=1e-5)
    assert math.degrees(gust.greatest) == pytest.approx(-1.06591, rel=1e-5)
    assert math.degrees(gust.rate) == pytest.approx(1.96523, rel=1e-5)
    held = found.held["alpha"]
    assert np.degrees([held.low, held.high]) == pytest.approx([-26.2172, 30.4686], rel=1e-5)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"gust": 0.0}, "gust = 0 m/s: above 0 and at most 100 m/s"),
        ({"gust": math.nan}, "gust = nan"),
        ({"gust": 101.0}, "gust = 101"),
        ({"offset": math.radians(21.0)}, "offset = 21 deg"),
        ({"offset": -0.1}, "offset = -5.72958 deg"),
        ({"decay": -0.1}, "decay = -0.1 1/s: 0 or above"),
        ({"decay": math.inf}, "decay = inf"),
        ({"rate_limit": 0.0}, "rate_limit = 0 rad/s"),
        ({"thruster": math.inf}, "thruster = inf N m"),
    ],
)
def test_settings_out_of_range_are_named(wrong, message):
    with pytest.raises(InputError, match=message):
        replace(FeedbackSettings(), **wrong)
