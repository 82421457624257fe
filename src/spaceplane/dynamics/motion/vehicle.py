"""The vehicle that moves: mass, full inertia tensor and where its aerodynamic coefficients come from."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from spaceplane.errors import InputError
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths


class Aerodynamics(Protocol):
    """What the equations of motion ask of an aerodynamic model.

    Attributes:
        reference: area, chord, span; the moment centre is taken as the centre of mass.

    A model may have a further attribute `lag`, (CL_alphadot, Cm_alphadot) on dalpha/dt c/2V: see `lag_of`.
    """

    reference: ReferenceLengths

    def coefficients(
        self,
        mach: float,
        alpha: float,
        beta: float = 0.0,
        rates: tuple[float, float, float] = (0.0, 0.0, 0.0),
        deflections: Mapping[str, float] | None = None,
    ) -> Mapping[str, float]:
        """CL, CD, CY (wind axes), Cl, Cm, Cn (body axes); angles in rad, rates p b/2V, q c/2V, r b/2V.

        Raises:
            InputError: outside of what the model knows; it must never extrapolate.
        """
        ...


def lag_of(aerodynamics: Aerodynamics) -> tuple[float, float]:
    """(CL_alphadot, Cm_alphadot) of a model, on dalpha/dt c/2V; 0 where it has none."""
    return getattr(aerodynamics, "lag", (0.0, 0.0))


@dataclass(frozen=True)
class Vehicle:
    """A rigid vehicle of constant mass.

    Attributes:
        mass: kg.
        inertia: [3, 3] kg m2 about the centre of mass in body axes (x forward, y right, z down); off the diagonal the
            products of inertia with a minus sign.
        aerodynamics: None for a body in vacuum.
        inverse: [3, 3] of the inertia, 1/(kg m2).

    Raises:
        InputError: no positive mass, or an inertia that is not symmetric or that of no rigid body.
    """

    mass: float
    inertia: np.ndarray
    aerodynamics: Aerodynamics | None = None
    inverse: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        if not (math.isfinite(self.mass) and self.mass > 0):
            raise InputError(f"mass = {self.mass} kg: must be above 0")
        inertia = np.array(self.inertia, dtype=float)
        if inertia.shape != (3, 3) or not np.all(np.isfinite(inertia)):
            raise InputError("inertia: must be 3 x 3 finite numbers, kg m2")
        if not np.allclose(inertia, inertia.T, rtol=1e-12, atol=1e-12 * np.abs(inertia).max()):
            raise InputError("inertia: must be symmetric")
        small, middle, large = np.linalg.eigvalsh(inertia)
        if not (small > 0 and small + middle >= large * (1 - 1e-12)):
            raise InputError(
                f"inertia: principal moments {small:.6g}, {middle:.6g}, {large:.6g} kg m2 are those of no rigid body"
            )
        inertia.flags.writeable = False
        object.__setattr__(self, "inertia", inertia)
        object.__setattr__(self, "inverse", np.linalg.inv(inertia))


def rigid_vehicle(
    mass: MassProperties,
    aerodynamics: Aerodynamics | None = None,
    products: tuple[float, float, float] | None = None,
) -> Vehicle:
    """A vehicle from its mass properties.

    Args:
        mass: kg and kg m2.
        aerodynamics: coefficients about the centre of mass; None in vacuum.
        products: products of inertia (Ixy, Ixz, Iyz), kg m2, such as Ixz = integral of x z dm; by default
            (0, `mass.Ixz`, 0).

    Raises:
        InputError: moments and products are those of no rigid body.
    """
    Ixy, Ixz, Iyz = (0.0, mass.Ixz, 0.0) if products is None else products
    tensor = np.array([[mass.Ixx, -Ixy, -Ixz], [-Ixy, mass.Iyy, -Iyz], [-Ixz, -Iyz, mass.Izz]])
    return Vehicle(mass.mass, tensor, aerodynamics)


def angular_acceleration(vehicle: Vehicle, omega: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """[3] d(p, q, r)/dt, rad/s2, by Euler's equations (3.13) of the thesis with the full inertia tensor.

    Args:
        vehicle: with its inertia.
        omega: [3] angular velocity against inertial space, body axes, rad/s.
        moment: [3] about the centre of mass, body axes, N m.
    """
    momentum = vehicle.inertia @ omega
    p, q, r = omega
    x, y, z = momentum
    gyroscopic = np.array([q * z - r * y, r * x - p * z, p * y - q * x])
    return vehicle.inverse @ (moment - gyroscopic)
