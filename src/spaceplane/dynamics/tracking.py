"""Modes followed along any parameter: a flight path, a derivative, the bank angle, the centre of mass.

Each eigenvalue is a branch that keeps its identity from one end to the other, through crossings, through the merging
of two real eigenvalues into a pair and the split of a pair into two real ones. How neighbours are paired:
`spaceplane.dynamics.eigenmatch`. Where the pairing is in doubt, where two eigenvalues pass each other, or where an
additional point inside the step contradicts it, the step is halved: down to a millionth of the range two passing
eigenvalues are told from two that repel each other. What merges and splits again between two points of the grid may go
unseen; a finer grid shows it.

Four kinds of events are found, to round-off of the parameter or, for names, to a millionth of the grid: `merge`,
`split`, `stability` (the real part changes its sign) and `name` (what takes part has changed so much that the mode is
called differently). A fifth, `unresolved`, marks a step in which the pairing stayed in doubt.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq

from spaceplane.dynamics.eigenmatch import Match, Spectrum, conjugate, match, nearest, spectrum
from spaceplane.dynamics.modes import identify
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

SystemOf = Callable[[float], StateSpace]

# Where the additional point of a step lies: off the middle, since symmetric families are singular there.
_PROBE = 0.47
# Steps are not halved below this fraction of the whole range.
_FINEST = 1e-8
# A point at which eigenvalues coincide is passed at this fraction of the step to its neighbours.
_ASIDE = 1e-3


@dataclass(frozen=True)
class Event:
    """Something that happens to branches along the parameter.

    Attributes:
        kind: "merge", "split", "stability", "name" or "unresolved".
        parameter: where, in the unit of the parameter.
        branches: labels of the branches.
        eigenvalue: 1/s, at the event.
        before: names of the branches just before.
        after: names just after.
    """

    kind: str
    parameter: float
    branches: tuple[str, ...]
    eigenvalue: complex
    before: tuple[str, ...]
    after: tuple[str, ...]


@dataclass(frozen=True)
class Branches:
    """Modes along a parameter.

    Attributes:
        dataset: dims (parameter, branch, state); variables `real`, `imag` (1/s), `name`, `kind`, `partner` (index of
            the conjugate's branch, the branch's own where real), `participation`; coordinate `given` tells the points
            of the grid from those added between them.
        events: in the order of the parameter.
    """

    dataset: xr.Dataset
    events: tuple[Event, ...]

    def eigenvalues(self) -> np.ndarray:
        """[parameter, branch] 1/s."""
        return self.dataset["real"].values + 1j * self.dataset["imag"].values


def interpolated(grid: Sequence[float], systems: Sequence[StateSpace]) -> SystemOf:
    """A family through given systems, A and B linear between them: for flight points of which only these are known.

    Args:
        grid: increasing values of the parameter, any unit.
        systems: one for each value, with the same states and inputs.

    Raises:
        InputError: grid and systems do not fit; asked outside the grid.
    """
    values = _checked_grid(grid)
    if len(systems) != len(values):
        raise InputError(f"systems: {len(systems)} given for {len(values)} values of the grid")
    first = systems[0]
    for system in systems:
        if (system.states, system.inputs) != (first.states, first.inputs):
            raise InputError("systems: all need the same states and inputs in the same order")

    def system_of(parameter: float) -> StateSpace:
        """The system at a value of the parameter, between its neighbours."""
        if not values[0] <= parameter <= values[-1]:
            raise InputError(f"parameter = {parameter:g}: must lie between {values[0]:g} and {values[-1]:g}")
        k = int(np.clip(np.searchsorted(values, parameter) - 1, 0, len(values) - 2))
        share = (parameter - values[k]) / (values[k + 1] - values[k])
        a, b = systems[k], systems[k + 1]
        A, B = ((1 - share) * x + share * y for x, y in ((a.A, b.A), (a.B, b.B)))
        return StateSpace(A, B, a.states, a.inputs, "interpolated")

    return system_of


def follow(system_of: SystemOf, grid: Sequence[float], parameter: str = "parameter", unit: str = "") -> Branches:
    """Follow every eigenvalue of a family of systems along a grid.

    Args:
        system_of: the system at a value of the parameter; smooth between the ends of the grid, always the same states.
        grid: two or more increasing values; points are added between them where needed.
        parameter: name of the parameter, that of the dimension of the result.
        unit: its unit, for the result's attributes.

    Raises:
        InputError: the grid does not increase, a name is taken, or the states of two systems differ.
    """
    values = _checked_grid(grid)
    if not parameter or parameter in ("branch", "state", "given"):
        raise InputError(f"parameter = {parameter!r}: must be a name other than branch, state or given")
    at = _evaluator(system_of)
    steps = _Steps(at, _FINEST * (values[-1] - values[0]))
    track, given = _track(values, at, steps)
    names = [_names(point) for point in track]
    labels = _labels(track[0], names[0])
    events = _Finder(at, track, names, labels, 1e-6 * (values[-1] - values[0]) / len(values)).events()
    unresolved = [
        Event("unresolved", where, tuple(labels[i] for i in branches), complex(np.nan), (), ())
        for where, branches in steps.doubts
    ]
    ordered = sorted([*events, *unresolved], key=lambda event: event.parameter)
    return Branches(_dataset(track, given, names, labels, parameter, unit), tuple(ordered))


def _checked_grid(grid: Sequence[float]) -> np.ndarray:
    values = np.asarray(grid, dtype=float)
    if values.ndim != 1 or len(values) < 2 or not np.isfinite(values).all() or not (np.diff(values) > 0).all():
        raise InputError("grid: must be two or more finite, increasing numbers")
    return values


def _evaluator(system_of: SystemOf) -> Callable[[float], Spectrum]:
    cache: dict[float, Spectrum] = {}
    states: list[tuple[str, ...]] = []

    def at(value: float) -> Spectrum:
        """Eigenvalues and eigenvectors at a value of the parameter."""
        value = float(value)
        if value not in cache:
            system = system_of(value)
            if not states:
                states.append(system.states)
            if system.states != states[0]:
                raise InputError(f"states at {value:g} are {system.states}: must be {states[0]} throughout")
            cache[value] = spectrum(value, system)
        return cache[value]

    return at


def _track(values: np.ndarray, at: Callable[[float], Spectrum], steps: _Steps) -> tuple[list[Spectrum], list[bool]]:
    """Spectra in the order of the branches, and which of them lie on the grid."""
    anchors = _anchors(values, at)
    passed = [value for value, regular in anchors if regular]
    track = [at(passed[0])]
    for target in passed[1:]:
        track += steps.advance(track[-1], at(target))
    grid = set(values.tolist())
    for value, regular in anchors:
        if not regular:  # at a branch point the eigenvalues say enough, and its eigenvectors nothing
            neighbour = min(track, key=lambda point: abs(point.parameter - value))
            track.append(nearest(neighbour, at(value)))
    track.sort(key=lambda point: point.parameter)
    return track, [point.parameter in grid for point in track]


def _anchors(values: np.ndarray, at: Callable[[float], Spectrum]) -> list[tuple[float, bool]]:
    """Points to pass through, and whether they can be matched; one at which eigenvalues coincide is bypassed."""
    anchors: list[tuple[float, bool]] = []
    for k, value in enumerate(values):
        here = at(value)
        if not here.clusters:
            anchors.append((float(value), True))
            continue
        beside = []
        if k > 0:
            beside.append(float(value - _ASIDE * (value - values[k - 1])))
        if k + 1 < len(values):
            beside.append(float(value + _ASIDE * (values[k + 1] - value)))
        if any(len(at(x).clusters) >= len(here.clusters) for x in beside):
            anchors.append((float(value), True))  # they coincide all along: matched as a group
            continue
        anchors += [(x, True) for x in beside] + [(float(value), False)]
    return anchors


class _Steps:
    """Steps along the parameter, halved until the pairing is certain."""

    def __init__(self, at: Callable[[float], Spectrum], finest: float) -> None:
        self.at = at
        self.finest = finest
        self.doubts: list[tuple[float, tuple[int, ...]]] = []

    def advance(self, a: Spectrum, b: Spectrum) -> list[Spectrum]:
        """Spectra from `a` (left out) to `b`, in the order of `a`."""
        middle = self.at(a.parameter + _PROBE * (b.parameter - a.parameter))
        first = match(a, middle)
        second = match(first.spectrum, b)
        direct = match(a, b)
        agree = np.array_equal(second.spectrum.values, direct.spectrum.values)
        width = b.parameter - a.parameter
        if first.certain and second.certain and direct.certain and agree:
            close = _approach(a, first) or _approach(first.spectrum, second)
            if not close or width <= 100 * self.finest:
                return [first.spectrum, second.spectrum]
        if width <= self.finest:
            moved = np.flatnonzero(np.abs(second.spectrum.values - direct.spectrum.values) > 0)
            self.doubts.append((middle.parameter, tuple(int(i) for i in moved)))
            return [first.spectrum, second.spectrum]
        track = self.advance(a, middle)
        return track + self.advance(track[-1], b)


def _approach(a: Spectrum, b: Match) -> bool:
    """Whether two eigenvalues pass each other within the step, far nearer than at its ends: crossing or repelled?"""
    start, change = a.values, b.spectrum.values - a.values
    gap, relative = (x[:, None] - x[None, :] for x in (start, change))
    speed = np.abs(relative) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        when = np.where(speed > 0, -(gap * relative.conj()).real / speed, 0.0)
    least = np.abs(gap + np.clip(when, 0.0, 1.0) * relative)
    ends = np.minimum(np.abs(gap), np.abs(gap + relative))
    watched = ~np.eye(len(start), dtype=bool)
    for i, j in b.joined:
        watched[i, j] = watched[j, i] = False
    return bool((watched & (least < 0.3 * ends)).any())


def _names(point: Spectrum) -> list[tuple[str, str, np.ndarray]]:
    """(name, kind, participation) for every branch."""
    modes = list(identify(point.system))
    out = []
    free = [2 if mode.oscillatory else 1 for mode in modes]
    for value in point.values:
        upper = complex(value.real, abs(value.imag))
        order = sorted(range(len(modes)), key=lambda k: abs(modes[k].eigenvalue - upper))
        k = next(k for k in order if free[k] > 0)
        free[k] -= 1
        out.append((modes[k].name, modes[k].kind, modes[k].participation))
    return out


def _labels(first: Spectrum, names: list[tuple[str, str, np.ndarray]]) -> list[str]:
    """What a branch is called all along: its name at the start, the half of a pair, a number where two are alike."""
    halves = {1: " (upper)", -1: " (lower)", 0: ""}
    bare = [name + halves[int(np.sign(z.imag))] for (name, _, _), z in zip(names, first.values, strict=True)]
    total, seen, labels = Counter(bare), Counter(), []
    for text in bare:
        seen[text] += 1
        labels.append(f"{text} {seen[text]}" if total[text] > 1 else text)
    return labels


@dataclass(frozen=True)
class _Finder:
    """Events between the points of a track."""

    at: Callable[[float], Spectrum]
    track: list[Spectrum]
    names: list[list[tuple[str, str, np.ndarray]]]
    labels: list[str]
    fineness: float

    def events(self) -> list[Event]:
        """Every event between the first and the last point."""
        found = []
        for k in range(len(self.track) - 1):
            a, b = self.track[k], self.track[k + 1]
            joined = _joined(a, b)
            found += [self._branch_point(k, pair) for pair in joined]
            busy = {i for pair in joined for i in pair}
            for i in range(len(self.labels)):
                kinds = {self.names[j][i][1] for j in (k, k + 1)}
                lower = a.values[i].imag < 0 or b.values[i].imag < 0  # its upper half tells
                if len(kinds) == 2 and "neutral" not in kinds and i not in busy and not lower:
                    found.append(self._renaming(k, i))
        for i in range(len(self.labels)):
            found += self._crossings(i)
        return found

    def _crossings(self, i: int) -> list[Event]:
        """Where the real part of a branch changes its sign; an exact zero on the way is the place."""
        found, last = [], None
        for k, point in enumerate(self.track):
            value = point.values[i]
            if abs(value.real) <= 1e-12 * np.abs(point.values).max():
                continue
            if last is not None and self.track[last].values[i].real * value.real < 0 and value.imag >= 0:
                if k == last + 1:
                    found.append(self._crossing(last, i))
                else:
                    here = self.track[last + 1]
                    at = complex(0.0, abs(here.values[i].imag))
                    found.append(self._event("stability", last, here.parameter, (i,), at, k))
            last = k
        return found

    def _between(self, k: int, value: float) -> Spectrum:
        return match(self.track[k], self.at(value)).spectrum

    def _event(
        self, kind: str, k: int, where: float, branches: tuple[int, ...], value: complex, end: int | None = None
    ) -> Event:
        """An event in the step that begins at point `k`, or the steps from there to point `end`.

        Names are those just beside the place, where that is inside the step: another event may change them farther on.
        """
        ends = (k, k + 1 if end is None else end)
        beside = [self.names[j] for j in ends]
        if end is None and self.track[k].parameter < where < self.track[k + 1].parameter:
            sides = (
                max(where - self.fineness, self.track[k].parameter),
                min(where + self.fineness, self.track[k + 1].parameter),
            )
            beside = [_names(self._between(k, value)) for value in sides]
        before, after = (tuple(names[i][0] for i in branches) for names in beside)
        return Event(kind, where, tuple(self.labels[i] for i in branches), complex(value), before, after)

    def _branch_point(self, k: int, pair: tuple[int, int]) -> Event:
        """Where the discriminant ((l1 - l2)/2)^2 of the two eigenvalues, smooth through the point, is zero."""
        i, j = pair
        a, b = self.track[k], self.track[k + 1]

        def discriminant(value: float) -> float:
            point = a if value == a.parameter else b if value == b.parameter else self._between(k, value)
            return float((((point.values[i] - point.values[j]) / 2) ** 2).real)

        ends = discriminant(a.parameter), discriminant(b.parameter)
        if ends[0] * ends[1] < 0:
            where = float(brentq(discriminant, a.parameter, b.parameter, xtol=1e-300, rtol=1e-14))
        else:  # one end is the point itself
            where = a.parameter if abs(ends[0]) <= abs(ends[1]) else b.parameter
        here = self._between(k, where)
        mean = (here.values[i] + here.values[j]) / 2
        return self._event("merge" if a.values[i].imag == 0 else "split", k, where, pair, mean.real)

    def _crossing(self, k: int, i: int) -> Event:
        a, b = self.track[k], self.track[k + 1]

        def growth(value: float) -> float:
            if value in (a.parameter, b.parameter):
                return float((a if value == a.parameter else b).values[i].real)
            return float(self._between(k, value).values[i].real)

        where = float(brentq(growth, a.parameter, b.parameter, xtol=1e-300, rtol=1e-14))
        value = self._between(k, where).values[i]
        return self._event("stability", k, where, (i,), complex(0.0, abs(value.imag)))

    def _renaming(self, k: int, i: int) -> Event:
        low, high = self.track[k].parameter, self.track[k + 1].parameter
        kind = self.names[k][i][1]
        while high - low > self.fineness:
            middle = 0.5 * (low + high)
            if _names(self._between(k, middle))[i][1] == kind:
                low = middle
            else:
                high = middle
        where = 0.5 * (low + high)
        return self._event("name", k, where, (i,), self._between(k, where).values[i])


def _joined(a: Spectrum, b: Spectrum) -> list[tuple[int, int]]:
    """Pairs of branches that are real on one side and conjugate on the other, the upper half first."""
    pairs = []
    for i in range(len(a.values)):
        was, now = a.values[i].imag != 0, b.values[i].imag != 0
        if was != now:
            j = conjugate((a if was else b).values, i)
            if (a if was else b).values[i].imag > 0:
                pairs.append((i, j))
    return pairs


def _dataset(
    track: list[Spectrum],
    given: list[bool],
    names: list[list[tuple[str, str, np.ndarray]]],
    labels: list[str],
    parameter: str,
    unit: str,
) -> xr.Dataset:
    import xarray as xr

    values = np.array([point.values for point in track])
    partner = np.array([[conjugate(point.values, i) for i in range(len(labels))] for point in track])
    dims = (parameter, "branch")
    return xr.Dataset(
        {
            "real": (dims, values.real, {"units": "1/s"}),
            "imag": (dims, values.imag, {"units": "1/s"}),
            "name": (dims, np.array([[entry[0] for entry in row] for row in names])),
            "kind": (dims, np.array([[entry[1] for entry in row] for row in names])),
            "partner": (dims, partner),
            "participation": ((*dims, "state"), np.array([[entry[2] for entry in row] for row in names])),
        },
        coords={
            parameter: (parameter, np.array([point.parameter for point in track]), {"units": unit}),
            "given": (parameter, np.array(given)),
            "branch": labels,
            "state": list(track[0].system.states),
        },
    )
