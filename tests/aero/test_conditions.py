import math
from dataclasses import dataclass

import numpy as np
import pytest

from spaceplane.aero.conditions import DerivativeSteps, plan, product
from spaceplane.errors import InputError


@dataclass(frozen=True)
class Point:
    mach: float
    alpha: float = 0.2
    beta: float = 0.0


def test_a_symmetric_point_needs_six_conditions_and_they_are_where_the_labels_say():
    steps = DerivativeSteps(alpha=0.01, beta=0.02, mach_fraction=0.1)
    made = plan([Point(0.8), Point(2.5)], steps)
    assert made.labels == ("base", "alpha+", "alpha-", "mach+", "mach-", "beta") * 2
    np.testing.assert_array_equal(made.point, [0] * 6 + [1] * 6)
    np.testing.assert_allclose(made.conditions.mach[6:], [2.5, 2.5, 2.5, 2.75, 2.25, 2.5])
    np.testing.assert_allclose(made.conditions.alpha[:6], [0.2, 0.21, 0.19, 0.2, 0.2, 0.2])
    np.testing.assert_allclose(made.conditions.beta[:6], [0, 0, 0, 0, 0, 0.02])
    (beta,) = made.points[1].of("beta")
    assert (beta.plus, beta.minus, beta.step) == (11, None, 0.02)


@pytest.mark.parametrize(("symmetric", "beta"), [(False, 0.0), (True, 0.05)])
def test_without_mirror_symmetry_both_signs_of_sideslip_are_solved(symmetric, beta):
    made = plan([Point(2.0, beta=beta)], DerivativeSteps(), symmetric)
    assert made.labels[-2:] == ("beta+", "beta-")
    (variation,) = made.points[0].of("beta")
    assert made.conditions.beta[variation.minus] == pytest.approx(beta - math.radians(2.0))


def test_two_step_sizes_add_half_steps():
    made = plan([Point(2.0)], DerivativeSteps(two_step_sizes=True))
    assert len(made.conditions) == 11
    full, half = made.points[0].of("alpha")
    assert half.step == full.step / 2
    assert made.labels[half.plus] == "alpha+/2"


def test_product_takes_every_combination():
    made = product([2.0, 3.0], [0.0, 0.1, 0.2], [0.0])
    assert len(made) == 6
    np.testing.assert_allclose(made.mach, [2, 2, 2, 3, 3, 3])
    np.testing.assert_allclose(made.alpha, [0, 0.1, 0.2] * 2)


@pytest.mark.parametrize("mach", [0.0, -1.0, math.nan, math.inf])
def test_bad_mach_numbers_are_refused_by_name(mach):
    with pytest.raises(InputError, match="mach"):
        product([mach], [0.0], [0.0])
    with pytest.raises(InputError, match="mach"):
        plan([Point(mach)], DerivativeSteps())


def test_bad_steps_and_angles_are_refused_by_name():
    with pytest.raises(InputError, match="step beta"):
        DerivativeSteps(beta=0.0)
    with pytest.raises(InputError, match="alpha"):
        product([1.0], [math.nan], [0.0])
    with pytest.raises(InputError, match="at least one"):
        product([], [0.0], [0.0])
