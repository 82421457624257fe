"""Stabilising feedback: textbook gains, mirrored roots, responses against an integration, efforts against limits."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import solve_continuous_are
from tests.dynamics import horus

from spaceplane.control.authority import RATE_LIMIT, Authority, authority
from spaceplane.control.closed_loop import close
from spaceplane.control.disturbance import Gust, disturbed, gust_column
from spaceplane.control.effort import efforts
from spaceplane.control.gramians import energy_to_rest
from spaceplane.control.regulator import bryson, minimum_effort
from spaceplane.control.saturation import Takeover, saturated, takeover
from spaceplane.dynamics.equations import flight_model, state_rates
from spaceplane.dynamics.linearise import linearise
from spaceplane.errors import InputError

from .systems import UNITS, horus_system, random_system, scaled, system


def limits_of(*bounds, names=("elevator", "aileron", "rudder")):
    low, high = np.array(bounds, dtype=float).T
    return Authority(names[: len(bounds)], low, high)


def double_integrator():
    return system([[0.0, 1.0], [0.0, 0.0]], [0.0, 1.0], ("sigma", "p"), ("aileron",))


def aileron(limit):
    return limits_of((-limit, limit), names=("aileron",))


def test_double_integrator_has_the_textbook_gain():
    """Position weighed 1, input weighed 1: K = (1, sqrt 2)."""
    regulator = bryson(double_integrator(), aileron(1.0), {"sigma": 1.0})
    assert regulator.gain[0] == pytest.approx([1.0, math.sqrt(2.0)], rel=1e-9)
    # weights by limits: sigma 0.1 rad, aileron 0.4 rad: K = (q, sqrt(2 q)) with q = 0.4 / 0.1
    regulator = bryson(double_integrator(), aileron(0.4), {"sigma": 0.1})
    assert regulator.gain[0] == pytest.approx([4.0, math.sqrt(8.0)], rel=1e-9)


def test_least_effort_mirrors_unstable_roots_and_leaves_the_others():
    for seed in range(8):
        plant = random_system(seed)
        closed = minimum_effort(plant, limits_of((-0.3, 0.3), (-0.1, 0.2))).closed()
        values = np.linalg.eigvals(plant.A)
        expected = np.where(values.real > 0, -values.conj(), values)
        found = np.linalg.eigvals(closed.A)
        assert np.abs(np.sort_complex(found) - np.sort_complex(expected)).max() < 1e-7


def test_least_effort_of_one_root_is_known():
    """x' = l x + b u: u = -2 l x / b."""
    regulator = minimum_effort(system([[0.7]], [[1.9]]), limits_of((-0.2, 0.2)))
    assert regulator.gain == pytest.approx(np.array([[2 * 0.7 / 1.9]]), rel=1e-12)


def test_least_effort_is_the_limit_of_small_weights():
    for seed in range(4):
        plant, scale = random_system(seed), np.array([0.3, 0.1])
        found = minimum_effort(plant, limits_of((-0.3, 0.3), (-0.1, 0.2))).gain
        X = solve_continuous_are(plant.A, plant.B, 1e-11 * np.eye(5), np.diag(1 / scale**2))
        assert np.allclose(found, np.diag(scale**2) @ plant.B.T @ X, atol=1e-4 * np.abs(found).max())


def test_least_effort_spends_the_least_energy():
    """Along its own response the integral of (u / limit)^2 is what the Gramian says."""
    plant, limits = random_system(3), limits_of((-0.3, 0.3), (-0.1, 0.2))
    regulator = minimum_effort(plant, limits)
    times = np.linspace(0.0, 60.0, 60_001)
    run = disturbed(regulator, times, {"alpha": 0.1, "p": -0.2})
    spent = sum(np.trapezoid((run[n].values / s) ** 2, times) for n, s in zip(limits.inputs, (0.3, 0.1), strict=True))
    assert spent == pytest.approx(energy_to_rest(plant, limits, {"alpha": 0.1, "p": -0.2}), rel=1e-5)


def test_decay_mirrors_about_a_line():
    plant = random_system(1)
    closed = minimum_effort(plant, limits_of((-1, 1), (-1, 1)), decay=0.5).closed()
    values = np.linalg.eigvals(plant.A)
    expected = np.where(values.real > -0.5, -1.0 - values.conj(), values)
    assert np.allclose(np.sort_complex(np.linalg.eigvals(closed.A)), np.sort_complex(expected), atol=1e-7)
    stable = random_system(2, unstable=0)
    assert not minimum_effort(stable, limits_of((-1, 1), (-1, 1))).gain.any()


