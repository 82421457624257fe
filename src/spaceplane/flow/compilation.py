"""Compilation of the flow kernels before they are needed, by two processes at once where there are two cores.

numba compiles under one lock, so that threads gain nothing. A helper process takes kernels from the same list as this
one and leaves them in the cache on disk. It may end at any time: what it has not finished is compiled here.
"""

from __future__ import annotations

import os
import queue
import signal
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import replace

import numba
import numpy as np

from spaceplane.flow.compiled import CACHE, LANES
from spaceplane.flow.ensemble import Ensemble
from spaceplane.flow.prolong import prolong
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import EQUILIBRIUM, FlowConditions
from spaceplane.flow.symmetry import symmetrise
from spaceplane.flow.topology import prepare
from spaceplane.kernelcache import writable
from spaceplane.mesh import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.progress import Progress, silent

NO_LANE, ALL_LANES = np.zeros(LANES, dtype=bool), np.ones(LANES, dtype=bool)


def _differences(ensemble: Ensemble) -> None:
    ensemble.anderson.known[:] = True
    ensemble.anderson.weights(ensemble.topology, ensemble.change, NO_LANE)


def _mirror(ensemble: Ensemble) -> None:
    symmetrise(ensemble.topology.mirror, ensemble.change, np.zeros(LANES, ensemble.dtype))


def _prolong(ensemble: Ensemble) -> None:
    cells, dtype = ensemble.mesh.cells, ensemble.dtype
    out = np.empty((cells, 5, 1), dtype)
    parent, offset = np.zeros(cells, np.int32), np.zeros((cells, 3), dtype)
    prolong(parent, offset, ensemble.state, ensemble.gradient, ensemble.order, 0, out, 0)


#: Name -> what makes numba compile one kernel, given a new ensemble; the costliest first.
STEPS: dict[str, Callable[[Ensemble], object]] = {
    "fluxes": Ensemble.balance,
    "diagonals": lambda ensemble: ensemble.factorise(np.ones(LANES), ALL_LANES),
    "gradients": Ensemble.reconstruct,
    "sweeps": Ensemble.relax,
    "update": lambda ensemble: ensemble.apply(0.4, NO_LANE),
    "differences": _differences,
    "wall": Ensemble.wall_pressure,
    "norms": Ensemble.norms,
    "prolongation": _prolong,
    "symmetry": _mirror,
}


def two_cells() -> Mesh:
    """Two unit cubes side by side at y = 0, their lower faces walls."""
    center = np.array([[0.0, -0.5, 0.0], [0.0, 0.5, 0.0]])
    outward = [(side, axis) for side in (-1.0, 1.0) for axis in range(3)]
    wall, far = [], []
    for cell in range(2):
        for side, axis in outward:
            area = np.zeros(3)
            area[axis] = side
            if axis == 1 and side * center[cell, 1] < 0.0:
                continue
            (wall if (side, axis) == (-1.0, 2) else far).append((cell, area, center[cell] + 0.5 * area))
    columns = [[np.array(column) for column in zip(*faces, strict=True)] for faces in (wall, far)]
    (wall_cell, wall_area, wall_center), (far_cell, far_area, far_center) = columns
    return Mesh(
        cell_volume=np.ones(2),
        cell_center=center,
        cell_size=np.ones(2),
        face_cells=np.array([[0, 1]], np.int32),
        face_area=np.array([[0.0, 1.0, 0.0]]),
        face_center=np.zeros((1, 3)),
        wall_cell=wall_cell.astype(np.int32),
        wall_area=wall_area,
        wall_center=wall_center,
        far_cell=far_cell.astype(np.int32),
        far_area=far_area,
        far_center=far_center,
        piece_wall=np.arange(2, dtype=np.int32),
        piece_area=wall_area,
        piece_center=wall_center,
        piece_part=np.zeros(2, np.int32),
        part_names=("floor",),
    )


def _compile(name: str, precision: str, gas: str) -> None:
    """Compile one kernel with the types that the solver calls it with, or find it in the cache."""
    mesh, settings = two_cells(), FlowSettings(precision=precision)
    # Sideslip: else every step would ask for the kernel of symmetric flow as well.
    stream = FlowConditions(np.array([2.0]), np.zeros(1), np.array([0.1]))
    if gas == EQUILIBRIUM:
        stream = replace(stream, gas=gas, density=np.array([1.2]), pressure=np.array([1e5]))
    STEPS[name](Ensemble(mesh, prepare(mesh, settings.dtype), stream, settings, 2))


