"""The block of a model without empty cells."""

from dataclasses import replace

import numpy as np
import pytest

from spaceplane.aero.model.model import SurfaceTable
from spaceplane.decks.full import full_part
from spaceplane.errors import InputError

from .horus import complete


def with_holes(model, *holes, name="CL"):
    table = model.base[name].copy()
    for hole in holes:
        table[hole] = np.nan
    return replace(model, base={**model.base, name: table})


def test_full_model_stays():
    model = complete()
    full = full_part(model)
    assert np.array_equal(full.alpha, model.alpha) and np.array_equal(full.mach, model.mach)
    for name, surface in model.surfaces.items():
        for coefficient, table in surface.increments.items():
            assert np.array_equal(full.surfaces[name].increments[coefficient], table)


def test_largest_block_by_brute_force():
    """Against a search over all blocks, for random holes in any table."""
    model = complete()
    random = np.random.default_rng(0)
    for _ in range(20):
        known = random.uniform(size=(10, 5)) > 0.15
        sizes = [
            (b - a) * (d - c)
            for a in range(9)
            for b in range(a + 2, 11)
            for c in range(4)
            for d in range(c + 2, 6)
            if known[a:b, c:d].all()
        ]
        full = full_part(with_holes(model, ~known, name=random.choice(["CL", "CD", "Cm"])))
        assert full.base["CL"].size == max(sizes)
        rows, columns = np.searchsorted(model.alpha, full.alpha), np.searchsorted(model.mach, full.mach)
        assert known[np.ix_(rows, columns)].all()
        assert np.array_equal(full.base["CD"], model.base["CD"][np.ix_(rows, columns)], equal_nan=False)


def test_holes_of_slopes_and_increments_count():
    model = complete()
    slope = model.slopes["Cl_p"].copy()
    slope[:, 4] = np.nan
    assert list(full_part(replace(model, slopes={**model.slopes, "Cl_p": slope})).mach) == [1.5, 2.0, 3.0, 10.0]
    flap = model.surfaces["body_flap"]
    increment = flap.increments["Cm"].copy()
    increment[0, 0, :] = np.nan
    holed = SurfaceTable(flap.deflection, {**flap.increments, "Cm": increment})
    full = full_part(replace(model, surfaces={**model.surfaces, "body_flap": holed}))
    assert np.degrees(full.alpha[0]) == pytest.approx(5.0) and len(full.mach) == 5


def test_table_without_numbers_is_left_out():
    model = complete()
    empty = replace(model, slopes={**model.slopes, "Cn_p": np.full((10, 5), np.nan)})
    full = full_part(empty)
    assert "Cn_p" not in full.slopes and "Cn_p" in full.unknown() and len(full.alpha) == 10


def test_no_block_is_refused():
    model = complete()
    holes = np.indices((10, 5)).sum(axis=0) % 2 == 0
    with pytest.raises(InputError, match="no block of 2 angles of attack by 2 Mach numbers"):
        full_part(with_holes(model, holes))