def test_gain_follows_the_units_of_the_states():
    plant = horus_system()
    other = scaled(plant, list(UNITS.values()))
    limits = authority(["elevator", "aileron", "rudder"])
    scale = np.array(list(UNITS.values()))
    for design in (
        lambda s, u: minimum_effort(s, limits),
        lambda s, u: bryson(
            s,
            limits,
            {
                "alpha": 0.05 * u["alpha"],
                "beta": 0.05 * u["beta"],
                "sigma": 0.2 * u["sigma"],
                "V": 20 * u["V"],
                "R": 500 * u["R"],
            },
        ),
    ):
        a = design(plant, dict.fromkeys(UNITS, 1.0)).gain
        b = design(other, UNITS).gain
        assert np.allclose(b * scale, a, rtol=1e-4, atol=1e-5 * np.abs(a).max())


def test_horus_is_stable_with_either_feedback():
    plant = horus_system()
    assert np.linalg.eigvals(plant.A).real.max() > 0.1
    limits = authority(["elevator", "aileron", "rudder"])
    for regulator in (
        minimum_effort(plant, limits),
        bryson(plant, limits, {"alpha": 0.05, "beta": 0.05, "sigma": 0.2, "V": 20.0, "R": 500.0}),
    ):
        closed = close(regulator)
        assert np.linalg.eigvals(closed.system.A).real.max() < 0
        assert all(mode.stable for mode in closed.modes)
        paragraphs = {v.paragraph for v in closed.verdicts}
        assert {"3.2.1.2", "3.2.2.1.2", "3.3.1.1", "3.3.1.2", "3.3.1.3"} <= paragraphs
        assert not any(v.level == "below 3" and v.paragraph == "3.2.1.1" for v in closed.verdicts)


def test_a_mode_out_of_reach_is_named():
    plant = system(np.diag([0.8, 0.5]), [[1.0], [0.0]])
    for design in (minimum_effort, lambda s, u: bryson(s, u, {"alpha": 1.0})):
        with pytest.raises(InputError, match="elevator: cannot reach the aperiodic pitch divergence"):
            design(plant, limits_of((-1, 1)))


