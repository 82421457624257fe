"""Supersonic flow of a perfect gas past the front of a sphere: the bow shock is fitted, not captured.

The steady equations stand in polar coordinates about the sphere's centre, theta from the axis upstream, r from the wall
to the shock. Total enthalpy is that of the free stream everywhere; velocities are fractions of sqrt(2 H). With
a^2 = (gamma - 1)/2 (1 - V^2), the vorticity w and sigma = ln(p / rho^gamma) what remains is

    a^2 div V - V . grad(V^2 / 2) = 0                                   continuity,
    v w + a^2 / (gamma (gamma - 1)) d sigma / dr = 0                    Crocco's theorem along r,
    -u w + a^2 / (gamma (gamma - 1)) (1/r) d sigma / d theta = 0        and along theta

(Crocco, Z. angew. Math. Mech. 17 (1937); Hayes and Probstein, Hypersonic Flow Theory, 2nd ed. (1966), chapter 6). On
the wall u = 0 and sigma is that behind a normal shock, the whole wall being one streamline; at the shock the
Rankine-Hugoniot relations hold (NACA Report 1135, equations 93 to 95). At the last theta the flow leaves faster than
sound: no condition. Everything is a polynomial between Chebyshev points (L. N. Trefethen, Spectral Methods in Matlab
(2000), chapters 5 and 6), even or odd in theta; Gauss and Newton's method finds the least squares of all equations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spaceplane.aero.exact.stagnation import stagnation_cp
from spaceplane.errors import InputError

LEAST_MACH, MOST_MACH = 1.5, 50.0
LEAST_GAMMA, MOST_GAMMA = 1.2, 1.67
FEWEST, MOST = 6, 40
LAST_ANGLE = math.radians(85.0)
LEAST_ANGLE, MOST_ANGLE = math.radians(80.0), math.radians(90.0)
"""Where the flow leaves, rad, and what is allowed: there it is supersonic along theta from wall to shock."""
_ITERATIONS, _TOLERANCE = 40, 1e-9
# Weight of wall and shock against the equations of the flow.
_BOUNDARY = 10.0


@dataclass(frozen=True)
class SphereFlow:
    """Axisymmetric flow between the front of a sphere of radius 1 and its bow shock.

    Attributes:
        mach: free-stream Mach number.
        gamma: ratio of specific heats.
        theta: [angle] angles of the rays from the axis upstream, rad, rising.
        layer: [point] place between wall (0) and shock (1) on each ray, rising.
        shock: [angle] distance of the shock from the centre.
        velocity: [point, angle, (outward along r, along theta)] over the largest speed sqrt(2 H).
        sigma: [point, angle] ln(p / rho^gamma), that of the wall taken off.
        misfit: root mean square of what is left of all equations.
    """

    mach: float
    gamma: float
    theta: np.ndarray
    layer: np.ndarray
    shock: np.ndarray
    velocity: np.ndarray
    sigma: np.ndarray
    misfit: float

    @property
    def standoff(self) -> float:
        """Distance from the nose to the shock over the radius."""
        return float(_even(self.theta, self.shock, 0.0)) - 1.0

    def shock_radius(self, theta: ArrayLike) -> np.ndarray:
        """Distance of the shock from the centre over the sphere's radius at angles from the axis, rad."""
        return _even(self.theta, self.shock, self._inside(theta))

    def wall_cp(self, theta: ArrayLike) -> np.ndarray:
        """Pressure coefficient on the sphere at angles from the stagnation point, rad.

        Raises:
            InputError: an angle beyond the last ray.
        """
        theta = self._inside(theta)
        # the speed over the sine of the angle is even
        speed = np.sin(theta) * _even(self.theta, self.velocity[0, :, 1] / np.sin(self.theta), theta)
        stagnation = 1.0 + 0.5 * self.gamma * self.mach**2 * stagnation_cp(self.mach, self.gamma)
        pressure = stagnation * (1.0 - speed**2) ** (self.gamma / (self.gamma - 1.0))
        return (pressure - 1.0) * 2.0 / (self.gamma * self.mach**2)

    def front_drag(self) -> float:
        """Drag coefficient on pi R^2 of the wall between the stagnation point and the last ray."""
        node, weight = np.polynomial.legendre.leggauss(64)
        half = 0.5 * float(self.theta[-1])
        theta = half * (1.0 + node)
        return float(half * (weight * self.wall_cp(theta) * np.sin(2.0 * theta)).sum())

    def _inside(self, theta: ArrayLike) -> np.ndarray:
        theta = np.asarray(theta, dtype=float)
        if not (np.abs(theta) <= self.theta[-1] + 1e-12).all():
            last = math.degrees(self.theta[-1])
            raise InputError(f"theta_deg: at most {last:.4g} deg from the stagnation point allowed")
        return theta


