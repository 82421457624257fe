"""What drives a mode: first-order change of eigenvalues with each aerodynamic derivative.

For A v = lambda v and w^H A = lambda w^H, d lambda / d theta = w^H (dA/d theta) v / (w^H v), exact to first order
(Lancaster 1964). dA/d theta is taken without subtraction by the complex step (Squire and Trapp 1998), C_L and C_D
included by central differences, which are exact too: A is quadratic in C_L and linear in C_D. Where two eigenvalues
meet, there is no derivative.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np
from scipy.linalg import eig

from spaceplane.aero.model.derivatives import DAMPING, STATIC, Derivatives
from spaceplane.dynamics.equations import flight_model
from spaceplane.dynamics.flightpoint import FlightPoint
from spaceplane.dynamics.linearise import analytic, linearise
from spaceplane.dynamics.modes import Mode
from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

AT_POINT = ("CL", "CD")
PARAMETERS = (*STATIC, *DAMPING, *AT_POINT)
"""What A depends on: control derivatives enter only B."""

_COMPLEX_STEP = 1e-30
# Left and right eigenvectors this close to orthogonal belong to a double eigenvalue.
_DEFECTIVE = 1e-9


@dataclass(frozen=True)
class ModeSensitivity:
    """How the eigenvalue of one mode changes.

    Attributes:
        mode: name of the mode.
        eigenvalue: 1/s.
        parameters: names, of `PARAMETERS`.
        values: [parameter] nominal values, per rad, per unit Mach or dimensionless.
        slopes: [parameter] complex d lambda / d parameter, 1/s per unit; NaN at a double eigenvalue.
    """

    mode: str
    eigenvalue: complex
    parameters: tuple[str, ...]
    values: np.ndarray
    slopes: np.ndarray

    def frequency_slopes(self) -> np.ndarray:
        """[parameter] change of the natural frequency |lambda|, rad/s per unit."""
        return (np.conj(self.eigenvalue) * self.slopes).real / abs(self.eigenvalue)

    def damping_slopes(self) -> np.ndarray:
        """[parameter] change of the damping ratio -Re(lambda)/|lambda| per unit."""
        size = abs(self.eigenvalue)
        return -self.slopes.real / size + self.eigenvalue.real * self.frequency_slopes() / size**2


@dataclass(frozen=True)
class Driver:
    """One parameter's part in a mode.

    Attributes:
        parameter: name.
        slope: d lambda / d parameter, 1/s per unit.
        per_percent: change of lambda, 1/s, by one per cent of the parameter's value.
        error: change of lambda, 1/s, by the half width of the parameter; None where none is given.
        share: of the sum over all parameters of |error|^2 or, without errors, of |per_percent|^2; a ratio.
    """

    parameter: str
    slope: complex
    per_percent: complex
    error: complex | None
    share: float


def matrix_slopes(
    point: FlightPoint,
    mass: MassProperties,
    reference: ReferenceLengths,
    derivatives: Derivatives,
    parameters: Sequence[str] = PARAMETERS,
    form: str = "rigid-body",
    density_gradient: bool = True,
    gyroscopic: bool = True,
) -> np.ndarray:
    """[parameter, state, state] dA/d parameter of the linear model at a flight point.

    Args:
        point: flight point with CL and CD.
        mass: kg, kg m2.
        reference: m2, m.
        derivatives: per rad and per unit Mach number.
        parameters: names, of `PARAMETERS`.
        form, density_gradient, gyroscopic: as for `spaceplane.dynamics.linearise.linearise`.

    Raises:
        InputError: an unknown parameter or form.
    """
    for name in parameters:
        if name not in PARAMETERS:
            raise InputError(unknown_name("parameter", name, PARAMETERS))
    options = (form, density_gradient, gyroscopic)

    def difference(name: str) -> np.ndarray:
        """Central difference; exact where A is at most quadratic in the parameter, so that the step may be large."""
        step = 0.1 * max(abs(value_of(name, point, derivatives)), 0.1)
        above, below = (
            linearise(moved_point, mass, reference, moved, *options).A
            for moved_point, moved in (moved_by({name: sign * step}, point, derivatives) for sign in (1.0, -1.0))
        )
        return (above - below) / (2.0 * step)

    def complex_step(name: str) -> np.ndarray:
        stepped = _complex(derivatives, name, 1j * _COMPLEX_STEP)
        model = flight_model(point, mass, reference, stepped, density_gradient, gyroscopic)
        return analytic(model).A.imag / _COMPLEX_STEP

    # the thesis's matrix is linear in every derivative
    exact = difference if form == "thesis" else complex_step
    return np.array([difference(name) if name in AT_POINT else exact(name) for name in parameters])


def eigenvalue_slopes(A: np.ndarray, slopes: np.ndarray, eigenvalue: complex) -> np.ndarray:
    """[parameter] d lambda / d parameter, 1/s per unit, of the eigenvalue of A [state, state] nearest to `eigenvalue`.

    Args:
        A: matrix, 1/s and mixed units.
        slopes: [parameter, state, state] dA/d parameter.
        eigenvalue: 1/s.
    """
    values, left, right = eig(A, left=True, right=True)
    k = int(np.argmin(np.abs(values - eigenvalue)))
    w, v = left[:, k].conj(), right[:, k]
    product = w @ v
    if abs(product) < _DEFECTIVE:
        return np.full(len(slopes), complex(np.nan, np.nan))
    return np.einsum("i,kij,j->k", w, slopes, v) / product


def sensitivities(
    A: np.ndarray, modes: Sequence[Mode], slopes: np.ndarray, parameters: Sequence[str], values: Sequence[float]
) -> tuple[ModeSensitivity, ...]:
    """Sensitivity of every mode.

    Args:
        A: [state, state] of the linear model.
        modes: its modes.
        slopes: of `matrix_slopes`.
        parameters: their names.
        values: nominal values of the parameters, per rad, per unit Mach number or dimensionless.
    """
    found = []
    for mode in modes:
        change = eigenvalue_slopes(A, slopes, mode.eigenvalue)
        if not mode.oscillatory:
            change = change.real.astype(complex)  # a simple real eigenvalue stays real
        found.append(
            ModeSensitivity(mode.name, mode.eigenvalue, tuple(parameters), np.asarray(values, dtype=float), change)
        )
    return tuple(found)


def of_model(
    point: FlightPoint,
    mass: MassProperties,
    reference: ReferenceLengths,
    derivatives: Derivatives,
    A: np.ndarray,
    modes: Sequence[Mode],
    form: str = "rigid-body",
    density_gradient: bool = True,
    gyroscopic: bool = True,
) -> tuple[ModeSensitivity, ...]:
    """Sensitivity of every mode to every one of `PARAMETERS`.

    Args:
        point: flight point with CL and CD.
        mass: kg, kg m2.
        reference: m2, m.
        derivatives: per rad and per unit Mach number.
        A: [state, state] of the linear model.
        modes: its modes.
        form, density_gradient, gyroscopic: as A was made with.
    """
    slopes = matrix_slopes(point, mass, reference, derivatives, PARAMETERS, form, density_gradient, gyroscopic)
    values = [value_of(name, point, derivatives) for name in PARAMETERS]
    return sensitivities(A, modes, slopes, PARAMETERS, values)


def eigenvalue_error(one: ModeSensitivity, covariance: np.ndarray) -> tuple[float, float]:
    """Standard deviations, 1/s, of real and imaginary part of an eigenvalue to first order.

    Args:
        one: sensitivity of the mode.
        covariance: [parameter, parameter] of the parameters, in their units.
    """
    real, imaginary = one.slopes.real, one.slopes.imag
    return tuple(float(np.sqrt(max(0.0, s @ covariance @ s))) for s in (real, imaginary))  # type: ignore[return-value]


def drivers(one: ModeSensitivity, half_width: Mapping[str, float] | None = None) -> tuple[Driver, ...]:
    """Parameters by their part in a mode, greatest first: of its error where half widths are given, else of one per
    cent.

    Args:
        one: sensitivity of the mode.
        half_width: of the parameters, in their units; parameters without one count nothing.
    """
    widths = half_width or {}
    errors = np.array([widths.get(name, 0.0) for name in one.parameters]) * one.slopes
    percent = 0.01 * one.values * one.slopes
    weight = np.abs(errors if np.any(np.abs(errors) > 0) else percent) ** 2
    total = float(weight.sum())
    order = np.argsort(-weight, kind="stable")
    return tuple(
        Driver(
            parameter=one.parameters[k],
            slope=complex(one.slopes[k]),
            per_percent=complex(percent[k]),
            error=complex(errors[k]) if one.parameters[k] in widths else None,
            share=float(weight[k]) / total,
        )
        for k in order
        if total > 0 and weight[k] > 0
    )


def value_of(name: str, point: FlightPoint, derivatives: Derivatives) -> float:
    """Nominal value of a parameter or control derivative."""
    if name in AT_POINT:
        return point.coefficients()[AT_POINT.index(name)]
    if name in STATIC or name in DAMPING:
        return float(getattr(derivatives, name))
    return float(derivatives.controls.get(name, 0.0))


def moved_by(
    changes: Mapping[str, float], point: FlightPoint, derivatives: Derivatives
) -> tuple[FlightPoint, Derivatives]:
    """Flight point and derivatives with some parameters or control derivatives changed by given amounts.

    Args:
        changes: name to amount, in the unit of the parameter.
        point: flight point with CL and CD.
        derivatives: per rad and per unit Mach number.
    """
    CL, CD = point.coefficients()
    moved = point.with_coefficients(CL + changes.get("CL", 0.0), CD + changes.get("CD", 0.0))
    plain = {
        f.name: getattr(derivatives, f.name) + changes.get(f.name, 0.0)
        for f in fields(derivatives)
        if f.name != "controls"
    }
    controls = {name: value + changes.get(name, 0.0) for name, value in derivatives.controls.items()}
    return moved, Derivatives(**plain, controls=controls)


def _complex(derivatives: Derivatives, name: str, step: complex) -> Derivatives:
    """The derivatives with a complex step on one; past the check that they are real, on purpose."""
    stepped = object.__new__(Derivatives)
    for item in fields(derivatives):
        object.__setattr__(stepped, item.name, getattr(derivatives, item.name))
    object.__setattr__(stepped, name, getattr(derivatives, name) + step)
    return stepped
