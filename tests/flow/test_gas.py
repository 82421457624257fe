"""Equilibrium air in the solver: invariants, and shocks against the exact jump of the same air."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from spaceplane.environment.air_table import air_table
from spaceplane.environment.equilibrium_air import GAS_CONSTANT, behind_normal_shock, equilibrium
from spaceplane.errors import InputError
from spaceplane.flow import implicit, jacobian
from spaceplane.flow.compiled import LANES
from spaceplane.flow.diagnostics import diagnose
from spaceplane.flow.ensemble import Ensemble
from spaceplane.flow.equilibrium import heat, speed_of_sound
from spaceplane.flow.fluxes import blend
from spaceplane.flow.settings import FlowSettings, check
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.flow.topology import prepare

from .structured import box, from_blocks, sphere

STATE = np.array([1.3, 0.4, -0.7, 0.2, 0.9])
NORMAL = np.array([0.6, -0.48, 0.64])
COLD, THIN = 245.0, 3e-4


def in_air(mach, temperature=COLD, density=THIN, alpha_deg=None, beta_deg=None, gas="equilibrium"):
    """Free streams in equilibrium air, or the same in the perfect gas."""
    mach = np.array(mach, dtype=float)
    angles = [np.zeros(len(mach)) if deg is None else np.radians(deg) for deg in (alpha_deg, beta_deg)]
    streams = FlowConditions(mach, *angles)
    if gas == "perfect":
        return streams
    pressure = density * GAS_CONSTANT * temperature
    return replace(streams, gas=gas, density=np.full(len(mach), density), pressure=np.full(len(mach), pressure))


def force(solution):
    """[condition, xyz] pressure force over free-stream dynamic pressure."""
    return solution.wall_cp().T.astype(float) @ solution.mesh.wall_area


# A gas with B = h rho / p that varies with both: B = 3.5 + 0.4 ln(rho) + 0.9 ln(p) + 1.
def factor(r, p):
    return 4.5 + 0.4 * math.log(r) + 0.9 * math.log(p)


def heat_at(r, p):
    b = factor(r, p)
    return b / (b - 1), b + 0.9, 1 / (b + 0.9 - 1), 0.4 * p / r


def conserved(q):
    energy = (factor(q[0], q[4]) - 1) * q[4] + 0.5 * q[0] * q[1:4] @ q[1:4]
    return np.array([q[0], *(q[0] * q[1:4]), energy])


def physical(q, n):
    un = q[1:4] @ n
    return np.array([q[0] * un, *(q[0] * un * q[1:4] + q[4] * n), un * (conserved(q)[4] + q[4])])


def differences(function, q, step=1e-6):
    return np.stack([(function(q + step * e) - function(q - step * e)) / (2 * step) for e in np.eye(5)], axis=1)


def columns(function):
    return np.stack([np.array(function(*e)) for e in np.eye(5)], axis=1)


def test_jacobian_of_any_gas_is_the_derivative_of_its_flux():
    heats = heat_at(STATE[0], STATE[4])
    analytic = columns(lambda *d: jacobian.flux_increment.py_func(*STATE, *d, *NORMAL, heats))
    np.testing.assert_allclose(analytic, differences(lambda q: physical(q, NORMAL), STATE), atol=1e-8)
    block = np.zeros((25, LANES))
    implicit.add_flux.py_func(block.reshape(-1), 2, 1.0, *STATE, *NORMAL, heats)
    np.testing.assert_allclose(block[:, 2].reshape(5, 5), analytic, atol=1e-12)
    block[:] = 0.0
    implicit.add_mass.py_func(block.reshape(-1), 2, 1.0, *STATE[:4], heats)
    np.testing.assert_allclose(block[:, 2].reshape(5, 5), differences(conserved, STATE), atol=1e-8)


def test_dissipation_of_any_gas_carries_its_enthalpy():
    r, u, v, w, p = STATE
    heats = heat_at(r, p)
    a, un = math.sqrt(heats[0] * p / r), STATE[1:4] @ NORMAL
    waves = jacobian.wave_dissipation.py_func(un, a, 0.3)
    analytic = columns(lambda *d: jacobian.dissipation_increment.py_func(r, u, v, w, a, *waves, *d, *NORMAL, heats))
    total = lambda q: np.array([factor(q[0], q[4]) * q[4] / q[0] + 0.5 * q[1:4] @ q[1:4]])  # noqa: E731
    expected = total(STATE)[0] * analytic[0] + waves[0] * r * differences(total, STATE)[0]
    np.testing.assert_allclose(analytic[4], expected, atol=1e-8)
    block = np.zeros((25, LANES))
    implicit.add_dissipation.py_func(block.reshape(-1), 5, 1.0, r, u, v, w, a, *waves, *NORMAL, heats)
    np.testing.assert_allclose(block[:, 5].reshape(5, 5), analytic, atol=1e-12)


@pytest.mark.parametrize("theta", [0.0, 0.4, 1.0])
def test_flux_of_equal_states_is_the_physical_flux(theta):
    ratio = heat_at(STATE[0], STATE[4])[0]
    flux = blend.py_func(*STATE, *STATE, *NORMAL, ratio, ratio, 0.0, theta)
    np.testing.assert_allclose(flux, physical(STATE, NORMAL), rtol=1e-12, atol=1e-12)


def test_free_stream_is_preserved():
    mesh = box(4, 0.2)
    streams = check(in_air([0.5, 5.0, 20.0], alpha_deg=[10.0, 20.0, 40.0], beta_deg=[5.0, 0.0, 3.0]))
    ensemble = Ensemble(mesh, prepare(mesh, np.float32), streams, FlowSettings(), 2)
    ensemble.evaluate()
    size = np.linalg.norm(mesh.face_area, axis=1).max() * np.array([1.0, 20.0, 20.0, 20.0, 400.0])[:, None] * 20.0
    assert np.abs(ensemble.residual / size).max() < 5e-7


def test_cold_flow_is_the_perfect_gas():
    """At 100 K and Mach 3 the stagnation point has 280 K: nothing is excited."""
    settings = FlowSettings(coarse_levels=1, residual_drop=3.5, least_drop=3.0)
    mesh = sphere(16, 8, far=6.0)
    air, ideal = (
        solve(mesh, in_air([3.0], 100.0, alpha_deg=[10.0], gas=g), settings) for g in ("equilibrium", "perfect")
    )
    assert air.records[0].good and ideal.records[0].good
    np.testing.assert_allclose(force(air), force(ideal), rtol=2e-4, atol=2e-4)


@pytest.fixture(scope="module")
def hot_sphere():
    """Mach 10 and 20 past a sphere, upright and with the wind from either side.

    Four decades: after three the wake at Mach 20 still moves, and how far it got depends on the processor's rounding
    (0.018 to 0.021 of the enthalpy's error; after four 0.0185 to 0.0188).
    """
    streams = in_air([10.0, 20.0, 10.0, 10.0], alpha_deg=[0.0, 0.0, 0.0, 0.0], beta_deg=[0.0, 0.0, 12.0, -12.0])
    deep = FlowSettings(coarse_levels=1, residual_drop=4.0, least_drop=3.0, iterations=300)
    return solve(sphere(24, 8, far=3.0), streams, deep)


def test_hot_sphere_is_steady_with_constant_total_enthalpy(hot_sphere):
    assert all(record.good for record in hot_sphere.records[:2])
    assert (diagnose(hot_sphere).enthalpy_error < 0.02).all()


def test_mirror_symmetry(hot_sphere):
    straight, right, left = (force(hot_sphere)[k] for k in (0, 2, 3))
    assert abs(straight[1]) < 1e-4 and right[1] < -0.1
    np.testing.assert_allclose(right * [1, -1, 1], left, rtol=2e-3, atol=2e-3)


def wedge(angle, cells=32):
    """A ramp of this angle, rad, from the origin on, and a layer of air of one height above it."""
    x = np.linspace(-0.125, 1.0, 9 * cells // 8 + 1)
    share = np.linspace(0.0, 1.0, cells + 1)
    foot = np.maximum(x, 0.0) * math.tan(angle)
    points = np.zeros((len(x), cells + 1, 2, 3))
    points[..., 0] = x[:, None, None]
    # Geometry axes are right-handed with z up; the flow is in the plane y = constant.
    points[..., 2] = (foot[:, None] + 0.4 * share)[:, :, None]
    points[..., 1] = np.array([0.05, 0.0])
    sides = lambda c: (c[:, 1] < 1e-6) | (c[:, 1] > 0.05 - 1e-6)  # noqa: E731
    below = lambda c: c[:, 2] < np.maximum(c[:, 0], 0.0) * math.tan(angle) + 1e-6  # noqa: E731
    return from_blocks([points], lambda c: sides(c) | below(c))


def oblique(mach, angle):
    """(shock angle, state behind it) of equilibrium air turned by `angle`, rad."""
    pressure = THIN * GAS_CONSTANT * COLD
    speed = mach * math.sqrt(1.4 * GAS_CONSTANT * COLD)

    def turned(shock):
        behind = behind_normal_shock(pressure, COLD, speed * math.sin(shock))
        return shock - math.atan(math.tan(shock) * THIN / behind.density), behind

    shock = brentq(lambda s: turned(s)[0] - angle, angle + 0.02, angle + 0.25)
    return shock, turned(shock)[1]


@pytest.mark.parametrize("mach", [8.0, 20.0])
def test_oblique_shock_is_the_exact_jump_of_equilibrium_air(mach):
    angle = math.radians(35.0)
    mesh, streams = wedge(angle), in_air([mach])
    # First order: with slopes, cells that the shock grazes flicker for ever on this mesh, in the perfect gas too.
    solution = solve(mesh, streams, FlowSettings(coarse_levels=1, order=1))
    assert solution.records[0].verdict == "converged" and solution.records[0].residual_drop > 3.0
    shock, behind = oblique(mach, angle)
    x, z = mesh.cell_center[:, 0], mesh.cell_center[:, 2]
    slope = z / np.maximum(x, 1e-9)
    layer = (x > 0.5) & (x < 0.95) & (slope > math.tan(angle + 0.2 * (shock - angle)))
    layer &= slope < math.tan(angle + 0.7 * (shock - angle))
    assert layer.sum() > 10
    density, pressure = (solution.state[layer, k, 0].astype(float) for k in (0, 4))
    assert density.mean() == pytest.approx(behind.density / THIN, rel=0.005)
    assert pressure.mean() * 1.4 == pytest.approx(behind.pressure / (THIN * GAS_CONSTANT * COLD), rel=0.005)
    warm = heat(solution.conditions, 0, density, pressure)["temperature"]
    assert warm.mean() == pytest.approx(behind.temperature, rel=0.005)


def test_speed_of_sound_is_that_of_small_isentropic_changes():
    streams = check(in_air([10.0]))
    for temperature, pressure in ((300.0, 1e3), (2500.0, 1e3), (6000.0, 1e4)):
        low = equilibrium(temperature, pressure)
        p = pressure * 1.001
        high = equilibrium(
            brentq(lambda T, p=p, s=low.entropy: equilibrium(T, p).entropy - s, 0.9 * temperature, 7e3), p
        )
        exact = math.sqrt((high.pressure - low.pressure) / (high.density - low.density))
        unit = math.sqrt(1.4 * GAS_CONSTANT * COLD)
        scaled = low.density / THIN, low.pressure / (THIN * unit**2)
        assert unit * float(speed_of_sound(streams, 0, *scaled)) == pytest.approx(exact, rel=3e-3)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"density": None}, "altitude"),
        ({"pressure": np.array([-1.0])}, "pressure"),
        ({"pressure": np.array([1.0, 2.0])}, "pressure"),
        ({"density": np.array([1e-9]), "pressure": np.array([7e-5])}, "density"),
        ({"pressure": np.array([700.0])}, "temperature"),
        ({"mach": np.array([30.0])}, "ionises"),
        ({"gamma": 1.3}, "gamma"),
        ({"gas": "equilibirum"}, "did you mean 'equilibrium'"),
    ],
)
def test_air_that_the_model_does_not_hold_for_is_refused(change, words):
    with pytest.raises(InputError, match=words):
        check(replace(in_air([10.0]), **change))


def test_the_table_reaches_beyond_every_stagnation_point_allowed():
    table = air_table()
    assert table.values[:, -1, 3].min() > 12_000.0


def test_stand_off_of_a_sphere_follows_the_density_ratio():
    """Seiff (NASA SP-24, 1962): 0.78 of the density ratio across the shock, on the radius, whatever the gas."""
    mesh = sphere(20, 8, far=1.8)
    solution = solve(mesh, in_air([10.0]), FlowSettings(coarse_levels=1))
    assert solution.records[0].verdict != "failed"
    pressure = THIN * GAS_CONSTANT * COLD
    behind = behind_normal_shock(pressure, COLD, 10.0 * math.sqrt(1.4 * GAS_CONSTANT * COLD))
    center = mesh.cell_center
    line = (center[:, 0] < 0) & (np.hypot(center[:, 1], center[:, 2]) < 0.22 * np.abs(center[:, 0]))
    radius, layer = np.unique(np.round(np.linalg.norm(center[line], axis=1), 6), return_inverse=True)
    ratio = 1.4 * np.bincount(layer, solution.state[line, 4, 0].astype(float)) / np.bincount(layer)
    middle = 0.5 * (1.0 + behind.pressure / pressure)
    last = np.flatnonzero(ratio > middle)[-1]
    found = np.interp(middle, ratio[[last + 1, last]], radius[[last + 1, last]]) - 1.0
    assert found == pytest.approx(0.78 * THIN / behind.density, rel=0.08)
