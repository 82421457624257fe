"""Two analyses side by side: derivatives, modes and levels at the flight points that both have."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path

from spaceplane import __version__
from spaceplane.errors import InputError
from spaceplane.study import thesis
from spaceplane.study.changes import level_number, worst_flow
from spaceplane.study.execute import execute
from spaceplane.study.matching import match_modes
from spaceplane.study.records import Case, Evaluate, Progress
from spaceplane.study.shapes import case_inputs, evaluate, with_one_wall_cell
from spaceplane.study.store import ResultStore

SCHEMA = "spaceplane.comparison"
SCHEMA_VERSION = 1
HYPERSONIC_CHECK_MACH = (0.8, 1.5, 2.5, 5.0, 10.0)
COEFFICIENTS = ("CL", "CD", "Cm", "L_over_D", "CA_forebody", "CA_base")

_MODE_FIELDS = (
    "name",
    "eigenvalue",
    "period_s",
    "half_time_s",
    "double_time_s",
    "damping_ratio",
    "natural_frequency_rads",
)


def default_against_optimised(
    store_path: Path | str,
    progress: Callable[[Progress], None] | None = None,
    workers: int = 1,
    settings: Mapping | None = None,
    vehicle: str = "horus-2b",
    mach: tuple[float, ...] = HYPERSONIC_CHECK_MACH,
    evaluate: Evaluate = evaluate,
    before: Callable[[], object] | None = None,
) -> dict:
    """Compare a vehicle with the thesis's optimised shape of it, computing what the store lacks.

    Args:
        store_path: result store, see `store.ResultStore`.
        progress: called on every change of the count of finished cases.
        workers: processes that compute at once.
        settings: settings of the pipeline, as its `AnalyseSettings.from_mapping` takes them.
        vehicle: name of a preset, or a vehicle's YAML file.
        mach: flight points.
        evaluate: from a case's inputs to a result as in result.json; the pipeline by default.
        before: called once, when the store has been checked and before anything is computed.

    Returns:
        A comparison, see `compare`, with the thesis's derivatives beside ours where it prints them.

    Raises:
        InputError: bad settings, a damaged store, or a shape that could not be computed.
    """
    from spaceplane.vehicle.presets import OPTIMISED_SHAPE

    ResultStore(store_path).close()  # a store that cannot be used is told before anything is meshed
    if before:
        before()
    settings = with_one_wall_cell(vehicle, {}, settings or {})
    cases = [
        Case(label, case_inputs(vehicle, changes, mach, settings))
        for label, changes in (("default", {}), ("optimised", OPTIMISED_SHAPE))
    ]
    outcome = execute(cases, evaluate, store_path, progress, workers)
    if outcome.failures:
        first = outcome.failures[0]
        raise InputError(f"the {first.label} shape has no result: {first.reason}")
    comparison = compare(*outcome.results, labels=("default", "optimised"))
    published = (thesis.derivatives("original"), thesis.derivatives("optimised"))
    for point in comparison["flight_points"]:
        for row in point["derivatives"]:
            row["thesis"] = [table.get(point["mach"], {}).get(row["name"]) for table in published]
    return comparison


def compare(first: dict, second: dict, labels: tuple[str, str] | None = None) -> dict:
    """Set two results side by side.

    Args:
        first, second: two result.json.
        labels: what to call them; the vehicles' names by default.

    Returns:
        JSON values: "labels", "shape" (parameters that differ), "flight_points" (each with "coefficients",
        "derivatives", "modes", "levels" as rows of pairs [first, second] and their difference), "warnings". Modes are
        paired by motion and eigenvalue (`matching.match_modes`); "resolved" says whether a derivative's difference
        exceeds both numerical error estimates.

    Raises:
        InputError: no flight point is common to both.
    """
    theirs = {point["mach"]: point for point in second["flight_points"]}
    pairs = [(point, theirs[point["mach"]]) for point in first["flight_points"] if point["mach"] in theirs]
    if not pairs:
        machs = ["/".join(f"{point['mach']:g}" for point in result["flight_points"]) for result in (first, second)]
        raise InputError(f"compare: no Mach number in common ({machs[0]} and {machs[1]})")
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "version": __version__,
        "labels": list(labels or _names(first, second)),
        "shape": _shape_rows(first, second),
        "reference": [result["vehicle"].get("reference") for result in (first, second)],
        "mesh": [result.get("mesh", {}).get("cells") for result in (first, second)],
        "flight_points": [_flight_point(a, b) for a, b in pairs],
        "warnings": _warnings(first, second, pairs),
    }


def _names(first: dict, second: dict) -> tuple[str, str]:
    one, two = first["vehicle"]["name"], second["vehicle"]["name"]
    return (one, two) if one != two else (f"{one} (first)", f"{two} (second)")


def _shape_rows(first: dict, second: dict) -> list[dict]:
    one, two = first["vehicle"]["shape"], second["vehicle"]["shape"]
    rows = []
    for name in dict.fromkeys([*one, *two]):
        values = [side.get(name, {}).get("value") for side in (one, two)]
        if values[0] != values[1]:
            rows.append({"name": name, "unit": one.get(name, two.get(name, {})).get("unit"), "values": values})
    return rows


def _flight_point(a: dict, b: dict) -> dict:
    keys = ("altitude_m", "alpha_deg", "gamma_deg", "bank_deg", "velocity_ms", "dynamic_pressure_Pa")
    return {
        "mach": a["mach"],
        **{key: [a.get(key), b.get(key)] for key in keys},
        "flow": [worst_flow(a), worst_flow(b)],
        "coefficients": [
            {"name": name, **_pair(a["coefficients"].get(name), b["coefficients"].get(name))} for name in COEFFICIENTS
        ],
        "derivatives": _derivative_rows(a["derivatives"], b["derivatives"]),
        "modes": _mode_rows(a, b),
        "levels": _level_rows(a["verdicts"], b["verdicts"]),
    }


def _pair(one: float | None, two: float | None) -> dict:
    known = one is not None and two is not None
    difference = two - one if known else None
    return {
        "values": [one, two],
        "difference": difference,
        "relative_percent": 100.0 * difference / abs(one) if known and one else None,
    }


def _derivative_rows(one: dict, two: dict) -> list[dict]:
    common = [name for name in one if name in two]
    names = [name for name in thesis.DERIVATIVES if name in common]
    names += [name for name in common if name not in names]
    rows = []
    for name in names:
        row = {"name": name, "unit": one[name].get("unit"), **_pair(one[name].get("value"), two[name].get("value"))}
        errors = [side[name].get("error") for side in (one, two)]
        gap = row["difference"]
        row["errors"] = errors
        row["resolved"] = None if gap is None or None in errors else abs(gap) > max(errors)
        rows.append(row)
    return rows


def _mode_rows(a: dict, b: dict) -> list[dict]:
    rows = []
    for pair in match_modes(a["modes"], b["modes"], a["velocity_ms"], b["velocity_ms"]):
        sides = [
            None if index is None else {field: modes[index][field] for field in _MODE_FIELDS}
            for index, modes in ((pair.first, a["modes"]), (pair.second, b["modes"]))
        ]
        gap = None
        if None not in sides:
            gap = [two - one for one, two in zip(sides[0]["eigenvalue"], sides[1]["eigenvalue"], strict=True)]
        rows.append({"modes": sides, "similarity": pair.similarity, "difference": gap})
    return rows


def _level_rows(one: list[dict], two: list[dict]) -> list[dict]:
    rows = []
    for found in _verdict_pairs(one, two):
        some = found[0] or found[1]
        rows.append(
            {
                "modes": [row["mode"] if row else None for row in found],
                "criterion": some["criterion"],
                "quantity": some["quantity"],
                "paragraph": some.get("paragraph"),
                "unit": some.get("unit"),
                "values": [row.get("value") if row else None for row in found],
                "levels": [row.get("level") if row else None for row in found],
                "notes": [row.get("note") if row else "no such mode" for row in found],
                "change": _level_change(*(level_number(row["level"]) if row else None for row in found)),
            }
        )
    return rows


def _verdict_pairs(one: list[dict], two: list[dict]) -> Iterator[tuple[dict | None, dict | None]]:
    """Pair verdicts on the same quantity of the same criterion; where there are several, those on modes of one name."""
    left = list(two)
    for verdict in one:
        alike = [row for row in left if all(row[key] == verdict[key] for key in ("criterion", "quantity"))]
        partner = next((row for row in alike if row["mode"] == verdict["mode"]), alike[0] if alike else None)
        if partner is not None:
            left.remove(partner)
        yield verdict, partner
    yield from ((None, row) for row in left)


def _level_change(one: int | None, two: int | None) -> str:
    if one is None or two is None:
        return "same" if one == two else "not comparable"
    return "same" if one == two else "better" if two < one else "worse"


def _warnings(first: dict, second: dict, pairs: list[tuple[dict, dict]]) -> list[str]:
    lines = []
    for a, b in pairs:
        if abs(a["alpha_deg"] - b["alpha_deg"]) > 1e-6 or abs(a["altitude_m"] - b["altitude_m"]) > 1e-3:
            lines.append(f"Mach {a['mach']:g}: the two are at different angles of attack or altitudes")
        verdict = worst_flow(a, b)
        if verdict != "converged":
            lines.append(f"Mach {a['mach']:g}: not every condition converged (worst: {verdict})")
    deflections = [result["vehicle"].get("deflections_deg") for result in (first, second)]
    if deflections[0] != deflections[1]:
        lines.append("the two have different control deflections")
    return lines
