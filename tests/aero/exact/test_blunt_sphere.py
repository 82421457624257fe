"""The fitted bow shock of a sphere: conservation that nothing imposes, resolution, and theory."""

import itertools
import math

import numpy as np
import pytest

from spaceplane.aero.exact.blunt_sphere import LAST_ANGLE, sphere_flow
from spaceplane.aero.exact.stagnation import stagnation_cp
from spaceplane.errors import InputError
from spaceplane.validation.blunt import standoff_seiff

GAMMA = 1.4


@pytest.fixture(scope="module", params=[1.5, 3.0, 10.0, 25.0])
def flow(request):
    return sphere_flow(request.param)


def state(flow):
    """Pressure over the stagnation pressure, density over the stagnation density [point, angle]."""
    left = 1.0 - (flow.velocity**2).sum(axis=-1)
    density = (left * np.exp(-flow.sigma)) ** (1.0 / (GAMMA - 1.0))
    return left * density, density


def integral(flow, values):
    """Integral over the layer on the last ray, from values [point] that a polynomial goes through."""
    polynomial = np.polynomial.chebyshev.Chebyshev.fit(flow.layer, values, len(flow.layer) - 1)
    area = polynomial.integ()
    return (flow.shock[-1] - 1.0) * (area(1.0) - area(0.0))


def stream(flow):
    """Velocity over sqrt(2 H), pressure over the stagnation pressure and density over the stagnation density, ahead."""
    energy = 1.0 + 0.5 * (GAMMA - 1.0) * flow.mach**2
    pressure = 1.0 / (1.0 + 0.5 * GAMMA * flow.mach**2 * stagnation_cp(flow.mach))
    return math.sqrt(1.0 - 1.0 / energy), pressure, pressure * energy


def test_what_enters_through_the_shock_leaves(flow):
    """Mass: the equations are not in the form of a balance, so this tests the solution as a whole."""
    speed, _, density_ahead = stream(flow)
    _, density = state(flow)
    r = 1.0 + flow.layer * (flow.shock[-1] - 1.0)
    sine = math.sin(LAST_ANGLE)
    entering = math.pi * (flow.shock[-1] * sine) ** 2 * density_ahead * speed
    leaving = integral(flow, 2.0 * math.pi * r * sine * density[:, -1] * flow.velocity[:, -1, 1])
    assert leaving == pytest.approx(entering, rel=3e-5 if flow.mach > 2.0 else 3e-4)


def test_force_on_the_front_is_the_momentum_lost(flow):
    """Axial momentum of the air between shock, last ray and wall; p over rho V^2 at rest is (gamma - 1) / 2 gamma."""
    speed, pressure_ahead, density_ahead = stream(flow)
    pressure, density = state(flow)
    sine, cosine = math.sin(LAST_ANGLE), math.cos(LAST_ANGLE)
    r = 1.0 + flow.layer * (flow.shock[-1] - 1.0)
    share = (GAMMA - 1.0) / (2.0 * GAMMA)
    u, v = flow.velocity[:, -1, 0], flow.velocity[:, -1, 1]
    axial = v * sine - u * cosine
    out = density[:, -1] * v * axial + share * (pressure[:, -1] - pressure_ahead) * sine
    leaving = integral(flow, 2.0 * math.pi * r * sine * out)
    entering = math.pi * (flow.shock[-1] * sine) ** 2 * density_ahead * speed**2
    force = math.pi * flow.front_drag() * 0.5 * GAMMA * flow.mach**2 * pressure_ahead * share
    assert entering - leaving == pytest.approx(force, rel=3e-5 if flow.mach > 2.0 else 3e-4)


def test_entropy_along_the_axis_is_that_behind_the_normal_shock(flow):
    """Only the wall is told; between wall and shock it follows from the equations."""
    fit = np.linalg.lstsq(np.vander(flow.theta**2, 6, increasing=True), flow.sigma.T, rcond=None)[0]
    assert np.abs(fit[0]).max() < (1e-4 if flow.mach > 2.0 else 1e-3)


def test_wall_pressure_at_the_nose_is_the_pitot_pressure(flow):
    assert flow.wall_cp(0.0) == pytest.approx(stagnation_cp(flow.mach), rel=1e-12)
    assert (np.diff(flow.wall_cp(np.linspace(0.0, LAST_ANGLE, 50))) < 0.0).all()


@pytest.mark.parametrize("mach", [2.0, 10.0])
def test_finer_points_change_little_and_less(mach):
    flows = [sphere_flow(mach, points=n, angles=n + 2) for n in (8, 11, 14, 17)]
    off = [abs(flow.standoff / flows[-1].standoff - 1.0) for flow in flows[:-1]]
    assert off[0] < 1e-3 and off[2] < 3e-5
    assert all(fine.misfit < 0.2 * coarse.misfit for coarse, fine in itertools.pairwise(flows))


@pytest.mark.parametrize("mach", [2.0, 5.0])
def test_where_the_flow_leaves_does_not_matter(mach):
    short, long = (sphere_flow(mach, points=16, angles=20, last_angle=math.radians(a)) for a in (82.0, 90.0))
    assert short.standoff == pytest.approx(long.standoff, rel=1e-4)
    angles = np.radians([0.0, 20.0, 40.0, 60.0, 75.0])
    assert short.wall_cp(angles) == pytest.approx(long.wall_cp(angles), abs=1e-3)


@pytest.mark.parametrize("mach", [5.0, 10.0, 25.0])
def test_standoff_is_near_seiffs_rule(mach):
    """0.78 of the density ratio, a rule for high speed."""
    assert sphere_flow(mach).standoff == pytest.approx(standoff_seiff(mach), rel=0.015)


def test_refused_input():
    with pytest.raises(InputError, match="last_angle"):
        sphere_flow(5.0, last_angle=2.0)
    with pytest.raises(InputError, match="gamma = 1"):
        sphere_flow(5.0, gamma=1.0)
    with pytest.raises(InputError, match="mach"):
        sphere_flow(1.2)
    with pytest.raises(InputError, match="theta_deg"):
        sphere_flow(5.0).wall_cp(2.0)
