"""The largest disturbance that limited controls hold: exact bounds, and a simulation on either side of them."""

import math

import numpy as np
import pytest
from tests.dynamics import horus

from spaceplane.control.authority import Authority, authority
from spaceplane.control.holding import largest_held, thruster_to_hold
from spaceplane.control.regulator import minimum_effort
from spaceplane.control.saturation import saturated
from spaceplane.errors import InputError

from .systems import horus_system, random_system, system


def limits_of(*bounds, names=("elevator", "aileron", "rudder")):
    low, high = np.array(bounds, dtype=float).T
    return Authority(names[: len(bounds)], low, high)


def test_one_unstable_root_is_held_up_to_b_u_over_lambda():
    """x' = l x + b u with u from -0.2 to 0.5: x between -b 0.5 / l and b 0.2 / l."""
    plant = system([[0.9]], [[1.7]])
    held = largest_held(plant, limits_of((-0.2, 0.5)), {"alpha": 1.0})
    assert held.high == pytest.approx(1.7 * 0.2 / 0.9, rel=1e-4) and held.high <= 1.7 * 0.2 / 0.9
    assert held.low == pytest.approx(-1.7 * 0.5 / 0.9, rel=1e-4) and held.low >= -1.7 * 0.5 / 0.9


@pytest.mark.parametrize("rate", [0.3, 2.0])
def test_a_saturated_simulation_agrees_with_the_bound(rate):
    """Just inside the exact boundary |x| < b u / l the feedback wins, just outside nothing can."""
    plant, limits = system([[rate]], [[1.3]]), limits_of((-0.4, 0.4))
    boundary = 1.3 * 0.4 / rate
    regulator = minimum_effort(plant, limits)
    times = np.linspace(0.0, 20.0 / rate, 50)
    for share, expected in ((0.98, 1), (0.5, 1), (1.02, 0), (3.0, 0)):
        for sign in (1.0, -1.0):
            run = saturated(regulator, times, {"alpha": sign * share * boundary})
            assert run.attrs["held"] == expected, share
            assert abs(run["elevator"].values).max() <= 0.4
    held = largest_held(plant, limits, {"alpha": 1.0})
    assert held.high == pytest.approx(boundary, rel=1e-4)


def test_stable_modes_take_no_part():
    """A stable root coupled to the unstable one changes nothing."""
    plant = system([[0.9, 0.0], [0.4, -2.0]], [[1.7], [0.3]])
    limits = limits_of((-0.2, 0.2))
    assert largest_held(plant, limits, {"alpha": 1.0}).high == pytest.approx(1.7 * 0.2 / 0.9, rel=1e-4)
    assert largest_held(plant, limits, {"q": 1.0}).high == math.inf
    stable = system([[-0.9]], [[1.7]])
    assert largest_held(stable, limits, {"alpha": 1.0}).low == -math.inf


def test_unstable_pair_reaches_the_bang_bang_limit_cycle():
    """s +- i w with |u| <= 1 in the second equation: the gauge along the first axis from the support function.

    Along c the reachable set extends to h(c) = integral of |c' exp(-A t) b|; the answer is its least with c' d = 1.
    """
    s, w = 0.25, 1.4
    A, b = np.array([[s, w], [-w, s]]), np.array([0.0, 1.0])
    held = largest_held(system(A, b), limits_of((-1.0, 1.0)), {"alpha": 1.0})
    t = np.linspace(0.0, 60.0, 120_001)
    decay = np.exp(-s * t)

    def extent(other):
        # exp(-A t) b = e^(-s t) (-sin w t, cos w t)
        return np.trapezoid(np.abs(decay * (-np.sin(w * t) + other * np.cos(w * t))), t)

    exact = min(extent(c) for c in np.linspace(-3, 3, 601))
    assert held.high == pytest.approx(exact, rel=2e-3) and held.high <= exact * (1 + 1e-3)
    assert held.low == pytest.approx(-held.high, rel=1e-6)


def test_two_inputs_add_for_one_root():
    plant = system([[0.5]], [[1.0, 3.0]])
    held = largest_held(plant, limits_of((-0.1, 0.1), (-0.2, 0.2)), {"alpha": 1.0})
    assert held.high == pytest.approx((0.1 + 0.6) / 0.5, rel=1e-4)


