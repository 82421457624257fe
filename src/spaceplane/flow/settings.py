"""Settings of the flow solver and the check of what it is asked to solve."""

from __future__ import annotations

import math
from collections.abc import Container
from dataclasses import dataclass, replace

import numpy as np

from spaceplane.errors import InputError, unknown_name
from spaceplane.flow.equilibrium import check_air
from spaceplane.flow.fluxes import FLUXES
from spaceplane.flow.limiters import LIMITERS
from spaceplane.flow.solution import EQUILIBRIUM, GASES, FlowConditions

PRECISIONS = {"single": np.float32, "double": np.float64}


@dataclass(frozen=True)
class FlowSettings:
    """Numerics of the ensemble Euler solver; defaults are what we trust.

    Attributes:
        precision: "single" (fp32) or "double" (fp64) for state and kernels; sums are always fp64.
        order: 2, or 1 for a first-order solution.
        flux: name in `fluxes.FLUXES`.
        limiter: name in `limiters.LIMITERS`.
        limiter_constant: Venkatakrishnan's K on the body length; variations below (K h / L)^1.5 of the local scale
            are left alone.
        wake_calming: most that slopes are reduced by in dead water behind blunt bases (see `deadwater`); 0 switches it
            off.
        low_mach: local Mach number below which the low-Mach correction stops shrinking the normal jump; 1 switches it
            off.
        wall_stiffness: share of the acoustic response to flow through the wall added to the wall pressure (0 to 1).
        cfl_start: first pseudo-time CFL number; falls to 5 between Mach 2 and 2.5. The impulsive start on the coarsest
            level uses a fifth of it, falling to 1 between Mach 2 and 5.
        cfl_max: largest CFL number; falls to 60 at Mach 5 and to 20 from Mach 10 on, and from Mach 2.5 on it is 80
            until the residual has fallen 1.7 decades.
        sweeps: symmetric Gauss-Seidel sweeps per iteration.
        anderson_depth: earlier iterates combined by Anderson acceleration, at most three from Mach 1.2 up; 0 switches
            it off.
        iterations: most iterations on the fine mesh.
        coarse_iterations: most iterations on each coarse level.
        coarse_levels: number of coarse levels to start on.
        residual_drop: decades that the density residual must fall on the fine mesh to stop at once.
        end_game_drop: decades from which on a run that asks for more keeps limits and cells at their bound where its
            forces stand and its residual creeps (see `freezing`).
        least_drop: decades below which nothing is called converged.
        force_tolerance: half peak-to-peak of the force over the window, on the force's size, to stop after
            `least_drop`.
        window: iterations of the force window.
    """

    precision: str = "single"
    order: int = 2
    flux: str = "blend"
    limiter: str = "venkatakrishnan"
    limiter_constant: float = 20.0
    wake_calming: float = 1.0
    low_mach: float = 0.05
    wall_stiffness: float = 0.0
    cfl_start: float = 25.0
    cfl_max: float = 100.0
    sweeps: int = 2
    anderson_depth: int = 5
    iterations: int = 200
    coarse_iterations: int = 60
    coarse_levels: int = 3
    residual_drop: float = 3.0
    end_game_drop: float = 3.0
    least_drop: float = 1.5
    force_tolerance: float = 5e-4
    window: int = 10

    def __post_init__(self) -> None:
        choose("precision", self.precision, PRECISIONS)
        choose("flux", self.flux, FLUXES)
        choose("limiter", self.limiter, LIMITERS)
        if self.order not in (1, 2):
            raise InputError(f"order: {self.order} is not allowed; 1 or 2")
        for name, low, high in (
            ("limiter_constant", 0.0, 1e3),
            ("wake_calming", 0.0, 1.0),
            ("low_mach", 0.0, 1.0),
            ("wall_stiffness", 0.0, 1.0),
            ("cfl_start", 0.05, 1e4),
            ("cfl_max", 0.05, 1e6),
            ("residual_drop", 0.1, 16.0),
            ("end_game_drop", 0.1, 16.0),
            ("least_drop", 0.0, 16.0),
            ("force_tolerance", 0.0, 1.0),
            ("sweeps", 1, 20),
            ("anderson_depth", 0, 10),
            ("iterations", 1, 10**6),
            ("coarse_iterations", 1, 10**6),
            ("coarse_levels", 0, 10),
            ("window", 2, 1000),
        ):
            value = getattr(self, name)
            if not (isinstance(value, int | float) and math.isfinite(value) and low <= value <= high):
                raise InputError(f"{name}: {value} is not allowed; {low} to {high}")

    def falling(self, decades: float) -> FlowSettings:
        """These settings for residuals that fall by `decades`, with more iterations where that is more than now."""
        more = max(1.0, decades / self.residual_drop)
        return replace(self, residual_drop=decades, iterations=round(more * self.iterations))

    @property
    def dtype(self) -> type:
        """numpy type of the working precision."""
        return PRECISIONS[self.precision]


