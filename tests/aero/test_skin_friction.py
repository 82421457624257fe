import math
from dataclasses import replace

import numpy as np
import pytest

from spaceplane.aero.increments.add import integrate_with
from spaceplane.aero.increments.edge import along_wall, edge_of
from spaceplane.aero.increments.friction_laws import LAMINAR, TURBULENT, local_friction
from spaceplane.aero.increments.settings import Air, IncrementSettings
from spaceplane.aero.increments.skin_friction import friction_forces
from spaceplane.environment.atmosphere import us1976
from spaceplane.errors import InputError

from . import walls

REYNOLDS, TEMPERATURE = 1e7, 220.0


def air(mach, reynolds=REYNOLDS, temperature=TEMPERATURE):
    return Air.at_reynolds(reynolds, mach, temperature)


def plate_drag(kind, mach, count, reynolds=REYNOLDS, **more):
    """Mean friction coefficient of one side of a plate of 1 m along the stream."""
    mesh = walls.plate(shape=(count, 2))
    solution = walls.flow_on(mesh, np.tile([1.0, 0.0, 0.0], (mesh.cells, 1)), mach)
    force = friction_forces(solution, 0, IncrementSettings(friction=kind, **more), air(mach, reynolds))
    return force[:, 0].sum() / (0.5 * mach**2 * np.linalg.norm(mesh.wall_area, axis=1).sum())


@pytest.mark.parametrize("mach", [0.1, 2.0, 5.0])
@pytest.mark.parametrize(("kind", "law"), [("laminar", LAMINAR), ("turbulent", TURBULENT)])
def test_plate_has_the_friction_of_the_law(kind, law, mach):
    """C_F = c_f(L) / (1 - m), Blasius' 1.328 / sqrt(Re) times the reference-temperature factor where laminar.

    The midpoint rule on the singular leading edge leaves an error of order h^(1-m).
    """
    exact = local_friction(law, np.array([REYNOLDS]), np.array([mach]), np.array([TEMPERATURE]), None)[0]
    exact /= 1.0 - law.exponent
    coarse, fine = (abs(plate_drag(kind, mach, count) / exact - 1.0) for count in (100, 400))
    assert fine < 0.02
    assert 1.5 < coarse / fine < 4.0


def test_laminar_plate_at_rest_is_blasius():
    assert plate_drag("laminar", 0.05, 800) == pytest.approx(1.328 / math.sqrt(REYNOLDS), rel=0.013)


def test_laminar_cone_has_mangler_s_root_three():
    """Local friction on a cone over that of a plate at the same edge state and slant length."""
    mesh = walls.cone(math.radians(10.0), (80, 48))
    slant = np.linalg.norm(mesh.wall_center, axis=1)
    solution = walls.flow_on(mesh, mesh.wall_center, 2.0)
    size = np.linalg.norm(mesh.wall_area, axis=1)
    for kind, law, factor in (("laminar", LAMINAR, math.sqrt(3.0)), ("turbulent", TURBULENT, 2.161**0.139)):
        force = friction_forces(solution, 0, IncrementSettings(friction=kind), air(2.0))
        found = np.linalg.norm(force, axis=1) / size / 2.0
        args = np.full_like(slant, 2.0), np.full_like(slant, TEMPERATURE)
        flat = local_friction(law, REYNOLDS * slant, *args, None)
        np.testing.assert_allclose((found / flat)[slant > 0.3], factor, rtol=0.02)


def test_edge_state_is_isentropic_from_the_cell_with_the_free_stream_s_enthalpy():
    """Wall pressure 2 at Mach 2: NACA 1135 gives M_e from p_t / p = 7.8244 / 2."""
    mesh = walls.plate(shape=(4, 2))
    edge = edge_of(walls.flow_on(mesh, np.tile([1.0, 0.0, 0.0], (8, 1)), 2.0, pressure=2.0), 0)
    mach = math.sqrt(5.0 * ((7.82444926 / 2.0) ** (2.0 / 7.0) - 1.0))
    np.testing.assert_allclose(edge.speed / np.sqrt(edge.temperature), mach, rtol=1e-6)
    np.testing.assert_allclose(edge.temperature + 0.2 * edge.speed**2, 1.8)
    np.testing.assert_allclose(edge.density, 2.0 ** (1.0 / 1.4))


def test_entropy_slows_the_edge_and_is_never_below_the_free_stream_s():
    mesh = walls.plate(shape=(4, 2))
    solution = walls.flow_on(mesh, np.tile([1.0, 0.0, 0.0], (8, 1)), 2.0)
    speeds = []
    for factor in (1.1, 1.0, 0.8, 1e-3):
        state = solution.state.copy()
        state[:, 0] *= factor
        speeds.append(edge_of(replace(solution, state=state), 0).speed[0])
    assert speeds[0] == pytest.approx(speeds[1])
    assert speeds[1] == pytest.approx(2.0)
    assert 0.0 < speeds[2] < 2.0
    assert speeds[3] == pytest.approx(0.0)


def test_force_lies_in_the_wall_along_the_flow():
    mesh = walls.cone(math.radians(20.0), (10, 12))
    velocity = np.tile([1.0, 0.2, 0.1], (mesh.cells, 1))
    force = friction_forces(walls.flow_on(mesh, velocity, 2.0), 0, IncrementSettings(friction="turbulent"), air(2.0))
    assert np.abs((force * mesh.wall_area).sum(axis=1)).max() < 1e-12 * np.abs(force).max()
    assert ((force * velocity).sum(axis=1) > 0.0).all()


