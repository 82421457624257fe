"""Compilation of the mesh kernels, kept on disk."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from numba import njit

from spaceplane.kernelcache import cache_of

CACHE = cache_of(Path(__file__).parent)


def kernel(function: Callable) -> Callable:
    """Compile a kernel of this package; use as `@kernel`. The plain Python function stays at `.py_func`."""
    return CACHE.compile(function, no_cfunc_wrapper=True)


def inner(function: Callable) -> Callable:
    """Compile a function that only kernels call: without an entry from Python it costs less time."""
    return njit(no_cpython_wrapper=True, no_cfunc_wrapper=True)(function)
