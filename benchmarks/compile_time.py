"""Seconds of the first start ever, which compiles every kernel, and of a later one."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time

SMALL_RUN = """
from common import conditions, vehicle_mesh
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solve import solve
solve(vehicle_mesh(1500), conditions(1), FlowSettings(iterations=2, coarse_iterations=2))
"""


def measure() -> dict[str, float]:
    """Seconds of a tiny mesh and flow in a new process, without kept kernels and with them."""
    with tempfile.TemporaryDirectory() as folder:
        return {"first_s": _run(folder), "later_s": _run(folder)}


def _run(cache: str) -> float:
    environment = os.environ | {"NUMBA_CACHE_DIR": cache, "PYTHONPATH": os.pathsep.join(sys.path)}
    began = time.perf_counter()
    subprocess.run([sys.executable, "-c", SMALL_RUN], env=environment, check=True, capture_output=True)
    return time.perf_counter() - began
