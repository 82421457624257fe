"""Compiled kernels on disk: where they are kept, when they are stale, whether all of a package's are there.

Kernels are kept in a folder named by the text of every source file of their package, so that an edit of a function that
others inline leaves no stale caller behind (numba itself watches the caller's own file only).
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numba
from numba import config, njit
from numba.core.registry import CPUDispatcher


@dataclass(frozen=True)
class KernelCache:
    """The compiled kernels of one package.

    Attributes:
        sources: folder of the package.
        folder: where its kernels are kept.
    """

    sources: Path
    folder: Path

    def compile(self, function: Callable, **options) -> Callable:
        """The function compiled when first called, or loaded from the folder; options are those of `numba.njit`."""
        options = {"no_cfunc_wrapper": True, **options}
        before = config.CACHE_DIR
        config.CACHE_DIR = str(self.folder)
        try:
            return njit(cache=True, **options)(function)
        finally:
            config.CACHE_DIR = before

    def is_complete(self, what: str) -> bool:
        """Whether `mark_complete` was called on these very files (numba recompiles when a file's time changes)."""
        return self._mark(what).exists()

    def mark_complete(self, what: str) -> None:
        """Remember that all kernels for `what` are in the folder."""
        if writable(self.folder):
            self._mark(what).touch()

    def _mark(self, what: str) -> Path:
        times = hashlib.sha256("".join(str(path.stat().st_mtime_ns) for path in _files(self.sources)).encode())
        return self.folder / f"complete-{what}-{times.hexdigest()[:16]}"


class Inner(CPUDispatcher):
    """A compiled function that kernels call, without an entry from Python of its own; called from there all the same,
    it is given one."""

    def __call__(self, *arguments):
        entry = self.__dict__.get("entry")
        if entry is None:
            function = self

            @njit
            def entry(*arguments):
                return function(*arguments)

            self.entry = entry
        return entry(*arguments)


def inner(function: Callable, **options) -> Callable:
    """The function compiled into the kernels that call it; options are those of `numba.njit`.

    Entries from Python and C, which are for nothing there, cost a fifth of the time of compiling.
    """
    compiled = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, **options)(function)
    if isinstance(compiled, CPUDispatcher):  # else numba was told not to compile
        compiled.__class__ = Inner  # called as it is, it would jump to nowhere
    return compiled


def cache_of(sources: Path) -> KernelCache:
    """The kernel cache of the package in the folder `sources`."""
    return KernelCache(sources, cache_root() / f"{sources.name}-{source_key(sources)}")


def source_key(folder: Path) -> str:
    """Hash of a package's sources and of numba's version, 16 hexadecimal digits."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in _files(folder):
        digest.update(path.relative_to(folder).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _files(folder: Path) -> list[Path]:
    return sorted(folder.rglob("*.py"))


def writable(folder: Path) -> bool:
    """Whether files can be created in `folder`, which is made if need be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def cache_root() -> Path:
    """Folder of all kernel caches: NUMBA_CACHE_DIR, else beside the sources, else the user's, else a temporary one."""
    asked = os.environ.get("NUMBA_CACHE_DIR")
    user = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    choices = [Path(asked)] if asked else []
    choices += [Path(__file__).parent / "__pycache__", user / "spaceplane"]
    for choice in choices:
        if writable(choice):
            return choice
    return Path(tempfile.gettempdir()) / f"spaceplane-{os.getuid()}"
