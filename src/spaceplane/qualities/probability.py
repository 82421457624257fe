"""Levels as probabilities: uncertain derivatives carried to modes and verdicts.

Derivatives are drawn from a joint normal distribution, given by half widths of 95 % intervals and, where known,
correlations. Two ways lead from a draw to its verdicts. "sampling" linearises, identifies and assesses every draw
anew: modes are named by what takes part in them, so that a draw in which a Dutch roll has become a divergence has no
Dutch roll, and says so. "first-order" moves the nominal eigenvalues along their derivatives and keeps names and
shapes; it costs a tenth, agrees with the other where errors are small, and cannot see modes change their kind. Each
parameter has random numbers of its own by its name: the same seed gives the same draws of C_n_beta at every flight
point, for every shape, and whatever else is uncertain (common random numbers).
"""

from __future__ import annotations

import math
import zlib
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from spaceplane.aero.model.derivatives import COEFFICIENTS, PAIRS, Derivatives
from spaceplane.dynamics.linearise import FORMS, linearise
from spaceplane.dynamics.modes import Mode, identify
from spaceplane.dynamics.sensitivity import PARAMETERS, eigenvalue_slopes, matrix_slopes, moved_by
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.environment.constants import STANDARD_GRAVITY
from spaceplane.errors import InputError, unknown_name
from spaceplane.qualities import limits
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.assess import assess, load_factor_slope
from spaceplane.qualities.assess_airframe import assess_airframe
from spaceplane.qualities.verdict import AIRFRAME, Verdict

NORMAL_95 = 1.959963984540054  # half width of the 95 % interval over the standard deviation
METHODS = ("sampling", "first-order")
OUTCOMES = ("1", "2", "3", "below 3", "met", "not met", "not applicable")


