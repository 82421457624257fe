"""The nonlinear motion against mechanics: conserved quantities, exact solutions, symmetry, other codings."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spaceplane.dynamics import attitude
from spaceplane.dynamics.equations import flight_model, state_rates
from spaceplane.dynamics.linearise import analytic
from spaceplane.dynamics.motion.linear_aero import LinearAerodynamics
from spaceplane.dynamics.motion.state import (
    TRAJECTORY_STATES,
    FlightState,
    from_inertial,
    from_trajectory,
    from_trajectory_array,
    to_inertial,
    to_trajectory,
)
from spaceplane.dynamics.motion.trajectory import steady_rates, trajectory_rates
from spaceplane.dynamics.motion.vehicle import Vehicle, rigid_vehicle
from spaceplane.dynamics.planet import (
    EARTH_SPHERE,
    EARTH_SPHERE_ROTATING,
    WGS84,
    cartesian,
    geodetic,
    gravity,
    potential,
)
from spaceplane.dynamics.simulate import FORMS, simulate
from spaceplane.environment.atmosphere import us1976
from spaceplane.errors import InputError
from spaceplane.vehicle.properties import MassProperties

from . import horus

PRODUCTS = (3_000.0, -20_000.0, 5_000.0)
NO_LAG = {name: value for name, value in horus.EXTRA.items() if "alphadot" not in name}
# Stable about all axes, with every term at work.
STABLE = {**NO_LAG, "Cm_alpha": -0.1, "Cn_beta": 0.1, "Cl_beta": -0.08, "CY_beta": -0.9}
NINE = [TRAJECTORY_STATES.index(name) for name in ("V", "gamma", "R", "p", "q", "r", "alpha", "beta", "sigma")]


def model(point=None, mass=horus.MASS, **changes):
    return flight_model(point or horus.point(), mass, horus.REFERENCE, horus.derivatives(**{**STABLE, **changes}))


def glider(products=(0.0, 0.0, 0.0), **changes):
    return rigid_vehicle(horus.MASS, LinearAerodynamics(model(**changes)), products)


def start(vehicle, planet, **changes):
    """The TAEM interface over Kourou, heading north-west, with the body rates that hold its attitude."""
    point = horus.point()
    lat = math.radians(5.2)
    ground = 0.0
    for _ in range(5):
        ground += point.altitude - geodetic(planet, cartesian(planet.radius + ground, -0.92, lat))[0]
    values = {
        "V": point.velocity, "gamma": point.gamma, "chi": -0.6, "R": planet.radius + ground, "lon": -0.92, "lat": lat,
        "alpha": point.alpha, "sigma": point.bank,
    }  # fmt: skip
    state = to_trajectory(from_trajectory({**values, **changes}))
    if not {"p", "q", "r"} & set(changes):
        state[6:9] = steady_rates(state, vehicle, planet, {}, us1976)
    return from_trajectory_array(state)


# Coordinates


@pytest.mark.parametrize("time", [0.0, 5000.0])
def test_coordinates_round_trip(time):
    rng = np.random.default_rng(3)
    for _ in range(20):
        values = np.array([700, *rng.uniform(-1.5, 1.5, 2), 6.4e6, *rng.uniform(-1.5, 1.5, 2), *rng.normal(size=3), *rng.uniform(-1.5, 1.5, 3)])  # fmt: skip  # noqa: E501
        state = from_trajectory_array(values)
        assert to_trajectory(state) == pytest.approx(values, rel=1e-12, abs=1e-12)
        back = from_inertial(to_inertial(state, WGS84, time), WGS84, time)
        assert to_trajectory(back) == pytest.approx(values, rel=1e-11, abs=1e-11)


def test_inertial_velocity_of_a_body_at_rest_on_the_ground():
    state = FlightState([6_378_137.0, 0, 0], [0, 0, 0], attitude.IDENTITY, [0, 0, 0])
    inertial = to_inertial(state, WGS84, 0.0)
    assert inertial[3:6] == pytest.approx([0, 465.101, 0], abs=1e-3)  # towards the east
    quarter = math.pi / 2 / WGS84.rotation
    assert to_inertial(state, WGS84, quarter)[:3] == pytest.approx([0, 6_378_137.0, 0], abs=1e-6)


# The path without air


def orbit(eccentricity, planet=EARTH_SPHERE):
    """State at the pericentre of an inclined ellipse, at time 0, and its semi-major axis and axes of the plane."""
    pericentre = 7.0e6
    a = pericentre / (1 - eccentricity)
    radial, along = np.array([0.6, 0.8, 0.0]), np.array([-0.8 * 0.6, 0.6 * 0.6, 0.8])
    speed = math.sqrt(planet.mu * (1 + eccentricity) / pericentre)
    inertial = np.concatenate([pericentre * radial, speed * along, attitude.IDENTITY, [0.0, 0.0, 0.0]])
    return from_inertial(inertial, planet, 0.0), a, radial, along


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("planet", [EARTH_SPHERE, EARTH_SPHERE_ROTATING], ids=["at rest", "rotating"])
def test_kepler_ellipse(form, planet):
    e = 0.3
    state, a, radial, along = orbit(e, planet)
    time = 3_000.0
    end = simulate(rigid_vehicle(horus.MASS), state, time, planet, form=form, rtol=1e-12, output_step=time).final
    mean = math.sqrt(planet.mu / a**3) * time
    E = mean
    for _ in range(50):
        E -= (E - e * math.sin(E) - mean) / (1 - e * math.cos(E))
    exact = a * ((math.cos(E) - e) * radial + math.sqrt(1 - e**2) * math.sin(E) * along)
    assert to_inertial(end, planet, time)[:3] == pytest.approx(exact, abs=0.02)  # on a path of 20 000 km


@pytest.mark.parametrize("form", FORMS)
def test_conserved_in_orbit_about_the_ellipsoid(form):
    """Inertial energy and polar angular momentum; Jacobi's constant in the rotating axes, which `history` carries."""
    state, *_ = orbit(0.1, WGS84)
    flight = simulate(rigid_vehicle(horus.MASS), state, 2_000.0, WGS84, form=form, rtol=1e-12, output_step=400.0)
    energy, momentum = [], []
    for time in flight.history.time.values:
        inertial = to_inertial(flight.state_at(float(time)), WGS84, float(time))
        energy.append(inertial[3:6] @ inertial[3:6] / 2 + potential(WGS84, inertial[:3]))
        momentum.append(np.cross(inertial[:3], inertial[3:6]))
    momentum = np.array(momentum)
    assert np.ptp(energy) < 1e-10 * abs(energy[0])
    assert np.ptp(momentum[:, 2]) < 1e-10 * abs(momentum[0, 2])
    assert np.ptp(momentum[:, 0]) > 1e-5 * abs(momentum[0, 0])  # the bulge turns the plane
    jacobi = flight.history.energy.values
    assert np.ptp(jacobi) < 1e-10 * abs(jacobi[0])
    assert np.ptp(flight.history.V.values) > 100.0


