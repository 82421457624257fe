"""JSBSim flies the deck as this package flies the model: accelerations, limits, and the short period."""

import math
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import logm
from scipy.optimize import brentq

from spaceplane.aero.model.published import horus_2b_published
from spaceplane.decks.jsbsim import INSIDE, deflection_property, write, xml
from spaceplane.dynamics.flightpoint import flight_point
from spaceplane.dynamics.frames import body_to_wind
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import identify
from spaceplane.dynamics.motion.vehicle import angular_acceleration, rigid_vehicle
from spaceplane.environment import constants
from spaceplane.environment.atmosphere import us1976
from spaceplane.errors import InputError
from spaceplane.vehicle.properties import HORUS_MASS

from . import fly
from .horus import complete

INERTIA = np.array([HORUS_MASS.Ixx, HORUS_MASS.Iyy, HORUS_MASS.Izz])
CENTER = (12.7, 0.0, 0.15)


@pytest.fixture(scope="module")
def model():
    return complete()


@pytest.fixture(scope="module")
def fdm(model, tmp_path_factory):
    folder = tmp_path_factory.mktemp("deck")
    write(model, HORUS_MASS, folder, "horus", CENTER)
    return fly.load(folder, "horus")


def wind_of(speed, alpha, beta):
    """Body components of a velocity."""
    return speed * np.array([math.cos(alpha) * math.cos(beta), math.sin(beta), math.sin(alpha) * math.cos(beta)])


def accelerations(model, altitude, mach, alpha, beta, rates, attitude, deflections, mass=HORUS_MASS):
    """(specific aerodynamic force, acceleration, angular acceleration) by Newton and Euler, body axes."""
    air, r = us1976(altitude), model.reference
    speed = mach * air.speed_of_sound
    length = np.array([r.span, r.chord, r.span])
    C = model.coefficients(mach, alpha, beta, tuple(np.array(rates) * length / (2 * speed)), deflections)
    pressure = 0.5 * air.density * speed**2 * r.area
    force = body_to_wind(alpha, beta).T @ np.array([-C["CD"], C["CY"], -C["CL"]]) * pressure / mass.mass
    moment = pressure * length * np.array([C["Cl"], C["Cm"], C["Cn"]])
    bank, pitch, _ = attitude
    down = np.array([-math.sin(pitch), math.sin(bank) * math.cos(pitch), math.cos(bank) * math.cos(pitch)])
    weight = constants.gravity(constants.EARTH_RADIUS + altitude) * down
    return (
        force,
        force + weight - np.cross(rates, wind_of(speed, alpha, beta)),
        angular_acceleration(rigid_vehicle(mass), np.array(rates), moment),
    )


def random_states(model, number):
    random = np.random.default_rng(4)
    for _ in range(number):
        yield {
            "altitude": random.uniform(18_000.0, 60_000.0),
            "mach": random.uniform(*model.mach[[0, -1]]),
            "alpha": random.uniform(*model.alpha[[0, -1]]),
            "beta": random.uniform(-1.0, 1.0) * model.beta_limit,
            "rates": random.uniform(-0.3, 0.3, 3),
            "attitude": (random.uniform(-3.0, 3.0), random.uniform(-1.2, 1.2), random.uniform(0.0, 6.0)),
            "deflections": {name: random.uniform(*surface.limits) for name, surface in model.surfaces.items()},
        }


def put(fdm, state):
    speed = state["mach"] * us1976(state["altitude"]).speed_of_sound
    velocity = wind_of(speed, state["alpha"], state["beta"])
    fly.place(fdm, state["altitude"], velocity, state["rates"], state["attitude"], state["deflections"])


def off(found, expected):
    """Greatest relative difference of a component."""
    return np.max(np.abs(found - expected) / np.abs(expected))


def test_accelerations_at_random_states(model, fdm):
    moved = model.moved(CENTER)
    for state in random_states(model, 50):
        put(fdm, state)
        force, acceleration, turning = accelerations(moved, **state)
        assert off(fly.force(fdm) / fly.mass(fdm), force) < 0.005, state
        assert off(fly.acceleration(fdm), acceleration) < 0.005, state
        assert off(fly.angular_acceleration(fdm), turning) < 0.005, state
        assert fdm[INSIDE] == 1.0


@pytest.mark.parametrize("Ixz", [-40e3, 60e3])
def test_product_of_inertia_has_our_sign(model, tmp_path, Ixz):
    mass = replace(HORUS_MASS, Ixz=Ixz)
    write(model, mass, tmp_path, "tilted", CENTER)
    fdm, moved = fly.load(tmp_path, "tilted"), model.moved(CENTER)
    for state in random_states(model, 20):
        put(fdm, state)
        turning = accelerations(moved, **state, mass=mass)[2]
        plain = accelerations(moved, **state)[2]
        assert off(fly.angular_acceleration(fdm), turning) < 0.005, state
        assert off(plain, turning) > 0.01, state


