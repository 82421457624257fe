"""Compilation of the flow kernels: decorators, disk cache, passive threads.

Kernels are cached on disk under a key made from the text of every source file of this package, so that an edit
of an inlined function cannot leave a stale caller behind (numba itself only watches the caller's own file).
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

# Spinning OpenMP threads doubled the CPU time of ensembles; wait passively. Must be set before numba starts its
# threads.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
os.environ.setdefault("GOMP_SPINCOUNT", "0")

import numba
from numba import config, njit

# Most lanes of an ensemble: a constant, so that the compiler knows the rows of scratch arrays apart and vectorises.
WIDTH = 32

# NaN and infinity keep their meaning (guards test for them); the rest of fast arithmetic is allowed.
FAST_MATH = {"reassoc", "contract", "arcp", "afn", "nsz"}


def source_key() -> str:
    """Hash of the package's sources and of numba's version: names the cache folder."""
    digest = hashlib.sha256(numba.__version__.encode())
    folder = Path(__file__).parent
    for path in sorted(folder.rglob("*.py")):
        digest.update(path.relative_to(folder).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def writable(folder: Path) -> bool:
    """Whether files can be created in `folder`, which is made if need be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def cache_root() -> Path:
    """Folder of all kernel caches: NUMBA_CACHE_DIR, else beside the sources, else the user's cache, else a temporary
    one."""
    asked = os.environ.get("NUMBA_CACHE_DIR")
    user = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    choices = [Path(asked)] if asked else []
    choices += [Path(__file__).parent / "__pycache__", user / "spaceplane"]
    for choice in choices:
        if writable(choice):
            return choice
    return Path(tempfile.gettempdir()) / f"spaceplane-{os.getuid()}"


CACHE_FOLDER = cache_root() / f"flow-{source_key()}"


def kernel(function: Callable | None = None, *, parallel: bool = True) -> Callable:
    """Compile a lane kernel, cached on disk. Use as `@kernel` or `@kernel(parallel=False)`."""

    def decorate(target: Callable) -> Callable:
        before = config.CACHE_DIR
        config.CACHE_DIR = str(CACHE_FOLDER)
        try:
            return njit(parallel=parallel, cache=True, fastmath=FAST_MATH, error_model="numpy", nogil=True)(target)
        finally:
            config.CACHE_DIR = before

    return decorate if function is None else decorate(function)


def inlined(function: Callable) -> Callable:
    """Compile a scalar function into its callers. The plain Python function stays at `.py_func`."""
    return njit(forceinline=True, fastmath=FAST_MATH, error_model="numpy")(function)


def is_compiled(precision: str) -> bool:
    """Whether a complete solution in this precision has left its kernels in the cache."""
    return (CACHE_FOLDER / f"complete-{precision}").exists()


def mark_compiled(precision: str) -> None:
    """Remember that the kernels of this precision are in the cache."""
    if writable(CACHE_FOLDER):
        (CACHE_FOLDER / f"complete-{precision}").touch()
