"""What changes when the shape changes: tidy rows from two results, flight point by flight point."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace

from spaceplane.aero.model.derivatives import DAMPING, is_per_angle
from spaceplane.study.matching import match_modes
from spaceplane.study.thesis import DERIVATIVES

COEFFICIENTS = ("CL", "CD", "Cm", "L_over_D")
MODE_FIGURES = {
    "real": ("real part", "1/s"),
    "imaginary": ("imaginary part", "1/s"),
    "damping_ratio": ("damping ratio", "-"),
    "natural_frequency": ("natural frequency", "rad/s"),
}
LEVEL_BELOW_3 = 4
"""Stands for "below 3" where levels are numbers."""


@dataclass(frozen=True)
class Change:
    """One quantity of a changed shape beside the default's.

    Attributes:
        parameter: what was changed, with its unit.
        side: "low" or "high" of the default.
        parameter_value: m or deg.
        parameter_default: m or deg.
        mach: flight point.
        kind: "coefficient", "derivative", "mode" or "level".
        quantity: name; modes as "Dutch roll: damping ratio", levels as "criterion: quantity".
        unit: of value, default and change.
        value: of the changed shape; None where it does not exist.
        default: of the default shape; None where it does not exist.
        error: numerical error of the value as the derivative's step sizes show it; None where not estimated.
        noise: by how much the default's value changes when only the mesh is shifted; None where not known.
        flow: "converged", "oscillating" or "failed": the worst condition of the two flows at this flight point.
    """

    parameter: str
    side: str
    parameter_value: float
    parameter_default: float
    mach: float
    kind: str
    quantity: str
    unit: str
    value: float | None
    default: float | None
    error: float | None
    flow: str
    noise: float | None = None

    @property
    def change(self) -> float | None:
        """Value less default."""
        return None if self.value is None or self.default is None else self.value - self.default

    @property
    def relative_percent(self) -> float | None:
        """Change relative to the size of the default, %."""
        return None if self.change is None or not self.default else 100.0 * self.change / abs(self.default)

    @property
    def rpd_percent(self) -> float | None:
        """Relative percent difference, thesis (7.1): change relative to the mean of the two sizes, -200 to 200 %."""
        if self.change is None:
            return None
        size = abs(self.value) + abs(self.default)
        return 200.0 * self.change / size if size else 0.0

    @property
    def resolved(self) -> bool | None:
        """Whether the change exceeds what a shift of the mesh alone does."""
        return None if self.change is None or self.noise is None else abs(self.change) > self.noise

    def as_row(self) -> dict:
        """Return the fields, the three changes and whether they are resolved, one flat row."""
        extra = ("change", "relative_percent", "rpd_percent", "resolved")
        return asdict(self) | {name: getattr(self, name) for name in extra}


def mesh_noise(shifted: list[dict], default: dict) -> dict[tuple[float, str, str], float]:
    """Return the greatest change of every quantity over results of the default shape on shifted meshes.

    Keys are (Mach number, kind, quantity), see `Change`.
    """
    noise: dict[tuple[float, str, str], float] = {}
    for result in shifted:
        for row in changes("mesh", "high", 0.0, 0.0, result, default):
            if row.change is not None:
                key = row.mach, row.kind, row.quantity
                noise[key] = max(noise.get(key, 0.0), abs(row.change))
    return noise


def changes(
    parameter: str,
    side: str,
    parameter_value: float,
    parameter_default: float,
    result: dict,
    default: dict,
    noise: dict[tuple[float, str, str], float] | None = None,
) -> list[Change]:
    """Compare a changed shape's result with the default's at every flight point that both have.

    Args:
        parameter, side, parameter_value, parameter_default: what was changed, in m or deg, see `Change`.
        result, default: two result.json.
        noise: see `mesh_noise`.
    """
    references = {point["mach"]: point for point in default["flight_points"]}
    rows = []
    for point in result["flight_points"]:
        reference, mach = references.get(point["mach"]), point["mach"]
        if reference is None:
            continue
        flow = worst_flow(point, reference)
        for kind, quantity, unit, value, base, error in _quantities(point, reference):
            change = Change(
                parameter,
                side,
                parameter_value,
                parameter_default,
                mach,
                kind,
                quantity,
                unit,
                value,
                base,
                error,
                flow,
            )
            rows.append(replace(change, noise=(noise or {}).get((mach, kind, quantity))))
    return rows


def worst_flow(*points: dict) -> str:
    """Return the worst convergence verdict among all conditions of some flight points."""
    order = ("converged", "oscillating", "failed")
    verdicts = [record["verdict"] for point in points for record in point["convergence"]]
    return max(verdicts, key=order.index, default="failed")


def lateral_oscillation(modes: list[dict]) -> dict | None:
    """Return the lateral oscillation, Dutch roll or of roll and sideslip; the fastest where there are two."""
    lateral = [mode for mode in modes if mode["kind"] in ("dutch_roll", "lateral_oscillation")]
    return max(lateral, key=lambda mode: abs(complex(*mode["eigenvalue"])), default=None)


def most_unstable(modes: list[dict]) -> dict | None:
    """Return the mode with the greatest real part."""
    return max(modes, key=lambda mode: mode["eigenvalue"][0], default=None)


def mode_figure(mode: dict | None, figure: str) -> float | None:
    """Return one figure of a mode, see `MODE_FIGURES`; None where it has none."""
    if mode is None:
        return None
    if figure == "real":
        return mode["eigenvalue"][0]
    if figure == "imaginary":
        return abs(mode["eigenvalue"][1])
    return mode["damping_ratio" if figure == "damping_ratio" else "natural_frequency_rads"]


def level_number(level: int | str | None) -> int | None:
    """Return 1, 2, 3, 4 for "below 3", or None where no level applies."""
    return LEVEL_BELOW_3 if level == "below 3" else level


def _quantities(point: dict, reference: dict) -> Iterator[tuple]:
    for name in COEFFICIENTS:
        yield "coefficient", name, "-", point["coefficients"].get(name), reference["coefficients"].get(name), None
    damping = [name for name in DAMPING if name in reference["derivatives"]]
    for name in (*DERIVATIVES, *damping):
        mine, base = point["derivatives"].get(name, {}), reference["derivatives"].get(name, {})
        unit = "1/rad" if is_per_angle(name) else "-"
        yield "derivative", name, unit, mine.get("value"), base.get("value"), mine.get("error")
    yield from _mode_quantities(point, reference)
    yield from _level_quantities(point, reference)


def _mode_quantities(point: dict, reference: dict) -> Iterator[tuple]:
    base, mine = reference["modes"], point["modes"]
    named = [
        ("greatest real part", most_unstable(mine), most_unstable(base)),
        ("lateral oscillation", lateral_oscillation(mine), lateral_oscillation(base)),
    ]
    for pair in match_modes(base, mine, reference["velocity_ms"], point["velocity_ms"]):
        before = None if pair.first is None else base[pair.first]
        after = None if pair.second is None else mine[pair.second]
        named.append((before["name"] if before else f"new: {after['name']}", after, before))
    for name, after, before in named:
        for figure, (label, unit) in MODE_FIGURES.items():
            yield "mode", f"{name}: {label}", unit, mode_figure(after, figure), mode_figure(before, figure), None


def _level_quantities(point: dict, reference: dict) -> Iterator[tuple]:
    mine, base = _worst_levels(point["verdicts"]), _worst_levels(reference["verdicts"])
    for name in dict.fromkeys([*base, *mine]):
        yield "level", name, "level", mine.get(name), base.get(name), None


def _worst_levels(verdicts: list[dict]) -> dict[str, int | None]:
    """Level by criterion and quantity; of several modes under one, the worst."""
    worst: dict[str, int | None] = {}
    for verdict in verdicts:
        name, level = f"{verdict['criterion']}: {verdict['quantity']}", level_number(verdict["level"])
        worst[name] = max((known for known in (level, worst.get(name)) if known is not None), default=None)
    return worst
