"""The nonlinear motion with forces by the rate of the angle of attack and in a wind, against independent answers."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spaceplane.dynamics import attitude
from spaceplane.dynamics.equations import flight_model, state_rates
from spaceplane.dynamics.linearise import analytic
from spaceplane.dynamics.motion.body import fixed_rates
from spaceplane.dynamics.motion.forces import Loads, with_lag
from spaceplane.dynamics.motion.linear_aero import LinearAerodynamics
from spaceplane.dynamics.motion.state import from_inertial, from_trajectory_array, to_fixed, to_inertial, to_trajectory
from spaceplane.dynamics.motion.trajectory import steady_rates, trajectory_rates
from spaceplane.dynamics.motion.vehicle import rigid_vehicle
from spaceplane.dynamics.motion.wind import MovingAir, air_acceleration, air_velocity, constant_wind, wind_profile
from spaceplane.dynamics.planet import EARTH_SPHERE, EARTH_SPHERE_ROTATING, WGS84, Planet, geodetic
from spaceplane.dynamics.simulate import FORMS, simulate
from spaceplane.environment.atmosphere import us1976
from spaceplane.errors import InputError

from . import horus
from .test_motion import CONTROLS, NINE, PRODUCTS, glider, model, start

LAG = {"CL_alphadot": 0.6, "Cm_alphadot": -0.7}
STRONG = {"CL_alphadot": 60.0, "Cm_alphadot": -70.0}
BODY_FORMS = ("body-fixed", "body-inertial")


# The rate of the angle of attack


def test_the_trajectory_form_with_lag_is_the_nine_state_model():
    """At random states and controls, to round-off. The nine-state model is linearised by the complex step elsewhere."""
    rng = np.random.default_rng(8)
    for changes in (LAG, STRONG):
        nine = model(**changes)
        vehicle = rigid_vehicle(horus.MASS, LinearAerodynamics(nine))
        for _ in range(20):
            state = nine.reference_state() + rng.uniform(-1, 1, 9) * [50, 0.1, 0, 0.1, 0.1, 0.1, 0.1, 0.1, 1.0]
            values = np.array([state[0], state[1], rng.uniform(-3, 3), state[2], 0.3, rng.uniform(-1, 1), *state[3:]])
            controls = {"elevon_left": 0.1, "rudder_left": 0.2, "moment_z": 1e4}
            inputs = [controls.get(name, 0.0) for name in nine.inputs]
            ours = trajectory_rates(0.0, values, vehicle, EARTH_SPHERE, controls, us1976)[NINE]
            assert ours == pytest.approx(state_rates(state, inputs, nine), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("changes", [LAG, STRONG], ids=["usual", "strong"])
def test_slopes_with_lag_are_the_linear_model(changes):
    """Differences of sixth order with every state and input reach 1e-8 of the analytic A and B."""
    nine = model(**changes)
    system = analytic(nine)
    # the air of the nine-state model: exponential density, linear speed of sound
    here, gradient = nine.point.ambient, nine.air

    def air(altitude):
        rise = altitude - here.altitude
        return replace(
            here,
            density=here.density * math.exp(gradient.log_density * rise),
            speed_of_sound=here.speed_of_sound + gradient.speed_of_sound * rise,
        )

    vehicle = rigid_vehicle(horus.MASS, LinearAerodynamics(nine))
    values = to_trajectory(start(vehicle, EARTH_SPHERE))

    def slope(at, controls):
        return trajectory_rates(0.0, at, vehicle, EARTH_SPHERE, controls, air)[NINE]

    def sixth(shifted, size):
        difference = {k: shifted(k * size) - shifted(-k * size) for k in (1, 2, 3)}
        return (45 * difference[1] - 9 * difference[2] + difference[3]) / (60 * size)

    steps = np.array([2.0, 2e-3, 1e-3, 200.0, 1e-3, 1e-3, 2e-3, 2e-3, 2e-3, 2e-3, 2e-3, 2e-3])
    largest = (np.abs(system.A) * steps[NINE]).max(axis=1)  # what each rate changes by, at most, by one step
    for column, k in enumerate(NINE):
        found = sixth(lambda x, k=k: slope(values + x * np.eye(12)[k], {}), steps[k])
        miss = np.abs(found - system.A[:, column])
        assert (miss <= 1e-8 * np.abs(system.A[:, column]) + 1e-10 * largest / steps[k]).all(), k
    for column, name in enumerate(system.inputs):
        size = 1e3 if name.startswith("moment") else 1e-2
        found = sixth(lambda x, name=name: slope(values, {name: x}), size)
        miss = np.abs(found - system.B[:, column])
        assert (miss <= 1e-8 * np.abs(system.B[:, column]) + 1e-10 * largest / size).all(), name


@pytest.mark.parametrize("planet", [EARTH_SPHERE_ROTATING, WGS84], ids=["rotating", "WGS 84"])
def test_all_forms_fly_the_same_path_with_lag(planet):
    vehicle = glider(PRODUCTS, **STRONG)
    begin = start(vehicle, planet, beta=0.02)
    found = [simulate(vehicle, begin, 20.0, planet, CONTROLS, form=form, rtol=1e-11).final for form in FORMS]
    without = simulate(glider(PRODUCTS), begin, 20.0, planet, CONTROLS, rtol=1e-11).final
    for final in found[1:]:
        assert np.abs(final.position - found[0].position).max() < 2e-4
        assert attitude.angle_between(final.attitude, found[0].attitude) < 1e-8
        assert np.abs(final.rates - found[0].rates).max() < 1e-8
    assert attitude.angle_between(without.attitude, found[0].attitude) > 1e-3  # it acts


def test_limits_of_the_lag():
    """None: nothing changes. Huge lift by the rate: the angle of attack hardly moves. Pitch alone: damping."""
    begin = start(glider(), EARTH_SPHERE)
    state = to_trajectory(begin)
    state[9] += 0.05  # out of equilibrium, so that the angle of attack moves

    def rates(**changes):
        return trajectory_rates(0.0, state, glider(**changes), EARTH_SPHERE, {}, us1976)

    none, tiny, huge, pitch = rates(), rates(CL_alphadot=1e-9), rates(CL_alphadot=1e9), rates(Cm_alphadot=-5.0)
    assert np.abs(tiny - none).max() < 1e-9
    assert abs(none[9]) > 1e-3 and abs(huge[9]) < 1e-5 * abs(none[9])
    assert pitch[9] == none[9]
    assert (pitch[7] - none[7]) * none[9] < 0.0  # the moment opposes the rate
    assert none[9] / rates(CL_alphadot=60.0)[9] > 1.0


def test_a_lift_that_overcomes_inertia_is_refused():
    vehicle = glider(CL_alphadot=-1e6)
    acting = Loads(0.0, 0.0, 0.0, np.zeros(3), 2.5, 1e4, {"CL": 0.0, "Cm": 0.0}, (-1e9, 0.0))
    with pytest.raises(InputError, match="CL_alphadot"):
        with_lag(acting, vehicle, 700.0, 0.0, 0.1)


def test_coefficients_told_hold_the_lag():
    """Lift coefficient of the history over that at a steady angle of attack: CL_alphadot dalpha/dt c/2V."""
    vehicle = glider(**STRONG)
    state = to_trajectory(start(vehicle, EARTH_SPHERE))
    state[9] += 0.03
    flight = simulate(vehicle, from_trajectory_array(state), 2.0, rtol=1e-11, output_step=0.01)
    h = flight.history
    rate = np.gradient(h.alpha.values, h.time.values)
    k = slice(5, -5)
    for name, slope in (("CL", "CL_alphadot"), ("Cm", "Cm_alphadot")):
        reduced = rate * horus.REFERENCE.chord / (2 * h.V.values)
        steady = []
        for i in range(len(rate)):
            q = h.q.values[i] * horus.REFERENCE.chord / (2 * h.V.values[i])
            rates = (h.p.values[i] * 13.0 / (2 * h.V.values[i]), q, h.r.values[i] * 13.0 / (2 * h.V.values[i]))
            aero = vehicle.aerodynamics
            steady.append(aero.coefficients(h.mach.values[i], h.alpha.values[i], h.beta.values[i], rates)[name])
        found = (h[name].values - np.array(steady))[k]
        assert found == pytest.approx((STRONG[slope] * reduced)[k], rel=2e-3, abs=1e-6)
        assert np.abs(found).max() > 1e-3


# Wind


FLAT = Planet("flat", 9.80665 * 1e11**2, 1e11)
"""So large that its surface is flat: gravity uniform, no curvature of the path."""


@pytest.mark.parametrize("form", BODY_FORMS)
def test_galilean_invariance(form):
    """In a uniform wind the vehicle flies as in still air, and drifts with the wind."""
    vehicle = glider(**LAG)
    velocity = np.array([0.0, 35.0, -20.0])  # up, east, north at longitude and latitude 0
    blowing = MovingAir(constant_wind(north=-20.0, east=35.0))
    still_start = start(vehicle, FLAT, lon=0.0, lat=0.0, R=FLAT.radius + 26_700.0, beta=0.02)
    wind_start = replace(still_start, velocity=still_start.velocity + velocity)
    time = 20.0
    options = {"controls": CONTROLS, "form": form, "rtol": 1e-11, "output_step": time}
    still = simulate(vehicle, still_start, time, FLAT, **options)
    windy = simulate(vehicle, wind_start, time, FLAT, air=blowing, **options)
    drift = windy.final.position - still.final.position
    assert drift == pytest.approx(velocity * time, abs=2e-3)  # positions of 1e11 m have 2e-5 m of round-off
    assert windy.final.velocity - still.final.velocity == pytest.approx(velocity, abs=1e-4)
    assert attitude.angle_between(windy.final.attitude, still.final.attitude) < 1e-7
    for name in ("V", "alpha", "beta", "mach", "CL", "Cm", "gamma", "chi", "sigma"):
        assert windy.history[name].values == pytest.approx(still.history[name].values, rel=1e-6, abs=1e-8)
    assert abs(windy.history.ground_speed.values[-1] - still.history.V.values[-1]) > 5.0


@pytest.mark.parametrize("form", BODY_FORMS)
def test_the_air_of_a_rotating_planet_is_an_east_wind_over_one_at_rest(form):
    """Along the equator: w = Omega r eastwards, a wind with shear. The lag sees the wind change on the way.

    Without derivatives with rates, whose reference differs by the planet's own rate.
    """
    level = flight_model(
        horus.point(bank_deg=0.0), horus.MASS, horus.REFERENCE, horus.derivatives(Cm_alpha=-0.1, Cn_beta=0.1, **STRONG)
    )
    vehicle = rigid_vehicle(horus.MASS, LinearAerodynamics(level))
    turning = replace(EARTH_SPHERE, rotation=10 * EARTH_SPHERE_ROTATING.rotation)  # ten times, for a wind that matters
    begin = to_trajectory(
        start(vehicle, turning, lon=0.0, lat=0.0, chi=math.pi / 2, sigma=0.0, R=6_356_766.0 + 26_700.0)
    )
    begin[9] += 0.02
    begin = from_trajectory_array(begin)
    inertial = to_inertial(begin, turning, 0.0)
    altitudes = np.linspace(20_000.0, 35_000.0, 2)
    east = turning.rotation * (EARTH_SPHERE.radius + altitudes)
    blowing = MovingAir(wind_profile(altitudes, [0.0, 0.0], east))
    time = 8.0
    with_rotation = simulate(vehicle, begin, time, turning, form=form, rtol=1e-10, output_step=time)
    with_wind = simulate(
        vehicle, from_inertial(inertial, EARTH_SPHERE, 0.0), time, EARTH_SPHERE, form=form, rtol=1e-10, air=blowing,
        output_step=time,
    )  # fmt: skip
    a = to_inertial(with_rotation.final, turning, time)
    b = to_inertial(with_wind.final, EARTH_SPHERE, time)
    assert b[:3] == pytest.approx(a[:3], abs=2e-3)
    assert b[3:6] == pytest.approx(a[3:6], abs=2e-4)
    assert b[10:] == pytest.approx(a[10:], abs=1e-6)
    assert float(with_wind.history.alpha[-1]) == pytest.approx(float(with_rotation.history.alpha[-1]), abs=1e-6)
    assert float(with_wind.history.V[-1]) == pytest.approx(float(with_rotation.history.V[-1]), abs=1e-3)
    assert abs(float(with_wind.history.ground_speed[-1]) - float(with_wind.history.V[-1])) > 2_000.0


PROFILE = wind_profile([0.0, 26_000.0, 60_000.0], [5.0, 30.0, -20.0], [-10.0, 60.0, 40.0], [0.0, 3.0, -2.0])


def test_wind_and_lag_agree_with_an_independent_integration():
    """Newton and Euler written out anew, the rate of alpha by difference and iteration, Runge-Kutta of order 4."""
    vehicle, planet = glider(PRODUCTS, **STRONG), WGS84
    begin = start(vehicle, planet, beta=0.01)
    time, steps = 5.0, 500
    air = MovingAir(PROFILE)
    final = simulate(vehicle, begin, time, planet, CONTROLS, rtol=1e-11, output_step=time, air=air).final
    aero, ref = vehicle.aerodynamics, horus.REFERENCE
    spin = np.array([0.0, 0.0, planet.rotation])
    thrust = np.array([CONTROLS["moment_x"], 0.0, 0.0])
    deflections = {name: value for name, value in CONTROLS.items() if not name.startswith("moment")}

    def relative(r, v, C):
        up = r / np.linalg.norm(r)
        east = np.cross([0.0, 0.0, 1.0], up)
        east /= np.linalg.norm(east)
        north, to_east, down = PROFILE(geodetic(planet, r)[0])
        blowing = north * np.cross(up, east) + to_east * east - down * up
        return C.T @ (v - np.cross(spin, r) - blowing)

    def slopes(y):
        r, v, C, omega = y[:3], y[3:6], y[6:15].reshape(3, 3), y[15:]
        z, rr = r[2], r @ r
        oblate = 1.5 * planet.J2 * (planet.radius**2 / rr)
        g = -planet.mu / rr**1.5 * (r * (1 - 5 * oblate * z**2 / rr) + oblate * (r + np.array([0, 0, 2 * z])))
        u, side_speed, w = relative(r, v, C)
        V = math.sqrt(u**2 + side_speed**2 + w**2)
        alpha, beta = math.atan(w / u), math.asin(side_speed / V)
        ambient = us1976(geodetic(planet, r)[0])
        q = ambient.density * V * V / 2 * ref.area
        turn = (omega - C.T @ spin) / (2 * V) * [ref.span, ref.chord, ref.span]
        c = aero.coefficients(V / ambient.speed_of_sound, alpha, beta, tuple(turn), deflections)
        drag = -np.array([u, side_speed, w]) / V
        lift = np.array([math.sin(alpha), 0.0, -math.cos(alpha)])
        p_, q_, r_ = omega
        swing = C @ np.array([[0, -r_, q_], [r_, 0, -p_], [-q_, p_, 0]])
        rate = 0.0
        for _ in range(40):
            reduced = rate * ref.chord / (2 * V)
            CL = c["CL"] + STRONG["CL_alphadot"] * reduced
            force = q * (c["CD"] * drag + CL * lift - c["CY"] * np.cross(lift, -drag))
            fall = C @ force / vehicle.mass + g
            h = 1e-4
            ahead, behind = (relative(r + s * h * v, v + s * h * fall, C + s * h * swing) for s in (1.0, -1.0))
            before, rate = rate, (math.atan(ahead[2] / ahead[0]) - math.atan(behind[2] / behind[0])) / (2 * h)
            if abs(rate - before) < 1e-12:
                break
        Cm = c["Cm"] + STRONG["Cm_alphadot"] * rate * ref.chord / (2 * V)
        moment = q * np.array([ref.span * c["Cl"], ref.chord * Cm, ref.span * c["Cn"]]) + thrust
        euler = np.linalg.solve(vehicle.inertia, moment - np.cross(omega, vehicle.inertia @ omega))
        return np.concatenate([v, fall, swing.ravel(), euler])

    packed = to_inertial(begin, planet, 0.0)
    y = np.concatenate([packed[:6], attitude.matrix(packed[6:10]).ravel(), packed[10:]])
    h = time / steps
    for _ in range(steps):
        a = slopes(y)
        b = slopes(y + h / 2 * a)
        c = slopes(y + h / 2 * b)
        y = y + h / 6 * (a + 2 * b + 2 * c + slopes(y + h * c))
    ours = to_inertial(final, planet, time)
    assert ours[:3] == pytest.approx(y[:3], abs=1e-3)
    assert ours[3:6] == pytest.approx(y[3:6], abs=1e-4)
    assert attitude.matrix(ours[6:10]) == pytest.approx(y[6:15].reshape(3, 3), abs=1e-6)
    assert ours[10:] == pytest.approx(y[15:], abs=1e-6)


def test_signs_of_the_wind():
    """Northbound: a wind to the north is a tail wind, one to the west comes from the right, one down lowers alpha."""
    vehicle = glider()
    begin = start(vehicle, EARTH_SPHERE, chi=0.0, sigma=0.0, gamma=0.0)

    def seen(**blowing):
        air = MovingAir(constant_wind(**blowing))
        return simulate(vehicle, begin, 1e-3, air=air, max_step=1e-3).history.isel(time=0)

    still = seen()
    V = float(still.V)
    assert float(seen(north=10.0).V) == pytest.approx(V - 10.0)
    assert float(seen(east=-10.0).beta) == pytest.approx(math.atan2(10.0, V), rel=1e-9)
    assert float(seen(down=10.0).alpha) - float(still.alpha) == pytest.approx(-math.atan2(10.0, V), rel=1e-9)
    assert float(seen(east=-10.0).track) == pytest.approx(0.0, abs=1e-12)
    assert float(seen(east=-10.0).chi) == pytest.approx(math.atan2(10.0, V), rel=1e-9)


def test_both_body_forms_agree_in_a_wind_and_the_trajectory_form_refuses_it():
    vehicle, air = glider(PRODUCTS, **LAG), MovingAir(PROFILE)
    begin = start(vehicle, WGS84, beta=0.01)
    one, other = (
        simulate(vehicle, begin, 15.0, WGS84, CONTROLS, form=f, air=air, rtol=1e-11).final for f in BODY_FORMS
    )
    assert np.abs(one.position - other.position).max() < 1e-4
    assert np.abs(one.rates - other.rates).max() < 1e-8
    with pytest.raises(InputError, match="wind"):
        simulate(vehicle, begin, 1.0, WGS84, form="trajectory", air=air)
    with pytest.raises(InputError, match="wind"):
        steady_rates(to_trajectory(begin), vehicle, WGS84, {}, air)


def test_the_wind_met_on_the_way_changes_as_the_path_does():
    """Climbing through a linear profile: dw/dt = dw/dh times the rate of climb, beside the turn of the horizon."""
    air = MovingAir(wind_profile([0.0, 40_000.0], [0.0, 80.0], [0.0, 0.0]))
    position = np.array([EARTH_SPHERE.radius + 20_000.0, 0.0, 0.0])
    assert air_velocity(air, EARTH_SPHERE, position) == pytest.approx([0.0, 0.0, 40.0])
    climbing = air_acceleration(air, EARTH_SPHERE, position, np.array([100.0, 0.0, 0.0]))
    assert climbing == pytest.approx([0.0, 0.0, 80.0 / 40_000.0 * 100.0], abs=1e-7)
    northwards = air_acceleration(air, EARTH_SPHERE, position, np.array([0.0, 0.0, 100.0]))
    assert northwards == pytest.approx([-40.0 * 100.0 / position[0], 0.0, 0.0], abs=1e-7)


def test_flight_ends_where_the_wind_is_not_known():
    vehicle = glider()
    begin = start(vehicle, EARTH_SPHERE)
    air = MovingAir(wind_profile([26_000.0, 40_000.0], [10.0, 10.0], [0.0, 0.0]))
    flight = simulate(vehicle, begin, 200.0, air=air)
    assert not flight.completed
    assert "the wind is known from 26000 to 40000 m" in flight.reason or "hold from" in flight.reason
    assert float(flight.history.altitude[-1]) >= 26_000.0 - 1e-3


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: constant_wind(math.nan), "wind"),
        (lambda: wind_profile([0.0], [1.0], [1.0]), "altitudes"),
        (lambda: wind_profile([0.0, 0.0], [1.0, 1.0], [1.0, 1.0]), "altitudes"),
        (lambda: wind_profile([0.0, 1e4], [1.0], [1.0, 1.0]), "north"),
        (lambda: wind_profile([0.0, 1e4], [1.0, 1.0], [math.inf, 1.0]), "east"),
        (lambda: wind_profile([0.0, 1e4], [1.0, 1.0], [1.0, 1.0], [0.0]), "down"),
        (lambda: air_velocity(MovingAir(lambda h: [1.0]), EARTH_SPHERE, np.array([6.4e6, 0.0, 0.0])), "three finite"),
    ],
)
def test_bad_winds(make, match):
    with pytest.raises(InputError, match=match):
        make()


def test_a_vehicle_in_vacuum_feels_no_wind():
    begin = to_fixed(start(glider(), WGS84))
    stone = rigid_vehicle(horus.MASS)
    still, windy = (fixed_rates(0.0, begin, stone, WGS84, {}, air) for air in (us1976, MovingAir(PROFILE)))
    assert np.array_equal(still, windy)
