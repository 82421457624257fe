"""Zeros of functions that are linear between nodes."""

import numpy as np
import pytest

from spaceplane.dynamics.trim.roots import beyond, zeros

X = np.array([0.0, 1.0, 2.0, 4.0])


@pytest.mark.parametrize(
    ("y", "expected"),
    [
        ([1.0, -1.0, 1.0, 2.0], [0.5, 1.5]),
        ([0.0, 1.0, 1.0, 0.0], [0.0, 4.0]),
        ([1.0, 0.0, 1.0, -1.0], [1.0, 3.0]),
        ([1.0, 2.0, 3.0, 4.0], []),
        ([-1.0, np.nan, 1.0, -1.0], [3.0]),
        ([-1.0, 0.0, np.nan, 1.0], [1.0]),
        ([np.nan, 0.0, 1.0, 1.0], [1.0]),
        ([np.nan, np.nan, np.nan, 0.0], []),
        ([0.0, 0.0, 1.0, 1.0], [0.0, 1.0]),
        ([1.0, 1e-17, 1.0, 1.0], [1.0]),
    ],
)
def test_every_zero_once(y, expected):
    assert zeros(X, np.array(y)) == pytest.approx(expected)


def test_beyond_the_ends():
    assert beyond(X, np.array([1.0, 2.0, 3.0, 4.0])) == pytest.approx(-1.0)
    assert beyond(X, np.array([9.0, 8.0, 7.0, 5.0])) == pytest.approx(9.0)
    assert beyond(X, np.array([1.0, 0.5, 0.5, 1.0])) is None
    assert beyond(X, np.array([np.nan, 2.0, 3.0, np.nan])) == pytest.approx(-1.0)
    assert beyond(X, np.full(4, np.nan)) is None
