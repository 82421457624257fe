"""The part of an aerodynamic model without empty cells: other programs cannot say "unknown" inside a table."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spaceplane.aero.model.model import AeroModel, SurfaceTable
from spaceplane.errors import InputError

# A table needs two nodes on each axis, here and in the other programs.
_LEAST = 2


def full_part(model: AeroModel) -> AeroModel:
    """The model on the largest block of nodes (alpha by Mach number) at which every table that holds a number is known.

    Tables without any number are left out. Where two blocks are of one size, the one of the lower Mach numbers.

    Raises:
        InputError: no block of two by two nodes is known.
    """
    slopes = {name: table for name, table in model.slopes.items() if np.isfinite(table).any()}
    surfaces = {
        name: SurfaceTable(surface.deflection, {c: t for c, t in surface.increments.items() if np.isfinite(t).any()})
        for name, surface in model.surfaces.items()
    }
    known = np.ones((len(model.alpha), len(model.mach)), dtype=bool)
    for table in (*model.base.values(), *slopes.values()):
        known &= np.isfinite(table)
    for surface in surfaces.values():
        for table in surface.increments.values():
            known &= np.isfinite(table).all(axis=0)
    rows, columns = _largest_block(known, model.name)
    return replace(
        model,
        alpha=model.alpha[rows],
        mach=model.mach[columns],
        base={name: table[rows, columns] for name, table in model.base.items()},
        slopes={name: table[rows, columns] for name, table in slopes.items()},
        surfaces={
            name: SurfaceTable(s.deflection, {c: t[:, rows, columns] for c, t in s.increments.items()})
            for name, s in surfaces.items()
        },
    )


def _largest_block(known: np.ndarray, name: str) -> tuple[slice, slice]:
    """(rows, columns) of the largest rectangle of true entries."""
    best, found = 0, None
    m = known.shape[1]
    for left in range(m - 1):
        for right in range(left + _LEAST, m + 1):
            whole = known[:, left:right].all(axis=1)
            edges = np.flatnonzero(np.diff(np.concatenate([[False], whole, [False]])))
            for low, high in zip(edges[::2], edges[1::2], strict=True):
                size = (high - low) * (right - left)
                if high - low >= _LEAST and size > best:
                    best, found = size, (slice(int(low), int(high)), slice(left, right))
    if found is None:
        raise InputError(
            f"{name}: no block of {_LEAST} angles of attack by {_LEAST} Mach numbers is known in all tables"
        )
    return found
