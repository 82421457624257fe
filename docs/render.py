"""Render the pictures of the documentation from a folder that `spaceplane analyse` has written.

    python docs/render.py out/horus-2b

The surface pressure is that of the fastest flight point.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pyvista as pv

IMAGES = Path(__file__).resolve().parent / "images"
VIEWS = {
    "perspective": ((-1.1, 1.0, 0.75), (0.0, 0.0, 1.0)),
    "below": ((-0.9, 0.9, -0.9), (0.0, 0.0, 1.0)),
    "top": ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
    "side": ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    "front": ((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
}


def pressure_picture(surface: pv.PolyData, scalars: str, title: str, path: Path) -> None:
    """Perspective from above and from below, coloured by the pressure coefficient."""
    values = surface.cell_data[scalars]
    # The stagnation region would use up the scale: colours end where the last 2 % of the triangles begin.
    limits = (float(np.quantile(values, 0.003)), float(np.quantile(values, 0.98)))
    mesh = surface.cell_data_to_point_data()
    plotter = pv.Plotter(off_screen=True, shape=(1, 2), window_size=(2000, 720), border=False)
    for column, view in enumerate(("perspective", "below")):
        plotter.subplot(0, column)
        plotter.add_mesh(
            mesh,
            scalars=scalars,
            cmap="turbo",
            clim=limits,
            smooth_shading=True,
            split_sharp_edges=True,
            ambient=0.45,
            diffuse=0.65,
            specular=0.1,
            show_scalar_bar=False,
        )
        plotter.view_vector(*VIEWS[view])
        plotter.camera.zoom(1.5)
    plotter.subplot(0, 0)
    plotter.add_text(title, position=(0.05, 0.90), viewport=True, font_size=14, color="black")
    bar = dict(title=" ", color="black", n_labels=5, fmt="%.2f", height=0.07, width=0.42, label_font_size=22)
    plotter.add_scalar_bar(position_x=0.05, position_y=0.02, **bar)
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    plotter.screenshot(path)
    plotter.close()


def main(folder: Path) -> int:
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    point = max(result["flight_points"], key=lambda p: p["mach"])
    surface = pv.read(folder / "surface.vtp")
    IMAGES.mkdir(exist_ok=True)
    path = IMAGES / "horus-2b-pressure.png"
    title = f"Pressure coefficient, Mach {point['mach']:g}, alpha {point['alpha_deg']:.1f} deg"
    pressure_picture(surface, f"Cp_{point['name']}", title, path)
    print(f"wrote {path}")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/horus-2b")))
