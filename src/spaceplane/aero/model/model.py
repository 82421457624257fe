"""An aerodynamic model: six coefficients over Mach number, angle of attack, sideslip, rates and deflections.

With a the angle of attack, M the Mach number, b the sideslip, d_s the deflection of surface s and reduced rates
p' = p b_ref/2V, q' = q c_ref/2V, r' = r b_ref/2V, each coefficient C of CL, CD, CY (wind axes) and Cl, Cm, Cn (body
axes) is

    C = C_base(a, M) + sum over s of dC_s(d_s, a, M) + C_b(a, M) b + C_p(a, M) p' + C_q(a, M) q' + C_r(a, M) r'

linear between the nodes of each table. Outside the tables, in an empty cell or beyond a deflection limit there is no
answer but `OutsideTables`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.integrate import LATERAL
from spaceplane.aero.model import move
from spaceplane.aero.model.derivatives import Derivatives
from spaceplane.aero.model.interpolate import (
    SIDES,
    OutsideTables,
    Place,
    in_user_units,
    interpolate,
    is_node,
    locate,
    node_slope,
)
from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle.controls import CONTROLS
from spaceplane.vehicle.properties import ReferenceLengths

__all__ = ["BASE", "LAG", "SLOPES", "AeroModel", "OutsideTables", "SurfaceTable"]

BASE = ("CL", "CD", "Cm")
SLOPES = ("CY_beta", "Cl_beta", "Cn_beta", "CL_q", "Cm_q", "CY_p", "Cl_p", "Cn_p", "CY_r", "Cl_r", "Cn_r")
LAG = ("CL_alphadot", "Cm_alphadot")
ZERO = 1e-12
_STEP = 1e-30  # of the complex step: any size does that squares away


@dataclass(frozen=True)
class SurfaceTable:
    """What one control surface adds to the coefficients.

    Attributes:
        deflection: [deflection] rad, increasing, 0 among them; the first and the last are its limits.
        increments: of CL, CD, Cm, CY, Cl, Cn, whichever are known -> [deflection, alpha, mach]; 0 at deflection 0, NaN
            where nothing is known.

    Raises:
        InputError: an axis that does not increase or lacks 0, an unknown coefficient, a wrong shape, or an
            increment without deflection.
    """

    deflection: np.ndarray
    increments: Mapping[str, np.ndarray]

    def __post_init__(self) -> None:
        axis = _axis("deflection", self.deflection)
        neutral = np.flatnonzero(axis == 0.0)
        if len(neutral) != 1:
            raise InputError("deflection: 0 must be one of the values")
        tables = {}
        for name, values in self.increments.items():
            if name not in FORCES_AND_MOMENTS:
                raise InputError(unknown_name("coefficient", name, FORCES_AND_MOMENTS))
            tables[name] = _table(f"increment of {name}", values, (len(axis), None, None))
            bare = tables[name][neutral[0]]
            if np.any(np.abs(bare[np.isfinite(bare)]) > ZERO):
                raise InputError(f"increment of {name}: must be 0 at deflection 0")
        object.__setattr__(self, "deflection", axis)
        object.__setattr__(self, "increments", tables)

    @property
    def limits(self) -> tuple[float, float]:
        """Least and greatest deflection, rad."""
        return float(self.deflection[0]), float(self.deflection[-1])


@dataclass(frozen=True)
class AeroModel:
    """Aerodynamics of one vehicle about one moment centre, without sideslip symmetric between left and right.

    Attributes:
        name: of the vehicle or the data.
        source: where the numbers come from, with what was assumed.
        reference: area m2, chord and span m, moment centre m in geometry axes.
        alpha: [alpha] rad, increasing.
        mach: [mach] increasing.
        base: CL, CD, Cm -> [alpha, mach] without deflection; NaN where nothing is known.
        surfaces: by control surface (`vehicle.controls.CONTROLS`) what it adds.
        slopes: of `SLOPES` -> [alpha, mach], per rad of sideslip or per reduced rate. One that is missing is unknown:
            it counts as zero and is named by `unknown`.
        beta_limit: greatest sideslip, rad, to either side, up to which the slopes are taken to hold.
        lag: (CL_alphadot, Cm_alphadot) on dalpha/dt c_ref/2V, the same everywhere; not in `coefficients`, which are
            those of a steady angle of attack.
        center_known: whether the moment centre is a known place; where not, moments are about the centre of mass,
            wherever that lies, and that of `reference` means nothing.

    Raises:
        InputError: an axis, a shape, a name or a coefficient that is wrong or missing.
    """

    name: str
    source: str
    reference: ReferenceLengths
    alpha: np.ndarray
    mach: np.ndarray
    base: Mapping[str, np.ndarray]
    surfaces: Mapping[str, SurfaceTable] = field(default_factory=dict)
    slopes: Mapping[str, np.ndarray] = field(default_factory=dict)
    beta_limit: float = math.radians(10.0)
    lag: tuple[float, float] = (0.0, 0.0)
    center_known: bool = True

    def __post_init__(self) -> None:
        alpha, mach = _axis("alpha", self.alpha), _axis("mach", self.mach)
        if mach[0] < 0:
            raise InputError(f"mach = {mach[0]:g}: must not be negative")
        shape = (len(alpha), len(mach))
        for name in (*self.base, *(missing for missing in BASE if missing not in self.base)):
            if name not in BASE:
                raise InputError(unknown_name("base coefficient", name, BASE))
            if name not in self.base:
                raise InputError(f"base: {name} is missing; needed are {', '.join(BASE)}")
        for name in self.slopes:
            if name not in SLOPES:
                raise InputError(unknown_name("slope", name, SLOPES))
        for name, surface in self.surfaces.items():
            if name not in CONTROLS:
                raise InputError(unknown_name("control surface", name, CONTROLS))
            for coefficient, values in surface.increments.items():
                _table(f"{name}, increment of {coefficient}", values, (len(surface.deflection), *shape))
        if not 0.0 <= self.beta_limit <= math.pi / 2:
            raise InputError(f"beta_limit = {self.beta_limit}: must lie between 0 and pi/2 rad")
        for name, value in zip(LAG, self.lag, strict=True):
            if not math.isfinite(value):
                raise InputError(f"{name} = {value}: must be a finite number")
        object.__setattr__(self, "alpha", alpha)
        object.__setattr__(self, "mach", mach)
        object.__setattr__(self, "base", {name: _table(name, self.base[name], shape) for name in BASE})
        object.__setattr__(self, "slopes", {name: _table(name, v, shape) for name, v in self.slopes.items()})
        object.__setattr__(self, "surfaces", dict(self.surfaces))

    def coefficients(
        self,
        mach: float,
        alpha: float,
        beta: float = 0.0,
        rates: tuple[float, float, float] = (0.0, 0.0, 0.0),
        deflections: Mapping[str, float] | None = None,
    ) -> dict[str, float]:
        """CL, CD, CY in wind axes and Cl, Cm, Cn in body axes about the moment centre.

        Args:
            mach: Mach number.
            alpha: angle of attack, rad.
            beta: sideslip, rad.
            rates: reduced rates (p b/2V, q c/2V, r b/2V).
            deflections: control surface -> rad; those not named stand at 0.

        Raises:
            OutsideTables: naming the quantity, its value and the range.
            InputError: a value is not finite, or a surface that the model does not have is deflected.
        """
        found = self._evaluate(mach, alpha, beta, rates, deflections or {})
        return {name: float(value.real) for name, value in found.items()}

    def derivatives(self, mach: float, alpha: float, deflections: Mapping[str, float] | None = None) -> Derivatives:
        """Slopes of the interpolation without sideslip and rates, per rad, per unit Mach and per reduced rate.

        At a node, where the slope jumps, the mean of both sides; at an end of a table, or where one side is empty, the
        slope of the other. Derivatives with the deflections are those of each surface of the model.

        Args:
            mach: Mach number.
            alpha: angle of attack, rad.
            deflections: control surface -> rad.

        Raises:
            OutsideTables: as for `coefficients`.
        """
        place = dict(deflections or {})
        self._evaluate(mach, alpha, 0.0, (0.0, 0.0, 0.0), place)  # so that what is outside is named as itself

        def at(mach: complex = mach, alpha: complex = alpha, side: str = "right") -> dict:
            return self._evaluate(mach, alpha, 0.0, (0.0, 0.0, 0.0), place, side)

        with_alpha = _slope(lambda x, side: at(alpha=x, side=side), alpha, self.alpha)
        with_mach = _slope(lambda x, side: at(mach=x, side=side), mach, self.mach)
        static = {f"{name}_alpha": with_alpha[name] for name in BASE} | {f"{name}_M": with_mach[name] for name in BASE}
        nodes = self._nodes(mach, alpha, "right")
        rest = {name: self._value(name, self.slopes[name], nodes, mach, alpha).real for name in self.slopes}
        controls = {}
        for name, surface in self.surfaces.items():
            for coefficient, values in self.increments(name, mach, alpha).items():
                slope = node_slope(surface.deflection, values, place.get(name, 0.0))
                controls[f"{coefficient}_{name}"] = self._known(f"{coefficient} of {name}", slope, mach, alpha)
        lateral = {"CY_beta": 0.0, "Cl_beta": 0.0, "Cn_beta": 0.0}
        lag = dict(zip(LAG, self.lag, strict=True))
        plain = {name: float(value) for name, value in (static | lateral | rest | lag).items()}
        return Derivatives(**plain, controls={name: float(value) for name, value in controls.items()})

    @property
    def movable(self) -> bool:
        """Whether `moved` can take the moments to another centre."""
        return self.center_known and not any(self.lag)

    def moved(self, center: tuple[float, float, float]) -> AeroModel:
        """The same aerodynamics about another moment centre; see `spaceplane.aero.model.move`.

        Args:
            center: x, y, z in geometry axes, m; y must stay that of the present centre.

        Raises:
            InputError: not three finite numbers, the centre leaves the plane of symmetry, the present one is not a
                known place, or the model has a lag, which is known about the present one only.
        """
        reference = replace(self.reference, moment_center=center)
        if reference != self.reference and not self.center_known:
            raise InputError(f"moment centre: {self.name} does not say where its own is, so it cannot be moved")
        if reference != self.reference and any(self.lag):
            raise InputError(f"moment centre: {' and '.join(LAG)} of {self.name} hold about its own only")
        arms = move.arms_between(self.reference, reference)
        base = move.base(self.alpha, self.base, arms)
        surfaces = {
            name: SurfaceTable(s.deflection, move.increments(self.alpha, s.increments, arms))
            for name, s in self.surfaces.items()
        }
        slopes = move.slopes(self.alpha, self.mach, self.base, self.slopes, arms)
        return replace(self, reference=reference, base=base, surfaces=surfaces, slopes=slopes)

    def unknown(self) -> tuple[str, ...]:
        """What the model does not know and takes as zero, such as "Cl_p" or "Cl_elevon_left".

        A body flap in the plane of symmetry has no lateral effect to be known.
        """
        return (
            *(name for name in SLOPES if name not in self.slopes),
            *(
                f"{coefficient}_{name}"
                for name in CONTROLS
                for coefficient in FORCES_AND_MOMENTS
                if name not in self.surfaces or coefficient not in self.surfaces[name].increments
                if not (name == "body_flap" and coefficient in LATERAL)
            ),
        )

    def limits(self, surface: str) -> tuple[float, float]:
        """Least and greatest deflection of a control surface, rad.

        Raises:
            InputError: the model does not have it.
        """
        if surface not in self.surfaces:
            raise InputError(unknown_name("control surface of the model", surface, self.surfaces))
        return self.surfaces[surface].limits

    def increments(self, surface: str, mach: float, alpha: float) -> dict[str, np.ndarray]:
        """What a surface adds at each deflection of its table: coefficient -> [deflection], NaN where unknown.

        Args:
            surface: control surface.
            mach: Mach number.
            alpha: angle of attack, rad.

        Raises:
            OutsideTables: Mach number or angle of attack outside the tables.
            InputError: the model does not have the surface.
        """
        self.limits(surface)
        nodes = self._nodes(mach, alpha, "right")
        tables = self.surfaces[surface].increments
        return {name: interpolate(np.moveaxis(table, 0, -1), nodes) for name, table in tables.items()}

    def _nodes(self, mach: complex, alpha: complex, side: str) -> tuple[Place, Place]:
        return locate(self.alpha, alpha, "alpha", side), locate(self.mach, mach, "mach", side)

    def _evaluate(
        self,
        mach: complex,
        alpha: complex,
        beta: float,
        rates: tuple[float, float, float],
        deflections: Mapping[str, complex],
        side: str = "right",
    ) -> dict[str, complex]:
        nodes = self._nodes(mach, alpha, side)
        if not abs(beta) <= self.beta_limit * (1.0 + ZERO):
            if not math.isfinite(beta):
                raise InputError(f"beta = {beta}: must be a finite number")
            limit = math.degrees(self.beta_limit)
            message = f"beta = {in_user_units('beta', beta)}: the slopes hold from {-limit:.6g} to {limit:.6g} deg"
            raise OutsideTables(message, "beta", beta, (-self.beta_limit, self.beta_limit))
        total: dict[str, complex] = dict.fromkeys(FORCES_AND_MOMENTS, 0.0)
        for name, table in self.base.items():
            total[name] = self._value(name, table, nodes, mach, alpha)
        for name, deflection in deflections.items():
            for coefficient, table in self._surface(name, deflection).items():
                turned = (locate(self.surfaces[name].deflection, deflection, name, side), *nodes)
                what = f"{coefficient} of {name} at {in_user_units(name, deflection.real)}"
                total[coefficient] += self._value(what, table, turned, mach, alpha)
        motion = {"beta": beta} | dict(zip("pqr", rates, strict=True))
        for quantity, value in motion.items():
            if not math.isfinite(value):
                raise InputError(f"rate {quantity} = {value}: must be a finite number")
        for name, table in self.slopes.items():
            coefficient, quantity = name.split("_")
            if motion[quantity] != 0.0:
                total[coefficient] += self._value(name, table, nodes, mach, alpha) * motion[quantity]
        return total

    def _surface(self, name: str, deflection: complex) -> Mapping[str, np.ndarray]:
        if name in self.surfaces:
            return self.surfaces[name].increments
        if name not in CONTROLS:
            raise InputError(unknown_name("control surface", name, CONTROLS))
        if deflection != 0:
            raise InputError(f"{name} = {in_user_units(name, deflection.real)}: {self.name} has no table of it")
        return {}

    def _value(self, what: str, table: np.ndarray, places: tuple[Place, ...], mach: complex, alpha: complex) -> complex:
        return self._known(what, interpolate(table, places), mach, alpha)

    def _known(self, what: str, value: complex, mach: complex, alpha: complex) -> complex:
        if np.isnan(value):
            where = f"Mach {in_user_units('mach', mach.real)}, alpha {in_user_units('alpha', alpha.real)}"
            message = f"{what}: the tables of {self.name} are empty at {where}"
            raise OutsideTables(message, what, math.nan, (math.nan, math.nan))
        return value


def _slope(function: Callable[[complex, str], dict], value: float, axis: np.ndarray) -> dict[str, float]:
    """Slopes of coefficients at a value, mean of both sides at a node where both are known."""
    sides = []
    for side in SIDES if is_node(axis, value) else SIDES[:1]:
        try:
            found = function(complex(value, _STEP), side)
        except OutsideTables as error:
            outside = error
            continue
        sides.append({name: complex(c).imag / _STEP for name, c in found.items()})
    if not sides:
        raise outside
    return {name: sum(one[name] for one in sides) / len(sides) for name in sides[0]}


def _axis(name: str, values: object) -> np.ndarray:
    axis = np.array(values, dtype=float)
    if axis.ndim != 1 or len(axis) < 2 or not np.all(np.isfinite(axis)) or not np.all(np.diff(axis) > 0):
        found = ", ".join(f"{value:g}" for value in axis.ravel())
        raise InputError(f"{name} = {found}: needs at least two finite, increasing values")
    axis.flags.writeable = False
    return axis


def _table(name: str, values: object, shape: tuple[int | None, ...]) -> np.ndarray:
    table = np.array(values, dtype=float)
    if table.ndim != len(shape) or any(n is not None and n != m for n, m in zip(shape, table.shape, strict=True)):
        wanted = ", ".join("any" if n is None else str(n) for n in shape)
        raise InputError(f"{name}: has shape {table.shape}, needed is ({wanted})")
    if np.any(np.isinf(table)):
        raise InputError(f"{name}: values must be finite, or NaN where nothing is known")
    table.flags.writeable = False
    return table
