"""How a stage tells how far it is."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, int, int, str], None]
"""Called with (phase, steps done, steps in all, text). Where there are several bodies, the name of the body and a colon
stand before the phase."""


def silent(phase: str, done: int, total: int, text: str) -> None:
    """A `Progress` that says nothing."""