def test_falling_body_drifts_east():
    """Omega (g - Omega^2 R) t^3 cos(lat) / 3 to leading order."""
    lat, fall = 0.7, 30.0
    radius = EARTH_SPHERE_ROTATING.radius + 10_000.0
    state = FlightState(cartesian(radius, 0.0, lat), [0, 0, 0], attitude.IDENTITY, [0, 0, 0])
    vehicle = rigid_vehicle(horus.MASS)
    planet = EARTH_SPHERE_ROTATING
    from spaceplane.dynamics.motion.body import fixed_rates
    from spaceplane.dynamics.motion.state import to_fixed

    values, step = to_fixed(state), 0.1
    for _ in range(round(fall / step)):
        k = []
        for share in (0.0, 0.5, 0.5, 1.0):
            k.append(fixed_rates(0, values + share * step * (k[-1] if k else 0), vehicle, planet, {}, us1976))
        values = values + step / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3])
    east = values[1]
    g = np.linalg.norm(gravity(planet, state.position)) - planet.rotation**2 * radius
    assert east == pytest.approx(planet.rotation * g * fall**3 * math.cos(lat) / 3, rel=1e-3)
    assert east > 0


# The rotation without moments


def spinning(inertia, rates):
    state = FlightState([8e6, 0, 0], [0, 6_000.0, 0], attitude.from_euler(0.3, 0.2, -1.0), rates)
    return Vehicle(1_000.0, inertia), state


