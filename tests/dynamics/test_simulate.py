"""Flights in time: events, ends of the data, control laws and what the history carries."""

import math

import numpy as np
import pytest

from spaceplane.aero.model.published import horus_2b_published
from spaceplane.dynamics.equations import flight_model
from spaceplane.dynamics.motion.linear_aero import LinearAerodynamics
from spaceplane.dynamics.motion.observe import QUANTITIES
from spaceplane.dynamics.motion.state import from_trajectory, to_trajectory
from spaceplane.dynamics.motion.vehicle import rigid_vehicle
from spaceplane.dynamics.planet import EARTH_SPHERE, WGS84
from spaceplane.dynamics.simulate import FORMS, Event, simulate
from spaceplane.errors import InputError

from . import horus

STONE = rigid_vehicle(horus.MASS)
STABLE = {"Cm_alpha": -0.1, "Cn_beta": 0.1, "Cl_beta": -0.08, "CY_beta": -0.9, "Cm_q": -3.0, "Cl_p": -0.3, "Cn_r": -0.5}


def thrown(**changes):
    """Thrown up at 45 deg from 30 km, without air."""
    values = {"V": 800.0, "gamma": math.pi / 4, "R": EARTH_SPHERE.radius + 30e3, "alpha": 0.1, "sigma": 0.0}
    return from_trajectory({**values, **changes})


def gliding(planet=EARTH_SPHERE, **reach):
    """At the TAEM interface over the equator."""
    model = flight_model(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(**STABLE))
    point, rates = model.point, model.rates
    state = from_trajectory(
        {
            "V": point.velocity, "gamma": point.gamma, "R": planet.radius + point.altitude,
            "alpha": point.alpha, "sigma": point.bank,
            "p": rates.p, "q": rates.q, "r": rates.r,
        }
    )  # fmt: skip
    return rigid_vehicle(horus.MASS, LinearAerodynamics(model, **reach)), state


@pytest.mark.parametrize("form", FORMS)
def test_stops_at_an_altitude(form):
    """Back at 20 km with the speed of conserved energy."""
    start = thrown()
    flight = simulate(STONE, start, 1_000.0, events=[Event("altitude", 20e3)], form=form)
    last = flight.history.isel(time=-1)
    assert flight.completed and "altitude reached 20000 m" in flight.reason and flight.reason == flight.history.ended
    assert float(last.altitude) == pytest.approx(20e3, abs=1e-4)
    assert float(last.time) == flight.end == flight.events[0].time
    R0, R1 = EARTH_SPHERE.radius + 30e3, EARTH_SPHERE.radius + 20e3
    assert float(last.V) == pytest.approx(math.sqrt(800.0**2 + 2 * EARTH_SPHERE.mu * (1 / R1 - 1 / R0)), rel=1e-9)
    assert float(last.gamma) < 0


def test_events_on_the_way():
    """Up and down through 40 km; the top lies between; a direction lets only one of them count."""
    marks = [
        Event("altitude", 40e3, stop=False),
        Event("altitude", 40e3, direction=-1, stop=False),
        Event("gamma", 0.0, stop=False),
        Event("altitude", 29e3),
        Event("altitude", 1e3),
    ]
    flight = simulate(STONE, thrown(), 1_000.0, events=marks)
    assert [one.event for one in flight.events] == [marks[0], marks[2], *sorted(marks[:2], key=lambda e: e.direction != 0), marks[3]]  # fmt: skip  # noqa: E501
    times = [one.time for one in flight.events]
    assert times == sorted(times) and flight.end == times[-1]
    top = to_trajectory(flight.state_at(times[1]))
    assert top[1] == pytest.approx(0.0, abs=1e-10)
    assert top[3] > to_trajectory(flight.state_at(times[1] - 0.1))[3]


def test_leaves_the_aerodynamics_known():
    """The glider slows down until its Mach number leaves the model: a clean stop just there."""
    vehicle, start = gliding(mach_reach=0.05)
    flight = simulate(vehicle, start, 500.0, max_step=2.0)
    assert not flight.completed
    assert flight.reason.startswith("mach = 2.4") and "hold from 2.45" in flight.reason
    assert float(flight.history.mach[-1]) == pytest.approx(2.45, abs=1e-5)
    assert np.isfinite(flight.history.mach.values).all() and 1.0 < flight.end < 100.0


def test_leaves_the_atmosphere_known():
    vehicle, start = gliding(mach_reach=5.0, alpha_reach=3.0, beta_limit=1.5)
    up = to_trajectory(start)
    up[1], up[3] = 0.8, EARTH_SPHERE.radius + 85_900.0
    from spaceplane.dynamics.motion.state import from_trajectory_array

    flight = simulate(vehicle, from_trajectory_array(up), 60.0, form="trajectory")
    assert not flight.completed and "US 1976" in flight.reason
    assert float(flight.history.altitude[-1]) == pytest.approx(86_000.0, abs=0.01)
    with pytest.raises(InputError, match="US 1976"):
        simulate(vehicle, from_trajectory_array(up + 200.0 * np.eye(12)[3]), 60.0)


