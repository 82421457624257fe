"""The state matrix of the thesis's Appendix A as printed, for reproduction only.

Three things of it are not right and are kept on purpose: the side force has the sign that amplifies sideslip
(`CY_beta` stands for the printed C_S,beta), a_sigma,gamma lacks 1/cos2(gamma), and the gyroscopic and turning-rate
terms of the rotation are left out. The roll and yaw rates and the sideslip have the opposite sense of this project's
body axes (the thesis's point aft, right and up), which leaves the eigenvalues alone. a_beta,R is missing in Appendix
A but stands in the matrix of section 3.3; it is taken from (3.25). The thesis neglects products of inertia (section
3.3): `spaceplane.dynamics.linearise` refuses `Ixz` in this form.
"""

from __future__ import annotations

import numpy as np

from spaceplane.aero.model.derivatives import Derivatives
from spaceplane.dynamics.flightpoint import FlightPoint, equilibrium_rates
from spaceplane.dynamics.statespace import MOMENT_INPUTS, STATES, StateSpace
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

INPUTS = ("elevator", "aileron", "rudder", *MOMENT_INPUTS)


def state_space(
    point: FlightPoint, mass: MassProperties, reference: ReferenceLengths, derivatives: Derivatives
) -> StateSpace:
    """A (equations A.1 to A.43) and B (A.44 to A.59) at a flight point with CL and CD; SI units and rad.

    Args:
        point: flight point with CL and CD.
        mass: kg, kg m2.
        reference: m2, m.
        derivatives: per rad and per unit Mach number.
    """
    A = np.zeros((9, 9))
    _translation(A, point, mass, reference, derivatives)
    _rotation(A, point, mass, reference, derivatives)
    _attitude(A, point, mass, reference, derivatives)
    rates = equilibrium_rates(point, mass.mass, reference.area)
    values = (
        point.velocity,
        point.gamma,
        point.radius,
        -rates.p,
        rates.q,
        -rates.r,
        point.alpha,
        point.beta,
        point.bank,
    )
    B = _control(point, mass, reference, derivatives)
    return StateSpace(A, B, STATES, INPUTS, "thesis", dict(zip(STATES, values, strict=True)))


def _forces(point: FlightPoint, reference: ReferenceLengths) -> tuple[float, float, float]:
    """(q S, L, D), N."""
    force = point.dynamic_pressure * reference.area
    CL, CD = point.coefficients()
    return force, force * CL, force * CD


def _translation(
    A: np.ndarray, point: FlightPoint, mass: MassProperties, reference: ReferenceLengths, d: Derivatives
) -> None:
    V, gamma, R = 0, 1, 2
    alpha, beta, sigma = 6, 7, 8
    m, V0, R0, g0, M0 = mass.mass, point.velocity, point.radius, point.gravity, point.mach
    qS, L0, D0 = _forces(point, reference)
    sin_g, cos_g = np.sin(point.gamma), np.cos(point.gamma)
    sin_s, cos_s = np.sin(point.bank), np.cos(point.bank)
    gamma_dot = L0 * cos_s / (m * V0) - (g0 / V0 - V0 / R0) * cos_g  # (3.7) without the Earth's rotation
    A[V, V] = -(M0 * d.CD_M * qS + 2 * D0) / (m * V0)  # A.1
    A[V, gamma] = -g0 * cos_g  # A.2
    A[V, R] = 2 * g0 / R0 * sin_g  # A.3
    A[V, alpha] = -d.CD_alpha * qS / m  # A.4
    A[gamma, V] = (-gamma_dot + 2 * V0 / R0 * cos_g) / V0 + cos_s / (m * V0**2) * (M0 * d.CL_M * qS + 2 * L0)  # A.6
    A[gamma, gamma] = -(V0 / R0 - g0 / V0) * sin_g  # A.7
    A[gamma, R] = (2 * g0 / V0 - V0 / R0) * cos_g / R0  # A.8
    A[gamma, alpha] = cos_s / (m * V0) * d.CL_alpha * qS  # A.9
    A[gamma, beta] = -sin_s / (m * V0) * d.CY_beta * qS  # A.10
    A[gamma, sigma] = -L0 / (m * V0) * sin_s  # A.11
    A[R, V] = sin_g  # A.13
    A[R, gamma] = V0 * cos_g  # A.14