@pytest.mark.parametrize("form", FORMS)
def test_torque_free_body_keeps_energy_and_angular_momentum(form):
    inertia = np.array([[300.0, -40.0, 25.0], [-40.0, 500.0, 10.0], [25.0, 10.0, 600.0]])
    vehicle, state = spinning(inertia, [0.3, 0.2, -0.4])
    flight = simulate(vehicle, state, 60.0, EARTH_SPHERE_ROTATING, form=form, rtol=1e-12, output_step=5.0)
    energy, momentum, rates = [], [], []
    for time in flight.history.time.values:
        inertial = to_inertial(flight.state_at(float(time)), EARTH_SPHERE_ROTATING, float(time))
        h = inertia @ inertial[10:13]
        energy.append(inertial[10:13] @ h / 2)
        momentum.append(attitude.rotate(inertial[6:10], h))  # a vector in inertial axes, not only its size
        rates.append(inertial[10:13])
    assert np.ptp(energy) < 1e-9 * energy[0]
    assert np.ptp(momentum, axis=0).max() < 1e-9 * np.linalg.norm(momentum[0])
    assert np.ptp(rates, axis=0).min() > 0.05


def test_axisymmetric_precession():
    """About h at |h|/It, about the own axis at (It - Is)/It p; here It = 500, Is = 200 kg m2."""
    p, transverse, time = 0.8, 0.3, 40.0
    vehicle, state = spinning(np.diag([200.0, 500.0, 500.0]), [p, transverse, 0.0])
    end = simulate(vehicle, state, time, EARTH_SPHERE, rtol=1e-12, output_step=time).final
    own = -(500.0 - 200.0) / 500.0 * p * time  # dq/dt = (It - Is)/It p r, dr/dt = -(It - Is)/It p q
    assert end.rates == pytest.approx([p, transverse * math.cos(own), transverse * math.sin(own)], abs=1e-9)
    h = attitude.rotate(state.attitude, np.diag([200.0, 500.0, 500.0]) @ state.rates)
    turned = attitude.about_axis(h, np.linalg.norm(h) / 500.0 * time)
    exact = attitude.multiply(attitude.multiply(turned, state.attitude), attitude.about_axis((1, 0, 0), -own))
    assert attitude.angle_between(end.attitude, exact) < 1e-9


# With air


def test_trajectory_form_on_a_sphere_at_rest_is_the_nine_state_model():
    """Two codings of the same equations, at random states, the trimmed moments included."""
    rng = np.random.default_rng(5)
    nine = model()
    vehicle = rigid_vehicle(horus.MASS, LinearAerodynamics(nine))
    for _ in range(30):
        state = nine.reference_state() + rng.uniform(-1, 1, 9) * [50, 0.1, 0, 0.1, 0.1, 0.1, 0.1, 0.1, 1.0]
        values = np.array([state[0], state[1], rng.uniform(-3, 3), state[2], rng.uniform(-3, 3), rng.uniform(-1, 1), *state[3:]])  # fmt: skip  # noqa: E501
        controls = {"elevon_left": 0.1, "elevon_right": -0.05, "rudder_left": 0.2, "moment_z": 1e4, "moment_x": -2e4}
        inputs = [controls.get(name, 0.0) for name in nine.inputs]
        ours = trajectory_rates(0.0, values, vehicle, EARTH_SPHERE, controls, us1976)
        air = replace(nine, air=nine.air)
        assert ours[NINE] == pytest.approx(state_rates(state, inputs, air), rel=1e-9, abs=1e-12)


def test_steady_rates_are_those_of_the_flight_point():
    vehicle = glider()
    state = to_trajectory(start(vehicle, EARTH_SPHERE))
    rates = model().rates
    assert state[6:9] == pytest.approx((rates.p, rates.q, rates.r), rel=1e-12)
    for planet in (EARTH_SPHERE, WGS84):
        state = to_trajectory(start(vehicle, planet))
        slopes = trajectory_rates(0.0, state, vehicle, planet, {}, us1976)
        assert np.abs(slopes[9:12]).max() < 1e-14


