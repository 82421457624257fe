"""Everything that an analysis leaves in its folder."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path

from spaceplane.analysis.found import Analysis
from spaceplane.errors import InputError
from spaceplane.report import record

FILES = ("result.json", "aero.nc", "geometry.stl", "surface.vtp", "report.html")


def check_output(out_dir: Path | str) -> Path:
    """Make the folder if it is missing and try to write into it.

    Raises:
        InputError: it cannot be made or written.
    """
    folder = Path(out_dir)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as probe:
            probe.write(b"spaceplane")
    except OSError as error:
        raise InputError(f"out: {folder} cannot be written ({error.strerror or error})") from error
    return folder


def write(analysis: Analysis, out_dir: Path | str) -> dict[str, Path]:
    """Write result.json, aero.nc, geometry.stl, surface.vtp and report.html; return their paths by name.

    Raises:
        InputError: the folder cannot be written.
    """
    from spaceplane.flow.export import write_vtp
    from spaceplane.report import write_report
    from spaceplane.vehicle.export import write_stl

    folder = check_output(out_dir)
    paths = {name: folder / name for name in FILES}
    write_stl(analysis.body.surface, paths["geometry.stl"])
    fields = {p.point.name: analysis.plan.points[i].base for i, p in enumerate(analysis.points)}
    write_vtp(analysis.body.surface, analysis.body.solution, paths["surface.vtp"], fields)
    analysis.database.save(paths["aero.nc"])
    _write_json(record.result(analysis), paths["result.json"])
    write_report(folder)
    return paths


def _write_json(value: dict, path: Path) -> None:
    """Write all or nothing."""
    text = json.dumps(value, indent=1, allow_nan=False, ensure_ascii=False) + "\n"
    part = path.with_suffix(".part")
    try:
        part.write_text(text, encoding="utf-8")
        os.replace(part, path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror or error})") from error