def sphere_flow(
    mach: float, gamma: float = 1.4, points: int = 14, angles: int = 16, last_angle: float = LAST_ANGLE
) -> SphereFlow:
    """Solve the flow between the front of a sphere and its shock.

    Against more points these have the stand-off within 4e-6 and Cp within 5e-5 from Mach 2 up; at Mach 1.5 it takes 18
    points and 22 rays to that, and these have 1.5e-4 and 4e-3.

    Args:
        mach: free-stream Mach number, `LEAST_MACH` to `MOST_MACH`.
        gamma: ratio of specific heats, `LEAST_GAMMA` to `MOST_GAMMA`.
        points: collocation points from wall to shock.
        angles: rays from the axis to the last.
        last_angle: of the last ray, rad; it takes more rays, and at Mach 1.5 with gamma 1.67 it fails, at 90 deg.

    Raises:
        InputError: a number out of its range.
        RuntimeError: no solution within the allowed iterations.
    """
    for name, value, low, high in (
        ("mach", mach, LEAST_MACH, MOST_MACH),
        ("gamma", gamma, LEAST_GAMMA, MOST_GAMMA),
        ("points", points, FEWEST, MOST),
        ("angles", angles, FEWEST, MOST),
        ("last_angle", last_angle, LEAST_ANGLE, MOST_ANGLE),
    ):
        if not low <= value <= high:
            raise InputError(f"{name} = {value}: allowed {low:g} to {high:g}")
    problem = _Problem(mach, gamma, _grid(points, angles, last_angle))
    unknown = problem.guess()
    residual = problem.residual(unknown)
    for _ in range(_ITERATIONS):
        step = np.linalg.lstsq(problem.jacobian(unknown), -residual, rcond=None)[0]
        unknown, residual, taken = _shortened(problem, unknown, residual, step)
        if np.abs(taken * step).max() < _TOLERANCE:
            return problem.flow(unknown, residual)
    raise RuntimeError(f"mach = {mach}: the flow past a sphere was not found in {_ITERATIONS} iterations")


@dataclass(frozen=True)
class _Grid:
    """Collocation points and matrices that differentiate by the place in the layer and by theta."""

    layer: np.ndarray
    theta: np.ndarray
    radial: np.ndarray
    even: np.ndarray
    odd: np.ndarray


