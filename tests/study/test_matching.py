"""Modes are paired by what moves, not by place in a list or by name."""

import fake
import numpy as np
import pytest

from spaceplane.study.matching import match_modes

SHORT_PERIOD = fake.mode("short period", -0.5 + 1.2j, {"alpha": 1.0, "q": 0.8, "V": 3.0})
DUTCH_ROLL = fake.mode("Dutch roll", -0.05 + 1.25j, {"beta": 0.5, "p": 1.0, "r": 0.3, "sigma": 0.6})
ROLL = fake.mode("roll mode", -0.8 + 0j, {"p": 1.0, "sigma": 0.9})
SPIRAL = fake.mode("spiral", 1e-4 + 0j, {"sigma": 1.0, "r": 0.01})
PHUGOID = fake.mode("phugoid", -0.004 + 0.05j, {"V": 30.0, "gamma": 0.12})
MODES = [SHORT_PERIOD, DUTCH_ROLL, ROLL, SPIRAL, PHUGOID]


def pairs(first, second):
    return {(pair.first, pair.second) for pair in match_modes(first, second, 240.0, 240.0)}


def test_modes_are_found_again_in_any_order():
    for order in ([4, 2, 0, 1, 3], [1, 0, 3, 2, 4]):
        second = [MODES[i] | {"name": "?"} for i in order]
        found = match_modes(MODES, second, 240.0, 240.0)
        assert [order[pair.second] for pair in found] == [0, 1, 2, 3, 4]
        assert all(pair.similarity == pytest.approx(1.0) for pair in found)


def test_motion_decides_where_eigenvalues_cross():
    slow = SHORT_PERIOD | {"eigenvalue": [-0.05, 1.25]}
    fast = DUTCH_ROLL | {"eigenvalue": [-0.5, 1.2]}
    assert pairs([SHORT_PERIOD, DUTCH_ROLL], [fast, slow]) == {(0, 1), (1, 0)}


def test_a_mode_without_counterpart_stays_alone():
    assert pairs(MODES, [MODES[0], MODES[1], MODES[2]]) == {(0, 0), (1, 1), (2, 2), (3, None), (4, None)}
    assert pairs([], [ROLL]) == {(None, 0)}
    assert pairs([SPIRAL], [SHORT_PERIOD]) == {(0, None), (None, 0)}


def test_a_turned_eigenvector_or_conjugate_is_the_same_motion():
    turned = {
        state: {"magnitude": 3 * entry["magnitude"], "phase_deg": entry["phase_deg"] + 77.0}
        for state, entry in DUTCH_ROLL["eigenvector"].items()
    }
    (pair,) = match_modes([DUTCH_ROLL], [DUTCH_ROLL | {"eigenvector": turned}], 240.0, 240.0)
    assert pair.similarity == pytest.approx(1.0)
    mirrored = {
        state: {"magnitude": entry["magnitude"], "phase_deg": -entry["phase_deg"]} for state, entry in turned.items()
    }
    conjugate = {"eigenvalue": [DUTCH_ROLL["eigenvalue"][0], -DUTCH_ROLL["eigenvalue"][1]], "eigenvector": mirrored}
    (pair,) = match_modes([DUTCH_ROLL], [DUTCH_ROLL | conjugate], 240.0, 240.0)
    assert pair.similarity == pytest.approx(1.0)


def test_modes_of_a_real_model_are_followed_when_it_changes_a_little():
    from spaceplane.dynamics.modes import identify, to_record
    from spaceplane.dynamics.statespace import StateSpace

    rng = np.random.default_rng(3)
    A = np.diag([-2.0, -1.0, -0.5, -0.1, 0.05, 0.3]) + 0.05 * rng.standard_normal((6, 6))
    states = ("V", "gamma", "q", "alpha", "p", "beta")

    def modes(matrix):
        return [to_record(mode) for mode in identify(StateSpace(matrix, np.zeros((6, 0)), states, (), "test"))]

    found = match_modes(modes(A), modes(A + 1e-4 * rng.standard_normal((6, 6))), 240.0, 240.0)
    assert all(pair.first == pair.second for pair in found)
    assert min(pair.similarity for pair in found) > 0.99