def test_coefficients_are_ours(model, fdm):
    """Tighter than the accelerations, which hold JSBSim's atmosphere and its rounded units as well."""
    moved = model.moved(CENTER)
    for state in random_states(model, 10):
        put(fdm, state)
        mach, alpha, beta = (fdm[name] for name in ("velocities/mach", "aero/alpha-rad", "aero/beta-rad"))
        reduced = [
            fdm[f"velocities/{rate}-aero-rad_sec"] * fdm[f"aero/{length}"]
            for rate, length in zip("pqr", ("bi2vel", "ci2vel", "bi2vel"), strict=True)
        ]
        expected = moved.coefficients(mach, alpha, beta, tuple(reduced), state["deflections"])
        for name, value in expected.items():
            assert fdm[f"aero/coefficient/{name}"] == pytest.approx(value, rel=1e-8, abs=1e-10), (name, state)


def test_mass_and_references(model, fdm):
    put(fdm, next(random_states(model, 1)))
    assert fly.mass(fdm) == pytest.approx(HORUS_MASS.mass, rel=1e-6)
    slug_ft2 = fly.slug * fly.foot**2
    inertia = fly.vector(fdm, [f"inertia/{name}-slugs_ft2" for name in ("ixx", "iyy", "izz")], slug_ft2)
    assert inertia == pytest.approx(INERTIA, rel=2e-4)  # JSBSim's own kg m2 in slug ft2 has five digits
    assert fdm["metrics/Sw-sqft"] * fly.foot**2 == pytest.approx(110.0, rel=1e-7)
    assert fdm["inertia/cg-x-in"] * fly.foot / 12 == pytest.approx(CENTER[0], rel=1e-7)
    assert fdm["metrics/aero-rp-x-in"] == pytest.approx(fdm["inertia/cg-x-in"], rel=1e-12)


def test_outside_tables_is_told_and_held_at_the_edge(model, fdm):
    """What the deck states of JSBSim: no word outside a table but `aero/inside-tables`."""
    state = next(random_states(model, 1)) | {"beta": 0.0, "rates": np.zeros(3), "deflections": {}}
    neutral = dict.fromkeys(model.surfaces, 0.0)
    edge = float(model.alpha[-1])
    found = {}
    for alpha in (edge, edge + 0.1):
        put(fdm, state | {"alpha": alpha, "deflections": neutral})
        found[alpha] = fdm["aero/coefficient/CD"], fdm[INSIDE]
    assert found[edge][1] == 1.0 and found[edge + 0.1][1] == 0.0
    assert found[edge][0] == pytest.approx(found[edge + 0.1][0], rel=1e-9)
    for change in ({"mach": 1.4}, {"mach": 21.0}, {"alpha": -0.01}, {"beta": 0.18}, {"beta": -0.18}):
        put(fdm, state | {"deflections": neutral} | change)
        assert fdm[INSIDE] == 0.0, change
    for name, surface in model.surfaces.items():
        for limit, step in zip(surface.limits, (-0.01, 0.01), strict=True):
            for beyond in (0.0, step):
                put(fdm, state | {"deflections": neutral | {name: limit + beyond}})
                assert fdm[INSIDE] == (1.0 if beyond == 0.0 else 0.0), (name, limit, beyond)


def longitudinal(fdm):
    """V m/s, gamma rad, altitude m, q rad/s, alpha rad."""
    return np.array(
        [
            fdm["velocities/vt-fps"] * fly.foot,
            fdm["flight-path/gamma-rad"],
            fdm["position/h-sl-ft"] * fly.foot,
            fdm["velocities/qi-rad_sec"],
            fdm["aero/alpha-rad"],
        ]
    )


def history(fdm, start, deflections, seconds, step):
    """[time, 5] of a wings-level flight from (V, gamma, altitude, q, alpha), held controls."""
    speed, gamma, altitude, q, alpha = start
    fdm.set_dt(step)
    fly.place(fdm, altitude, wind_of(speed, alpha, 0.0), (0.0, q, 0.0), (0.0, alpha + gamma, 0.0), deflections)
    states = [longitudinal(fdm)]
    for _ in range(round(seconds / step)):
        fdm.run()
        states.append(longitudinal(fdm))
    return np.array(states)