def test_response_to_a_gust_against_an_integration():
    """Every shape of gust, with an offset, against an integration of the same closed loop."""
    plant = horus_system()
    regulator = minimum_effort(plant, authority(["elevator", "aileron", "rudder"]))
    column = gust_column("beta", horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(**horus.EXTRA))
    times = np.linspace(0.0, 6.0, 61)
    closed = regulator.closed()
    for shape, duration in (("sharp", 0.0), ("one-cosine", 1.37), ("ramp", 2.0)):
        gust = Gust(shape, "beta", 0.03, column, duration)
        run = disturbed(regulator, times, {"alpha": 0.01}, gust)
        start = np.zeros(9)
        start[6] = 0.01
        check = solve_ivp(
            lambda t, x, g=gust: closed.A @ x + column * g.at(t),
            (0, 6),
            start,
            "DOP853",
            times,
            rtol=1e-11,
            atol=1e-12,
            max_step=0.05,
        )
        for k, name in enumerate(plant.states):
            size = np.abs(check.y[k]).max()
            assert np.allclose(run[name].values, check.y[k], atol=1e-6 * size), (shape, name)
        assert np.allclose(run["gust"].values, [gust.at(t) for t in times], atol=1e-14)
        fine = disturbed(regulator, np.linspace(2.5, 2.6, 1001), {"alpha": 0.01}, gust)
        slope = np.gradient(fine["elevator"].values, fine["time"].values, edge_order=2)
        assert np.allclose(slope, fine["elevator_rate"].values, rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("axis", ["alpha", "beta"])
def test_gust_acts_as_the_air_does(axis):
    """The column is the change of the nonlinear equations when only the aerodynamic angle is turned."""
    derivatives = horus.derivatives(**horus.EXTRA)
    model = flight_model(horus.point(), horus.MASS, horus.REFERENCE, derivatives)
    column = gust_column(axis, horus.point(), horus.MASS, horus.REFERENCE, derivatives)
    names = {"alpha": ("CL", "CD", "Cm"), "beta": ("CY", "Cl", "Cn")}[axis]
    # the same coefficients by a fictitious control surface with the derivatives of the angle
    extra = {f"{name}_body_flap": getattr(derivatives, f"{name}_{axis}") for name in names}
    others = {k: v for k, v in horus.EXTRA.items() if "body_flap" not in k}
    flap = flight_model(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(**others, **extra))
    inputs = np.zeros(len(flap.inputs), dtype=complex)
    inputs[flap.inputs.index("body_flap")] = 1e-30j
    rates = state_rates(model.reference_state().astype(complex), inputs, flap)
    assert np.allclose(rates.imag / 1e-30, column, rtol=1e-9, atol=1e-12 * np.abs(column).max())


def test_efforts_against_limits():
    """A sharp gust in sideslip: peaks of every surface, margins, rates, and how they grow with the gust."""
    plant = horus_system()
    limits = authority(["elevator", "rudder"], {"elevon_left": -0.1, "elevon_right": -0.1})
    regulator = minimum_effort(plant, limits)
    column = gust_column("alpha", horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(**horus.EXTRA))
    times = np.linspace(0.0, 20.0, 2001)
    found = []
    for angle in (0.01, 0.02):
        run = disturbed(regulator, times, gust=Gust("sharp", "alpha", angle, column))
        found.append({e.name: e for e in efforts(run, limits)})
    small, large = found
    assert set(small) == {"elevon_left", "elevon_right", "rudder_left", "rudder_right"}
    for name in small:
        trim = limits.trim[name]
        for end in ("least", "greatest"):
            grown = getattr(large[name], end) - trim
            assert grown == pytest.approx(2 * (getattr(small[name], end) - trim), rel=1e-9, abs=1e-12)
        assert large[name].rate == pytest.approx(2 * small[name].rate, rel=1e-4)
        assert small[name].jump == 0.0 and small[name].rate_limit == RATE_LIMIT
        assert small[name].least >= small[name].low
    assert small["rudder_left"].least == 0.0  # outboard only
    rate = small["elevon_left"].rate
    tight = {e.name: e for e in efforts(run, limits, {"elevon_left": 1.5 * rate})}
    assert not tight["elevon_left"].within and tight["elevon_right"].within
    huge = disturbed(regulator, times, gust=Gust("sharp", "alpha", 10.0, column))
    beyond = efforts(huge, limits)[0]
    assert beyond.margin < 0 and not beyond.within


def test_an_offset_makes_the_inputs_jump():
    plant = horus_system()
    limits = authority(["elevator", "moment_z"], moments={"moment_z": 2e4})
    regulator = minimum_effort(plant, limits)
    run = disturbed(regulator, [0.0, 0.1, 0.2], {"alpha": 0.05})
    jump = -float(regulator.gain[0, plant.index("alpha")]) * 0.05
    by_name = {e.name: e for e in efforts(run, limits)}
    assert by_name["elevon_left"].jump == pytest.approx(jump)
    assert by_name["moment_z"].unit == "N m" and by_name["moment_z"].rate_limit == math.inf


def test_saturated_without_saturation_is_the_linear_response():
    plant = horus_system()
    regulator = minimum_effort(plant, authority(["elevator", "aileron", "rudder"]))
    times = np.linspace(0.0, 8.0, 33)
    linear = disturbed(regulator, times, {"alpha": 1e-3, "beta": 1e-3})
    limited = saturated(regulator, times, {"alpha": 1e-3, "beta": 1e-3})
    for name in (*plant.states, "elevator", "rudder"):
        size = np.abs(linear[name].values).max()
        assert np.allclose(limited[name].values, linear[name].values, atol=1e-5 * size + 1e-9), name


def test_rate_limit_and_lag_act():
    plant, limits = system([[1.0]], [[1.0]]), limits_of((-1.0, 1.0))
    regulator = minimum_effort(plant, limits)
    times = np.linspace(0.0, 20.0, 401)
    fast = saturated(regulator, times, {"alpha": 0.3}, lag=0.02, rate_limit=5.0)
    slow = saturated(regulator, times, {"alpha": 0.3}, lag=0.02, rate_limit=0.2)
    assert fast.attrs["held"] == 1 and slow.attrs["held"] == 0
    rise = np.diff(slow["elevator"].values) / np.diff(slow["time"].values)
    assert np.abs(rise).max() == pytest.approx(0.2, rel=1e-3)
    assert slow.attrs["until"] < 20.0


def test_thruster_takes_over_where_the_rudder_stops():
    """A rudder that only yaws: with the thruster the loop is the linear one, its moment what is missing."""
    only_yaw = {"CY_rudder_left": 0.0, "CY_rudder_right": 0.0, "Cl_rudder_left": 0.0}
    plant = horus_system(alpha_deg=2.0, bank_deg=0.0, Cm_alpha=-0.1, Cn_beta=-0.06, **only_yaw)
    regulator = minimum_effort(plant, authority(["rudder"]))
    relief = takeover(plant, "rudder", "moment_z")
    qSb = horus.point(alpha_deg=2.0).dynamic_pressure * horus.REFERENCE.area * horus.REFERENCE.span
    assert relief.ratio == pytest.approx(-0.04 * qSb, rel=1e-9)
    times = np.linspace(0.0, 10.0, 201)
    linear = disturbed(regulator, times, {"beta": 0.05})
    limit = 0.25 * float(np.abs(linear["rudder"].values).max())
    tight = Authority(("rudder",), np.array([-limit]), np.array([limit]), regulator.limits.trim)
    small = type(regulator)(regulator.kind, regulator.system, regulator.gain, tight)
    run = saturated(small, times, {"beta": 0.05}, reliefs=[relief])
    assert np.allclose(run["beta"].values, linear["beta"].values, atol=1e-5)
    missing = linear["rudder"].values - np.clip(linear["rudder"].values, -limit, limit)
    assert np.allclose(run["moment_z"].values, relief.ratio * missing, atol=1e-4 * abs(relief.ratio) * limit)
    assert np.abs(run["rudder"].values).max() <= limit


@pytest.mark.parametrize("mass", [horus.MASS, horus.TILTED], ids=["symmetric", "Ixz"])
def test_a_thruster_takes_over_the_moment_of_its_own_axis(mass):
    """C_l and C_n of the rudder times q S b, whatever the product of inertia makes of them."""
    d = horus.derivatives(**horus.EXTRA)
    plant = linearise(horus.point(), mass, horus.REFERENCE, d)
    qSb = horus.point().dynamic_pressure * horus.REFERENCE.area * horus.REFERENCE.span
    for coefficient, moment in (("Cl", "moment_x"), ("Cn", "moment_z")):
        ratio = takeover(plant, "rudder", moment).ratio
        assert ratio == pytest.approx(d.control(coefficient, "rudder") * qSb, rel=1e-9)
    only_yaw = horus.derivatives(**{**horus.EXTRA, "Cl_rudder_left": 0.0})
    with pytest.raises(InputError, match="makes no moment_x"):
        takeover(linearise(horus.point(), mass, horus.REFERENCE, only_yaw), "rudder", "moment_x")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r: Gust("square", "alpha", 0.1, np.zeros(9)), "unknown gust 'square'"),
        (lambda r: Gust("ramp", "alpha", 0.1, np.zeros(9)), "duration = 0"),
        (lambda r: Gust("sharp", "gamma", 0.1, np.zeros(9)), "unknown gust axis"),
        (lambda r: Gust("sharp", "beta", math.nan, np.zeros(9)), "angle = nan"),
        (lambda r: disturbed(r, [0.0, 1.0], gust=Gust("sharp", "beta", 0.1, np.zeros(3))), "gust: its column has 3"),
        (lambda r: disturbed(r, [0.0, 1.0], {"psi": 0.1}), "unknown state 'psi'"),
        (lambda r: minimum_effort(r.system, r.limits, -1.0), "decay = -1"),
        (lambda r: bryson(r.system, r.limits, {"alpha": 0.0}), "alpha = 0"),
        (lambda r: saturated(r, [0.0, 1.0], lag=-1.0), "lag = -1"),
        (lambda r: saturated(r, [0.0, 1.0], rate_limit=1.0), "rate_limit = 1"),
        (lambda r: takeover(r.system, "rudder", "moment_z"), "unknown input"),
        (lambda r: saturated(r, [0.0, 1.0], reliefs=[Takeover("rudder", "moment_z", 1.0, np.zeros(9))]), "relieve"),
        (lambda r: saturated(r, [0.0, 1.0], reliefs=2 * [Takeover("elevator", "moment_y", 1.0, np.zeros(9))]), "axis"),
        (lambda r: efforts(disturbed(r, [0.0, 1.0]), r.limits, {"flap": 1.0}), "unknown control surface"),
        (lambda r: efforts(disturbed(r, [0.0, 1.0]), r.limits, {"body_flap": 0.0}), "rate limit of body_flap"),
        (lambda r: close(r, "V"), "vehicle_class"),
    ],
)
def test_refuses(call, message):
    with pytest.raises(InputError, match=message):
        call(minimum_effort(horus_system(), authority(["elevator"])))
