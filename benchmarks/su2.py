"""Our solver and SU2 side by side on the same body-fitted mesh: a ramp of 15 deg at Mach 2.5.

Skipped, and said so, where there is no `SU2_CFD` on the PATH. Both solve the Euler equations to second order, to the
same drop of the density residual from the free stream; SU2 for one condition, as it has no ensembles. SU2's mesh file
is the one that `spaceplane flow --mesh` reads.
"""

from __future__ import annotations

import csv
import math
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from mesh.body_fitted import grid, hexahedra, marked, write_su2
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.elements import Elements
from spaceplane.mesh.imported import read_mesh

MACH, SLOPE = 2.5, math.tan(math.radians(15.0))
DECADES = 3.0

CONFIGURATION = f"""
SOLVER= EULER
MACH_NUMBER= {MACH}
AOA= 0.0
SIDESLIP_ANGLE= 0.0
FREESTREAM_PRESSURE= 101325.0
FREESTREAM_TEMPERATURE= 288.15
REF_AREA= 1.0
REF_DIMENSIONALIZATION= FREESTREAM_VEL_EQ_MACH
MARKER_EULER= ( ramp )
MARKER_SYM= ( sym_y )
MARKER_FAR= ( farfield )
MARKER_MONITORING= ( ramp )
NUM_METHOD_GRAD= WEIGHTED_LEAST_SQUARES
CONV_NUM_METHOD_FLOW= ROE
MUSCL_FLOW= YES
SLOPE_LIMITER_FLOW= VENKATAKRISHNAN
TIME_DISCRE_FLOW= EULER_IMPLICIT
CFL_NUMBER= 10.0
CFL_ADAPT= YES
CFL_ADAPT_PARAM= ( 0.5, 1.5, 1.0, 100.0 )
LINEAR_SOLVER= FGMRES
LINEAR_SOLVER_PREC= ILU
LINEAR_SOLVER_ERROR= 0.1
LINEAR_SOLVER_ITER= 5
ITER= 1000
CONV_FIELD= REL_RMS_DENSITY
CONV_RESIDUAL_MINVAL= {-DECADES}
MESH_FILENAME= ramp.su2
MESH_FORMAT= SU2
TABULAR_FORMAT= CSV
CONV_FILENAME= history
HISTORY_OUTPUT= ( ITER, RMS_RES, AERO_COEFF )
OUTPUT_FILES= ( RESTART )
"""


def ramp(size: int) -> Elements:
    """Hexahedra over a flat plate 0.5 m long and a ramp 1 m long, `size` cells high; markers ramp, sym_y, farfield."""
    points, number = grid((3 * size // 2, max(size // 4, 2), size))
    x, y, z = points.T
    x = 1.5 * x - 0.5
    floor = SLOPE * np.maximum(x, 0.0)
    points = np.column_stack([x, 0.25 * y, floor + (1.0 - floor) * z])

    def name(middle: np.ndarray) -> str:
        if middle[2] < SLOPE * max(middle[0], 0.0) + 1e-9:
            return "ramp"
        return "sym_y" if min(middle[1], 0.25 - middle[1]) < 1e-9 else "farfield"

    return marked(points, {"hexahedron": hexahedra(number)}, name)


def measure(size: int = 48) -> dict[str, float]:
    """Seconds and drag (on q, per m2) of both solvers, on `ramp(size)`; empty without SU2."""
    program = shutil.which("SU2_CFD")
    if program is None:
        return {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        mesh = read_mesh(write_su2(ramp(size), folder / "ramp.su2")).mesh
        return {"cells": mesh.cells, **_spaceplane(mesh), **_su2(program, folder)}


def _spaceplane(mesh) -> dict[str, float]:
    settings = FlowSettings(residual_drop=DECADES)
    solve(mesh, FlowConditions(np.array([MACH]), np.zeros(1), np.zeros(1)), FlowSettings(iterations=2))
    result = {}
    for count in (1, 16):
        conditions = FlowConditions(np.full(count, MACH), np.zeros(count), np.zeros(count))
        began = time.perf_counter()
        solution = solve(mesh, conditions, settings)
        result[f"spaceplane {count} conditions s"] = time.perf_counter() - began
    body = solution.mesh.body_wall
    force = solution.wall_cp()[body, 0].astype(float) @ solution.mesh.wall_area[body, 0]
    return result | {"spaceplane drag": float(force)}


def _su2(program: str, folder: Path) -> dict[str, float]:
    (folder / "ramp.cfg").write_text(CONFIGURATION)
    began = time.perf_counter()
    run = subprocess.run([program, "ramp.cfg"], cwd=folder, capture_output=True, text=True, check=False)
    seconds = time.perf_counter() - began
    history = folder / "history.csv"
    if run.returncode or not history.exists():
        raise RuntimeError(f"SU2_CFD: exit {run.returncode}\n{run.stdout[-2000:]}{run.stderr[-2000:]}")
    with history.open(newline="") as lines:
        rows = [{key.strip(' "'): value for key, value in row.items()} for row in csv.DictReader(lines)]
    return {"su2 1 conditions s": seconds, "su2 iterations": len(rows), "su2 drag": float(rows[-1]["CD"])}