CONTROLS = {"elevon_left": -0.01, "elevon_right": 0.012, "rudder_right": 0.05, "body_flap": 0.02, "moment_x": 2_000.0}


@pytest.mark.parametrize("planet", [EARTH_SPHERE, EARTH_SPHERE_ROTATING, WGS84], ids=["rest", "rotating", "WGS 84"])
def test_all_forms_fly_the_same_path(planet):
    vehicle = glider(PRODUCTS)
    begin = start(vehicle, planet, beta=0.02)
    found = {
        form: simulate(vehicle, begin, 30.0, planet, CONTROLS, form=form, rtol=1e-11, output_step=30.0).final
        for form in FORMS
    }
    first = found["body-inertial"]
    moved = np.linalg.norm(first.position - begin.position)
    assert moved > 15_000.0
    for final in found.values():
        assert np.abs(final.position - first.position).max() < 1e-8 * moved
        assert np.abs(final.velocity - first.velocity).max() < 1e-8 * np.linalg.norm(first.velocity)
        assert attitude.angle_between(final.attitude, first.attitude) < 1e-8
        assert np.abs(final.rates - first.rates).max() < 1e-8
    assert np.abs(to_trajectory(first)[9:] - to_trajectory(begin)[9:]).max() > 0.05  # the attitude has moved, too


def test_glide_agrees_with_an_independent_integration():
    """Newton and Euler written out anew: inertial Cartesian, a rotation matrix, Runge-Kutta of order 4."""
    vehicle, planet = glider(PRODUCTS), WGS84
    begin = start(vehicle, planet, beta=0.01)
    time, steps = 10.0, 2_000
    final = simulate(vehicle, begin, time, planet, CONTROLS, rtol=1e-11, output_step=time).final
    aero, ref = vehicle.aerodynamics, horus.REFERENCE
    spin = np.array([0.0, 0.0, planet.rotation])
    thrust = np.array([CONTROLS["moment_x"], 0.0, 0.0])
    deflections = {name: value for name, value in CONTROLS.items() if not name.startswith("moment")}

    def slopes(y):
        r, v, C, omega = y[:3], y[3:6], y[6:15].reshape(3, 3), y[15:]  # C: inertial components of a body vector
        z, rr = r[2], r @ r
        oblate = 1.5 * planet.J2 * (planet.radius**2 / rr)
        g = -planet.mu / rr**1.5 * (r * (1 - 5 * oblate * z**2 / rr) + oblate * (r + np.array([0, 0, 2 * z])))
        u, w_side, w = C.T @ (v - np.cross(spin, r))
        V = math.sqrt(u**2 + w_side**2 + w**2)
        alpha, beta = math.atan(w / u), math.asin(w_side / V)
        air = us1976(geodetic(planet, r)[0])
        q = air.density * V * V / 2 * ref.area
        turn = (omega - C.T @ spin) / (2 * V) * [ref.span, ref.chord, ref.span]
        c = aero.coefficients(V / air.speed_of_sound, alpha, beta, tuple(turn), deflections)
        drag = -np.array([u, w_side, w]) / V
        lift = np.array([math.sin(alpha), 0.0, -math.cos(alpha)])
        side = np.cross(lift, -drag)  # up x forward is left, and lift x drag is right
        force = q * (c["CD"] * drag + c["CL"] * lift - c["CY"] * side)
        moment = q * np.array([ref.span * c["Cl"], ref.chord * c["Cm"], ref.span * c["Cn"]]) + thrust
        euler = np.linalg.solve(vehicle.inertia, moment - np.cross(omega, vehicle.inertia @ omega))
        p_, q_, r_ = omega
        cross = np.array([[0, -r_, q_], [r_, 0, -p_], [-q_, p_, 0]])
        return np.concatenate([v, C @ force / vehicle.mass + g, (C @ cross).ravel(), euler])

    packed = to_inertial(begin, planet, 0.0)
    y = np.concatenate([packed[:6], attitude.matrix(packed[6:10]).ravel(), packed[10:]])
    h = time / steps
    for _ in range(steps):
        a = slopes(y)
        b = slopes(y + h / 2 * a)
        c = slopes(y + h / 2 * b)
        d = slopes(y + h * c)
        y = y + h / 6 * (a + 2 * b + 2 * c + d)
    ours = to_inertial(final, planet, time)
    assert ours[:3] == pytest.approx(y[:3], abs=1e-4)
    assert ours[3:6] == pytest.approx(y[3:6], abs=1e-5)
    assert attitude.matrix(ours[6:10]) == pytest.approx(y[6:15].reshape(3, 3), abs=1e-7)
    assert ours[10:] == pytest.approx(y[15:], abs=1e-7)


