"""Compilation of the flow kernels: decorators, passive threads; kept on disk."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

# Spinning OpenMP threads doubled the CPU time of ensembles; wait passively. Must be set before numba starts its
# threads.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
os.environ.setdefault("GOMP_SPINCOUNT", "0")

from numba.core.cpu import CPUTargetOptions
from numba.core.options import TargetOptions

from spaceplane.kernelcache import cache_of, inner

CACHE = cache_of(Path(__file__).parent)

# Lanes of an ensemble: a constant, so that loops over them become vectors without remainder. Eight are one vector of
# single precision on most processors: sixteen took a seventh less time per lane, but twice the memory, and in a set of
# sixteen conditions three fifths of them stood empty on the mean while the last ones converged; of eight a quarter.
# A row holds the five variables of a cell, each for all lanes: density from RHO on, velocity from VX, VY, VZ, pressure
# from PRS.
LANES = 8
ROW = 5 * LANES
RHO, VX, VY, VZ, PRS = range(0, ROW, LANES)

# NaN and infinity keep their meaning (guards test for them); the rest of fast arithmetic is allowed.
FAST_MATH = {"reassoc", "contract", "arcp", "afn", "nsz"}
OPTIONS = {"fastmath": FAST_MATH, "error_model": "numpy"}

# numba can tell the compiler that no two arguments overlap, but has no name for it among its options. Without it, every
# short loop over lanes is preceded by a test of all its arrays against each other, or stays scalar.
CPUTargetOptions.noalias = TargetOptions.Mapping("noalias")


def kernel(function: Callable) -> Callable:
    """Compile a kernel that runs on all threads, kept on disk."""
    return CACHE.compile(function, parallel=True, nogil=True, **OPTIONS)


def distinct(function: Callable) -> Callable:
    """Compile the work of one thread, whose array arguments must not overlap each other; called from a kernel."""
    return inner(function, noalias=True, nogil=True, **OPTIONS)


def inlined(function: Callable) -> Callable:
    """Compile a scalar function into its callers. The plain Python function stays at `.py_func`."""
    return inner(function, forceinline=True, **OPTIONS)
