"""The registry of validation cases and the function that runs them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module

from spaceplane.errors import InputError, unknown_name
from spaceplane.validation.records import Record

Progress = Callable[[str, float], None]
"""Called with a line saying what runs and the fraction done (0 to 1) of all cases."""

CASES: dict[str, str] = {
    "cones": "spaceplane.validation.cones",
    "sphere": "spaceplane.validation.sphere",
    "hb2": "spaceplane.validation.hb2",
    "finner": "spaceplane.validation.finner",
    "m6": "spaceplane.validation.m6",
    "horus": "spaceplane.validation.horus",
    "dynamics": "spaceplane.validation.dynamics",
}
"""Case name -> module whose `run(fine, progress) -> list[Record]` computes it; imported when the case is run."""


def run(cases: Sequence[str] = (), progress: Progress | None = None, fine: bool = True) -> tuple[Record, ...]:
    """Run validation cases and return every published value beside the computed one.

    Args:
        cases: names from `CASES`; all of them when empty.
        progress: told what runs and how far it has come.
        fine: the meshes of the documentation; False takes coarser ones that finish in seconds, for tests.

    Raises:
        InputError: on an unknown case, with the nearest valid name.
    """
    names = list(cases) or list(CASES)
    for name in names:
        if name not in CASES:
            raise InputError(unknown_name("case", name, CASES))
    tell = progress or (lambda line, fraction: None)
    records: list[Record] = []
    for index, name in enumerate(names):

        def tell_part(line: str, fraction: float, index: int = index, name: str = name) -> None:
            tell(f"{name}: {line}", (index + fraction) / len(names))

        records += import_module(CASES[name]).run(fine, tell_part)
    tell("done", 1.0)
    return tuple(records)
