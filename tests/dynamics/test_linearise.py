"""The linear model against the nonlinear equations, against independent answers and against the published modes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spaceplane.aero.model.derivatives import DAMPING, STATIC
from spaceplane.dynamics import derivatives_file
from spaceplane.dynamics.equations import air_gradient, flight_model, state_rates
from spaceplane.dynamics.flightpoint import flight_point
from spaceplane.dynamics.linearise import analytic, linearise, numerical
from spaceplane.dynamics.modes import identify
from spaceplane.dynamics.statespace import STATES
from spaceplane.environment import constants
from spaceplane.errors import InputError
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

from . import horus


def eigenvalues(system):
    return np.linalg.eigvals(system.A)


def nearest(system, value):
    values = eigenvalues(system)
    return values[np.argmin(np.abs(values - value))]


@pytest.mark.parametrize(
    "point",
    [
        horus.point(),
        horus.point(gamma_deg=3.0, bank_deg=-30.0, alpha_deg=2.0),
        horus.point(mach=0.8, altitude_m=13_000.0, alpha_deg=10.0, bank_deg=0.0),
        horus.point(mach=10.0, altitude_m=53_000.0, alpha_deg=36.0, gamma_deg=-1.0),
    ],
    ids=["TAEM", "climbing left turn", "Mach 0.8", "Mach 10"],
)
@pytest.mark.parametrize("density_gradient", [True, False])
@pytest.mark.parametrize("gyroscopic", [True, False])
def test_analytic_equals_numerical(point, density_gradient, gyroscopic):
    model = flight_model(
        point, horus.MASS, horus.REFERENCE, horus.derivatives(**horus.EXTRA), density_gradient, gyroscopic
    )
    exact, measured = analytic(model), numerical(model)
    for ours, theirs in ((exact.A, measured.A), (exact.B, measured.B)):
        assert np.allclose(ours, theirs, rtol=1e-10, atol=1e-18)
    assert exact.inputs == measured.inputs
    assert np.abs(exact.B).max(axis=0).min() > 0  # every input acts


def test_central_differences_agree_too():
    """A route that does not share the complex arithmetic."""
    model = flight_model(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(**horus.EXTRA))
    start, no_input = model.reference_state(), np.zeros(len(model.inputs))
    for k, size in enumerate((1e-2, 1e-5, 10.0, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5)):
        step = np.zeros(9)
        step[k] = size
        slope = (state_rates(start + step, no_input, model) - state_rates(start - step, no_input, model)) / (2 * size)
        assert np.allclose(slope, analytic(model).A[:, k], rtol=1e-6, atol=1e-10), STATES[k]


def test_steady_flight_is_an_equilibrium_of_attitude_and_rates():
    model = flight_model(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives())
    rates = state_rates(model.reference_state(), np.zeros(len(model.inputs)), model)
    assert np.abs(rates[3:]).max() < 1e-14
    assert rates[2] == pytest.approx(model.point.velocity * np.sin(model.point.gamma))


def test_equilibrium_rates_of_the_thesis():
    """(3.27) to (3.29), p and r with the opposite sign since the thesis's axes point aft and up."""
    point = horus.point()
    V, g = point.velocity, point.gravity
    lift = point.dynamic_pressure * 110.0 * 0.36 / (26_000.0 * V)
    gamma, sigma, alpha = point.gamma, point.bank, point.alpha
    p = g / V * np.cos(gamma) * np.sin(sigma) * np.sin(alpha) + lift * np.tan(gamma) * np.sin(sigma) * np.cos(alpha)
    q = lift - g / V * np.cos(gamma) * np.cos(sigma)
    r = -g / V * np.cos(gamma) * np.sin(sigma) * np.cos(alpha) + lift * np.tan(gamma) * np.sin(sigma) * np.sin(alpha)
    rates = flight_model(point, horus.MASS, horus.REFERENCE, horus.derivatives()).rates
    assert (rates.p, rates.q, rates.r) == pytest.approx((-p, q, -r), rel=1e-12)


