"""The nine-state linear model about a flight point, in two forms.

`rigid-body` (the default) is the analytic linearisation of `spaceplane.dynamics.equations`; `thesis` is the matrix of
the thesis's Appendix A as printed (`spaceplane.dynamics.appendix_a`). Linearised about steady banked flight: dV/dt and
dgamma/dt need not vanish there, since a gliding vehicle descends through its trajectory.
"""

from __future__ import annotations

import numpy as np

from spaceplane.aero.model.derivatives import COEFFICIENTS, Derivatives
from spaceplane.dynamics import appendix_a
from spaceplane.dynamics.equations import FlightModel, flight_model, state_rates
from spaceplane.dynamics.flightpoint import FlightPoint
from spaceplane.dynamics.inertia import primed
from spaceplane.dynamics.statespace import STATES, StateSpace
from spaceplane.errors import InputError
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

FORMS = ("rigid-body", "thesis")


def linearise(
    point: FlightPoint,
    mass: MassProperties,
    reference: ReferenceLengths,
    derivatives: Derivatives,
    form: str = "rigid-body",
    density_gradient: bool = True,
    gyroscopic: bool = True,
) -> StateSpace:
    """A and B about a flight point.

    Args:
        point: flight point with CL and CD.
        mass: mass and inertia, SI.
        reference: reference area and lengths, SI.
        derivatives: per rad and per unit Mach.
        form: "rigid-body" or "thesis".
        density_gradient: `rigid-body` only: density and speed of sound change with height.
        gyroscopic: `rigid-body` only: keep the gyroscopic moments of the steady turning rates.

    Raises:
        InputError: unknown form, CL or CD missing, or form "thesis" with a product of inertia.
    """
    check_form(form, mass)
    if form == "thesis":
        return appendix_a.state_space(point, mass, reference, derivatives)
    model = flight_model(point, mass, reference, derivatives, density_gradient, gyroscopic)
    return analytic(model)


def check_form(form: str, mass: MassProperties) -> None:
    """Refuse a form that does not exist, or that a vehicle cannot have.

    Raises:
        InputError: unknown form, or form "thesis" with a product of inertia, which Appendix A does not know.
    """
    if form not in FORMS:
        raise InputError(f"form = {form!r}: must be one of {', '.join(FORMS)}")
    if form == "thesis" and mass.Ixz != 0.0:
        raise InputError(f"Ixz = {mass.Ixz:g} kg m2: must be 0 with form = 'thesis', which has no product of inertia")


def analytic(model: FlightModel) -> StateSpace:
    """Linearisation by the chain rule, exact. Every differential below is a row over (states, inputs)."""
    n, m = len(STATES), len(model.inputs)
    rows = np.eye(n + m)
    d = dict(zip(STATES, rows, strict=False))
    p, mass = model.point, model.mass.mass
    V, R, g = p.velocity, p.radius, p.gravity
    sin_g, cos_g = np.sin(p.gamma), np.cos(p.gamma)
    sin_s, cos_s = np.sin(p.bank), np.cos(p.bank)
    sin_a, cos_a = np.sin(p.alpha), np.cos(p.alpha)
    force, dforce, dC, dalpha_dot = _aerodynamic_rows(model, d, rows[n:])
    CL, CD = p.coefficients()
    L = force * CL
    dL = force * dC["CL"] + CL * dforce
    dD = force * dC["CD"] + CD * dforce
    dY = force * dC["CY"]
    dg = -2 * g / R * d["R"]
    roll_stability = model.rates.p * cos_a + model.rates.r * sin_a  # dalpha/dt = 0 leaves Q = 0 from q, L and g below
    pull = L / (mass * V) - g / V * cos_g * cos_s
    dweight = dg / V - g / V**2 * d["V"]  # of g / V
    dlift = dL / (mass * V) - L / (mass * V**2) * d["V"]  # of L / (m V)
    dside = dY / (mass * V)
    moments = _moment_rows(model, d, rows[n:], force, dforce, dC)
    derivative = np.array(
        [
            -dD / mass - dg * sin_g - g * cos_g * d["gamma"],
            cos_s * dlift
            - L / (mass * V) * sin_s * d["sigma"]
            - sin_s * dside
            - (dweight - d["V"] / R + V / R**2 * d["R"]) * cos_g
            + (g / V - V / R) * sin_g * d["gamma"],
            sin_g * d["V"] + V * cos_g * d["gamma"],
            *moments,
            dalpha_dot,
            sin_a * d["p"]
            - cos_a * d["r"]
            + roll_stability * d["alpha"]
            + dside
            + dweight * cos_g * sin_s
            + g / V * (cos_g * cos_s * d["sigma"] - sin_g * sin_s * d["gamma"]),
            cos_a * d["p"]
            + sin_a * d["r"]
            + (model.rates.r * cos_a - model.rates.p * sin_a) * d["alpha"]
            + pull * d["beta"]
            + np.tan(p.gamma) * (sin_s * dlift + L / (mass * V) * cos_s * d["sigma"] + cos_s * dside)
            + L / (mass * V) * sin_s / cos_g**2 * d["gamma"],
        ]
    )
    return _state_space(derivative[:, :n], derivative[:, n:], model, "rigid-body")