class Work:
    """The steps that are left, and the helper process that takes some of them.

    Attributes:
        left: names in `STEPS` that nobody has taken.
    """

    def __init__(self, precision: str, gas: str, helped: bool):
        self.precision, self.gas = precision, gas
        self.left = deque(STEPS)
        self.helper = _start(precision, gas) if helped else None
        self.feeder = threading.Thread(target=self._feed, daemon=True)
        if self.helper is not None:
            self.feeder.start()

    def finish(self) -> None:
        """Compile what is left, wait for the helper, and compile what that could not."""
        try:
            self._work()
            if self.helper is not None:
                self.feeder.join()
                self._work()
        except BaseException:
            if self.helper is not None:
                self.helper.kill()
            raise

    def _take(self) -> str | None:
        try:
            return self.left.popleft()  # one of the operations of a deque that threads may share
        except IndexError:
            return None

    def _work(self) -> None:
        while (name := self._take()) is not None:
            _compile(name, self.precision, self.gas)

    def _feed(self) -> None:
        """Hand the helper one step after the other; one that it does not answer goes back to the list."""
        with self.helper as helper:
            while (name := self._take()) is not None:
                try:
                    helper.stdin.write(name + "\n")
                    helper.stdin.flush()
                    answer = helper.stdout.readline()
                except (OSError, ValueError):
                    answer = ""
                if answer.strip() != name:
                    self.left.append(name)
                    helper.kill()
                    break


def _start(precision: str, gas: str) -> subprocess.Popen | None:
    """A helper process that runs `serve`; None where none can be had."""
    command = f"import sys; sys.path[:] = {sys.path!r}; from spaceplane.flow.compilation import serve; "
    command += f"serve({precision!r}, {gas!r})"
    try:
        return subprocess.Popen(
            [sys.executable, "-c", command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,  # what fails there is done again here, and fails here
            text=True,
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
        )
    except (OSError, ValueError):
        return None


def serve(precision: str, gas: str) -> None:
    """What a helper does: names of steps in by the standard input, each told when it is done, until the input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the parent decides
    names: queue.SimpleQueue[str] = queue.SimpleQueue()

    def listen() -> None:
        for line in sys.stdin:
            names.put(line.strip())
        os._exit(0)  # in the middle of a step as well: the parent has all it needs, or is gone

    threading.Thread(target=listen, daemon=True).start()
    while True:
        name = names.get()
        _compile(name, precision, gas)
        print(name, flush=True)


_begun: dict[tuple[str, str], Work] = {}


def begin(settings: FlowSettings, conditions: FlowConditions) -> None:
    """Let a helper compile what flows with these settings and conditions need, while this process does something else.

    Does nothing where all is compiled, where numba is to use one thread only, or where a helper could not hand over
    what it compiles.
    """
    key = settings.precision, conditions.gas
    if key in _begun or CACHE.is_complete("-".join(key)):
        return
    if numba.config.NUMBA_NUM_THREADS > 1 and sys.executable and writable(CACHE.folder):
        _begun[key] = Work(*key, helped=True)


def compile_kernels(settings: FlowSettings, conditions: FlowConditions, progress: Progress | None = None) -> None:
    """Compile what flows with these settings and conditions need, or do nothing where the cache has all of it.

    Args:
        progress: told with the phase "compile", when there is something to compile.
    """
    key = settings.precision, conditions.gas
    if CACHE.is_complete("-".join(key)):
        return
    (progress or silent)("compile", 0, 1, "compiling kernels (once, ~20 s)")
    begin(settings, conditions)
    work = _begun.pop(key, None) or Work(*key, helped=False)
    work.finish()
    CACHE.mark_complete("-".join(key))


def compile_all(progress: Progress | None = None) -> None:
    """Compile what meshing and solving need by default, once, before several processes begin."""
    settings, still = FlowSettings(), FlowConditions(*np.zeros((3, 1)))
    begin(settings, still)
    generate.compile_kernels(progress)
    compile_kernels(settings, still, progress)