def _march(model, start, seconds, steps):
    """Classical Runge-Kutta."""
    state, h = start.copy(), seconds / steps
    no_input = np.zeros(len(model.inputs))
    for _ in range(steps):
        k1 = state_rates(state, no_input, model)
        k2 = state_rates(state + h / 2 * k1, no_input, model)
        k3 = state_rates(state + h / 2 * k2, no_input, model)
        k4 = state_rates(state + h * k3, no_input, model)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return state


def test_energy_is_conserved_without_drag():
    """Lift and side force do no work: V^2/2 - g0 R0^2 / R is constant when CD is zero."""
    zero = {name: 0.0 for name in ("CD_alpha", "CD_M", "Cm_M")}
    derivatives = horus.derivatives(**zero, Cm_alpha=-0.1, Cn_beta=0.1, Cm_q=-5.0, Cl_p=-0.5, Cn_r=-0.5)
    model = flight_model(horus.point(CD=0.0), horus.MASS, horus.REFERENCE, derivatives)
    start = model.reference_state()
    start[7] += 0.05  # sideslip, so that the side force acts as well

    def energy(state):
        return state[0] ** 2 / 2 - constants.STANDARD_GRAVITY * constants.EARTH_RADIUS**2 / state[2]

    end = _march(model, start, 30.0, 3_000)
    assert abs(end[0] - start[0]) > 10.0  # the speed changes a lot
    assert energy(end) - energy(start) == pytest.approx(0.0, abs=1e-6 * start[0] ** 2 / 2)


def test_torque_free_spin_keeps_angular_momentum():
    """Euler's equations alone, with the aerodynamics made to vanish."""
    point = horus.point(pressure_Pa=1e-9, temperature_K=223.24)
    model = flight_model(point, horus.MASS, horus.REFERENCE, horus.derivatives(), density_gradient=False)
    model = replace(model, trim=(0.0, 0.0, 0.0))  # no control moments either
    start = model.reference_state()
    start[3:6] = (0.3, 0.05, 0.4)
    inertia = np.array([119_000.0, 769_000.0, 806_000.0])
    end = _march(model, start, 1.0, 1_000)
    assert np.linalg.norm(end[3:6] - start[3:6]) > 1e-2
    assert np.linalg.norm(inertia * end[3:6]) == pytest.approx(np.linalg.norm(inertia * start[3:6]), rel=1e-9)


def test_circular_orbit_is_an_equilibrium():
    """In vacuum at circular speed the path stays level: gravity balances V^2/R."""
    altitude = 80_000.0
    radius = constants.EARTH_RADIUS + altitude
    speed = np.sqrt(constants.gravity(radius) * radius)
    point = flight_point(25.0, altitude, 0.0, 0.0, 0.0, 0.0, 0.0, pressure_Pa=1e-12, temperature_K=200.0)
    model = flight_model(point, horus.MASS, horus.REFERENCE, horus.derivatives(), density_gradient=False)
    state = model.reference_state()
    state[0], state[4] = speed, -speed / radius
    rates = state_rates(state, np.zeros(3), model)
    assert np.abs(rates[:3]).max() < 1e-9
    assert rates[6] == pytest.approx(-speed / radius + constants.gravity(radius) / speed, abs=1e-12)


# Published modes


def test_thesis_form_gives_table_6_2():
    system = linearise(horus.point(pressure_Pa=1967.5, temperature_K=223.24), horus.MASS, horus.REFERENCE,
                       horus.derivatives(), "thesis")  # fmt: skip
    for published in (-1.0884 + 0j, 0.9518 + 0j, 0.0392 + 1.343j):
        assert abs(nearest(system, published) - published) < 0.07 * abs(published)
    # and the values that were computed independently of this program, to their digits
    assert nearest(system, -1.1).real == pytest.approx(-1.137, abs=6e-4)
    assert nearest(system, 1.0).real == pytest.approx(1.010, abs=6e-4)
    assert nearest(system, 1.4j) == pytest.approx(0.0391 + 1.397j, abs=6e-4)
    assert nearest(system, -0.022 + 0.012j) == pytest.approx(-0.0224 + 0.0121j, abs=6e-5)
    assert nearest(system, 0.034).real == pytest.approx(0.0336, abs=6e-5 + 1e-4)