def test_other_method_of_integration_agrees():
    vehicle = glider()
    begin = start(vehicle, WGS84, beta=0.02)
    one, other = (
        simulate(vehicle, begin, 10.0, WGS84, rtol=tolerance, method=method, output_step=10.0).final
        for method, tolerance in (("DOP853", 1e-11), ("RK45", 1e-10))
    )
    assert np.abs(one.position - other.position).max() < 1e-3
    assert np.abs(one.rates - other.rates).max() < 1e-7


def test_drag_takes_the_energy_it_should():
    """Jacobi's constant changes by the work of drag alone."""
    vehicle = glider()
    flight = simulate(vehicle, start(vehicle, WGS84, beta=0.03), 20.0, WGS84, rtol=1e-10, output_step=0.05)
    h = flight.history
    power = -h.CD.values * h.dynamic_pressure.values * horus.REFERENCE.area / horus.MASS.mass * h.V.values
    t = h.time.values
    work = np.sum((power[1:] + power[:-1]) / 2 * np.diff(t))
    assert work < -1e4
    assert h.energy.values[-1] - h.energy.values[0] == pytest.approx(work, rel=1e-5)


# Symmetry and signs

FLIP_MERIDIAN = np.array([1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, -1])


def symmetric_glider():
    """No trimmed roll and yaw moments, no steady rates: the aerodynamics of a symmetric vehicle."""
    level = flight_model(horus.point(bank_deg=0.0), horus.MASS, horus.REFERENCE, horus.derivatives(**STABLE))
    return rigid_vehicle(horus.MASS, LinearAerodynamics(level))


def test_mirror_of_a_symmetric_vehicle_is_exact():
    vehicle = symmetric_glider()
    begin = to_trajectory(start(vehicle, WGS84, beta=0.02, lon=0.3, sigma=0.4))
    mirrored = from_trajectory_array(begin * FLIP_MERIDIAN)
    opposite = WGS84.turning(-WGS84.rotation)
    right = simulate(vehicle, from_trajectory_array(begin), 20.0, WGS84, rtol=1e-11, output_step=20.0).final
    left = simulate(vehicle, mirrored, 20.0, opposite, rtol=1e-11, output_step=20.0).final
    assert to_trajectory(left) * FLIP_MERIDIAN == pytest.approx(to_trajectory(right), rel=1e-9, abs=1e-9)
    same_sense = simulate(vehicle, mirrored, 20.0, WGS84, rtol=1e-11, output_step=20.0).final
    assert np.linalg.norm(same_sense.position - left.position) > 5.0  # the rotation matters


