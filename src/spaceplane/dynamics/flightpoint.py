"""Flight points: where, how fast and in which attitude the vehicle flies, and the turning rates that hold it there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from spaceplane.environment import constants as c
from spaceplane.environment.atmosphere import Ambient, from_pressure_temperature, us1976
from spaceplane.errors import InputError

# Altitudes of thesis Table 4.1 (m) by Mach number, read as geometric altitudes. The pressures that the thesis prints
# beside them are those of geopotential altitudes, 1.5 % lower at 25 km; ours follow from the atmosphere.
TRAJECTORY_ALTITUDE = {
    0.8: 13_000.0,
    1.0: 16_000.0,
    1.2: 18_000.0,
    1.5: 20_000.0,
    2.0: 22_500.0,
    2.5: 25_000.0,
    5.0: 38_000.0,
    7.5: 48_000.0,
    10.0: 53_000.0,
    15.0: 60_000.0,
    20.0: 70_000.0,
    25.0: 75_000.0,
}

# Angle of attack by Mach number, deg. 16.6 at Mach 2.5 is the thesis's (Table 6.1); 40 at entry is HORUS-2B's (Mooij,
# M-692, 1995). Between and below, the thesis prints nothing: the values are this project's choice, in the manner of the
# Space Shuttle, whose angle of attack falls with the Mach number from 40 deg to about 14 deg at the TAEM interface
# and on to about 10 deg or less at subsonic speed.
ALPHA_SCHEDULE = ((0.8, 10.0), (1.5, 12.0), (2.5, 16.6), (5.0, 24.0), (10.0, 36.0), (12.0, 40.0), (25.0, 40.0))
ALPHA_SOURCE_THESIS = "thesis Table 6.1"
ALPHA_SOURCE_SCHEDULE = "Shuttle-like schedule through 16.6 deg at Mach 2.5 (the thesis prints no other value)"

# Flight-path angle and bank angle of thesis Table 6.1, deg, used at every Mach number: it prints no others.
TAEM_GAMMA_DEG = -8.4
TAEM_BANK_DEG = 55.0
TAEM_MACH = (0.8, 1.5, 2.5)


@dataclass(frozen=True)
class FlightPoint:
    """A steady banked flight condition, SI units and rad.

    Attributes:
        name: label, for example "Mach 2.5".
        mach: Mach number.
        ambient: undisturbed air, with the altitude.
        alpha: angle of attack, nose up positive.
        gamma: flight-path angle, climbing positive.
        bank: bank angle, right wing down positive.
        CL: lift coefficient at the point; None until it is known.
        CD: drag coefficient at the point; None until it is known.
        beta: sideslip, wind from the right positive.
        alpha_source: where the angle of attack comes from.
    """

    name: str
    mach: float
    ambient: Ambient
    alpha: float
    gamma: float
    bank: float
    CL: float | None = None
    CD: float | None = None
    beta: float = 0.0
    alpha_source: str = "given"

    def __post_init__(self) -> None:
        for name in ("mach", "alpha", "gamma", "bank", "beta"):
            if not math.isfinite(getattr(self, name)):
                raise InputError(f"{name} = {getattr(self, name)}: must be a finite number")
        if self.mach <= 0:
            raise InputError(f"mach = {self.mach}: must be above 0")
        for name, limit in (("alpha", 90.0), ("gamma", 89.0), ("bank", 180.0)):
            degrees = math.degrees(getattr(self, name))
            if abs(degrees) > limit + 1e-9:
                raise InputError(f"{name}_deg = {degrees:.6g}: must lie between -{limit:g} and {limit:g}")
        if self.beta != 0.0:
            raise InputError(f"beta = {self.beta}: a flight point has no sideslip")

    @property
    def altitude(self) -> float:
        """Geometric altitude, m."""
        return self.ambient.altitude

    @property
    def velocity(self) -> float:
        """Airspeed, m/s."""
        return self.mach * self.ambient.speed_of_sound

    @property
    def dynamic_pressure(self) -> float:
        """Pa."""
        return 0.5 * self.ambient.density * self.velocity**2

    @property
    def radius(self) -> float:
        """Distance from the Earth's centre, m."""
        return c.EARTH_RADIUS + self.ambient.altitude

    @property
    def gravity(self) -> float:
        """m/s2."""
        return c.gravity(self.radius)

    def with_coefficients(self, CL: float, CD: float) -> FlightPoint:
        """The same point with its lift and drag coefficients."""
        return replace(self, CL=float(CL), CD=float(CD))

    def coefficients(self) -> tuple[float, float]:
        """(CL, CD), both on dynamic pressure and reference area.

        Raises:
            InputError: one of them is missing or not finite.
        """
        for name in ("CL", "CD"):
            value = getattr(self, name)
            if value is None or not math.isfinite(value):
                raise InputError(f"{name} = {value}: the flight point {self.name!r} needs a finite value")
        return float(self.CL), float(self.CD)  # type: ignore[arg-type]


@dataclass(frozen=True)
class AngularRates:
    """Body rates p, q, r, rad/s, in body axes (x forward, y right, z down)."""

    p: float
    q: float
    r: float


