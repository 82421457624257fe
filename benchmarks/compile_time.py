"""Seconds of the first start ever, which compiles every kernel, and of later ones.

Wall seconds, and those of processor time of all processes: on a machine that does other work as well, only the latter
mean something.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time

SMALL_RUN = """
import time
from common import DEFLECTED, conditions
from spaceplane.aero.bodies import solve_vehicle
from spaceplane.flow.settings import FlowSettings
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.presets import horus_2b

def tell(phase, *_):
    if phase == "body: fine" and not begun:
        begun.append(time.time())

begun = []
mesh, flow = MeshSettings(wall_cell=1.0), FlowSettings(iterations=2, coarse_iterations=2)
solve_vehicle(horus_2b(), DEFLECTED, conditions(1), mesh, flow, tell)
print(begun[0])
"""


def measure() -> dict[str, float]:
    """Cost of geometry, mesh and flow of a tiny case in a new process, without kept kernels and with them."""
    with tempfile.TemporaryDirectory() as folder:
        first, later = _run(folder), _run(folder)
    return {f"first_{name}": value for name, value in first.items()} | {
        f"later_{name}": value for name, value in later.items()
    }


def _run(cache: str) -> dict[str, float]:
    """Seconds: `s` in all, `cpu_s` on all processors, `to_flow_s` until the first iteration on the fine mesh."""
    environment = os.environ | {"NUMBA_CACHE_DIR": cache, "PYTHONPATH": os.pathsep.join(sys.path)}
    busy, began, clock = _children(), time.perf_counter(), time.time()
    done = subprocess.run(
        [sys.executable, "-c", SMALL_RUN], env=environment, check=True, capture_output=True, text=True
    )
    seconds = time.perf_counter() - began
    return {"s": seconds, "cpu_s": _children() - busy, "to_flow_s": float(done.stdout.split()[-1]) - clock}


def _children() -> float:
    """Processor seconds of all processes that this one and its children have waited for."""
    times = os.times()
    return times.children_user + times.children_system
