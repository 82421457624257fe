"""Flow kernels are compiled once, all of them, by two processes that share the work whatever becomes of the helper."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from spaceplane.flow import compilation
from spaceplane.flow.compilation import STEPS, Work, begin, compile_kernels, two_cells
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.kernelcache import KernelCache

STREAM = FlowConditions(np.array([2.0]), np.zeros(1), np.zeros(1))
ECHO = "import sys\nfor line in sys.stdin: print(line.strip(), flush=True)"
DIES_AT_THE_SECOND = "import sys\nprint(sys.stdin.readline().strip(), flush=True)\nsys.stdin.readline()\nsys.exit(1)"
SILENT = "import sys\nsys.stdin.read()"

COUNT = """
import importlib, pkgutil, sys
import numpy as np
import spaceplane.flow
from flow.structured import sphere
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve

heard = []
streams = FlowConditions(np.array([0.8, 2.0]), np.array([0.0, 0.1]), np.array([0.0, 0.05]))
settings = FlowSettings(iterations=6, coarse_iterations=4, residual_drop=16.0)
solve(sphere(16, 8), streams, settings, lambda *told: heard.append(told[0]))
misses = hits = 0
for module in pkgutil.walk_packages(spaceplane.flow.__path__, "spaceplane.flow."):
    for value in vars(importlib.import_module(module.name)).values():
        if hasattr(value, "stats"):
            misses += sum(value.stats.cache_misses.values())
            hits += sum(value.stats.cache_hits.values())
print("compile" in heard, misses, hits)
"""


def test_what_is_compiled_is_all_that_a_solution_needs(request):
    compile_kernels(FlowSettings(), STREAM)
    path = repr([str(request.config.rootpath / "tests"), *sys.path])
    command = [sys.executable, "-c", f"import sys; sys.path[:] = {path}\n{COUNT}"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    told, misses, hits = done.stdout.split()
    assert (told, misses) == ("False", "0")
    assert int(hits) >= len(STEPS)


def test_the_two_cells_are_closed_and_have_walls():
    mesh = two_cells()
    np.testing.assert_array_equal(mesh.closure(), 0.0)
    assert len(mesh.wall_cell) == 2 and len(mesh.far_cell) == 8


@pytest.fixture
def compiled(monkeypatch):
    """Names that this process was asked to compile."""
    names = []
    monkeypatch.setattr(compilation, "_compile", lambda name, *_: names.append(name))
    return names


def helped_by(monkeypatch, script):
    """Work whose helper runs this script."""

    def start(*_):
        command = [sys.executable, "-c", script]
        return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    monkeypatch.setattr(compilation, "_start", start)
    return Work("single", "perfect", helped=True)


def test_alone_every_kernel_is_compiled_here(compiled):
    Work("single", "perfect", helped=False).finish()
    assert compiled == list(STEPS)


def test_a_helper_that_does_all_leaves_nothing_to_do(compiled, monkeypatch):
    work = helped_by(monkeypatch, ECHO)
    work.feeder.join(60.0)
    work.finish()
    assert compiled == []
    assert work.helper.returncode == 0


@pytest.mark.parametrize(("script", "answered"), [(DIES_AT_THE_SECOND, 1), ("raise SystemExit(1)", 0)])
def test_what_a_helper_leaves_when_it_dies_is_compiled_here(compiled, monkeypatch, script, answered):
    work = helped_by(monkeypatch, script)
    work.feeder.join(60.0)
    work.finish()
    assert sorted(compiled) == sorted(list(STEPS)[answered:])
    assert work.helper.poll() is not None


def test_an_interrupt_ends_the_helper(monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(compilation, "_compile", interrupted)
    work = helped_by(monkeypatch, SILENT)
    with pytest.raises(KeyboardInterrupt):
        work.finish()
    assert work.helper.wait(60.0) != 0


def test_a_helper_whose_parent_is_gone_ends():
    helper = compilation._start("single", "perfect")
    helper.stdin.write("prolongation\n")
    helper.stdin.close()
    assert helper.wait(120.0) == 0
    helper.stdout.close()


@pytest.mark.parametrize(("threads", "can_write", "helpers"), [(1, True, 0), (2, False, 0), (2, True, 1)])
def test_a_helper_is_started_where_it_helps(monkeypatch, tmp_path, threads, can_write, helpers):
    started = []
    monkeypatch.setattr(compilation, "_start", lambda *key: started.append(key))
    monkeypatch.setattr(compilation, "_begun", {})
    monkeypatch.setattr(compilation, "CACHE", KernelCache(compilation.CACHE.sources, tmp_path))
    monkeypatch.setattr(compilation, "writable", lambda _: can_write)
    monkeypatch.setattr(compilation.numba.config, "NUMBA_NUM_THREADS", threads)
    for _ in range(2):
        begin(FlowSettings(), STREAM)
    assert started == [("single", "perfect")] * helpers
