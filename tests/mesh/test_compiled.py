"""Mesh kernels are compiled once, with a word about it, and never again."""

import subprocess
import sys

import numpy as np
import pytest

from spaceplane import kernelcache
from spaceplane.aero import bodies as vehicle_bodies
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.mesh import generate as meshing
from spaceplane.mesh.settings import MeshSettings

from . import bodies

COUNT = """
import importlib, pkgutil, numpy as np
import spaceplane.mesh
from spaceplane.mesh.coarsen import coarsen
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings, RefinementBox
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.presets import horus_2b

heard = []
box = RefinementBox((0.0, -1.0, -1.0), (5.0, 1.0, 1.0), 0.6)
for settings, elevon in (
    (MeshSettings(wall_cell=0.7, far_field=1.0), 0.0),
    (MeshSettings(wall_cell=0.7, far_field=1.0, fine_parts=("elevon",), boxes=(box,)), 0.0),
    (MeshSettings(wall_cell=0.7, far_field=1.0), 10.0),
):
    body = build(horus_2b().shape, ControlDeflections.from_degrees(elevon_left=elevon))
    coarsen(generate(body, settings, lambda *told: heard.append(told)))
kernels = {}
for module in pkgutil.iter_modules(spaceplane.mesh.__path__):
    for value in vars(importlib.import_module(f"spaceplane.mesh.{module.name}")).values():
        if hasattr(value, "stats"):
            kernels[value] = value.stats
misses = sum(sum(found.cache_misses.values()) for found in kernels.values())
hits = sum(sum(found.cache_hits.values()) for found in kernels.values())
print(len(heard), misses, hits)
"""


def test_a_second_start_compiles_nothing():
    meshing.compile_kernels()
    done = subprocess.run([sys.executable, "-c", COUNT], capture_output=True, text=True, check=True, timeout=200)
    heard, misses, hits = map(int, done.stdout.split())
    assert (heard, misses) == (0, 0)
    assert hits > 10


@pytest.fixture
def fresh(tmp_path, monkeypatch):
    """A cache that nothing was compiled into (what this process has compiled already stays compiled)."""
    cache = kernelcache.KernelCache(meshing.CACHE.sources, tmp_path / "kernels")
    monkeypatch.setattr(meshing, "CACHE", cache)
    return cache


def test_the_first_compilation_says_so_and_the_second_is_none(fresh):
    heard = []
    for _ in range(2):
        meshing.generate(bodies.sphere(1.0, 1), MeshSettings(wall_cell=0.5), lambda *told: heard.append(told))
    assert [phase for phase, *_ in heard] == ["compile mesh"]
    assert "once" in heard[0][3]


def test_a_vehicle_names_the_body_whose_mesh_compiles(fresh, monkeypatch):
    from spaceplane.vehicle.controls import ControlDeflections
    from spaceplane.vehicle.presets import horus_2b

    monkeypatch.setattr(vehicle_bodies, "solve", lambda *_: None)
    heard = []
    settings = MeshSettings(wall_cell=0.7, far_field=1.0)
    stream = FlowConditions(np.array([2.0]), np.zeros(1), np.zeros(1))
    vehicle_bodies.solve_vehicle(
        horus_2b(),
        ControlDeflections(),
        stream,
        settings,
        FlowSettings(),
        lambda *told: heard.append(told[0]),
        "base",
    )
    assert heard == ["base: geometry", "base: mesh", "base: compile mesh"]


def test_a_changed_source_asks_for_another_compilation(tmp_path):
    sources = tmp_path / "package"
    sources.mkdir()
    (sources / "one.py").write_text("a = 1\n")
    first = kernelcache.cache_of(sources)
    cache = kernelcache.KernelCache(sources, tmp_path / first.folder.name)
    cache.mark_complete("all")
    assert cache.is_complete("all") and not cache.is_complete("other")
    (sources / "one.py").write_text("a = 2\n")
    assert not cache.is_complete("all")
    assert kernelcache.cache_of(sources).folder != first.folder


def test_functions_inside_kernels_can_be_called_from_python():
    @kernelcache.inner
    def double(x):
        return 2 * x

    @kernelcache.inner
    def twice(x):
        return double(double(x))

    assert twice(3) == 12 and double(0.5) == 1.0 and twice.py_func(1) == 4