def choose(field: str, name: str, registry: Container[str]) -> None:
    """Refuse a `name` that the registry does not have."""
    if name not in registry:
        raise InputError(unknown_name(field, name, registry))


def check(conditions: FlowConditions) -> FlowConditions:
    """The conditions as float64 arrays of one length; an InputError for what no flow can have."""
    values = {}
    for name in ("mach", "alpha", "beta"):
        try:
            values[name] = np.atleast_1d(np.asarray(getattr(conditions, name), dtype=np.float64))
        except (TypeError, ValueError) as error:
            raise InputError(f"{name}: {getattr(conditions, name)!r} is not a number") from error
        if values[name].ndim != 1:
            raise InputError(f"{name}: shape {values[name].shape} is not allowed; a list of numbers")
        bad = values[name][~np.isfinite(values[name])]
        if len(bad):
            raise InputError(f"{name}: {bad[0]} is not allowed; a finite number")
    count = {name: len(value) for name, value in values.items()}
    if len(set(count.values())) != 1 or not count["mach"]:
        raise InputError(f"conditions: {count} entries; mach, alpha and beta need the same number, at least one")
    if (values["mach"] <= 0).any():
        raise InputError(f"mach: {values['mach'].min():g} is not allowed; greater than 0")
    for name in ("alpha", "beta"):
        if (np.abs(values[name]) > np.pi).any():
            raise InputError(f"{name}: {np.abs(values[name]).max():g} rad is not allowed; -pi to pi")
    if not (np.isfinite(conditions.gamma) and 1.0 < conditions.gamma <= 3.0):
        raise InputError(f"gamma: {conditions.gamma} is not allowed; greater than 1, at most 3")
    rates, center = _check_rotation(conditions, values["mach"])
    streams = FlowConditions(values["mach"], values["alpha"], values["beta"], float(conditions.gamma), rates, center)
    choose("gas", conditions.gas, GASES)
    if conditions.gas != EQUILIBRIUM:
        return streams
    heated = replace(streams, gas=EQUILIBRIUM, density=conditions.density, pressure=conditions.pressure)
    check_air(heated)
    return heated


def _check_rotation(conditions: FlowConditions, mach: np.ndarray) -> tuple[np.ndarray | None, tuple]:
    """Rates [condition, 3] and centre as finite numbers; no rates where nothing turns."""
    center = np.asarray(conditions.center, dtype=float)
    if center.shape != (3,) or not np.isfinite(center).all():
        raise InputError(f"center: {conditions.center} is not allowed; three finite lengths, m")
    if conditions.rates is None:
        return None, tuple(center)
    rates = np.asarray(conditions.rates, dtype=float)
    if rates.shape != (len(mach), 3) or not np.isfinite(rates).all():
        raise InputError(
            f"rates: shape {rates.shape} is not allowed; finite p, q, r for each of {len(mach)} conditions"
        )
    return (rates if rates.any() else None), tuple(center)
