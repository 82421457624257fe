"""Read what an analysis left in its folder."""

from __future__ import annotations

import json
from pathlib import Path

from spaceplane.errors import InputError

SCHEMA = "spaceplane.result"
SCHEMA_VERSION = 1


def read_result(out_dir: Path) -> dict:
    """The `result.json` of `out_dir`, which may also be the file itself.

    Raises:
        InputError: no such folder or file, not JSON, or another schema.
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
    return result


def level_text(level: int | str | None) -> str:
    """A verdict's level in words: `level 1`, `below 3`, `not applicable`."""
    if level is None:
        return "not applicable"
    return f"level {level}" if isinstance(level, int) else str(level)
