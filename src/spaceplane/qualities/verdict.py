"""What a criterion says, and how values turn into levels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field

from spaceplane.dynamics.modes import Mode
from spaceplane.qualities import limits

BELOW = "below 3"
AIRFRAME = "airframe"  # in place of a mode
Level = int | str | None


@dataclass(frozen=True)
class Verdict:
    """One criterion on one mode.

    Attributes:
        mode: name of the mode, or of the mode that the criterion asks for and that is absent; "airframe" for none.
        criterion: title of the criterion.
        quantity: what is measured, for example "damping ratio".
        paragraph: of MIL-F-8785C, or the source of another criterion.
        vehicle_class: I, II-L, II-C, III or IV.
        category: flight phase category A, B or C.
        value: measured value; None if there is none.
        unit: of value, limits and margin.
        limits: {"1": text, ...} per level.
        level: 1, 2, 3, "below 3", or None if the criterion does not apply.
        margin: distance of the value to the nearest bound of level 1, positive inside; None if there is no value.
        applicable: whether the criterion applies.
        note: what applies instead, or how the value was formed.
        met: for a requirement that knows no levels: whether it is met; None where levels are given.
    """

    mode: str
    criterion: str
    quantity: str
    paragraph: str
    vehicle_class: str
    category: str
    value: float | None = None
    unit: str = ""
    limits: dict[str, str] = field(default_factory=dict)
    level: Level = None
    margin: float | None = None
    applicable: bool = True
    note: str = ""
    met: bool | None = None


@dataclass(frozen=True)
class Context:
    """Vehicle class and flight phase category that verdicts are given for."""

    vehicle_class: str
    category: str

    def verdict(self, criterion: str, mode: str, quantity: str, **values: object) -> Verdict:
        """A verdict with title and paragraph of the criterion; `values` are the other fields of `Verdict`."""
        entry = limits.specification()[criterion]
        return Verdict(
            mode,
            entry["title"],
            quantity,
            entry["paragraph"],
            self.vehicle_class,
            self.category,
            **values,  # type: ignore[arg-type]
        )

    def entry(self, criterion: str) -> dict:
        """Limits of the criterion for this class and category."""
        return limits.of(criterion, self.category, self.vehicle_class)  # type: ignore[return-value]


def worst(levels: Sequence[Level]) -> Level:
    """The worst of some levels; None stands for no requirement and is passed over."""
    order: dict[Level, int] = {1: 1, 2: 2, 3: 3, BELOW: 4}
    known = [level for level in levels if level is not None]
    return max(known, key=lambda level: order[level]) if known else None


def to_record(verdict: Verdict) -> dict:
    """The verdict as plain JSON types."""
    return asdict(verdict)


def level_of_least(value: float, lows: Sequence[float | None]) -> Level:
    """Best level whose least value is met, in the unit of its limits; None means that a level sets no limit."""
    for level, low in enumerate(lows, start=1):
        if low is None or value >= low:
            return level
    return BELOW


def level_of_most(value: float, highs: Sequence[float | None]) -> Level:
    """Best level whose greatest value is met, in the unit of its limits; None means that a level sets no limit."""
    for level, high in enumerate(highs, start=1):
        if high is None or value <= high:
            return level
    return BELOW


def level_of_range(value: float, lows: Sequence[float], highs: Sequence[float | None]) -> Level:
    """Best level whose range holds the value, in the unit of its limits; a missing upper bound is none."""
    for level, low in enumerate(lows, start=1):
        high = highs[level - 1] if level <= len(highs) else None
        if value >= low and (high is None or value <= high):
            return level
    return BELOW


def least_text(lows: Sequence[float | None]) -> dict[str, str]:
    """Least values by level, as text."""
    return {str(k): "not specified" if low is None else f">= {low:.4g}" for k, low in enumerate(lows, start=1)}


def most_text(highs: Sequence[float | None]) -> dict[str, str]:
    """Greatest values by level, as text."""
    return {str(k): "not specified" if high is None else f"<= {high:.4g}" for k, high in enumerate(highs, start=1)}


def range_text(lows: Sequence[float], highs: Sequence[float | None]) -> dict[str, str]:
    """Ranges by level, as text."""
    text = {}
    for level, low in enumerate(lows, start=1):
        high = highs[level - 1] if level <= len(highs) else None
        text[str(level)] = f">= {low:.4g}" if high is None else f"{low:.4g} to {high:.4g}"
    return text


def of_kind(modes: Sequence[Mode], *kinds: str) -> list[Mode]:
    """Modes of some kinds, see `spaceplane.dynamics.mode_names.KINDS`."""
    return [mode for mode in modes if mode.kind in kinds]


def _describe(modes: Sequence[Mode]) -> str:
    """What some modes do, for a note."""
    texts = []
    for mode in modes:
        if mode.double_time is not None:
            texts.append(f"{mode.name}: doubles in {mode.double_time:.3g} s")
        elif mode.half_time is not None:
            texts.append(f"{mode.name}: halves in {mode.half_time:.3g} s")
    return "; ".join(texts)


def absent(
    context: Context, criterion: str, mode: str, quantity: str, instead: Sequence[Mode], oscillation: bool = True
) -> Verdict:
    """A criterion whose mode, an oscillation or not, does not exist; `instead` is what the vehicle does."""
    split = oscillation and any(not m.oscillatory for m in instead)
    reason = "not applicable: aperiodic" if split else f"not applicable: no {mode}"
    found = _describe(instead)
    return context.verdict(
        criterion, mode, quantity, applicable=False, note=f"{reason}. Instead {found}." if found else f"{reason}."
    )