def test_short_period_from_time_histories(tmp_path):
    """Six histories of 1 s, one undisturbed and one with each state disturbed, give the transition matrix of that
    second; its logarithm has the roots of the flight in its middle. A single history fitted by damped oscillations
    would not do: meanwhile the glider slows down, 0.7 % every second, which changes a fitted damping by 6 %."""
    model = replace(horus_2b_published(), slopes={name: np.full((10, 5), x) for name, x in SLOPES.items()})
    model = model.moved((12.2, 0.0, 0.0))
    mach, alpha, flap = 2.5, math.radians(12.5), math.radians(-20.0)

    def with_elevator(angle):
        return {"elevon_left": angle, "elevon_right": angle, "body_flap": flap}

    elevator = brentq(
        lambda x: model.coefficients(mach, alpha, deflections=with_elevator(x))["Cm"], math.radians(-40), 0.0
    )
    deflections = with_elevator(elevator)

    def at(altitude, mach, alpha, gamma=0.0):
        C = model.coefficients(mach, alpha, deflections=deflections)
        return flight_point(mach, altitude, math.degrees(alpha), math.degrees(gamma), CL=C["CL"], CD=C["CD"])

    def climb(altitude):
        p = at(altitude, mach, alpha)
        lift = p.dynamic_pressure * model.reference.area * p.coefficients()[0] / HORUS_MASS.mass
        return lift - p.gravity + p.velocity**2 / p.radius

    point = at(brentq(climb, 15_000.0, 40_000.0), mach, alpha)
    write(model, HORUS_MASS, tmp_path, "glider")
    fdm = fly.load(tmp_path, "glider")
    # dalpha/dt = q - dgamma/dt in the turning local axes: the pitch rate of level flight round the Earth.
    start = np.array([point.velocity, 0.0, point.altitude, -point.velocity / point.radius, alpha])
    seconds, step = 1.0, 1.0 / 400.0
    size = np.array([0.1, 1e-4, 10.0, 1e-4, 1e-4])
    steady = history(fdm, start, deflections, seconds, step)
    runs = [history(fdm, start + size * one, deflections, seconds, step) for one in np.eye(5)]
    first, last = (np.array([run[k] - steady[k] for run in runs]).T for k in (0, -1))
    roots = np.linalg.eigvals(logm(last @ np.linalg.inv(first)) / seconds)

    speed, gamma, altitude, _, alpha = steady[len(steady) // 2]
    middle = at(altitude, speed / us1976(altitude).speed_of_sound, alpha, gamma)
    slopes = model.derivatives(middle.mach, alpha, deflections)
    modes = identify(linearise(middle, HORUS_MASS, model.reference, slopes))
    (short_period,) = [mode.eigenvalue for mode in modes if mode.name == "short period"]
    assert short_period.real < -0.3 and short_period.imag > 0.5
    found = roots[np.argmax(roots.imag)]
    assert abs(found - short_period) < 0.005 * abs(short_period)


SLOPES = {"CL_q": 0.9, "Cm_q": -1.8}


def test_header_states_what_a_reader_needs(model):
    root = ET.fromstring(xml(model, HORUS_MASS, "horus").split("?>", 1)[1])
    note = " ".join(root.find("fileheader/note").text.split())
    for text in (
        model.source,
        "wind axes",
        "body axes (x forward, y right, z down)",
        "positive nose up",
        "rad",
        "reference area 110 m2",
        "13 m behind the nose",
        "mach 1.5 to 20",
        "alpha 0 to 45 deg",
        "beta -10 to 10 deg",
        "body_flap -20 to 30 deg",
        "rudder_left positive trailing edge outboard",
        "CY_elevon_left",
        INSIDE,
    ):
        assert text in note, text


def test_empty_cells_are_cut_off_and_told(model):
    table = model.base["CL"].copy()
    table[-1, 0] = np.nan  # alpha 45 deg at Mach 1.5: 9 x 5 nodes without the angle beat 10 x 4 without the Mach number
    text = xml(replace(model, base={**model.base, "CL": table}), HORUS_MASS, "horus")
    assert "alpha 0 to 40 deg" in text and "left out" in text and "nan" not in text.split("</fileheader>")[1]
    assert "left out" not in xml(model, HORUS_MASS, "horus")


@pytest.mark.parametrize("name", ["", "a b", "../up", "x.xml"])
def test_bad_name_is_refused(model, name, tmp_path):
    with pytest.raises(InputError, match="name = "):
        write(model, HORUS_MASS, tmp_path, name)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("center", [(13.0, 0.0), (13.0, 0.0, math.nan), (13.0, 0.5, 0.0)])
def test_bad_center_of_mass_is_refused(model, center, tmp_path):
    with pytest.raises(InputError, match=r"moment.center|center_of_mass|moment centre"):
        write(model, HORUS_MASS, tmp_path, "horus", center)


def test_surfaces_are_properties(model):
    text = xml(model, HORUS_MASS)
    assert all(f">{deflection_property(name)}</property>" in text for name in model.surfaces)
    assert 'name="HORUS-2B-completed"' in text