def flight_point(
    mach: float,
    altitude_m: float,
    alpha_deg: float,
    gamma_deg: float = 0.0,
    bank_deg: float = 0.0,
    CL: float | None = None,
    CD: float | None = None,
    pressure_Pa: float | None = None,
    temperature_K: float | None = None,
    name: str = "",
    alpha_source: str = "given",
) -> FlightPoint:
    """A flight point from the quantities users give, angles in degrees.

    The air is the US 1976 atmosphere's at `altitude_m`; a pressure or temperature given replaces the standard's.

    Args:
        mach: Mach number.
        altitude_m: geometric altitude, m.
        alpha_deg, gamma_deg, bank_deg: angle of attack, flight-path angle (climb positive) and bank angle, deg.
        CL, CD: lift and drag coefficient, where known.
        pressure_Pa, temperature_K: ambient state, where it is not the standard's.
        name: "Mach ..." by default.
        alpha_source: where the angle of attack comes from, for the report.

    Raises:
        InputError: a value is not finite or outside its limits.
    """
    if pressure_Pa is None and temperature_K is None:
        ambient = us1976(altitude_m)
    else:
        standard = us1976(altitude_m) if pressure_Pa is None or temperature_K is None else None
        ambient = from_pressure_temperature(
            altitude_m,
            standard.pressure if pressure_Pa is None else pressure_Pa,  # type: ignore[union-attr]
            standard.temperature if temperature_K is None else temperature_K,  # type: ignore[union-attr]
        )
    return FlightPoint(
        name=name or f"Mach {mach:g}",
        mach=float(mach),
        ambient=ambient,
        alpha=math.radians(alpha_deg),
        gamma=math.radians(gamma_deg),
        bank=math.radians(bank_deg),
        CL=None if CL is None else float(CL),
        CD=None if CD is None else float(CD),
        alpha_source=alpha_source,
    )


def trajectory_altitude(mach: float) -> float:
    """Altitude, m, on the descent of thesis Table 4.1, linear between its points.

    Raises:
        InputError: the Mach number lies outside the table.
    """
    return _interpolate("altitude", tuple(TRAJECTORY_ALTITUDE.items()), mach)


def scheduled_alpha_deg(mach: float) -> float:
    """Angle of attack, deg, of `ALPHA_SCHEDULE`, linear between its points.

    Raises:
        InputError: the Mach number lies outside the table.
    """
    return _interpolate("angle of attack", ALPHA_SCHEDULE, mach)


def taem_point(
    mach: float,
    altitude_m: float | None = None,
    alpha_deg: float | None = None,
    gamma_deg: float = TAEM_GAMMA_DEG,
    bank_deg: float = TAEM_BANK_DEG,
) -> FlightPoint:
    """The point of the descent at a Mach number: altitude by Table 4.1, angle of attack by the schedule, unless given.

    Works at every Mach number of the tables, 0.8 to 25, so also for the hypersonic check at Mach 5 and 10.

    Args:
        mach: Mach number.
        altitude_m: m.
        alpha_deg, gamma_deg, bank_deg: angle of attack, flight-path angle and bank angle, deg.

    Raises:
        InputError: a Mach number outside the tables without the altitude or angle of attack that they would give.
    """
    if alpha_deg is not None:
        source = "given"
    else:
        alpha_deg = scheduled_alpha_deg(mach)
        source = ALPHA_SOURCE_THESIS if mach == 2.5 else ALPHA_SOURCE_SCHEDULE
    altitude = trajectory_altitude(mach) if altitude_m is None else altitude_m
    return flight_point(mach, altitude, alpha_deg, gamma_deg, bank_deg, alpha_source=source)


def equilibrium_rates(point: FlightPoint, mass: float, area: float) -> AngularRates:
    """Body rates that hold angle of attack, sideslip and bank constant in flight without side force.

    With them dalpha/dt = dbeta/dt = dsigma/dt = 0 in the equations of `spaceplane.dynamics.equations`. They are (3.27)
    to (3.29) of the thesis with p and r reversed, since its axes point aft and up.

    Args:
        point: flight point with CL.
        mass: kg.
        area: reference area, m2.
    """
    lift_rate = point.dynamic_pressure * area * point.coefficients()[0] / (mass * point.velocity)
    gravity_rate = point.gravity / point.velocity * math.cos(point.gamma)
    roll_wind = -lift_rate * math.tan(point.gamma) * math.sin(point.bank)
    yaw_wind = gravity_rate * math.sin(point.bank)
    cos_a, sin_a = math.cos(point.alpha), math.sin(point.alpha)
    return AngularRates(
        p=roll_wind * cos_a - yaw_wind * sin_a,
        q=lift_rate - gravity_rate * math.cos(point.bank),
        r=roll_wind * sin_a + yaw_wind * cos_a,
    )


def _interpolate(what: str, table: tuple[tuple[float, float], ...], mach: float) -> float:
    machs = [row[0] for row in table]
    if not machs[0] <= mach <= machs[-1]:
        raise InputError(
            f"mach = {mach}: the {what} table runs from Mach {machs[0]:g} to {machs[-1]:g}; give the value"
        )
    return float(np.interp(mach, machs, [row[1] for row in table]))
