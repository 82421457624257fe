"""The estimate on values whose error is known: v(h) = exact + c h^p."""

import numpy as np
import pytest

from spaceplane.aero.uncertainty.grid import ORDER, SAFETY, SAFETY_SUPERSONIC, half_width

MACH = np.array([1.5, 2.0, 2.5, 4.0])
FACTOR = SAFETY_SUPERSONIC / (2.0**ORDER - 1.0)  # on the difference between two meshes of which one is twice as coarse


def values(exact, slope, cell, power=ORDER):
    return np.asarray(exact) + np.asarray(slope) * cell**power


def test_errors_of_the_assumed_order_are_covered_by_the_safety_factor():
    exact, slope = np.full((1, 4), 0.3), np.full((1, 4), -0.2)
    for cell, ratio in ((0.25, 2.0), (0.1, 1.5)):
        fine, coarse = (values(exact, slope, h) for h in (cell, ratio * cell))
        found = half_width(fine, coarse, MACH, ["force"], ratio)
        np.testing.assert_allclose(found, SAFETY_SUPERSONIC * np.abs(fine - exact), rtol=1e-12)


def test_errors_of_half_to_second_order_are_covered_too():
    exact, slope = np.full((1, 4), 0.3), np.full((1, 4), -0.2)
    for power in (0.5, 1.0, 2.0):
        fine, coarse = (values(exact, slope, h, power) for h in (0.25, 0.5))
        found = half_width(fine, coarse, MACH, ["force"], 2.0)
        assert (np.abs(fine - exact) < found).all() and (found < 5.0 * SAFETY_SUPERSONIC * np.abs(fine - exact)).all()


def test_a_group_is_off_by_no_less_than_its_share_of_another_and_only_where_it_has_one():
    fine = np.full((2, 2), 0.3)
    args = fine, fine + np.array([[0.001], [0.02]]), np.array([2.0, 2.0]), ["force", "moment"], 2.0
    force, moment = half_width(*args, {"force": [("moment", np.array([0.25, 0.0])), ("none", np.ones(2))]})
    assert force[0] == pytest.approx(0.25 * moment[0])
    np.testing.assert_array_equal(half_width(*args)[0], force[1])
    assert force[1] < 0.1 * moment[1]


def test_of_several_ties_the_largest_holds():
    fine = np.full((3, 1), 0.3)
    args = fine, fine + np.array([[0.001], [0.02], [0.03]]), np.array([2.0]), ["force", "moment", "other"], 2.0
    ties = [("moment", np.array([0.5])), ("other", np.array([0.5]))]
    for order in (ties, ties[::-1]):
        force, _, other = half_width(*args, {"force": order})[:, 0]
        assert force == pytest.approx(0.5 * other)


def test_in_supersonic_flow_the_factor_of_safety_is_smaller():
    mach = np.array([0.5, 0.8, 1.2, 1.35, 4.9, 5.0, 20.0])
    found = half_width(np.full((1, 7), 0.3), np.full((1, 7), 0.31), mach, ["force"], 2.0)[0]
    np.testing.assert_allclose(found[[3, 4]], FACTOR * 0.01)
    np.testing.assert_allclose(found[[0, 1, 2, 5, 6]] / found[3], SAFETY / SAFETY_SUPERSONIC)


def test_the_estimate_falls_with_the_cell():
    exact, slope = np.full((1, 4), 0.3), np.full((1, 4), 0.2)
    widths = [
        half_width(values(exact, slope, h), values(exact, slope, 2 * h), MACH, ["force"], 2.0)[0, 0]
        for h in (0.5, 0.25, 0.1)
    ]
    np.testing.assert_allclose(widths, SAFETY_SUPERSONIC * 0.2 * np.array([0.5, 0.25, 0.1]) ** ORDER)


def test_a_difference_that_vanishes_by_chance_takes_its_neighbours():
    """Differences that change sign with the Mach number cross zero, where the error need not vanish."""
    mach = np.linspace(1.4, 1.6, 5)
    difference = np.array([[-0.02, -0.01, 0.0, 0.01, 0.02]])
    found = half_width(np.full((1, 5), 0.3), 0.3 + difference, mach, ["force"], 2.0)
    spread = FACTOR * np.sqrt((difference**2).mean())
    assert found[0, 2] == pytest.approx(spread, rel=0.2)
    assert found[0, 4] == pytest.approx(FACTOR * 0.02)  # what is larger than its neighbours keeps its own


def test_far_mach_numbers_lend_nothing():
    difference = np.array([[0.0, 0.1]])
    found = half_width(np.full((1, 2), 0.3), 0.3 + difference, np.array([0.5, 10.0]), ["force"], 2.0)
    assert found[0, 0] < 1e-4 * found[0, 1]


def test_a_quantity_borrows_from_those_of_its_scale_only():
    fine = np.full((3, 1), 0.3)
    coarse = fine + np.array([[0.0], [0.03], [0.0]])
    force, other, moment = half_width(fine, coarse, np.array([2.0]), ["force", "force", "moment"], 2.0)[:, 0]
    assert 0.0 < force < other and moment == 0.0


def test_zero_by_symmetry_stays_certain_and_is_no_sample():
    fine = np.array([[0.3, 0.3], [1e-7, 0.02]])
    coarse = np.array([[0.33, 0.33], [3e-7, 0.021]])
    found = half_width(fine, coarse, np.array([2.0, 2.0]), ["force", "force"], 2.0)
    assert found[1, 0] == pytest.approx(FACTOR * 2e-7)
    assert found[1, 1] > FACTOR * 1e-3


def test_what_failed_on_either_mesh_is_unknown_and_leaves_the_rest():
    fine = np.array([[0.3, np.nan, 0.3]])
    coarse = np.array([[0.31, 0.31, np.nan]])
    found = half_width(fine, coarse, np.array([2.0, 2.0, 2.0]), ["force"], 2.0)
    assert found[0, 0] == pytest.approx(FACTOR * 0.01) and np.isnan(found[0, 1:]).all()
