"""Compilation of this package's kernels, kept on disk."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from spaceplane.kernelcache import cache_of

CACHE = cache_of(Path(__file__).parent)


def kernel(function: Callable) -> Callable:
    """Compile a kernel of this package; use as `@kernel`. The plain Python function stays at `.py_func`."""
    return CACHE.compile(function, nogil=True)
