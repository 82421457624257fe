"""Everything that an analysis leaves in its folder."""

from __future__ import annotations

from pathlib import Path

from spaceplane.analysis.found import Analysis
from spaceplane.files import json_text, told, writable_folder, write_text
from spaceplane.report import record

FILES = ("result.json", "aero.nc", "geometry.stl", "surface.vtp", "report.html")


def write(analysis: Analysis, out_dir: Path | str) -> dict[str, Path]:
    """Write result.json, aero.nc, geometry.stl, surface.vtp and report.html; return their paths by name.

    Raises:
        InputError: the folder cannot be written.
    """
    from spaceplane.flow.export import write_vtp
    from spaceplane.report import write_report
    from spaceplane.vehicle.export import write_stl

    folder = writable_folder(out_dir)
    paths = {name: folder / name for name in FILES}
    write_stl(analysis.body.surface, paths["geometry.stl"])
    fields = {p.point.name: analysis.plan.points[i].base for i, p in enumerate(analysis.points)}
    write_vtp(analysis.body.surface, analysis.body.solution, paths["surface.vtp"], fields)
    analysis.database.save(paths["aero.nc"])
    with told(folder):
        write_text(json_text(record.result(analysis)), paths["result.json"])
    write_report(folder)
    return paths
