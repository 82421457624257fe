"""The generated blocks of the page on the fast tier, from docs/data/fast_tier.json (scripts/compare_tiers.py)."""

from __future__ import annotations

import json
from collections.abc import Callable
from statistics import mean

from blocks import DATA, table

STORED = DATA / "fast_tier.json"
SHOWN_METHODS = ("newtonian-expansion", "tangent")


def stored() -> dict:
    """What scripts/compare_tiers.py kept."""
    return json.loads(STORED.read_text(encoding="utf-8"))


def grid(result: dict) -> list[tuple[float, float]]:
    """[condition] Mach number and angle of attack, deg."""
    return [(mach, alpha) for mach in result["machs"] for alpha in result["alphas_deg"]]


def methods() -> str:
    """Every method with its laws."""
    from spaceplane.aero.inclination.settings import METHODS

    rows = []
    for name, settings in METHODS.items():
        laws = dict.fromkeys(settings.by_part.values())
        others = [f"`{law}` on {', '.join(p for p, own in settings.by_part.items() if own == law)}" for law in laws]
        if settings.blunt is not None:
            radius = f"{100 * settings.blunt_radius:g} %"
            others.append(f"`{settings.blunt}` where the radius of curvature is below {radius} of the length")
        rows.append((f"`{name}`", f"`{settings.windward}`", "; ".join(others) or "-", f"`{settings.leeward}`"))
    return table(("method", "windward", "but", "leeward"), rows)


def settings() -> str:
    """Every setting with its default and meaning."""
    from blocks import settings_table

    from spaceplane.aero.inclination.settings import InclinationSettings

    return settings_table(InclinationSettings)


def coefficients() -> str:
    """One table for each Mach number: Euler, two methods and what was published."""
    from spaceplane.validation import horus_tables

    result, parts = stored(), []
    for mach in result["machs"]:
        printed = mach in horus_tables.base("CL").mach
        head = ["alpha, deg"]
        for name in ("CL", "CD", "Cm"):
            head += [f"{name} Euler", *SHOWN_METHODS] + (["published"] if printed else [])
        rows = []
        for index, (own, alpha) in enumerate(grid(result)):
            if own != mach:
                continue
            row: list[str] = [f"{alpha:g}"]
            for name in ("CL", "CD", "Cm"):
                row += [f"**{result['euler'][name][index]:.4f}**"]
                row += [f"{result['fast'][method][name][index]:.4f}" for method in SHOWN_METHODS]
                row += [f"{horus_tables.base(name).at(mach, alpha):g}"] if printed else []
            rows.append(row)
        parts.append(f"**Mach {mach:g}**\n\n" + table(head, rows, "r" * len(head)))
    return "\n\n".join(parts)


def _gap(ours: list[float], theirs: list[float], relative: bool) -> str:
    gaps = [abs(a - b) / (abs(b) if relative else 1.0) for a, b in zip(ours, theirs, strict=True)]
    return f"{100 * mean(gaps):.1f} %" if relative else f"{mean(gaps):.4f}"


def _deviations(sources: dict[str, dict], truth: dict[str, list[float]], machs: list[float], places: list) -> str:
    """Mean deviation of each source from the truth over the angles of attack, for each Mach number."""
    rows = []
    for name in ("CL", "CD", "Cm"):
        for source, values in sources.items():
            row = [name, f"`{source}`"]
            for mach in machs:
                at = [k for k, (own, _) in enumerate(places) if own == mach]
                row.append(_gap([values[name][k] for k in at], [truth[name][k] for k in at], name != "Cm"))
            rows.append(row)
    return table(("", "method", *(f"Mach {mach:g}" for mach in machs)), rows, "ll" + "r" * len(machs))


def from_euler() -> str:
    """Deviations from the Euler solver."""
    result = stored()
    return _deviations(result["fast"], result["euler"], result["machs"], grid(result))


def from_published() -> str:
    """Deviations of all, the Euler solver too, from the published tables at the Mach numbers that they print."""
    from spaceplane.validation import horus_tables

    result = stored()
    printed = [mach for mach in result["machs"] if mach in horus_tables.base("CL").mach]
    truth = {
        name: [horus_tables.base(name).at(mach, alpha) for mach, alpha in grid(result)] for name in ("CL", "CD", "Cm")
    }
    return _deviations({"euler": result["euler"]} | result["fast"], truth, printed, grid(result))


def times() -> str:
    """Milliseconds for a condition."""
    rows = [
        (f"`{row['method']}`", f"{row['triangles']:,}".replace(",", " "), row["conditions"], f"{row['ms']:.1f}")
        for row in stored()["times"]
    ]
    return table(("method", "triangles", "conditions in one call", "ms for a condition"), rows, "lrrr")


def euler_run() -> str:
    """Mesh and convergence of the Euler run."""
    result = stored()
    verdicts = result["euler_verdicts"]
    return (
        f"Euler: wall cell {result['wall_cell_m']:g} m, {result['cells']} cells, {verdicts.count('converged')} of "
        f"{len(verdicts)} conditions converged, {result['euler_seconds']:.0f} s for all of them, mesh included."
    )


BLOCKS: dict[str, Callable[[], str]] = {
    "fast methods": methods,
    "fast settings": settings,
    "fast coefficients": coefficients,
    "fast from euler": from_euler,
    "fast from published": from_published,
    "fast times": times,
    "fast euler run": euler_run,
}
