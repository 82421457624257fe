"""Read what an analysis left in its folder."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path

from spaceplane.errors import InputError

SCHEMA = "spaceplane.result"
SCHEMA_VERSION = 1
VEHICLE = ("name", "shape", "deflections_deg", "mass", "reference")
POINT = {
    "name": str,
    **dict.fromkeys(("mach", "altitude_m", "alpha_deg", "gamma_deg", "bank_deg", "velocity_ms"), (int, float)),
    **dict.fromkeys(("coefficients", "coefficient_errors", "derivatives"), dict),
    **dict.fromkeys(("modes", "verdicts", "convergence"), list),
}
"""What every flight point has, also where its flow failed, and of which type."""
ENTRY = {
    "derivatives": ("value", "error"),
    "modes": ("name", "eigenvalue", "eigenvector", "period_s", "half_time_s", "double_time_s", "damping_ratio",
              "natural_frequency_rads"),
    "verdicts": ("mode", "criterion", "quantity", "level"),
    "convergence": ("verdict",),
}  # fmt: skip
"""What each entry of a mapping or list of a flight point has; values may be null."""


def read_result(out_dir: Path) -> dict:
    """The `result.json` of `out_dir`, which may also be the file itself.

    Raises:
        InputError: no such folder or file, not JSON, another schema, or a vehicle or flight point that lacks something.
    """
    out_dir = Path(out_dir)
    path = out_dir if out_dir.suffix == ".json" and not out_dir.is_dir() else out_dir / "result.json"
    if not path.parent.is_dir():
        raise InputError(f"{out_dir}: no such folder")
    if not path.is_file():
        raise InputError(f"{path}: no such file; `spaceplane analyse VEHICLE --out {out_dir}` writes it")
    try:
        result = json.loads(path.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: damaged, not valid JSON ({error})") from error
    if not isinstance(result, dict) or result.get("schema") != SCHEMA:
        raise InputError(f'{path}: not a result of `spaceplane analyse` (no "schema": "{SCHEMA}")')
    if result.get("schema_version") != SCHEMA_VERSION:
        raise InputError(
            f"{path}: schema version {result.get('schema_version')!r}, this version reads {SCHEMA_VERSION}"
        )
    missing = [key for key in ("vehicle", "flight_points") if key not in result]
    if missing or not isinstance(result["flight_points"], list):
        raise InputError(f"{path}: damaged, lacks {', '.join(missing) or 'a list of flight points'}")
    try:
        _require("vehicle", result["vehicle"], VEHICLE)
        for number, point in enumerate(result["flight_points"], start=1):
            _check_point(f"flight point {number}", point)
    except InputError as error:
        raise InputError(f"{path}: damaged, {error}") from error
    return result


def _check_point(where: str, point: object) -> None:
    name = point.get("name") if isinstance(point, Mapping) else None
    where = f"{where} ({name})" if isinstance(name, str) else where
    _require(where, point, POINT)
    for key, kind in POINT.items():
        if not isinstance(point[key], kind) or isinstance(point[key], bool):
            raise InputError(f"{where}: {key} = {str(point[key])[:40]!r} is not as an analysis writes it")
    _require(f"{where}, coefficients", point["coefficients"], ("CL", "CD", "Cm"))
    for key, needed in ENTRY.items():
        entries = point[key]
        named = entries.items() if isinstance(entries, Mapping) else enumerate(entries, start=1)
        for label, entry in named:
            _require(f"{where}, {key} {label}", entry, needed)


def _require(where: str, record: object, keys: Iterable[str]) -> None:
    if not isinstance(record, Mapping):
        raise InputError(f"{where} is no mapping")
    for key in keys:
        if key not in record:
            raise InputError(f"{where} lacks {key!r}")


def level_text(level: int | str | None) -> str:
    """A verdict's level in words: `level 1`, `below 3`, `not applicable`."""
    if level is None:
        return "not applicable"
    return f"level {level}" if isinstance(level, int) else str(level)
