"""Euler's equations of a body with the product of inertia I_xz (body axes x forward, y right, z down).

    Ixx dp/dt - Ixz dr/dt = Mx + (Iyy - Izz) q r + Ixz p q
    Iyy dq/dt             = My + (Izz - Ixx) p r - Ixz (p^2 - r^2)
    Izz dr/dt - Ixz dp/dt = Mz + (Ixx - Iyy) p q - Ixz q r

Etkin and Reid, Dynamics of Flight, 3rd ed. (1996), section 4.5.
"""

from __future__ import annotations

from typing import TypeVar

from spaceplane.vehicle.properties import MassProperties

Number = TypeVar("Number")  # a real or complex number, or an array of them


def coupling(mass: MassProperties, p: Number, q: Number, r: Number) -> tuple[Number, Number, Number]:
    """-omega x (I omega) about x, y, z, N m: what turns the body beside the moments that act on it.

    Args:
        mass: kg m2.
        p, q, r: body rates, rad/s.
    """
    return (
        (mass.Iyy - mass.Izz) * q * r + mass.Ixz * p * q,
        (mass.Izz - mass.Ixx) * p * r - mass.Ixz * (p * p - r * r),
        (mass.Ixx - mass.Iyy) * p * q - mass.Ixz * q * r,
    )


def primed(mass: MassProperties, roll: Number, yaw: Number) -> tuple[Number, Number]:
    """The moments about x and z that would turn a body of the same Ixx and Izz in the same way without I_xz.

    dp/dt is the first over Ixx, dr/dt the second over Izz. In straight flight derivatives may be primed instead of
    the equations: Cl' = (Cl + Ixz/Izz Cn) / (1 - Ixz^2/(Ixx Izz)), and Cn' with Ixx and Cl in their place.

    Args:
        mass: kg m2.
        roll, yaw: moments about x and z, N m, or their coefficients on the span.
    """
    share = 1.0 - mass.Ixz**2 / (mass.Ixx * mass.Izz)
    return (roll + mass.Ixz / mass.Izz * yaw) / share, (yaw + mass.Ixz / mass.Ixx * roll) / share
