"""Every limiter by its defining inequalities."""

import numpy as np
import pytest

from spaceplane.flow import limiters

FUNCTIONS = {"venkatakrishnan": limiters.venkatakrishnan, "barth_jespersen": limiters.barth_jespersen}
SAMPLES = [(np.float64(room), np.float64(step)) for room in (0.0, 0.1, 0.5, 1.0, 3.0) for step in (0.01, 0.2, 1.0, 4.0)]


def plain(function):
    """The Python function behind the compiled one."""
    return getattr(function, "py_func", function)


def test_every_limiter_but_none_is_here():
    assert set(FUNCTIONS) | {"none"} == set(limiters.LIMITERS)
    assert len(set(limiters.LIMITERS.values())) == len(limiters.LIMITERS)


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize(("room", "step"), SAMPLES)
def test_a_factor_between_nothing_and_the_whole_gradient(name, room, step):
    assert 0.0 <= plain(FUNCTIONS[name])(room, step, np.float64(0.0)) <= 1.0


@pytest.mark.parametrize(("room", "step"), SAMPLES)
def test_barth_jespersen_never_passes_the_neighbours(room, step):
    """The reconstructed value stays within the extreme of the neighbours: factor * step <= room."""
    assert limiters.LIMITERS["barth_jespersen"] == limiters.BARTH_JESPERSEN
    assert plain(limiters.barth_jespersen)(room, step, np.float64(0.0)) * step <= room + 1e-12


def test_room_of_round_off_is_no_room():
    """Room is a sum of halves: beside a large fall, a rise of nothing comes out as a fall of round-off."""
    assert plain(limiters.barth_jespersen)(np.float32(-6e-8), np.float32(1e-12), np.float32(0.0)) == 0.0


@pytest.mark.parametrize("name", FUNCTIONS)
def test_no_limiting_with_room_to_spare(name):
    assert plain(FUNCTIONS[name])(np.float64(1.0), np.float64(0.2), np.float64(0.0)) == pytest.approx(1.0, abs=1e-12)


def test_venkatakrishnan_leaves_noise_alone():
    factor = plain(limiters.venkatakrishnan)(np.float64(0.0), np.float64(1e-6), np.float64(1e-4))
    assert factor == pytest.approx(1.0, abs=1e-6)