def _aerodynamic_rows(model: FlightModel, d: dict[str, np.ndarray], inputs: np.ndarray) -> tuple:
    """(q S, its differential, differentials of the coefficients, differential of dalpha/dt)."""
    p, a, ref, mass = model.point, model.derivatives, model.reference, model.mass.mass
    V, R, g, sound = p.velocity, p.radius, p.gravity, p.ambient.speed_of_sound
    force = p.dynamic_pressure * ref.area
    dforce = force * (2 / V * d["V"] + model.air.log_density * d["R"])
    dmach = d["V"] / sound - V * model.air.speed_of_sound / sound**2 * d["R"]
    droll, dyaw = (
        ref.span / (2 * V) * (d[name] - steady / V * d["V"])
        for name, steady in (("p", model.rates.p), ("r", model.rates.r))
    )
    dpitch = ref.chord / (2 * V) * (d["q"] - model.rates.q / V * d["V"])
    dC = {name: model.control_column(name) @ inputs for name in COEFFICIENTS}
    dC["CD"] = dC["CD"] + a.CD_alpha * d["alpha"] + a.CD_M * dmach
    dC["CL"] = dC["CL"] + a.CL_alpha * d["alpha"] + a.CL_M * dmach + a.CL_q * dpitch
    dC["CY"] = dC["CY"] + a.CY_beta * d["beta"] + a.CY_p * droll + a.CY_r * dyaw
    dC["Cl"] = dC["Cl"] + a.Cl_beta * d["beta"] + a.Cl_p * droll + a.Cl_r * dyaw
    dC["Cm"] = dC["Cm"] + a.Cm_alpha * d["alpha"] + a.Cm_M * dmach + a.Cm_q * dpitch
    dC["Cn"] = dC["Cn"] + a.Cn_beta * d["beta"] + a.Cn_p * droll + a.Cn_r * dyaw
    CL = p.coefficients()[0]
    cos_gs = np.cos(p.gamma) * np.cos(p.bank)
    roll_stability = model.rates.p * np.cos(p.alpha) + model.rates.r * np.sin(p.alpha)
    dQ = (
        (force * dC["CL"] + CL * dforce) / (mass * V)
        - force * CL / (mass * V**2) * d["V"]
        + (2 * g / (R * V) * d["R"] + g / V**2 * d["V"]) * cos_gs
        + g / V * (np.sin(p.gamma) * np.cos(p.bank) * d["gamma"] + np.cos(p.gamma) * np.sin(p.bank) * d["sigma"])
    )
    # dalpha/dt is zero at the flight point, so the implicit factor itself need not be varied.
    implicit = 1.0 + force * ref.chord * a.CL_alphadot / (2 * mass * V**2)
    dalpha_dot = (d["q"] - roll_stability * d["beta"] - dQ) / implicit
    dC["CL"] = dC["CL"] + a.CL_alphadot * ref.chord / (2 * V) * dalpha_dot
    dC["Cm"] = dC["Cm"] + a.Cm_alphadot * ref.chord / (2 * V) * dalpha_dot
    return force, dforce, dC, dalpha_dot


def _moment_rows(
    model: FlightModel,
    d: dict[str, np.ndarray],
    inputs: np.ndarray,
    force: float,
    dforce: np.ndarray,
    dC: dict[str, np.ndarray],
) -> list[np.ndarray]:
    """Differentials of dp/dt, dq/dt, dr/dt; the last three inputs are moments about x, y, z."""
    inertia, ref, rates = model.mass, model.reference, model.rates
    roll, pitch, yaw = model.trim
    dmx, dmy, dmz = inputs[-3:]
    about_x = ref.span * (force * dC["Cl"] + roll * dforce) + dmx
    about_y = ref.chord * (force * dC["Cm"] + pitch * dforce) + dmy
    about_z = ref.span * (force * dC["Cn"] + yaw * dforce) + dmz
    if model.gyroscopic:
        dqr = rates.q * d["r"] + rates.r * d["q"]
        dpr = rates.p * d["r"] + rates.r * d["p"]
        dpq = rates.p * d["q"] + rates.q * d["p"]
        about_x = about_x + (inertia.Iyy - inertia.Izz) * dqr + inertia.Ixz * dpq
        about_y = about_y + (inertia.Izz - inertia.Ixx) * dpr
        about_y = about_y - 2.0 * inertia.Ixz * (rates.p * d["p"] - rates.r * d["r"])
        about_z = about_z + (inertia.Ixx - inertia.Iyy) * dpq - inertia.Ixz * dqr
    about_x, about_z = primed(inertia, about_x, about_z)
    return [about_x / inertia.Ixx, about_y / inertia.Iyy, about_z / inertia.Izz]


def numerical(model: FlightModel, step: float = 1e-30) -> StateSpace:
    """Linearisation of the nonlinear equations by the complex step, free of subtraction (Squire and Trapp 1998).

    `step` is in the SI unit of each state.
    """
    n, m = len(STATES), len(model.inputs)
    start = np.concatenate([model.reference_state(), np.zeros(m)]).astype(complex)
    jacobian = np.zeros((n, n + m))
    for k in range(n + m):
        shifted = start.copy()
        shifted[k] += 1j * step
        jacobian[:, k] = state_rates(shifted[:n], shifted[n:], model).imag / step
    return _state_space(jacobian[:, :n], jacobian[:, n:], model, "rigid-body (numerical)")


def _state_space(A: np.ndarray, B: np.ndarray, model: FlightModel, form: str) -> StateSpace:
    reference = dict(zip(STATES, (float(value) for value in model.reference_state()), strict=True))
    return StateSpace(A, B, STATES, model.inputs, form, reference)