def test_units_and_twice_the_authority():
    for seed in range(4):
        plant = random_system(seed, n=4, unstable=2)
        one = largest_held(plant, limits_of((-0.1, 0.2), (-0.3, 0.3)), {"q": 1.0})
        two = largest_held(plant, limits_of((-0.2, 0.4), (-0.6, 0.6)), {"q": 2.0})
        assert (two.low, two.high) == pytest.approx((one.low, one.high), rel=1e-6)
        flipped = largest_held(plant, limits_of((-0.1, 0.2), (-0.3, 0.3)), {"q": -1.0})
        assert (flipped.low, flipped.high) == pytest.approx((-one.high, -one.low), rel=1e-6)


def test_horus_elevator_holds_the_pitch_divergence():
    """Simulated with saturation: half of the bound in alpha comes back, one and a half times runs away."""
    plant = horus_system(bank_deg=0.0)
    limits = authority(["elevator", "moment_x", "moment_z"], moments={"moment_x": 1e4, "moment_z": 1e4})
    held = largest_held(plant, limits, {"alpha": 1.0}, floor=0.05)
    # about what the elevator's moment balances: C_m_elevator u = C_m_alpha alpha
    moments = 0.17 * math.radians(40.0) / horus.derivatives().Cm_alpha
    assert held.high == pytest.approx(moments, rel=0.3)
    regulator = minimum_effort(plant, limits)
    times = np.linspace(0.0, 30.0, 61)
    assert saturated(regulator, times, {"alpha": 1.5 * held.high}).attrs["held"] == 0
    inside = saturated(regulator, np.linspace(0.0, 300.0, 61), {"alpha": 0.5 * held.high})
    assert abs(inside["alpha"].values[-1]) < 0.1 * held.high


def test_thruster_makes_up_for_what_the_rudder_lacks():
    """One root: (l x - b_r u) / b_t, exactly; nothing where the rudder suffices, infinite off its axis."""
    plant = system([[0.5]], [[2.0, 1e-4, 0.0]], inputs=("rudder", "moment_z", "moment_x"))
    limits = limits_of((-0.3, 0.3), names=("rudder",))
    assert thruster_to_hold(plant, limits, {"alpha": 1.0}, "moment_z") == 0.0
    need = thruster_to_hold(plant, limits, {"alpha": 3.0}, "moment_z")
    assert need == pytest.approx((0.5 * 3.0 - 2.0 * 0.3) / 1e-4, rel=1e-3)
    assert thruster_to_hold(plant, limits, {"alpha": 3.0}, "moment_x") == math.inf
    with_it = Authority(("rudder", "moment_z"), np.array([-0.3, -need]), np.array([0.3, need]))
    assert largest_held(plant, with_it, {"alpha": 1.0}).high == pytest.approx(3.0, rel=1e-3)


def test_thruster_and_bound_agree_on_horus():
    """Yaw divergence at a small angle of attack: with the moment found, exactly the offset asked for is held."""
    plant = horus_system(alpha_deg=2.0, bank_deg=0.0, Cm_alpha=-0.1, Cn_beta=-0.06)
    limits = authority(["rudder"])
    alone = largest_held(plant, limits, {"beta": 1.0}, floor=0.05)
    offset = 2.0 * alone.high
    need = thruster_to_hold(plant, limits, {"beta": offset}, "moment_z", floor=0.05)
    assert need > 0
    both = authority(["rudder", "moment_z"], moments={"moment_z": need})
    assert largest_held(plant, both, {"beta": 1.0}, floor=0.05).high == pytest.approx(offset, rel=1e-3)
    enough = thruster_to_hold(plant, limits, {"beta": 0.5 * alone.high}, "moment_z", floor=0.05)
    assert enough == pytest.approx(0, abs=1e-6 * need)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda p, u: largest_held(p, u, {}), "direction"),
        (lambda p, u: largest_held(p, u, {"beta": 1.0}), "unknown state 'beta'"),
        (lambda p, u: thruster_to_hold(p, u, {"alpha": 1.0}, "moment"), "unknown thruster 'moment'"),
        (lambda p, u: thruster_to_hold(p, u, {"alpha": 1.0}, "moment_z"), "unknown input 'moment_z'"),
    ],
)
def test_refuses(call, message):
    with pytest.raises(InputError, match=message):
        call(system([[0.5]], [[1.0]]), limits_of((-0.1, 0.1)))