def test_consistent_side_force_sign():
    """The side force damps: +0.046 becomes -0.016 1/s at the thesis's ambient values, with the rest unchanged."""
    point = horus.thesis_ambient()
    printed = linearise(point, horus.MASS, horus.REFERENCE, horus.derivatives(), "thesis")
    plain = linearise(point, horus.MASS, horus.REFERENCE, horus.derivatives(), gyroscopic=False)
    full = linearise(point, horus.MASS, horus.REFERENCE, horus.derivatives())
    assert nearest(printed, 1.58j).real == pytest.approx(0.046, abs=5e-4)
    assert nearest(plain, 1.58j).real == pytest.approx(-0.016, abs=5e-4)
    # The gyroscopic moment of the steady pitch rate (q0 = 0.015 rad/s) couples roll into yaw and undoes this damping.
    assert nearest(full, 1.58j).real == pytest.approx(0.0088, abs=5e-4)


def test_boeing_747_longitudinal():
    """Etkin and Reid, Dynamics of Flight, 3rd ed., table 6.1: their body-axes derivatives turned into ours.

    C_X_u and C_Z_u hold thrust at constant value, so M CD_M + 2 CD0 = -C_X_u and M CL_M = -C_Z_u; thrust along the
    body's x axis adds CD0 to the lift slope; C_Z_q and C_Z_alphadot are -CL_q and -CL_alphadot.
    """
    weight, area, chord, density, speed = 2.83176e6, 511.0, 8.324, 0.3045, 235.9
    sound = speed / 0.8
    temperature = sound**2 / (1.4 * constants.GAS_CONSTANT_AIR)
    pressure = density * constants.GAS_CONSTANT_AIR * temperature
    mach = 0.8
    CL = weight / (0.5 * density * speed**2 * area)
    point = flight_point(mach, 12_192.0, 0.0, 0.0, 0.0, CL, 0.0, pressure, temperature)
    mass = MassProperties(weight / point.gravity, 0.247e8, 0.449e8, 0.673e8)
    derivatives = horus.derivatives(
        CD_alpha=CL - 0.2193, CL_alpha=4.92, Cm_alpha=-1.023, CD_M=0.1080 / mach, CL_M=0.106 / mach, Cm_M=0.1043 / mach,
        CL_q=5.92, Cm_q=-23.92, CL_alphadot=-5.9, Cm_alphadot=-6.314, CY_beta=-0.9, Cl_beta=-0.2, Cn_beta=0.15,
    )  # fmt: skip
    system = linearise(
        point, mass, ReferenceLengths(area, chord, 59.64, (0, 0, 0)), derivatives, density_gradient=False
    )
    short_period, phugoid = nearest(system, -0.37 + 0.89j), nearest(system, 0.067j)
    assert short_period == pytest.approx(-0.3719 + 0.8875j, abs=2e-3)
    assert phugoid == pytest.approx(-0.003289 + 0.06723j, abs=4e-4)


def test_density_gradient_stiffens_the_phugoid():
    """Uniform air: omega = sqrt(2) g / V (Lanchester). Thinner air above adds g / H to omega^2 (H: scale height)."""
    case = derivatives_file.read(Path(__file__).parents[2] / "examples" / "boeing747_cruise.toml")
    omega = {}
    for gradient in (False, True):
        system = linearise(case.point, case.mass, case.reference, case.derivatives, density_gradient=gradient)
        omega[gradient] = next(m for m in identify(system) if m.kind == "phugoid").natural_frequency
    rise = omega[True] ** 2 - omega[False] ** 2
    assert omega[False] == pytest.approx(np.sqrt(2) * case.point.gravity / case.point.velocity, rel=0.2)
    assert rise == pytest.approx(-case.point.gravity * air_gradient(case.point.altitude).log_density, rel=0.15)