def test_mirror_in_the_equator_is_exact():
    """Here the planet keeps its sense: north becomes south, a right bank a left one."""
    vehicle = symmetric_glider()
    begin = to_trajectory(start(vehicle, WGS84, beta=0.02, sigma=0.4))
    flip = np.array([1, 1, -1, 1, 1, -1, -1, 1, -1, 1, -1, -1])
    turn = np.array([0, 0, math.pi, 0, 0, 0, 0, 0, 0, 0, 0, 0])
    north = simulate(vehicle, from_trajectory_array(begin), 20.0, WGS84, rtol=1e-11, output_step=20.0).final
    south = simulate(vehicle, from_trajectory_array(begin * flip + turn), 20.0, WGS84, rtol=1e-11, output_step=20.0).final  # fmt: skip  # noqa: E501
    expected = to_trajectory(north) * flip + turn
    found = to_trajectory(south)
    found[2] = expected[2] + (found[2] - expected[2] + math.pi) % (2 * math.pi) - math.pi
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_signs_of_bank_and_controls():
    vehicle = symmetric_glider()
    state = to_trajectory(start(vehicle, EARTH_SPHERE, sigma=0.5))

    def slope(name, values=state, **controls):
        return trajectory_rates(0.0, values, vehicle, EARTH_SPHERE, controls, us1976)[TRAJECTORY_STATES.index(name)]

    assert slope("chi") > 0  # right bank turns right: from north to the east
    left = state.copy()
    left[11] = -0.5
    assert slope("chi", left) < 0
    assert slope("R") < 0 and slope("V") < 0  # a glide descends and slows down
    assert slope("q", elevator=0.1) < slope("q")  # trailing edge down: nose down
    assert slope("p", aileron=-0.1) < slope("p")  # EXTRA's Cl_aileron is positive
    assert slope("r", moment_z=1e5) > slope("r")
    east = state.copy()
    east[2], east[11] = math.pi / 2, 0.0
    rotating = trajectory_rates(0.0, east, vehicle, EARTH_SPHERE_ROTATING, {}, us1976)
    assert rotating[1] > trajectory_rates(0.0, east, vehicle, EARTH_SPHERE, {}, us1976)[1]  # Eotvos: lighter eastwards
    north = state.copy()
    north[2], north[11] = 0.0, 0.0
    assert trajectory_rates(0.0, north, vehicle, EARTH_SPHERE_ROTATING, {}, us1976)[2] > 0  # Coriolis: to the right


# The linear model


def test_small_perturbations_follow_the_linear_model():
    """About level, banked flight without drag nothing drifts; the linear response misses the second order only."""
    weight = horus.point().gravity - horus.point().velocity ** 2 / horus.point().radius
    bank = math.radians(35.0)
    lift = horus.MASS.mass * weight / math.cos(bank) / (horus.point().dynamic_pressure * 110.0)
    point = horus.point(CL=lift, CD=0.0, gamma_deg=0.0, bank_deg=35.0)
    nine = model(point, CD_alpha=0.4, CD_M=-0.01)
    system = analytic(nine)
    vehicle = rigid_vehicle(horus.MASS, LinearAerodynamics(nine))
    reference = nine.reference_state()
    direction = np.array([5.0, 0.004, 20.0, 0.01, 0.01, 0.01, 0.01, 0.01, 0.02])
    inputs = {"elevator": 0.004, "aileron": 0.002, "rudder": 0.003, "body_flap": 0.003, "moment_z": 500.0}
    u = np.array([inputs.get(name, 0.0) for name in system.inputs])
    time = 8.0
    from scipy.linalg import expm

    grown = expm(np.block([[system.A, (system.B @ u)[:, None]], [np.zeros((1, 10))]]) * time)
    response = grown[:9, :9] @ direction + grown[:9, 9]
    scale = np.abs(response) + np.abs(direction)
    errors = []
    for size in (0.4, 0.2, 0.1):
        nine_values = reference + size * direction
        values = np.array([nine_values[0], nine_values[1], 0.4, nine_values[2], 0.1, 0.2, *nine_values[3:]])
        controls = {name: size * value for name, value in inputs.items()}
        begin = from_trajectory_array(values)
        final = simulate(vehicle, begin, time, controls=controls, form="trajectory", rtol=1e-12, output_step=time).final
        moved = to_trajectory(final)[NINE] - reference
        errors.append(np.abs((moved - size * response) / scale).max())
    assert errors[0] < 0.1  # the response itself is of size 0.4
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.2)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.1)


