"""Refinement until an accuracy is reached, on coefficients with a known error and on a cone."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from spaceplane.aero.uncertainty.accuracy import Accuracy, refine, relative
from spaceplane.aero.uncertainty.errors import of_coefficients
from spaceplane.aero.uncertainty.grid import ORDER, SAFETY_SUPERSONIC
from spaceplane.aero.uncertainty.settings import FIRST_CELLS
from spaceplane.errors import InputError

MACH = np.array([1.5, 3.0])
EXACT = {"CL": 0.3, "CD": 0.4, "CY": 0.0, "Cl": 0.0, "Cm": -0.1, "Cn": 0.0, "CA": 0.35, "CN": 0.35,
         "CA_forebody": 0.3, "CA_base": 0.05}  # fmt: skip
SLOPE = 0.2  # error over wall cell to the assumed order of every coefficient that is not zero by symmetry


def mesh(cell):
    """Cells as the inverse square of the wall cell, 12 000 at 1 m."""
    cell = 1.0 if cell is None else cell
    return SimpleNamespace(cells=round(12_000 / cell**2), record={"wall_cell_m": cell})


def solved(made, slope=SLOPE):
    cell = made.record["wall_cell_m"]
    variables = {}
    for name, exact in EXACT.items():
        variables[name] = (("condition", "part"), np.full((2, 1), exact and exact + slope * cell**ORDER))
        variables[f"{name}_spread"] = ("condition", np.zeros(2))
    along = {name: ("condition", value) for name, value in (("mach", MACH), ("alpha", 0 * MACH), ("beta", 0 * MACH))}
    body = {"wall_reach_m": [1.0, 0.1, 0.1], "wall_rms_m": [0.5, 0.05, 0.05], "c_ref_m": 1.0, "b_ref_m": 1.0}
    return xr.Dataset(variables, {"part": ["total"], **along}, body)


def test_it_stops_at_the_accuracy_and_the_error_is_below_it():
    heard = []
    found = refine(mesh, solved, Accuracy(0.1, 10**8), heard.append)
    assert found.met and found.needed is None and found.reached <= 0.1
    assert [t.cells for t in heard] == [t.cells for t in found.trials]
    assert [t.cells for t in found.trials] == sorted(t.cells for t in found.trials)
    last = found.trials[-1]
    force = 0.5
    assert SLOPE * last.wall_cell**ORDER / force <= found.reached
    # not far beyond what was asked: at most one halving
    assert found.trials[-2].reached > 0.1 and found.reached > 0.1 / 2.5
    assert found.trials[0].reached is None and "at Mach" in last.worst
    assert float(relative(found.coefficients).max()) == found.reached


def test_a_tighter_accuracy_takes_more_cells():
    cells = [refine(mesh, solved, Accuracy(target, 10**8)).trials[-1].cells for target in (0.2, 0.1, 0.05)]
    assert cells[0] < cells[1] < cells[2]


def test_it_stops_at_the_cells_and_says_what_would_be_needed():
    found = refine(mesh, solved, Accuracy(0.01, 150_000))
    assert not found.met and found.reached > 0.01
    assert 75_000 < found.trials[-1].cells <= 150_000
    # the uncertainty falls with the wall cell to that order, the cells grow with its inverse square
    grown = (found.reached / 0.01) ** (2.0 / ORDER)
    assert found.needed == pytest.approx(found.trials[-1].cells * grown, rel=0.05)


def test_no_mesh_is_larger_than_allowed_even_if_the_count_is_mispredicted():
    def dense(cell):
        made = mesh(cell)
        return SimpleNamespace(cells=round(12_000 / (cell or 1.0) ** 3), record=made.record)

    found = refine(dense, solved, Accuracy(0.005, 200_000))
    assert not found.met and max(t.cells for t in found.trials) <= 200_000


def test_too_few_cells_for_two_meshes_are_refused():
    with pytest.raises(InputError, match=f"max_cells: {FIRST_CELLS}, too few for two meshes"):
        refine(mesh, solved, Accuracy(0.05, FIRST_CELLS))


@pytest.mark.parametrize("target", [0.0, -0.01, 1e-5, 0.9, math.nan, math.inf])
def test_accuracies_out_of_range_are_refused(target):
    with pytest.raises(InputError, match=r"accuracy: .* %, allowed 0\.05 % to 50 %"):
        Accuracy(target, 10**6)


def test_the_errors_of_coefficients_are_those_of_mesh_and_iteration_together():
    fine, coarse = solved(mesh(0.5)), solved(mesh(1.0))
    fine["CL_spread"] = ("condition", np.full(2, 0.03))
    found = of_coefficients(fine, coarse, 2.0)
    by_mesh = SAFETY_SUPERSONIC * SLOPE * 0.5**ORDER
    np.testing.assert_allclose(found.CL_mesh_error, by_mesh, rtol=0.05)
    np.testing.assert_allclose(found.CL_error, np.hypot(found.CL_mesh_error, 0.03))
    assert found.CY_error.values.max() == 0.0
    alone = of_coefficients(fine, None, 2.0)
    np.testing.assert_allclose(alone.CL_error, 0.03)
    assert "CL_mesh_error" not in alone