def test_published_tables_end_cleanly():
    """HORUS-2B as published is unstable in pitch at Mach 2.5: its angle of attack runs out of the tables."""
    aero = horus_2b_published()
    vehicle = rigid_vehicle(horus.MASS, aero)
    _, start = gliding(WGS84)
    controls = {"elevon_left": math.radians(-3), "elevon_right": math.radians(-3), "body_flap": math.radians(-20)}
    flight = simulate(vehicle, start, 300.0, WGS84, controls, events=[Event("altitude", 10e3)], rtol=1e-7)
    assert flight.end > 1.0
    if not flight.completed:
        assert "outside the tables" in flight.reason or "empty" in flight.reason or "slopes hold" in flight.reason
    history = flight.history
    assert np.rad2deg(history.alpha.values).max() <= math.degrees(aero.alpha[-1]) + 1e-6
    found = aero.coefficients(float(history.mach[0]), float(history.alpha[0]), deflections=controls)
    assert float(history.CL[0]) == pytest.approx(found["CL"], rel=1e-9)
    assert float(history.control_body_flap[0]) == pytest.approx(math.radians(-20))
    with pytest.raises(InputError, match="body_flap"):
        simulate(vehicle, start, 10.0, controls={"body_flap": math.radians(-30)})


def test_pulse_of_a_thruster():
    """About one principal axis the spin is the impulse over the inertia, exactly."""

    def law(time, state):
        return {"moment_x": 1_190.0 if 1.0 <= time < 2.0 else 0.0}

    flight = simulate(STONE, thrown(), 4.0, controls=law, breaks=(1.0, 2.0), output_step=0.5)
    assert flight.final.rates == pytest.approx([0.01, 0.0, 0.0], abs=1e-12)
    assert flight.history.control_moment_x.values[[0, 2, 4]] == pytest.approx([0.0, 1190.0, 0.0])
    assert flight.history.control_moment_x.units == "N m"


@pytest.mark.parametrize("form", FORMS)
def test_feedback_law(form):
    """A moment -k p makes p decay as exp(-k t / Ixx) where nothing else turns."""
    start = thrown(p=0.2)
    flight = simulate(STONE, start, 20.0, controls=lambda t, s: {"moment_x": -11_900.0 * s.rates[0]}, form=form)
    assert flight.final.rates[0] == pytest.approx(0.2 * math.exp(-2.0), rel=1e-8)


def test_state_between_the_outputs():
    vehicle, start = gliding()
    long = simulate(vehicle, start, 10.0, rtol=1e-10)
    short = simulate(vehicle, start, 3.7, rtol=1e-10)
    assert long.state_at(3.7).position == pytest.approx(short.final.position, abs=1e-3)
    assert long.state_at(3.7).rates == pytest.approx(short.final.rates, abs=1e-7)
    with pytest.raises(InputError, match="time"):
        long.state_at(11.0)


def test_history_has_units():
    vehicle, start = gliding(WGS84)
    history = simulate(vehicle, start, 2.5, WGS84, {"moment_y": 10.0}, output_step=0.5).history
    assert history.time.values == pytest.approx([0, 0.5, 1, 1.5, 2, 2.5])
    assert set(QUANTITIES) <= set(history)
    for name in (*history.data_vars, "time"):
        assert history[name].attrs["units"], name
    assert history.attrs["planet"] == "WGS 84" and history.attrs["ended"].startswith("end of time")
    # lift about the weight over cos(bank) of 55 deg
    assert float(history.load_factor[0]) == pytest.approx(1.6, abs=0.3)
    assert float(history.phi[0]) > 0 and float(history.theta[0]) > 0


def test_progress_is_told():
    told = []
    simulate(STONE, thrown(), 50.0, progress=lambda *call: told.append(call))
    assert told[-1][1:3] == (1000, 1000) and [call[1] for call in told] == sorted(call[1] for call in told)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("duration", {"duration": 0.0}),
        ("output_step", {"output_step": math.nan}),
        ("max_step", {"max_step": -1.0}),
        ("rtol", {"rtol": 0.5}),
        ("trajectory", {"form": "trajectry"}),
        ("DOP853", {"method": "DOP835"}),
        ("breaks", {"breaks": (math.inf,)}),
        ("without aerodynamics", {"controls": {"elevator": 0.1}}),
    ],
)
def test_bad_options(name, options):
    with pytest.raises(InputError, match=name):
        simulate(STONE, thrown(), **{"duration": 1.0, **options})


def test_bad_events():
    with pytest.raises(InputError, match="altitude"):
        Event("altitud", 1.0)
    with pytest.raises(InputError, match="finite"):
        Event("altitude", math.nan)
    with pytest.raises(InputError, match="direction"):
        Event("altitude", 1.0, direction=2)
    with pytest.raises(InputError, match="gamma_deg"):
        simulate(STONE, thrown(gamma=math.pi / 2), 1.0, form="trajectory")
