"""Calls from Python of functions that are compiled for kernels only, see `spaceplane.flow.compiled.NO_ENTRY`."""

from __future__ import annotations

from collections.abc import Callable

from numba import njit


def compiled(function: Callable) -> Callable:
    """The function with an entry from Python."""

    @njit
    def call(*arguments):
        return function(*arguments)

    return call
