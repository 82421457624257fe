"""Flight without power along given altitudes: the lift, bank and path angle that it takes.

Quasi-equilibrium glide (N. X. Vinh, A. Busemann, R. D. Culp, Hypersonic and Planetary Entry Flight Mechanics, 1980,
chapter 7): the lift that is not turned sideways carries what the path's curvature leaves of the weight.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from scipy.optimize import brentq

from spaceplane.dynamics.flightpoint import TRAJECTORY_ALTITUDE, FlightPoint, trajectory_altitude
from spaceplane.environment.atmosphere import us1976
from spaceplane.errors import InputError

STEP = 0.05
"""Share of the Mach number to each side over which the slope of the tabulated altitudes is taken: they are coarse."""


def glide_lift_coefficient(point: FlightPoint, mass: float, area: float) -> float:
    """Lift coefficient that keeps the flight-path angle: L cos(sigma) = m (g - V^2/R) cos(gamma).

    Raises:
        InputError: the bank angle is 90 deg or more, where no lift holds the path.
    """
    if abs(math.degrees(point.bank)) >= 89.0:
        raise InputError(f"bank_deg = {math.degrees(point.bank):.4g}: equilibrium glide needs less than 89 deg")
    weight = mass * (point.gravity - point.velocity**2 / point.radius) * math.cos(point.gamma)
    return weight / (point.dynamic_pressure * area * math.cos(point.bank))


def glide_alpha(
    point: FlightPoint,
    mass: float,
    area: float,
    lift_coefficient: Callable[[float], float],
    lower_deg: float = -5.0,
    upper_deg: float = 45.0,
) -> float:
    """Angle of attack, rad, of the equilibrium glide at the point's Mach number, altitude, path and bank angle.

    Args:
        point: flight point; its own angle of attack is not used.
        mass: kg.
        area: reference area, m2.
        lift_coefficient: CL as a function of the angle of attack, rad.
        lower_deg: least angle of attack tried, deg.
        upper_deg: greatest angle of attack tried, deg.

    Raises:
        InputError: the lift needed is not reached between the two angles.
    """
    needed = glide_lift_coefficient(point, mass, area)
    lower, upper = math.radians(lower_deg), math.radians(upper_deg)
    low, high = lift_coefficient(lower) - needed, lift_coefficient(upper) - needed
    if not low * high < 0:
        raise InputError(
            f"{point.name}: no equilibrium glide, CL = {needed:.4g} is needed and CL runs from {low + needed:.4g} to "
            f"{high + needed:.4g} between {lower_deg:g} and {upper_deg:g} deg"
        )
    return float(brentq(lambda alpha: lift_coefficient(alpha) - needed, lower, upper, xtol=1e-10))


def glide_bank(point: FlightPoint, mass: float, area: float) -> float:
    """Bank angle, rad, that keeps the path angle of a point with its CL: what lift is left over turns sideways.

    0 where all lift upwards is too little, so that the path steepens. Above 90 deg where the vehicle is faster than a
    circular orbit.

    Args:
        point: flight point with CL; its own bank angle is not used.
        mass: kg.
        area: reference area, m2.
    """
    lift = point.dynamic_pressure * area * point.coefficients()[0]
    weight = mass * (point.gravity - point.velocity**2 / point.radius) * math.cos(point.gamma)
    return math.acos(max(weight / lift, -1.0)) if lift > abs(weight) or weight < 0.0 < lift else 0.0


def glide_path_angle(point: FlightPoint, mass: float, area: float, height_per_speed: float) -> float:
    """Path angle, rad, on which drag takes the speed away as fast as the descent goes through its altitudes.

    From dV/dt = -D/m - g sin(gamma) and dh/dt = V sin(gamma): sin(gamma) = -h' D / (m (V + g h')), h' = dh/dV.

    Args:
        point: flight point with CD; its own path angle is not used.
        mass: kg.
        area: reference area, m2.
        height_per_speed: slope dh/dV of the altitudes flown through, m per m/s.

    Raises:
        InputError: altitudes that no glide follows.
    """
    drag = point.dynamic_pressure * area * point.coefficients()[1] / mass
    speed = point.velocity + point.gravity * height_per_speed
    sine = -height_per_speed * drag / speed if speed > 0.0 else math.nan
    if not abs(sine) < 1.0:
        raise InputError(f"{point.name}: no glide follows altitudes that rise by {height_per_speed:.4g} m per m/s")
    return math.asin(sine)


def tabulated_slope(mach: float) -> float:
    """Slope dh/dV, m per m/s, of the altitudes of thesis Table 4.1.

    Raises:
        InputError: a Mach number outside the table.
    """
    machs = list(TRAJECTORY_ALTITUDE)
    trajectory_altitude(mach)
    ends = max((1.0 - STEP) * mach, machs[0]), min((1.0 + STEP) * mach, machs[-1])
    heights = [trajectory_altitude(m) for m in ends]
    speeds = [m * us1976(h).speed_of_sound for m, h in zip(ends, heights, strict=True)]
    return (heights[1] - heights[0]) / (speeds[1] - speeds[0])
