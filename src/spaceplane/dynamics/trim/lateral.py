"""Trim about all three axes: in steady flight with bank, with sideslip, or with failed surfaces.

In steady flight the body turns as the trajectory does. With L, Y lift and side force, s the bank and c the path angle,
the trajectory axes turn at

    (-w tan c, (L cos s - Y sin s) / (m V) - (g / V) cos c, w),   w = (L sin s + Y cos s) / (m V)

(see `spaceplane.dynamics.equations`), which gives body rates, damping moments and gyroscopic moments; surfaces must
balance them. A straight flight has w = 0, so that tan s = -Y / L. Speed and height need not be steady, as in a descent.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from spaceplane.aero.model.model import AeroModel, OutsideTables
from spaceplane.dynamics.flightpoint import AngularRates, FlightPoint
from spaceplane.dynamics.frames import body_to_wind, wind_to_trajectory
from spaceplane.dynamics.inertia import coupling
from spaceplane.dynamics.trim.allocation import MOMENTS, Allocation, allocate
from spaceplane.dynamics.trim.effects import Limits
from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

_ITERATIONS = 60
_SETTLED = 1e-11  # change of CL and CY


@dataclass(frozen=True)
class LateralTrim:
    """Steady flight, or why there is none.

    Attributes:
        allocation: deflections and coefficients; None where the condition is outside the tables.
        beta, bank: rad.
        rates: body rates, rad/s.
        reason: why it is not trimmed; empty where it is.
        external: Cl, Cm, Cn of moments from elsewhere that the surfaces had to balance.
    """

    allocation: Allocation | None
    beta: float
    bank: float
    rates: AngularRates
    reason: str = ""
    external: Mapping[str, float] = field(default_factory=dict)

    @property
    def found(self) -> bool:
        """Whether all moments are balanced within limits."""
        return not self.reason


def steady_rates(
    point: FlightPoint,
    mass: float,
    area: float,
    CL: float,
    CY: float = 0.0,
    beta: float = 0.0,
    bank: float | None = None,
) -> AngularRates:
    """Body rates, rad/s, that keep angle of attack, sideslip and bank.

    Args:
        point: flight point; its own coefficients are not used.
        mass: kg.
        area: reference area, m2.
        CL, CY: lift and side-force coefficient.
        beta: sideslip, rad.
        bank: rad; the point's by default.
    """
    bank = point.bank if bank is None else bank
    scale = point.dynamic_pressure * area / (mass * point.velocity)
    sideways = scale * (CL * math.sin(bank) + CY * math.cos(bank))
    upwards = scale * (CL * math.cos(bank) - CY * math.sin(bank))
    gravity = point.gravity / point.velocity * math.cos(point.gamma)
    turning = np.array([-sideways * math.tan(point.gamma), upwards - gravity, sideways])
    body = body_to_wind(point.alpha, beta).T @ wind_to_trajectory(bank).T @ turning
    return AngularRates(*body.tolist())


def gyroscopic_moments(
    point: FlightPoint, mass: MassProperties, reference: ReferenceLengths, rates: AngularRates
) -> dict[str, float]:
    """Cl, Cm and Cn that keep body rates steady: those of omega x (I omega).

    Args:
        point: flight point.
        mass: kg, kg m2.
        reference: m2, m.
        rates: rad/s.
    """
    force = point.dynamic_pressure * reference.area
    roll, pitch, yaw = coupling(mass, rates.p, rates.q, rates.r)
    return {
        "Cl": -roll / (force * reference.span),
        "Cm": -pitch / (force * reference.chord),
        "Cn": -yaw / (force * reference.span),
    }


def trim_lateral(
    model: AeroModel,
    point: FlightPoint,
    mass: MassProperties,
    beta: float | None = 0.0,
    straight: bool = False,
    held: Mapping[str, float] | None = None,
    limits: Limits | None = None,
    external: Mapping[str, float] | None = None,
) -> LateralTrim:
    """Deflections of steady flight at a point's Mach number, angle of attack, path angle and bank.

    Args:
        model: aerodynamics about the centre of mass.
        point: flight point; its own CL and CD are not used.
        mass: kg, kg m2.
        beta: sideslip, rad; None asks for the one without side force (a coordinated turn).
        straight: find the bank that keeps the heading, instead of the point's.
        held: surfaces that cannot move, rad: failed, or set by a schedule.
        limits: narrower than those of the tables, rad.
        external: moments that are not the model's, such as those of thrust to one side, as coefficients Cl, Cm, Cn.

    Raises:
        InputError: an unknown surface or moment, a value that is not finite, or no lift to bank with.
    """
    if beta is not None and not math.isfinite(beta):
        raise InputError(f"beta = {beta}: must be a finite number")
    external = _checked_moments(external or {})
    ref = model.reference
    wanted_force = {} if beta is not None else {"CY": 0.0}
    lengths = np.array([ref.span, ref.chord, ref.span])
    bank, rates = point.bank, AngularRates(0.0, 0.0, 0.0)
    allocation = None
    try:
        found = model.coefficients(point.mach, point.alpha, beta or 0.0)
        CL, CY = found["CL"], found["CY"] if beta is not None else 0.0
        for _ in range(_ITERATIONS):
            if straight:
                if CL == 0.0:
                    raise InputError(
                        f"alpha = {math.degrees(point.alpha):g} deg: no lift, so no bank keeps the heading"
                    )
                bank = math.atan(-CY / CL)
            angle = beta if allocation is None else allocation.beta
            rates = steady_rates(point, mass.mass, ref.area, CL, CY, angle or 0.0, bank)
            reduced = np.array([rates.p, rates.q, rates.r]) * lengths / (2.0 * point.velocity)
            needed = gyroscopic_moments(point, mass, ref, rates)
            wanted = {name: value - external.get(name, 0.0) for name, value in needed.items()} | wanted_force
            allocation = allocate(model, point.mach, point.alpha, wanted, beta, tuple(reduced.tolist()), held, limits)
            new = allocation.coefficients["CL"], allocation.coefficients["CY"]
            moved = max(abs(new[0] - CL), abs(new[1] - CY))
            CL, CY = new
            if moved < _SETTLED:
                break
        else:
            if allocation.found:
                return LateralTrim(
                    allocation, allocation.beta, bank, rates, "lift and turning rate do not settle", external
                )
    except OutsideTables as error:
        return LateralTrim(None, beta or 0.0, bank, rates, f"outside the tables: {error}", external)
    return LateralTrim(allocation, allocation.beta, bank, rates, allocation.reason, external)


def _checked_moments(external: Mapping[str, float]) -> dict[str, float]:
    for name, value in external.items():
        if name not in MOMENTS:
            raise InputError(unknown_name("moment", name, MOMENTS))
        if not math.isfinite(value):
            raise InputError(f"external {name} = {value}: must be a finite number")
    return dict(external)


def balanced(
    trim: LateralTrim, point: FlightPoint, mass: MassProperties, reference: ReferenceLengths
) -> dict[str, float]:
    """What the moments of a trim leave over, as coefficients: zero where it is found.

    Args:
        trim: as found.
        point: flight point.
        mass: kg, kg m2.
        reference: m2, m.
    """
    if trim.allocation is None:
        return dict.fromkeys(MOMENTS, math.nan)
    needed = gyroscopic_moments(point, mass, reference, trim.rates)
    given = trim.allocation.coefficients
    return {name: given[name] + trim.external.get(name, 0.0) - needed[name] for name in MOMENTS}