# Every input acts


@pytest.mark.parametrize(
    ("form", "name"),
    [*(("rigid-body", name) for name in (*STATIC, *DAMPING)), *(("thesis", name) for name in STATIC)],
)
def test_every_derivative_moves_an_eigenvalue(form, name):
    base = horus.derivatives(**horus.EXTRA)
    changed = horus.derivatives(**{**horus.EXTRA, name: getattr(base, name) * 1.1 + 1e-3})
    before = np.poly(linearise(horus.point(), horus.MASS, horus.REFERENCE, base, form).A)
    after = np.poly(linearise(horus.point(), horus.MASS, horus.REFERENCE, changed, form).A)
    assert np.abs((after - before)[:8]).max() > 1e-9


@pytest.mark.parametrize(
    "field", ["mach", "altitude_m", "alpha_deg", "gamma_deg", "bank_deg", "CL", "CD", "pressure_Pa"]
)
def test_every_flight_value_moves_an_eigenvalue(field):
    values = {"mach": 2.6, "altitude_m": 26_800.0, "alpha_deg": 16.8, "gamma_deg": -8.6, "bank_deg": 54.0, "CL": 0.37,
              "CD": 0.21, "pressure_Pa": 2000.0}  # fmt: skip
    base = eigenvalues(linearise(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives()))
    moved = eigenvalues(
        linearise(horus.point(**{field: values[field]}), horus.MASS, horus.REFERENCE, horus.derivatives())
    )
    assert np.abs(np.sort_complex(moved) - np.sort_complex(base)).max() > 1e-5


def test_combined_controls_are_sums_of_their_surfaces():
    system = linearise(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(**horus.EXTRA))
    column = {name: system.B[:, k] for k, name in enumerate(system.inputs)}
    assert np.allclose(column["elevator"], column["elevon_left"] + column["elevon_right"])
    assert np.allclose(column["aileron"], column["elevon_left"] - column["elevon_right"])
    assert np.allclose(column["rudder"], column["rudder_left"] - column["rudder_right"])
    assert column["elevator"][system.index("q")] < 0  # trailing edge down pitches down
    assert column["moment_y"][system.index("q")] == pytest.approx(1 / 769_000.0)


def test_thesis_form_control_matrix():
    system = linearise(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(**horus.EXTRA), "thesis")
    force = horus.point().dynamic_pressure * 110.0
    assert system.inputs == ("elevator", "aileron", "rudder", "moment_x", "moment_y", "moment_z")
    assert system.B[4, 0] == pytest.approx((-0.09 - 0.08) * force * 23.0 / 769_000.0)
    assert system.B[3, 1] == pytest.approx((0.05 + 0.06) * force * 13.0 / 119_000.0)
    assert system.B[5, 2] == pytest.approx((-0.02 - 0.02) * force * 13.0 / 806_000.0)
    assert np.count_nonzero(system.B[[0, 1, 2, 6, 7, 8]]) == 0


def test_bad_input():
    with pytest.raises(InputError, match="form"):
        linearise(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(), "appendix")
    with pytest.raises(InputError, match="CL"):
        linearise(horus.point(CL=None), horus.MASS, horus.REFERENCE, horus.derivatives())
    with pytest.raises(InputError, match="mach"):
        horus.point(mach=0.0)
    with pytest.raises(InputError, match="gamma_deg"):
        horus.point(gamma_deg=90.0)
    with pytest.raises(InputError, match="elevator"):
        horus.derivatives(**horus.EXTRA, Cm_elevator=-0.1)