def _rotation(
    A: np.ndarray, point: FlightPoint, mass: MassProperties, reference: ReferenceLengths, d: Derivatives
) -> None:
    V, p, q, r, alpha, beta = 0, 3, 4, 5, 6, 7
    qS = _forces(point, reference)[0]
    A[p, beta] = d.Cl_beta * qS * reference.span / mass.Ixx  # A.16
    A[q, V] = point.mach / (mass.Iyy * point.velocity) * d.Cm_M * qS * reference.chord  # A.18
    A[q, alpha] = d.Cm_alpha * qS * reference.chord / mass.Iyy  # A.19
    A[r, beta] = d.Cn_beta * qS * reference.span / mass.Izz  # A.21


def _attitude(
    A: np.ndarray, point: FlightPoint, mass: MassProperties, reference: ReferenceLengths, d: Derivatives
) -> None:
    V, gamma, R, p, q, r, alpha, beta, sigma = range(9)
    m, V0, R0, g0, M0 = mass.mass, point.velocity, point.radius, point.gravity, point.mach
    qS, L0, _ = _forces(point, reference)
    sin_g, cos_g, tan_g = np.sin(point.gamma), np.cos(point.gamma), np.tan(point.gamma)
    sin_s, cos_s = np.sin(point.bank), np.cos(point.bank)
    sin_a, cos_a = np.sin(point.alpha), np.cos(point.alpha)
    lift = (M0 * d.CL_M * qS + L0) / (m * V0**2)
    A[alpha, V] = -g0 / V0**2 * cos_g * cos_s - lift  # A.23
    A[alpha, gamma] = -g0 / V0 * sin_g * cos_s  # A.24
    A[alpha, R] = -2 * g0 / (R0 * V0) * cos_g * cos_s  # A.25
    A[alpha, q] = 1.0  # A.26
    A[alpha, alpha] = -d.CL_alpha * qS / (m * V0)  # A.27
    A[alpha, sigma] = -g0 / V0 * cos_g * sin_s  # A.28
    A[beta, V] = g0 / V0**2 * cos_g * sin_s  # A.30
    A[beta, gamma] = g0 / V0 * sin_g * sin_s  # A.31
    A[beta, R] = 2 * g0 / (R0 * V0) * cos_g * sin_s  # (3.25)
    A[beta, p] = sin_a  # A.32
    A[beta, r] = -cos_a  # A.33
    A[beta, beta] = -d.CY_beta * qS / (m * V0)  # A.34
    A[beta, sigma] = -g0 / V0 * cos_g * cos_s  # A.35
    A[sigma, V] = tan_g * sin_s * lift  # A.37
    A[sigma, gamma] = L0 / (m * V0) * sin_s  # A.37
    A[sigma, p] = -cos_a  # A.38
    A[sigma, r] = -sin_a  # A.39
    A[sigma, alpha] = tan_g * sin_s / (m * V0) * d.CL_alpha * qS  # A.40
    A[sigma, beta] = tan_g * cos_s / (m * V0) * d.CY_beta * qS - L0 / (m * V0) + g0 / V0 * cos_g * cos_s  # A.41
    A[sigma, sigma] = tan_g * cos_s * L0 / (m * V0)  # A.42


def _control(point: FlightPoint, mass: MassProperties, reference: ReferenceLengths, d: Derivatives) -> np.ndarray:
    qS = _forces(point, reference)[0]
    p, q, r = 3, 4, 5
    B = np.zeros((9, len(INPUTS)))
    column = {name: k for k, name in enumerate(INPUTS)}
    B[p, column["aileron"]] = d.control("Cl", "aileron") * qS * reference.span / mass.Ixx  # A.47
    B[p, column["moment_x"]] = 1 / mass.Ixx  # A.48
    B[q, column["elevator"]] = d.control("Cm", "elevator") * qS * reference.chord / mass.Iyy  # A.50
    B[q, column["moment_y"]] = 1 / mass.Iyy  # A.51
    B[r, column["aileron"]] = d.control("Cn", "aileron") * qS * reference.span / mass.Izz  # A.53
    B[r, column["rudder"]] = d.control("Cn", "rudder") * qS * reference.span / mass.Izz  # A.54
    B[r, column["moment_z"]] = 1 / mass.Izz  # A.55
    return B