@pytest.mark.parametrize("mass", [horus.MASS, horus.TILTED], ids=["symmetric", "Ixz"])
def test_slopes_of_the_trajectory_form_are_the_linear_model(mass):
    """At the TAEM interface, banked and descending: central differences with every state and input."""
    nine = model(mass=mass)
    system = analytic(nine)
    vehicle = rigid_vehicle(mass, LinearAerodynamics(nine))
    values = to_trajectory(start(vehicle, EARTH_SPHERE))
    steps = np.array([1e-2, 1e-5, 1e-5, 1.0, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5])

    def slope(at, controls):
        return trajectory_rates(0.0, at, vehicle, EARTH_SPHERE, controls, us1976)[NINE]

    for column, k in enumerate(NINE):
        step = np.zeros(12)
        step[k] = steps[k]
        found = (slope(values + step, {}) - slope(values - step, {})) / (2 * steps[k])
        assert found == pytest.approx(system.A[:, column], rel=1e-6, abs=1e-9), TRAJECTORY_STATES[k]
    for column, name in enumerate(system.inputs):
        size = 1e3 if name.startswith("moment") else 1e-3
        found = (slope(values, {name: size}) - slope(values, {name: -size})) / (2 * size)
        assert found == pytest.approx(system.B[:, column], rel=1e-6, abs=1e-13), name


@pytest.mark.parametrize("Ixz", [-150e3, -60e3, 0.0, 100e3])
def test_nine_states_turn_as_the_full_tensor(Ixz):
    """The same dp/dt, dq/dt and dr/dt at random states, far from steady, and none in steady flight."""
    mass = replace(horus.MASS, Ixz=Ixz)
    nine = model(mass=mass)
    vehicle = rigid_vehicle(mass, LinearAerodynamics(nine))
    assert vehicle.inertia[0, 2] == vehicle.inertia[2, 0] == -Ixz
    reference, rng = nine.reference_state(), np.random.default_rng(11)
    assert state_rates(reference, np.zeros(len(nine.inputs)), nine)[3:6] == pytest.approx(np.zeros(3), abs=1e-15)
    for _ in range(40):
        moments = dict(zip(("moment_x", "moment_y", "moment_z"), rng.normal(scale=1e4, size=3), strict=True))
        given = np.array([moments.get(name, 0.0) for name in nine.inputs])
        values = reference + rng.uniform(-1, 1, 9) * [20.0, 0.2, 0.0, 0.6, 0.6, 0.6, 0.05, 0.05, 1.0]
        twelve = np.array([*values[:2], 0.4, values[2], 0.1, 0.2, *values[3:]])
        full = trajectory_rates(0.0, twelve, vehicle, EARTH_SPHERE, moments, us1976)[NINE]
        ours = state_rates(values, given, nine)
        assert ours[3:6] == pytest.approx(full[3:6], rel=1e-11, abs=1e-13)


def test_products_given_apart_win():
    assert rigid_vehicle(horus.TILTED, products=(0.0, 5.0, 0.0)).inertia[0, 2] == -5.0
    assert np.array_equal(rigid_vehicle(horus.MASS).inertia, np.diag([119_000.0, 769_000.0, 806_000.0]))


# At the door


def test_bad_vehicles_and_states():
    with pytest.raises(InputError, match="symmetric"):
        Vehicle(1.0, [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]])
    with pytest.raises(InputError, match="rigid body"):
        rigid_vehicle(MassProperties(1.0, 1.0, 1.0, 1.0), products=(0.9, 0.9, 0.9))
    with pytest.raises(InputError, match="mass"):
        Vehicle(0.0, np.eye(3))
    with pytest.raises(InputError, match="missing"):
        from_trajectory({"V": 100.0})
    with pytest.raises(InputError, match="gamma"):
        from_trajectory({"V": 100.0, "gamm": 0.1})
    with pytest.raises(InputError, match="lat_deg"):
        from_trajectory({"V": 100.0, "gamma": 0, "R": 7e6, "alpha": 0, "sigma": 0, "lat": 2.0})
    with pytest.raises(InputError, match="rates"):
        FlightState([7e6, 0, 0], [0, 0, 0], [1, 0, 0, 0], [0, math.nan, 0])


def test_linear_aerodynamics_refuse_to_extrapolate():
    aero = LinearAerodynamics(model())
    assert aero.coefficients(2.5, math.radians(16.6))["CL"] == pytest.approx(0.36, abs=0.01)
    for values, name in (((3.2, 0.29), "mach"), ((2.5, 0.6), "alpha"), ((2.5, 0.29, 0.3), "beta")):
        with pytest.raises(InputError, match=name):
            aero.coefficients(*values)
    with pytest.raises(InputError, match="elevator"):
        aero.coefficients(2.5, 0.29, deflections={"elevater": 0.1})
