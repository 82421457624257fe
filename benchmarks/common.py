"""What the benchmarks share: clocks, the machine's name, the vehicle's mesh."""

from __future__ import annotations

import os
import platform
import resource
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from spaceplane.flow.solution import FlowConditions
from spaceplane.mesh.generate import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.presets import horus_2b

DEFLECTED = ControlDeflections.from_degrees({"body_flap": -20.0, "elevon_left": -17.5, "elevon_right": -17.5})


def conditions(count: int) -> FlowConditions:
    """`count` free streams from Mach 1.2 to 5 and 0 to 20 deg, every fourth with sideslip."""
    index = np.arange(count)
    mach = np.geomspace(1.2, 5.0, count)
    return FlowConditions(mach, np.radians(5.0 * (index % 5)), np.radians(2.0) * (index % 4 == 3))


def vehicle_mesh(cells: int) -> Mesh:
    """HORUS-2B with deflected controls, about `cells` cells round it."""
    return generate(build(horus_2b().shape, DEFLECTED), MeshSettings(target_cells=cells))


def timed(task: Callable[[], object], repeats: int = 1) -> tuple[float, object]:
    """Median wall seconds of a task, and its last result."""
    seconds, result = [], None
    for _ in range(repeats):
        start = time.perf_counter()
        result = task()
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds), result


def peak_memory() -> float:
    """Bytes of memory that this process has held at most.

    Linux counts into a process's `ru_maxrss` what the one that started it held; `VmHWM` is its own.
    """
    status = Path("/proc/self/status")
    if status.exists():
        for line in status.read_text().splitlines():
            if line.startswith("VmHWM:"):
                return float(line.split()[1]) * 1024.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024.0


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def machine() -> str:
    """Processor and cores: what a timing is valid for."""
    model = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        lines = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        model = lines[0].partition(":")[2].strip() if lines else model
    return f"{model}, {cores()} cores"
