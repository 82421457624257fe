"""Nonlinear equations of motion of a rigid glider over a spherical Earth that does not rotate, air at rest.

States: airspeed V, flight-path angle gamma, distance from the Earth's centre R, body rates p, q, r (body axes: x
forward, y right, z down), angle of attack alpha, sideslip beta (wind from the right positive), bank angle sigma (right
wing down positive). Heading, longitude and latitude do not act back on them. With L up, D aft and Y right in wind axes:

    dV/dt     = -D/m - g sin(gamma)
    dgamma/dt = (L cos(sigma) - Y sin(sigma)) / (m V) - (g/V - V/R) cos(gamma)
    dR/dt     = V sin(gamma)
    Ixx dp/dt - Ixz dr/dt = Mx + (Iyy - Izz) q r + Ixz p q
    Iyy dq/dt             = My + (Izz - Ixx) p r - Ixz (p^2 - r^2)
    Izz dr/dt - Ixz dp/dt = Mz + (Ixx - Iyy) p q - Ixz q r
    dalpha/dt = q - (p cos(alpha) + r sin(alpha)) tan(beta) - Q / cos(beta)
    dbeta/dt  = p sin(alpha) - r cos(alpha) + Y/(m V) + (g/V) cos(gamma) sin(sigma)
    dsigma/dt = (p cos(alpha) + r sin(alpha)) / cos(beta) + Q tan(beta) + w tan(gamma)
    Q         = L/(m V) - (g/V) cos(gamma) cos(sigma)
    w         = (L sin(sigma) + Y cos(sigma)) / (m V)

They follow from the turning rate of the trajectory axes (x along the velocity, y kept horizontal), which is
(-w tan(gamma), (L cos(sigma) - Y sin(sigma))/(m V) - (g/V) cos(gamma), w), and the turns by sigma, -beta and alpha on
to the body. The rates are those against inertial space, so the curvature of the Earth enters only dgamma/dt. The
vehicle is symmetric, so that Ixy and Iyz are zero; Ixz = integral of x z dm, which the thesis neglects (section 3.3).

The aerodynamic coefficients are linear about the flight point. Air density and speed of sound follow the atmosphere's
gradient at the flight point: exponential density, linear speed of sound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spaceplane.aero.model.derivatives import COEFFICIENTS, Derivatives
from spaceplane.dynamics.flightpoint import AngularRates, FlightPoint, equilibrium_rates
from spaceplane.dynamics.inertia import coupling, primed
from spaceplane.dynamics.statespace import MOMENT_INPUTS
from spaceplane.environment import constants as c
from spaceplane.environment.atmosphere import HIGHEST_ALTITUDE, LOWEST_ALTITUDE, us1976
from spaceplane.errors import InputError
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths


@dataclass(frozen=True)
class AirGradient:
    """How the air changes with height at the flight point.

    Attributes:
        log_density: d ln(rho) / dh, 1/m.
        speed_of_sound: da/dh, 1/s.
    """

    log_density: float
    speed_of_sound: float


@dataclass(frozen=True)
class FlightModel:
    """A vehicle at a flight point, ready for its equations of motion.

    Attributes:
        point: flight point with CL and CD.
        mass: mass and inertia.
        reference: reference area and lengths.
        derivatives: per rad and per unit Mach.
        inputs: names of the inputs: controls, then moments.
        rates: body rates of steady flight.
        trim: (Cl, Cm, Cn) that balance the gyroscopic moments of these rates, so that the controls hold the point.
        air: gradients of the air; zero where the model is told to neglect them.
        gyroscopic: whether the gyroscopic moments of the rotation (omega x I omega) are kept.
    """

    point: FlightPoint
    mass: MassProperties
    reference: ReferenceLengths
    derivatives: Derivatives
    inputs: tuple[str, ...]
    rates: AngularRates
    trim: tuple[float, float, float]
    air: AirGradient
    gyroscopic: bool = True

    def reference_state(self) -> np.ndarray:
        """[9] the states at the flight point, SI and rad."""
        p = self.point
        return np.array(
            [p.velocity, p.gamma, p.radius, self.rates.p, self.rates.q, self.rates.r, p.alpha, p.beta, p.bank]
        )

    def control_column(self, coefficient: str) -> np.ndarray:
        """[input] derivatives of a coefficient with every input, 1/rad (zero for the moments)."""
        return np.array([0.0 if i in MOMENT_INPUTS else self.derivatives.control(coefficient, i) for i in self.inputs])


def air_gradient(altitude: float) -> AirGradient:
    """Gradients of the US 1976 atmosphere at an altitude, m, by central difference over 2 m.

    Raises:
        InputError: the altitude is outside the atmosphere model.
    """
    low = max(altitude - 1.0, LOWEST_ALTITUDE)
    high = min(altitude + 1.0, HIGHEST_ALTITUDE)
    below, above = us1976(low), us1976(high)
    step = high - low
    return AirGradient(
        log_density=float(np.log(above.density / below.density)) / step,
        speed_of_sound=(above.speed_of_sound - below.speed_of_sound) / step,
    )


def flight_model(
    point: FlightPoint,
    mass: MassProperties,
    reference: ReferenceLengths,
    derivatives: Derivatives,
    density_gradient: bool = True,
    gyroscopic: bool = True,
) -> FlightModel:
    """Bring a vehicle and a flight point together.

    Args:
        point: flight point with CL and CD.
        mass: kg, kg m2.
        reference: m2, m.
        derivatives: per rad and per unit Mach.
        density_gradient: let density and speed of sound change with height. False gives the thesis's uniform air.
        gyroscopic: keep the gyroscopic moments. False drops them, as the thesis's linearisation does.

    Raises:
        InputError: the flight point has no CL or CD, or a reference length is 0.
    """
    rates = equilibrium_rates(point, mass.mass, reference.area)
    force = point.dynamic_pressure * reference.area
    if force * reference.span * reference.chord == 0.0:
        raise InputError("reference area, chord and span must be above 0")
    lengths = np.array([reference.span, reference.chord, reference.span])
    moments = np.array(coupling(mass, rates.p, rates.q, rates.r)) / (force * lengths)
    trim = tuple(float(-value) if gyroscopic else 0.0 for value in moments)
    return FlightModel(
        point=point,
        mass=mass,
        reference=reference,
        derivatives=derivatives,
        inputs=(*derivatives.available_controls(), *MOMENT_INPUTS),
        rates=rates,
        trim=trim,  # type: ignore[arg-type]
        air=air_gradient(point.altitude) if density_gradient else AirGradient(0.0, 0.0),
        gyroscopic=gyroscopic,
    )


def state_rates(state: Sequence[complex], inputs: Sequence[complex], model: FlightModel) -> np.ndarray:
    """Time derivatives of the nine states; complex arguments are allowed, so that the complex step can differentiate.

    Args:
        state: [9] V, gamma, R, p, q, r, alpha, beta, sigma.
        inputs: [input] perturbations of the inputs of the model.
        model: vehicle at its flight point.

    Returns:
        [9] time derivatives, SI units.
    """
    V, gamma, R, p, q, r, alpha, beta, sigma = state
    mass, ref = model.mass, model.reference
    g = c.STANDARD_GRAVITY * (c.EARTH_RADIUS / R) ** 2
    force, alpha_dot, coefficients = _aerodynamics(np.asarray(state), np.asarray(inputs), g, model)
    CD, CL, CY, Cl, Cm, Cn = coefficients
    D, L, Y = force * CD, force * CL, force * CY
    Mx, My, Mz = force * ref.span * Cl, force * ref.chord * Cm, force * ref.span * Cn
    if len(inputs):
        Mx, My, Mz = Mx + inputs[-3], My + inputs[-2], Mz + inputs[-1]
    if model.gyroscopic:
        spin = coupling(mass, p, q, r)
        Mx, My, Mz = Mx + spin[0], My + spin[1], Mz + spin[2]
    Mx, Mz = primed(mass, Mx, Mz)
    roll_stability = p * np.cos(alpha) + r * np.sin(alpha)
    pull = L / (mass.mass * V) - g / V * np.cos(gamma) * np.cos(sigma)
    turn = (L * np.sin(sigma) + Y * np.cos(sigma)) / (mass.mass * V)
    return np.array(
        [
            -D / mass.mass - g * np.sin(gamma),
            (L * np.cos(sigma) - Y * np.sin(sigma)) / (mass.mass * V) - (g / V - V / R) * np.cos(gamma),
            V * np.sin(gamma),
            Mx / mass.Ixx,
            My / mass.Iyy,
            Mz / mass.Izz,
            alpha_dot,
            p * np.sin(alpha) - r * np.cos(alpha) + Y / (mass.mass * V) + g / V * np.cos(gamma) * np.sin(sigma),
            roll_stability / np.cos(beta) + pull * np.tan(beta) + turn * np.tan(gamma),
        ]
    )


def _aerodynamics(state: np.ndarray, inputs: np.ndarray, g: complex, model: FlightModel) -> tuple:
    """(q S, dalpha/dt, (CD, CL, CY, Cl, Cm, Cn)); dalpha/dt here because lift may depend on it."""
    V, gamma, R, p, q, r, alpha, beta, sigma = state
    d, ref, point, rates = model.derivatives, model.reference, model.point, model.rates
    rise = R - point.radius
    density = point.ambient.density * np.exp(model.air.log_density * rise)
    sound = point.ambient.speed_of_sound + model.air.speed_of_sound * rise
    force = 0.5 * density * V**2 * ref.area
    attack, mach = alpha - point.alpha, V / sound - point.mach
    roll, yaw = (ref.span / 2 * (rate / V - steady / point.velocity) for rate, steady in ((p, rates.p), (r, rates.r)))
    pitch = ref.chord / 2 * (q / V - rates.q / point.velocity)
    CL0, CD0 = point.coefficients()
    trim_roll, trim_pitch, trim_yaw = model.trim
    control = {name: model.control_column(name) @ inputs if len(inputs) else 0.0 for name in COEFFICIENTS}
    CD = CD0 + d.CD_alpha * attack + d.CD_M * mach + control["CD"]
    CL = CL0 + d.CL_alpha * attack + d.CL_M * mach + d.CL_q * pitch + control["CL"]
    CY = d.CY_beta * beta + d.CY_p * roll + d.CY_r * yaw + control["CY"]
    Cl = trim_roll + d.Cl_beta * beta + d.Cl_p * roll + d.Cl_r * yaw + control["Cl"]
    Cm = trim_pitch + d.Cm_alpha * attack + d.Cm_M * mach + d.Cm_q * pitch + control["Cm"]
    Cn = trim_yaw + d.Cn_beta * beta + d.Cn_p * roll + d.Cn_r * yaw + control["Cn"]
    # Lift changes with dalpha/dt and dalpha/dt with lift: one linear equation for dalpha/dt.
    momentum = model.mass.mass * V * np.cos(beta)
    explicit = (
        q
        - (p * np.cos(alpha) + r * np.sin(alpha)) * np.tan(beta)
        - (force * CL - model.mass.mass * g * np.cos(gamma) * np.cos(sigma)) / momentum
    )
    alpha_dot = explicit / (1.0 + force * ref.chord * d.CL_alphadot / (2 * V * momentum))
    lag = alpha_dot * ref.chord / (2 * V)
    return force, alpha_dot, (CD, CL + d.CL_alphadot * lag, CY, Cl, Cm + d.Cm_alphadot * lag, Cn)
