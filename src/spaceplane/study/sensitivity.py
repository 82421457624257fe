"""One shape parameter at a time: how derivatives, modes and levels answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from spaceplane import __version__
from spaceplane.errors import InputError, unknown_name
from spaceplane.files import json_text, writable_folder, write_csv, write_text
from spaceplane.study import thesis
from spaceplane.study.cases import SensitivityStudy
from spaceplane.study.changes import Change, changes, mesh_noise
from spaceplane.study.execute import execute
from spaceplane.study.keys import code_fingerprint
from spaceplane.study.records import Case, Evaluate, Failure, Progress
from spaceplane.study.shapes import ParameterRange, case_inputs, evaluate, parameter_ranges, shifted, with_one_wall_cell
from spaceplane.study.store import ResultStore

SCHEMA = "spaceplane.sensitivity"
SCHEMA_VERSION = 1
MESH_SHIFTS = ((0.5, 0.0), (0.0, 0.5), (0.5, 0.5))
"""Along x and z, in wall cells; half a cell is as far as a mesh can be from where it was."""


@dataclass(frozen=True)
class Variation:
    """One changed shape of a study.

    Attributes:
        parameter: shape parameter, with its unit.
        side: "low" or "high".
        value: m or deg.
        range: the parameter's default and limits.
    """

    parameter: str
    side: str
    value: float
    range: ParameterRange

    @property
    def label(self) -> str:
        """What a person calls it."""
        return f"{self.parameter} = {self.value:g} ({self.side})"


@dataclass(frozen=True)
class SensitivityResult:
    """What a study found.

    Attributes:
        study: what was asked.
        default: result of the default shape (as result.json).
        variations: the changed shapes that have a result.
        results: [variation] their results.
        rows: every quantity of every changed shape beside the default's.
        agreement: our changes beside the thesis's, see `thesis.agreement`.
        failures: cases without a result.
        warnings: shapes with conditions that did not converge, one line each.
        files: what was written, by name of the file (plots: the PNG, by name without its ending).
        computed, reused: cases computed now, and found in the store.
        seconds: wall-clock time, s.
    """

    study: SensitivityStudy
    default: dict
    variations: tuple[Variation, ...]
    results: tuple[dict, ...]
    rows: tuple[Change, ...]
    agreement: tuple[dict, ...]
    failures: tuple[Failure, ...]
    warnings: tuple[str, ...]
    files: dict[str, Path]
    computed: int
    reused: int
    seconds: float


def run(
    study: SensitivityStudy,
    store_path: Path | str,
    out_dir: Path | str,
    progress: Callable[[Progress], None] | None = None,
    workers: int | None = None,
    evaluate: Evaluate = evaluate,
    plots: bool = True,
    before: Callable[[], object] | None = None,
) -> SensitivityResult:
    """Compute what the store lacks of a study, then write tables and plots.

    Args:
        study: what to vary, see `cases.load_study`.
        store_path: the result store; a study that was cut short goes on from it.
        out_dir: folder for sensitivity.csv, sensitivity.json, agreement.csv and the plots.
        progress: called on every change of the count of finished cases.
        workers: processes that compute at once; the study's own number by default.
        evaluate: from a case's inputs to a result as in result.json; the pipeline by default.
        plots: draw the plots too.
        before: called once, when the input has been checked and before anything is computed.

    Raises:
        InputError: an unknown parameter, a value out of limits, a damaged store, a folder that cannot be written, or
            the default shape itself has no result.
        KeyboardInterrupt: as `execute.execute`; run again to go on.
    """
    out_dir = writable_folder(out_dir)
    variations = plan(study)
    ResultStore(store_path).close()  # a store that cannot be used is told before anything is meshed
    if before:
        before()
    cases = _cases(study, variations)
    outcome = execute(cases, evaluate, store_path, progress, workers or study.workers)
    default = outcome.results[0]
    if default is None:
        raise InputError(f"the default shape has no result: {outcome.failures[0].reason}")
    repeats, varied = outcome.results[1 : 1 + study.mesh_shifts], outcome.results[1 + study.mesh_shifts :]
    noise = mesh_noise([result for result in repeats if result is not None], default)
    good = [(one, result) for one, result in zip(variations, varied, strict=True) if result is not None]
    rows = tuple(
        row
        for one, result in good
        for row in changes(one.parameter, one.side, one.value, one.range.default, result, default, noise)
    )
    found = SensitivityResult(
        study,
        default,
        tuple(one for one, _ in good),
        tuple(result for _, result in good),
        rows,
        tuple(thesis.agreement(as_sensitivities(rows))),
        outcome.failures,
        _warnings([("default", default), *((one.label, result) for one, result in good)]),
        {},
        outcome.computed,
        outcome.reused,
        outcome.seconds,
    )
    found.files.update(write_tables(found, out_dir))
    if plots:
        from spaceplane.study.plots import write_plots  # matplotlib takes a second to import

        found.files.update(write_plots(found, out_dir))
    return found


def plan(study: SensitivityStudy) -> tuple[Variation, ...]:
    """Return the changed shapes that a study asks for.

    Raises:
        InputError: an unknown parameter, or a value out of its limits or equal to the default.
    """
    ranges = parameter_ranges(study.vehicle, study.set)
    variations = []
    for name, values in study.parameters.items():
        if name not in ranges:
            raise InputError("parameters: " + unknown_name("shape parameter", name, ranges))
        limits = ranges[name]
        for value in values or (limits.lower, limits.upper):
            if not study.allow_outside_limits and not limits.lower <= value <= limits.upper:
                raise InputError(f"{name}: {value:g}; allowed: {limits.lower:g} to {limits.upper:g} {limits.unit}")
            if value == limits.default:
                raise InputError(f"{name}: {value:g} is the default; name another value")
            variations.append(Variation(name, "low" if value < limits.default else "high", float(value), limits))
    return tuple(variations)


def as_sensitivities(rows: tuple[Change, ...]) -> list[thesis.Sensitivity]:
    """Return the derivatives among the rows whose flow did not fail, for comparison with the thesis."""
    return [
        thesis.Sensitivity(
            row.parameter,
            row.side,
            row.parameter_value,
            row.mach,
            row.quantity,
            row.value,
            row.default,
            max(thesis.resolution(row.value, row.default), row.noise or 0.0),
        )
        for row in rows
        if row.kind == "derivative" and row.flow != "failed" and row.value is not None and row.default is not None
    ]


def write_tables(found: SensitivityResult, out_dir: Path) -> dict[str, Path]:
    """Write sensitivity.csv (tidy), agreement.csv and sensitivity.json; return their paths by name."""
    files = {name: out_dir / name for name in ("sensitivity.csv", "agreement.csv", "sensitivity.json")}
    write_csv([row.as_row() for row in found.rows], files["sensitivity.csv"])
    write_csv(found.agreement, files["agreement.csv"])
    write_text(json_text(_document(found)), files["sensitivity.json"])
    return files


def _document(found: SensitivityResult) -> dict:
    labels = [one.label for one in found.variations]
    tables = {by: thesis.agreement_table(found.agreement, by) for by in ("derivative", "parameter", "mach")}
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "version": __version__,
        "code": code_fingerprint(),
        "study": found.study.model_dump(mode="json"),
        "cases": {"computed": found.computed, "reused": found.reused, "seconds": round(found.seconds, 3)},
        "failures": [{"case": failure.label, "reason": failure.reason} for failure in found.failures],
        "warnings": list(found.warnings),
        "default": {"settings": found.default["settings"], "flight_points": found.default["flight_points"]},
        "shapes": [_shape("default", found.default), *map(_shape, labels, found.results)],
        "rows": [row.as_row() for row in found.rows],
        "thesis_agreement": {"by": tables, "rows": list(found.agreement)},
    }


def _cases(study: SensitivityStudy, variations: tuple[Variation, ...]) -> list[Case]:
    """The default, the default on shifted meshes, and every changed shape, all with the default's wall cell."""
    outside = study.allow_outside_limits
    settings = with_one_wall_cell(study.vehicle, study.set, study.settings, outside)

    def inputs(change: dict[str, float]) -> dict:
        return case_inputs(study.vehicle, study.set | change, study.mach, settings, outside)

    cases = [Case("default", inputs({}))]
    for number, shift in enumerate(MESH_SHIFTS[: study.mesh_shifts], start=1):
        cases.append(Case(f"default, mesh shifted ({number})", shifted(cases[0].inputs, shift)))
    return cases + [Case(one.label, inputs({one.parameter: one.value})) for one in variations]


def _shape(label: str, result: dict) -> dict:
    """Size and cost of one shape's computation."""
    seconds = result.get("solver", {}).get("seconds_by_phase", {})
    return {"case": label, "cells": result.get("mesh", {}).get("cells"), "seconds": sum(seconds.values())}


def _warnings(results: list[tuple[str, dict]]) -> tuple[str, ...]:
    """One line for each shape and flight point where a condition did not converge."""
    lines = []
    for label, result in results:
        for point in result["flight_points"]:
            bad = [f"{row['label']} {row['verdict']}" for row in point["convergence"] if row["verdict"] != "converged"]
            if bad:
                lines.append(f"{label}, Mach {point['mach']:g}: {', '.join(bad)}")
    return tuple(lines)