@dataclass(frozen=True)
class Uncertainty:
    """Joint normal distribution of derivatives.

    Attributes:
        half_width: name to half width of the 95 % interval, in the derivative's unit (per rad, per unit Mach number).
            Names are those of `Derivatives`, its control derivatives, CL and CD.
        correlation: pair of names to coefficient of correlation, -1 to 1; pairs left out are independent.

    Raises:
        InputError: a half width is negative or not finite, or correlations contradict each other.
    """

    half_width: Mapping[str, float]
    correlation: Mapping[tuple[str, str], float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, value in self.half_width.items():
            if not (math.isfinite(value) and value >= 0):
                raise InputError(f"half_width of {name} = {value}: must be a finite number, 0 or above")
        for pair, value in self.correlation.items():
            if len(set(pair)) != 2 or not set(pair) <= set(self.half_width):
                raise InputError(f"correlation of {pair}: must be of two different names with a half width")
            if not -1.0 <= value <= 1.0:
                raise InputError(f"correlation of {pair} = {value}: must lie between -1 and 1")
        if self.correlation and np.linalg.eigvalsh(self.matrix())[0] < -1e-9:
            raise InputError("correlation: the coefficients given are those of no distribution")

    @property
    def names(self) -> tuple[str, ...]:
        """Names, sorted."""
        return tuple(sorted(self.half_width))

    def deviations(self) -> np.ndarray:
        """[name] standard deviations, in the units of the derivatives."""
        return np.array([self.half_width[name] for name in self.names]) / NORMAL_95

    def matrix(self) -> np.ndarray:
        """[name, name] coefficients of correlation."""
        place = {name: k for k, name in enumerate(self.names)}
        found = np.eye(len(place))
        for (a, b), value in self.correlation.items():
            found[place[a], place[b]] = found[place[b], place[a]] = value
        return found

    def covariance(self, names: Sequence[str]) -> np.ndarray:
        """[name, name] covariance of the names asked for, zero for those without a half width."""
        place = {name: k for k, name in enumerate(self.names)}
        sigma, matrix = self.deviations(), self.matrix()
        found = np.zeros((len(names), len(names)))
        for i, a in enumerate(names):
            for j, b in enumerate(names):
                if a in place and b in place:
                    found[i, j] = sigma[place[a]] * sigma[place[b]] * matrix[place[a], place[b]]
        return found

    def draw(self, count: int, seed: int) -> np.ndarray:
        """[draw, name] deviations from the nominal values, in the units of the derivatives.

        Args:
            count: number of draws.
            seed: of the random numbers.
        """
        if not self.names:
            return np.zeros((count, 0))
        independent = np.stack(
            [np.random.default_rng([seed, zlib.crc32(name.encode())]).standard_normal(count) for name in self.names],
            axis=1,
        )
        values, vectors = np.linalg.eigh(self.matrix())
        # the symmetric root leaves independent names alone, whatever the others do
        root = vectors * np.sqrt(np.clip(values, 0.0, None)) @ vectors.T
        return independent @ root * self.deviations()


@dataclass(frozen=True)
class Outlook:
    """A verdict and how likely each of its outcomes is.

    Attributes:
        verdict: at the nominal derivatives; one that does not apply where the criterion arises only in some draws.
        probabilities: of `OUTCOMES` that occur, ratios that add to 1.
        error: half width of the 95 % interval of the greatest probability, a ratio (Wilson 1927).
        instead: where the criterion does not apply: what grows without oscillation there, and how likely, ratios.
        samples: number of draws.
    """

    verdict: Verdict
    probabilities: Mapping[str, float]
    error: float
    instead: Mapping[str, float]
    samples: int

    @property
    def text(self) -> str:
        """Such as `level 2 with 87 % (level 1: 11 %, not applicable: 2 %)`."""
        ranked = sorted(self.probabilities.items(), key=lambda item: -item[1])
        named = [(f"level {name}" if name in "123" else name, per_cent(share)) for name, share in ranked]
        first, rest = named[0], named[1:]
        text = f"{first[0]} with {first[1]}"
        if rest:
            text += f" ({', '.join(f'{name}: {share}' for name, share in rest)})"
        if self.instead and self.probabilities.get("not applicable", 0.0) > 0:
            grown = ", ".join(f"{name} with {per_cent(share)}" for name, share in self.instead.items())
            text += f"; instead {grown}"
        return text


@dataclass(frozen=True)
class Assessed:
    """Linear model, modes and verdicts of one set of derivatives; no model where only its modes were moved."""

    system: StateSpace | None
    modes: tuple[Mode, ...]
    verdicts: tuple[Verdict, ...]


def assess_all(
    airframe: Airframe,
    vehicle_class: str = "III",
    category: str = "B",
    form: str = "rigid-body",
    density_gradient: bool = True,
    gyroscopic: bool = True,
    with_airframe: bool = True,
) -> Assessed:
    """Linearise, identify and hold against every criterion: on modes first, then on the airframe.

    Args:
        airframe: vehicle at its flight point.
        vehicle_class: I, II-L, II-C, III or IV.
        category: flight phase category A, B or C.
        form, density_gradient, gyroscopic: as for `spaceplane.dynamics.linearise.linearise`.
        with_airframe: whether criteria on the airframe are asked as well.

    Raises:
        InputError: unknown class, category or form.
    """
    a = airframe
    system = linearise(a.point, a.mass, a.reference, a.derivatives, form, density_gradient, gyroscopic)
    modes = identify(system)
    verdicts = assess(modes, vehicle_class, category, _n_alpha(a))
    if with_airframe:
        verdicts += assess_airframe(a, vehicle_class, category, system)
    return Assessed(system, modes, verdicts)


def outlooks(
    airframe: Airframe,
    uncertainty: Uncertainty,
    vehicle_class: str = "III",
    category: str = "B",
    method: str = "sampling",
    samples: int = 2000,
    seed: int = 0,
    form: str = "rigid-body",
    density_gradient: bool = True,
    gyroscopic: bool = True,
    with_airframe: bool = True,
) -> tuple[Outlook, ...]:
    """Probabilities of the levels of every criterion.

    Args:
        airframe: vehicle at its flight point, with nominal derivatives.
        uncertainty: of the derivatives.
        vehicle_class: I, II-L, II-C, III or IV.
        category: flight phase category A, B or C.
        method: "sampling" or "first-order".
        samples: number of draws, 1 to 1 000 000.
        seed: of the random numbers, 0 or above.
        form, density_gradient, gyroscopic: as for `spaceplane.dynamics.linearise.linearise`.
        with_airframe: whether criteria on the airframe are asked as well.

    Returns:
        One for each nominal verdict in its order, then those that arise only in some draws.

    Raises:
        InputError: an unknown name, method, class, category or form, or a number out of range.
    """
    _check(airframe, uncertainty, method, samples, seed, form)
    limits.check(vehicle_class, category)
    options = (vehicle_class, category, form, density_gradient, gyroscopic, with_airframe)
    nominal = assess_all(airframe, *options)
    draws = uncertainty.draw(samples, seed)
    names = uncertainty.names

    def anew(deviation: np.ndarray) -> Assessed:
        return assess_all(_moved(airframe, names, deviation), *options)

    judge = anew if method == "sampling" else _first_order(airframe, uncertainty, nominal, *options)
    return _collect(nominal, [judge(deviation) for deviation in draws])


def mirror_correlation(derivatives: Derivatives, half_width: Mapping[str, float]) -> dict[tuple[str, str], float]:
    """Correlations of control derivatives whose surface is the mirror image of another: their errors are one error.

    Args:
        derivatives: per rad.
        half_width: of the derivatives, per rad.

    Returns:
        1 or -1 by the sign of the pair, for pairs of equal size with half widths of equal size.
    """
    found = {}
    for coefficient in COEFFICIENTS:
        for left, right, _ in PAIRS.values():
            names = f"{coefficient}_{left}", f"{coefficient}_{right}"
            if set(names) <= set(half_width) & set(derivatives.controls):
                a, b = (derivatives.controls[name] for name in names)
                alike = math.isclose(abs(a), abs(b), rel_tol=1e-6)
                if alike and a != 0 and math.isclose(half_width[names[0]], half_width[names[1]], rel_tol=1e-6):
                    found[names] = math.copysign(1.0, a * b)
    return found


def wilson_half_width(share: float, count: int) -> float:
    """Half width of the 95 % interval of a probability, a ratio, from a share of `count` draws (Wilson 1927)."""
    z2 = NORMAL_95**2
    return NORMAL_95 * math.sqrt(share * (1 - share) / count + z2 / (4 * count**2)) / (1 + z2 / count)


def outcome(verdict: Verdict) -> str:
    """One of `OUTCOMES`."""
    if not verdict.applicable:
        return "not applicable"
    if verdict.level is not None:
        return str(verdict.level)
    return "not applicable" if verdict.met is None else "met" if verdict.met else "not met"


def _check(airframe: Airframe, uncertainty: Uncertainty, method: str, samples: int, seed: int, form: str) -> None:
    allowed = (*PARAMETERS, *airframe.derivatives.controls)
    for name in uncertainty.names:
        if name not in allowed:
            raise InputError(unknown_name("uncertain derivative", name, allowed))
    if method not in METHODS:
        raise InputError(unknown_name("method", method, METHODS))
    if form not in FORMS:
        raise InputError(f"form = {form!r}: must be one of {', '.join(FORMS)}")
    if isinstance(samples, bool) or not isinstance(samples, int) or not 1 <= samples <= 1_000_000:
        raise InputError(f"samples = {samples!r}: must be a whole number from 1 to 1000000")
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError(f"seed = {seed!r}: must be a whole number, 0 or above")


def _moved(airframe: Airframe, names: Sequence[str], deviation: np.ndarray) -> Airframe:
    changes = dict(zip(names, (float(x) for x in deviation), strict=True))
    point, derivatives = moved_by(changes, airframe.point, airframe.derivatives)
    return replace(airframe, point=point, derivatives=derivatives)


def _n_alpha(a: Airframe) -> float:
    weight = a.mass.mass * STANDARD_GRAVITY
    return load_factor_slope(a.derivatives.CL_alpha, a.point.dynamic_pressure, a.reference.area, weight)


def _first_order(
    airframe: Airframe,
    uncertainty: Uncertainty,
    nominal: Assessed,
    vehicle_class: str,
    category: str,
    form: str,
    density_gradient: bool,
    gyroscopic: bool,
    with_airframe: bool,
) -> Callable[[np.ndarray], Assessed]:
    """A judge that moves the nominal eigenvalues along their derivatives; criteria on the airframe are asked anew."""
    a, names = airframe, uncertainty.names
    model = (a.point, a.mass, a.reference, a.derivatives)
    known = [name for name in names if name in PARAMETERS]
    slopes = matrix_slopes(*model, known, form, density_gradient, gyroscopic)
    columns = [names.index(name) for name in known]
    by_mode = [eigenvalue_slopes(nominal.system.A, slopes, mode.eigenvalue) for mode in nominal.modes]

    def judge(deviation: np.ndarray) -> Assessed:
        """Verdicts on the moved eigenvalues."""
        modes = tuple(
            _shifted(mode, complex(slope @ deviation[columns]))
            for mode, slope in zip(nominal.modes, by_mode, strict=True)
        )
        moved = _moved(a, names, deviation)
        verdicts = assess(modes, vehicle_class, category, _n_alpha(moved))
        if with_airframe:
            verdicts += assess_airframe(moved, vehicle_class, category)
        return Assessed(None, modes, verdicts)

    return judge


def _shifted(mode: Mode, change: complex) -> Mode:
    """The mode with its eigenvalue moved, 1/s, and what follows from it; name and shape stay."""
    if not np.isfinite(change):  # a double eigenvalue has no derivative: it is left where it is
        return mode
    value = mode.eigenvalue + (change if mode.oscillatory else change.real)
    growth = value.real
    return replace(
        mode,
        eigenvalue=value,
        period=2 * math.pi / abs(value.imag) if mode.oscillatory and value.imag else None,
        half_time=math.log(2) / -growth if growth < 0 else None,
        double_time=math.log(2) / growth if growth > 0 else None,
        damping_ratio=-growth / abs(value) if mode.oscillatory else None,
        natural_frequency=abs(value),
    )


Key = tuple[str, str]


def _by_key(verdicts: Sequence[Verdict]) -> dict[Key, list[Verdict]]:
    found: dict[Key, list[Verdict]] = {}
    for verdict in verdicts:
        found.setdefault((verdict.criterion, verdict.quantity.split(" by ")[0]), []).append(verdict)
    return found


_SEVERITY = {name: k for k, name in enumerate(("not applicable", "1", "met", "2", "3", "not met", "below 3"))}


def _collect(nominal: Assessed, drawn: Sequence[Assessed]) -> tuple[Outlook, ...]:
    """Outcomes by nominal verdict, then by criteria that arise only in some draws."""
    wanted = _by_key(nominal.verdicts)
    subjects: list[tuple[Key, Verdict]] = [(key, v) for key, group in wanted.items() for v in group]
    order = {id(verdict): k for k, verdict in enumerate(nominal.verdicts)}
    subjects.sort(key=lambda item: order[id(item[1])])
    sorted_draws = [_by_key(one.verdicts) for one in drawn]
    for found in sorted_draws:
        for key, group in found.items():
            if key not in wanted:
                wanted[key] = [_unexpected(group[0])]
                subjects.append((key, wanted[key][0]))
    return tuple(
        _outlook(verdict, [(_match(verdict, wanted[key], found.get(key, [])), one) for found, one in pairs])
        for key, verdict in subjects
        for pairs in [list(zip(sorted_draws, drawn, strict=True))]
    )


def _unexpected(verdict: Verdict) -> Verdict:
    """A verdict of some draws as one that does not apply at the nominal derivatives."""
    note = "not applicable at the nominal derivatives, but within their uncertainty"
    return replace(verdict, value=None, level=None, margin=None, met=None, applicable=False, note=note)


def _match(verdict: Verdict, alike: Sequence[Verdict], found: Sequence[Verdict]) -> str:
    """Outcome in one draw. Several modes of one criterion are paired by name; left over, the worst of all counts."""
    if not found:
        return "not applicable"
    if len(alike) > 1:
        of_mode = [v for v in found if v.mode == verdict.mode]
        same = [v for v in alike if v.mode == verdict.mode]
        if len(of_mode) == len(same):
            return outcome(of_mode[[id(v) for v in same].index(id(verdict))])
    return max((outcome(v) for v in found), key=lambda name: _SEVERITY[name])


def _outlook(verdict: Verdict, outcomes: Sequence[tuple[str, Assessed]]) -> Outlook:
    count = len(outcomes)
    tally = Counter(name for name, _ in outcomes)
    shares = {name: tally[name] / count for name in OUTCOMES if tally[name]}
    grown = Counter(
        name for found, one in outcomes if found == "not applicable" for name in _growing(one.modes, verdict.paragraph)
    )
    ofmode = verdict.mode != AIRFRAME
    return Outlook(
        verdict=verdict,
        probabilities=shares,
        error=wilson_half_width(max(shares.values()), count),
        instead={name: number / count for name, number in grown.most_common()} if ofmode else {},
        samples=count,
    )


def _growing(modes: Sequence[Mode], paragraph: str) -> set[str]:
    """Names of aperiodic divergences in the plane of motion of a paragraph: 3.2 longitudinal, 3.3 lateral."""
    group = "longitudinal" if paragraph.startswith("3.2") else "lateral"
    return {
        m.name
        for m in modes
        if m.double_time is not None
        and not m.oscillatory
        and m.kind not in ("spiral", "height")
        and m.group in (group, "coupled")
    }


def per_cent(share: float) -> str:
    """A probability, ratio, as text; 100 % is said of what is certain only."""
    if 0.995 <= share < 1.0:
        return "> 99 %"
    return f"{100 * share:.0f} %" if share >= 0.01 else f"{100 * share:.1f} %"
