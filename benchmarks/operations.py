"""Count the floating-point operations of the flow kernels, by running their Python text on numbers that count.

    NUMBA_DISABLE_JIT=1 python benchmarks/operations.py

A tiny box of air is enough: all kernels do the same work in every cell and on every face. Prints one line of JSON:
operations (each addition, product, quotient, root, comparison of a minimum or maximum) per cell or face and condition.
"""

from __future__ import annotations

import json
import math
import os
import sys
import types
from pathlib import Path

if __name__ == "__main__" and os.environ.get("NUMBA_DISABLE_JIT") != "1":
    sys.exit("NUMBA_DISABLE_JIT: must be 1, the kernels' Python text is run")

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from flow.structured import box
from spaceplane.flow import acceleration, implicit, jacobian, reconstruction, residual
from spaceplane.flow.compiled import LANES
from spaceplane.flow.ensemble import Ensemble
from spaceplane.flow.fluxes import hllc, hlle
from spaceplane.flow.gas import PerfectGas
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.topology import prepare


class Counted(float):
    """A float whose arithmetic counts itself."""

    done = 0

    def __lt__(self, other):
        Counted.done += 1
        return float.__lt__(self, other)

    def __gt__(self, other):
        Counted.done += 1
        return float.__gt__(self, other)

    __hash__ = float.__hash__


def _counting(name: str):
    plain = getattr(float, name)

    def operation(self, *others):
        Counted.done += 1
        value = plain(self, *others)
        return value if value is NotImplemented else Counted(value)

    return operation


for _name in ("add", "radd", "sub", "rsub", "mul", "rmul", "truediv", "rtruediv"):
    setattr(Counted, f"__{_name}__", _counting(f"__{_name}__"))
Counted.__neg__ = lambda self: Counted(float.__neg__(self))  # signs cost nothing
Counted.__abs__ = lambda self: Counted(float.__abs__(self))


def _root(value: float) -> Counted:
    Counted.done += 1
    return Counted(math.sqrt(value))


def counted(array: np.ndarray) -> np.ndarray:
    """The array with numbers that count."""
    return np.frompyfunc(Counted, 1, 1)(array)


class CountingEnsemble(Ensemble):
    """An ensemble whose arithmetic is counted."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        for name, value in list(vars(self).items()):
            if isinstance(value, np.ndarray) and value.dtype == self.dtype:
                setattr(self, name, counted(value))
        for name in ("gamma", "smallness", "low", "high"):
            setattr(self, name, Counted(getattr(self, name)))
        self.gas = PerfectGas(self.gamma)
        self.frame = self.frame._replace(
            **{name: counted(getattr(self.frame, name)) for name in ("spin", "drift", "still")}
        )
        self.topology = self.topology._replace(
            **{
                name: counted(value)
                for name, value in self.topology._asdict().items()
                if isinstance(value, np.ndarray) and value.dtype == self.dtype
            }
        )
        self.dtype = Counted


def count() -> dict[str, float]:
    """Operations of each step of an iteration per cell and condition, on a box of hexahedra."""
    for module in (acceleration, implicit, jacobian, reconstruction, residual, hllc, hlle):
        if hasattr(module, "math"):
            module.math = types.SimpleNamespace(sqrt=_root)
    mesh = box(6, 0.2)
    settings = FlowSettings(anderson_depth=0)
    mach = np.linspace(0.8, 2.5, LANES)
    ensemble = CountingEnsemble(
        mesh, prepare(mesh, settings.dtype), FlowConditions(mach, 0.1 * mach, 0 * mach), settings, 2
    )
    cfl, calm = np.full(LANES, 10.0), np.zeros(LANES, dtype=bool)
    steps = {
        "gradients": ensemble.reconstruct,
        "fluxes": ensemble.balance,
        "diagonals": lambda: ensemble.factorise(cfl, ~calm),
        "sweeps": ensemble.relax,
    }
    result = {}
    for name, step in steps.items():
        Counted.done = 0
        step()
        result[name] = Counted.done / mesh.cells / LANES
    return {"faces_per_cell": len(mesh.face_cells) / mesh.cells, **result}


if __name__ == "__main__":
    print(json.dumps(count()))