class _Problem:
    """The collocated equations. Unknowns: u, v, sigma [point, angle] each, then the shock's distance [angle]."""

    def __init__(self, mach: float, gamma: float, grid: _Grid):
        self.mach, self.gamma, self.grid = mach, gamma, grid
        self.shape = (len(grid.layer), len(grid.theta))
        self.fastest = math.sqrt(2.0 / ((gamma - 1.0) * mach**2) + 1.0)  # sqrt(2 H) over the stream's speed
        self.wall_sigma = float(np.log(self._behind(np.array(1.0))[0]))

    def _behind(self, normal2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """p / rho^gamma on its value in the stream, and density ratio, behind shocks; `normal2` is the square of the
        sine of the shock's angle."""
        m2, g = self.mach**2 * normal2, self.gamma
        density = (g + 1.0) * m2 / ((g - 1.0) * m2 + 2.0)
        return (1.0 + 2.0 * g / (g + 1.0) * (m2 - 1.0)) / density**g, density

    def at_shock(self, shock: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """u, v and sigma [angle] behind a shock at the distance `shock` with the derivative `slope` by theta."""
        theta = self.grid.theta
        length = np.sqrt(shock**2 + slope**2)  # complex steps pass through here
        out_r, out_t = shock / length, -slope / length  # unit normal into the stream
        u, v = -np.cos(theta) / self.fastest, np.sin(theta) / self.fastest
        through = u * out_r + v * out_t
        entropy, density = self._behind((through * self.fastest) ** 2)
        lost = through * (1.0 - 1.0 / density)
        return u - lost * out_r, v - lost * out_t, np.log(entropy) - self.wall_sigma

    def guess(self) -> np.ndarray:
        """Seiff's stand-off under a hyperbola with Billig's radius; straight lines between shock and wall."""
        theta, eta = self.grid.theta, self.grid.layer[:, None]
        mach, g = self.mach, self.gamma
        standoff = 0.78 * (2.0 + (g - 1.0) * mach**2) / ((g + 1.0) * mach**2)
        standoff *= 1.0 + 2.0 / mach**3
        radius = 1.143 * math.exp(0.54 / (mach - 1.0) ** 1.2)
        slope2 = 1.0 / (mach**2 - 1.0)
        # the hyperbola x = 1 + standoff - k (sqrt(1 + y^2 / (k radius)) - 1), k = radius / slope2, meets each ray
        low, high = np.ones_like(theta), np.full_like(theta, 30.0)
        for _ in range(60):
            middle = 0.5 * (low + high)
            x, y = middle * np.cos(theta), middle * np.sin(theta)
            inside = x < 1.0 + standoff - radius / slope2 * (np.sqrt(1.0 + slope2 * (y / radius) ** 2) - 1.0)
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        shock = 0.5 * (low + high)
        u, v, sigma = self.at_shock(shock, self.grid.even @ shock)
        # Newtonian pressure on the wall
        wall = np.sqrt(1.0 - np.maximum(np.cos(theta) ** 2, 0.02) ** ((g - 1.0) / g))
        fields = (eta * u, wall + eta * (v - wall), eta * sigma)
        return np.concatenate([*(field.ravel() for field in fields), shock])

    def split(self, unknown: np.ndarray) -> tuple[np.ndarray, ...]:
        """u, v, sigma [point, angle] and the shock [angle]."""
        size = self.shape[0] * self.shape[1]
        fields = unknown[: 3 * size].reshape(3, *self.shape)
        return fields[0], fields[1], fields[2], unknown[3 * size :]

    def inputs(self, unknown: np.ndarray) -> tuple[np.ndarray, ...]:
        """[point, angle] each: u, v, sigma, their derivatives by place and by theta, the shock and its slope."""
        u, v, sigma, shock = self.split(unknown)
        d = self.grid
        whole = np.ones((self.shape[0], 1))
        return (
            *(u, v, sigma),
            *(d.radial @ u, d.radial @ v, d.radial @ sigma),
            *(u @ d.even.T, v @ d.odd.T, sigma @ d.even.T),
            *(whole * shock, whole * (d.even @ shock)),
        )

    def flow_equations(self, *inputs: np.ndarray) -> np.ndarray:
        """[3, point, angle] continuity and Crocco's theorem along r and theta."""
        u, v, _, u_n, v_n, s_n, u_t, v_t, s_t, shock, slope = inputs
        eta, theta = self.grid.layer[:, None], self.grid.theta
        # r = 1 + eta (shock - 1): derivatives along r, and at constant r along theta, over r
        width = shock - 1.0
        r = 1.0 + eta * width
        turn = eta * slope / width
        u_r, v_r, s_r = u_n / width, v_n / width, s_n / width
        u_t, v_t, s_t = (u_t - turn * u_n) / r, (v_t - turn * v_n) / r, (s_t - turn * s_n) / r
        g = self.gamma
        a2 = 0.5 * (g - 1.0) * (1.0 - u * u - v * v)
        divergence = u_r + 2.0 * u / r + v_t + v / (r * np.tan(theta))
        steepening = u * (u * u_r + v * v_r) + v * (u * u_t + v * v_t)
        vorticity = v_r + v / r - u_t
        heat = a2 / (g * (g - 1.0))
        return np.stack([a2 * divergence - steepening, v * vorticity + heat * s_r, -u * vorticity + heat * s_t])

    def residual(self, unknown: np.ndarray) -> np.ndarray:
        """Equations of the flow at all points, then wall and shock."""
        u, v, sigma, shock = self.split(unknown)
        equations = self.flow_equations(*self.inputs(unknown))
        jump = [a[-1] - b for a, b in zip((u, v, sigma), self.at_shock(shock, self.grid.even @ shock), strict=True)]
        return np.concatenate([equations.ravel(), *(_BOUNDARY * row for row in (u[0], sigma[0], *jump))])

    def jacobian(self, unknown: np.ndarray) -> np.ndarray:
        """Derivatives of the residual by the unknowns; complex steps through the equations of each point."""
        points, angles = self.shape
        size = points * angles
        d = self.grid
        along, around = np.eye(points), np.eye(angles)
        same, radial = np.eye(size), np.kron(d.radial, around)
        even, odd = np.kron(along, d.even), np.kron(along, d.odd)
        spread = np.kron(np.ones((points, 1)), around)
        columns = [slice(k * size, (k + 1) * size) for k in range(3)] + [slice(3 * size, 3 * size + angles)]
        matrix = np.zeros((3 * size + 5 * angles, len(unknown)))
        # which unknowns each of the inputs is made of, and how
        operators = (same, same, same, radial, radial, radial, even, odd, even, spread, spread @ d.even)
        inputs = self.inputs(unknown)
        for k, (field, operator) in enumerate(zip((0, 1, 2) * 3 + (3, 3), operators, strict=True)):
            stepped = [value + (1e-30j if k == n else 0.0) for n, value in enumerate(inputs)]
            slope = self.flow_equations(*stepped).imag.reshape(3, size) / 1e-30
            for row in range(3):
                matrix[row * size : (row + 1) * size, columns[field]] += slope[row][:, None] * operator
        first = 3 * size
        for row, (field, point) in enumerate([(0, 0), (2, 0), (0, -1), (1, -1), (2, -1)]):
            place = field * size + (point % points) * angles
            rows = slice(first + row * angles, first + (row + 1) * angles)
            matrix[rows, place : place + angles] = _BOUNDARY * around
        shock = self.split(unknown)[3]
        slope = d.even @ shock
        by_place = self.at_shock(shock + 1e-30j, slope)
        by_slope = self.at_shock(shock, slope + 1e-30j)
        for row in range(3):
            rows = slice(first + (2 + row) * angles, first + (3 + row) * angles)
            change = np.diag(by_place[row].imag) + by_slope[row].imag[:, None] * d.even
            matrix[rows, columns[3]] = -_BOUNDARY * change / 1e-30
        return matrix

    def flow(self, unknown: np.ndarray, residual: np.ndarray) -> SphereFlow:
        """The solution as it is handed out."""
        u, v, sigma, shock = self.split(unknown)
        misfit = float(np.sqrt(np.mean(residual**2)))
        velocity = np.stack([u, v], axis=-1)
        return SphereFlow(self.mach, self.gamma, self.grid.theta, self.grid.layer, shock, velocity, sigma, misfit)


def _shortened(
    problem: _Problem, unknown: np.ndarray, residual: np.ndarray, step: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Unknowns, residual and share after that part of the step that lowers the residual, halved until it does."""
    before = float(residual @ residual)
    share = 1.0
    while share > 1e-3:
        trial = unknown + share * step
        if problem.split(trial)[3].min() > 1.0:
            found = problem.residual(trial)
            if float(found @ found) < before or np.abs(step).max() < 1e-6:
                return trial, found, share
        share *= 0.5
    return trial, problem.residual(trial), share


def _grid(points: int, angles: int, last: float) -> _Grid:
    """Chebyshev points: on [0, 1] from wall to shock; the positive half of [-last, last] in theta."""
    layer = 0.5 * (1.0 - np.cos(np.pi * np.arange(points) / (points - 1)))
    both = last * np.cos(np.pi * np.arange(2 * angles) / (2 * angles - 1))
    whole = _differentiation(both)
    upper, mirrored = whole[:angles, :angles], whole[:angles, angles:][:, ::-1]
    flip = slice(None, None, -1)
    even, odd = (upper + mirrored)[flip, flip], (upper - mirrored)[flip, flip]
    return _Grid(layer, both[:angles][::-1], _differentiation(layer), even, odd)


def _differentiation(place: np.ndarray) -> np.ndarray:
    """Matrix that differentiates the polynomial through values at Chebyshev points of the second kind."""
    weight = np.where(np.arange(len(place)) % 2, -1.0, 1.0)
    weight[[0, -1]] *= 0.5
    gap = place[:, None] - place + np.eye(len(place))
    matrix = weight / weight[:, None] / gap
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return matrix


def _even(theta: np.ndarray, values: np.ndarray, at: ArrayLike) -> np.ndarray:
    """The even polynomial through `values` at the positive Chebyshev points `theta`, at the angles `at`, rad."""
    count = 2 * len(theta)
    place = np.concatenate([-theta[::-1], theta])
    weight = np.where(np.arange(count) % 2, -1.0, 1.0)
    weight[[0, -1]] *= 0.5
    gap = np.asarray(at, dtype=float)[..., None] - place
    hit = np.abs(gap) < 1e-14
    terms = weight / np.where(hit, 1.0, gap)
    terms = np.where(hit.any(axis=-1, keepdims=True), hit, terms)
    return (terms @ np.concatenate([values[::-1], values])) / terms.sum(axis=-1)