def test_nothing_moves_where_no_direction_is_known():
    area = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, -1.0], [0.0, 0.0, 0.0]])
    velocity = np.array([[0.0, 0.0, 3.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    assert along_wall(velocity, area)[:2] == pytest.approx(0.0)
    assert along_wall(velocity, area)[2] == pytest.approx(0.0)


def test_friction_vanishes_as_the_reynolds_number_grows():
    drags = [plate_drag("turbulent", 2.0, 50, reynolds=10.0**n) for n in (6, 8, 16)]
    assert drags[0] / drags[1] == pytest.approx(100.0**0.139, rel=1e-6)
    assert drags[2] < 0.05 * drags[0]


def test_transition_lies_between_laminar_and_turbulent():
    laminar, turbulent = (plate_drag(kind, 2.0, 100) for kind in ("laminar", "turbulent"))
    early, late = (plate_drag("turbulent", 2.0, 100, transition_reynolds=re) for re in (2e6, 8e6))
    assert laminar < late < early < turbulent
    assert plate_drag("turbulent", 2.0, 100, transition_reynolds=1e9) == pytest.approx(laminar)
    assert plate_drag("turbulent", 2.0, 100, transition_reynolds=1.0) == pytest.approx(turbulent)


def test_a_cold_wall_drags_more():
    assert plate_drag("turbulent", 3.0, 50, wall_temperature_K=300.0) > 1.05 * plate_drag("turbulent", 3.0, 50)


def test_a_radiating_wall_lies_between_cold_and_adiabatic():
    """The denser the air the more heat it brings, and the closer the wall comes to the adiabatic temperature."""
    shares = []
    for reynolds in (1e5, 1e6, 1e7):
        cold, adiabatic, radiating = (
            plate_drag("turbulent", 8.0, 20, reynolds, **more)
            for more in ({"wall_temperature_K": 220.0}, {}, {"emissivity": 0.8})
        )
        shares.append((cold - radiating) / (cold - adiabatic))
    assert 0.0 < shares[0] < shares[1] < shares[2] < 1.0


def test_mirrored_flow_gives_the_mirrored_force(make_lengths):
    """Port and starboard of a cone in sideslip: CY, Cl, Cn reverse, the rest stays."""
    mesh = walls.cone(math.radians(15.0), (20, 24))
    settings = IncrementSettings(friction="turbulent")
    velocity = np.array([1.0, -0.3, 0.15])
    found = []
    for sign in (1.0, -1.0):
        flow = np.tile(velocity * [1.0, sign, 1.0], (mesh.cells, 1)) + 0.5 * mesh.wall_center
        solution = walls.flow_on(mesh, flow, 2.0, alpha=0.15, beta=0.3 * sign)
        data = integrate_with(solution, make_lengths(), settings, air(2.0)).sel(part="total", source="friction")
        found.append({name: float(data[f"{name}_by_source"][0]) for name in ("CL", "CD", "CY", "Cl", "Cm", "Cn")})
    for name, value in found[0].items():
        other = -found[1][name] if name in ("CY", "Cl", "Cn") else found[1][name]
        assert other == pytest.approx(value, rel=1e-9, abs=1e-12)
    assert found[0]["CD"] > 0.0
    assert abs(found[0]["CY"]) > 1e-6


def test_air_of_an_atmosphere_and_of_a_reynolds_number_agree():
    ambient = us1976(25_000.0)
    one = Air.of([ambient, ambient])
    unit = 2.5 * ambient.speed_of_sound * ambient.density / ambient.viscosity
    other = Air.at_reynolds(unit, [2.5, 2.5], ambient.temperature)
    np.testing.assert_allclose(one.sonic_reynolds, other.sonic_reynolds)
    np.testing.assert_allclose(one.temperature, other.temperature)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"friction": "on"}, "friction = 'on': allowed are off, laminar, turbulent"),
        ({"base": "vacuum"}, "base = 'vacuum': allowed are inviscid, correlation"),
        ({"friction": "laminar", "wall_temperature_K": 0.0}, "wall_temperature_K = 0"),
        ({"friction": "laminar", "wall_temperature_K": math.nan}, "wall_temperature_K = nan"),
        ({"friction": "turbulent", "transition_reynolds": -1.0}, "transition_reynolds = -1"),
        ({"friction": "laminar", "emissivity": 0.0}, "emissivity = 0"),
        ({"friction": "laminar", "emissivity": math.nan}, "emissivity = nan"),
        ({"emissivity": 0.8}, "emissivity = 0.8: needs friction"),
        ({"friction": "laminar", "emissivity": 0.8, "wall_temperature_K": 300.0}, "not both"),
        ({"wall_temperature_K": 300.0}, "wall_temperature_K = 300: needs friction"),
        ({"friction": "laminar", "transition_reynolds": 1e6}, "transition_reynolds = 1e.06: needs friction turbulent"),
    ],
)
def test_bad_settings_are_named(values, message):
    with pytest.raises(InputError, match=message):
        IncrementSettings(**values)


def test_bad_air_is_named(make_lengths):
    solution = walls.flow_on(walls.plate(shape=(4, 2)), np.ones((8, 3)), 2.0)
    settings = IncrementSettings(friction="laminar")
    with pytest.raises(InputError, match="needs the air"):
        integrate_with(solution, make_lengths(), settings)
    with pytest.raises(InputError, match="2 conditions for 1"):
        integrate_with(solution, make_lengths(), settings, air([2.0, 2.0]))
    for name, bad in (
        ("reynolds", (0.0, 2.0, 220.0)),
        ("mach", (1e6, -1.0, 220.0)),
        ("temperature_K", (1e6, 2.0, math.inf)),
    ):
        with pytest.raises(InputError, match=name):
            Air.at_reynolds(*bad)
