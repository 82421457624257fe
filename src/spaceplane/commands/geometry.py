"""`spaceplane geometry`: the vehicle's shape as a file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import writable_file, write_json
from spaceplane.files import renamed_when_done

EXAMPLE = "Example: spaceplane geometry horus-2b --set winglet_length_m=4 --deflect elevon_left=-10 --out body.stl"
SUFFIXES = (".stl", ".glb", ".step", ".stp", ".png")


def geometry(
    vehicle: options.VehicleName,
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="File to write: .stl, .glb, .step or .png.")],
    changes: options.Changes = None,
    deflect: options.Deflections = None,
    allow_outside_limits: options.AllowOutside = False,
    json_file: options.JsonFile = None,
) -> int:
    """Build the watertight surface of a vehicle and write it as STL, GLB, STEP or a PNG picture."""
    writable_file(out, "--out", SUFFIXES)
    writable_file(json_file, "--json")
    subject = options.load_vehicle(vehicle, changes, allow_outside_limits)
    deflections = options.load_deflections(deflect, allow_outside_limits)
    from spaceplane.vehicle import export
    from spaceplane.vehicle.build import build

    surface = build(subject.shape, deflections)
    with renamed_when_done(out) as partial:
        if out.suffix.lower() in (".step", ".stp"):
            from spaceplane.vehicle.step import write_step

            write_step(subject.shape, deflections, partial)
        else:
            write = {".stl": export.write_stl, ".glb": export.write_glb, ".png": export.write_png}[out.suffix.lower()]
            write(surface, partial)
    lower, upper = surface.bounds
    record = {
        "vehicle": subject.name,
        "file": str(out),
        "deflections_deg": deflections.to_degrees(),
        "length_m": float(upper[0] - lower[0]),
        "span_m": float(upper[1] - lower[1]),
        "height_m": float(upper[2] - lower[2]),
        "wetted_area_m2": surface.area,
        "volume_m3": surface.volume,
        "triangles": len(surface.triangles),
        "parts": list(surface.part_names),
    }
    write_json(record, json_file)
    if str(json_file) != "-":
        typer.echo(
            f"{out}: {record['length_m']:.2f} x {record['span_m']:.2f} x {record['height_m']:.2f} m, wetted area "
            f"{record['wetted_area_m2']:.1f} m2, volume {record['volume_m3']:.1f} m3, {record['triangles']} triangles"
        )
    return 0
