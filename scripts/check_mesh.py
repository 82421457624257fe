"""Mesh HORUS-2B, or random shapes, with random deflections and grid offsets, and report the worst errors.

Example: python scripts/check_mesh.py --count 50 --cell 0.2 --json mesh.json
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

import numpy as np
from rich.progress import track

from spaceplane.errors import InputError
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import CONTROL_LIMITS_DEG, ControlDeflections
from spaceplane.vehicle.shape import PARAMETERS, ShapeParameters

# What a sound mesh may show at most: areas and volume on the surface's, closure in m2, the rest in wall cells.
ALLOWED = {
    "volume_error": 1e-10,
    "area_error": 1e-10,
    "projected_area_error": 1e-10,
    "closure": 1e-10,
    "gauss_error": 1e-11,
    "folded": 0,
}


def case(rng: np.random.Generator, cell: float, shapes: bool) -> dict:
    """Mesh one random case and return the measures of its record that `ALLOWED` names, and counts.

    Raises:
        InputError: the shape could not be built or meshed.
    """
    shape = {p.name: float(rng.uniform(p.lower, p.upper)) for p in PARAMETERS} if shapes else {}
    deflections = {name: float(rng.uniform(*limits)) for name, limits in CONTROL_LIMITS_DEG.items()}
    surface = build(ShapeParameters.create(shape), ControlDeflections.from_degrees(deflections))
    settings = MeshSettings(wall_cell=cell, offset=tuple(rng.random(2)), symmetric=False, far_field=2.0)
    mesh = generate(surface, settings)
    record = mesh.record
    found = {name: record[name] for name in ALLOWED if name in record}
    found["folded"] = sum("folds" in warning for warning in record["warnings"])
    found.update({name: record[name] for name in ("cells", "cut_cells", "split_cells", "merged_cells", "seconds")})
    found["smallest_volume_fraction"] = record["smallest_volume_fraction"]
    return found


def main() -> int:
    """Run the sweep; exit code 1 when a case failed or left the allowed errors."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=50, help="cases")
    parser.add_argument("--cell", type=float, default=0.2, help="wall cell, m")
    parser.add_argument("--shapes", action="store_true", help="random shapes as well")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", type=Path, help="write the summary here")
    options = parser.parse_args()

    failures, cases = [], []
    for index in track(range(options.count), description="meshes"):
        rng = np.random.default_rng([options.seed, index])
        try:
            found = case(rng, options.cell, options.shapes)
        except InputError as err:
            failures.append({"case": index, "reason": str(err)})
            continue
        cases.append(found)
        failures += [
            {"case": index, "reason": f"{name} {found[name]:.3g} above {limit}"}
            for name, limit in ALLOWED.items()
            if found[name] > limit
        ]
    summary = {"meshes": len(cases), "failures": failures, "wall_cell_m": options.cell}
    if cases:
        summary["worst"] = {name: max(c[name] for c in cases) for name in ALLOWED}
        summary["smallest_volume_fraction"] = min(c["smallest_volume_fraction"] for c in cases)
        summary["totals"] = {n: sum(c[n] for c in cases) for n in ("cells", "cut_cells", "split_cells", "merged_cells")}
        summary["mean_seconds"] = sum(c["seconds"] for c in cases) / len(cases)
    print(json.dumps(summary, indent=1))
    if options.json:
        options.json.write_text(json.dumps(summary, indent=1) + "\n", encoding="utf-8")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
