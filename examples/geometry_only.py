"""Build HORUS-2B with its body flap up, say how large it is and write it as STL. No flow is solved."""

import sys
from pathlib import Path

import numpy as np

from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.export import write_stl
from spaceplane.vehicle.presets import horus_2b

out = Path(sys.argv[1] if len(sys.argv) > 1 else "out/examples")
vehicle = horus_2b()
surface = build(vehicle.shape, ControlDeflections.from_degrees(body_flap=-20.0))

length, span, height = surface.bounds[1] - surface.bounds[0]
print(f"{vehicle.name}: {length:.2f} m long, {span:.2f} m in span, {height:.2f} m high")
print(f"wetted area {surface.area:.1f} m2, volume {surface.volume:.1f} m3, {len(surface.triangles)} triangles")
for index, part in enumerate(surface.part_names):
    area = np.linalg.norm(surface.area_vectors[surface.part == index], axis=1).sum()
    print(f"  {part:14s} {area:7.2f} m2")

out.mkdir(parents=True, exist_ok=True)
write_stl(surface, out / "horus-2b.stl")
print(f"wrote {out / 'horus-2b.stl'}")
