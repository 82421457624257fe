"""MIL-F-8785C levels: the limits themselves, how several of them combine, and what is said of aperiodic motion."""

import math
from dataclasses import replace

import numpy as np
import pytest

from dynamics import horus
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import identify
from spaceplane.dynamics.statespace import from_matrix
from spaceplane.errors import InputError
from spaceplane.qualities import limits
from spaceplane.qualities.assess import BELOW, assess, load_factor_slope, to_record, worst

B747_LATERAL = np.array(
    [
        [-0.0558, -0.9968, 0.0802, 0.0415],
        [0.598, -0.115, -0.0318, 0.0],
        [-3.05, 0.388, -0.465, 0.0],
        [0.0, 0.0805, 1.0, 0.0],
    ]
)


def oscillator(zeta: float, omega: float, states: tuple[str, str]):
    """Modes of one oscillation in two states."""
    return identify(from_matrix(np.array([[0.0, 1.0], [-(omega**2), -2 * zeta * omega]]), states))


def real_root(root: float, state: str):
    return identify(from_matrix(np.array([[root]]), (state,)))


def of(verdicts, paragraph, quantity=None):
    found = [v for v in verdicts if v.paragraph == paragraph and (quantity is None or v.quantity == quantity)]
    assert len(found) == 1
    return found[0]


def test_boeing_747_lateral():
    """Damping ratio alone level 2, its product with the frequency level 3, so level 3; roll level 2; spiral stable."""
    verdicts = assess(identify(from_matrix(B747_LATERAL, ("beta", "r", "p", "phi"))))
    zeta = of(verdicts, "3.3.1.1", "damping ratio")
    product = of(verdicts, "3.3.1.1", "damping ratio times frequency")
    assert (zeta.level, product.level) == (2, 3)
    assert product.value == pytest.approx(0.033, abs=1e-3)
    assert of(verdicts, "3.3.1.1", "natural frequency").level == 1
    overall = of(verdicts, "3.3.1.1", "overall")
    assert overall.level == 3 and "damping ratio times frequency" in overall.note
    roll = of(verdicts, "3.3.1.2")
    assert roll.value == pytest.approx(1.777, abs=1e-3) and roll.level == 2
    assert roll.margin == pytest.approx(1.4 - 1.777, abs=1e-3)
    spiral = of(verdicts, "3.3.1.3")
    assert spiral.level == 1 and spiral.value is None and "stable" in spiral.note
    assert all(v.vehicle_class == "III" and v.category == "B" for v in verdicts)


@pytest.mark.parametrize(
    ("zeta", "level"), [(0.05, 1), (0.04, 1), (0.039, 2), (0.0, 2), (-0.05, 3), (-0.3, BELOW)]
)  # omega 0.1: -0.05 doubles in 139 s, -0.3 in 23 s
def test_phugoid(zeta, level):
    verdict = of(assess(oscillator(zeta + 1e-9, 0.1, ("theta", "V"))), "3.2.1.2")
    assert verdict.level == level
    assert verdict.margin == pytest.approx(zeta - 0.04, abs=1e-8)


@pytest.mark.parametrize(
    ("category", "zeta", "level"),
    [
        ("B", 0.30, 1),
        ("B", 0.29, 2),
        ("B", 0.19, 3),
        ("B", 0.14, BELOW),
        ("A", 0.34, 2),
        ("A", 0.24, 3),
        ("C", 0.36, 1),
    ],
)
def test_short_period_damping(category, zeta, level):
    verdict = of(assess(oscillator(zeta + 1e-9, 2.0, ("alpha", "q")), category=category, n_alpha=10.0), "3.2.2.1.2")
    assert verdict.level == level


@pytest.mark.parametrize(
    ("category", "omega", "n_alpha", "level"),
    [
        ("B", 1.0, 10.0, 1),  # CAP 0.1
        ("B", 0.8, 10.0, 2),  # 0.064
        ("B", 0.5, 10.0, BELOW),  # 0.025
        ("B", 7.0, 10.0, 2),  # 4.9: above the upper bound of level 1
        ("B", 11.0, 10.0, 3),  # 12.1: level 3 has no upper bound
        ("A", 2.0, 10.0, 1),  # 0.4
        ("A", 0.9, 2.0, 2),  # 0.405, but omega below 1.0
        ("C", 1.0, 5.0, 1),  # 0.2
        ("C", 0.65, 1.5, 2),  # 0.28, but omega below 0.7 and n/alpha below 2
        ("C", 0.65, 0.9, 3),  # n/alpha below 1
    ],
)
def test_control_anticipation_parameter(category, omega, n_alpha, level):
    verdict = of(assess(oscillator(0.5, omega, ("alpha", "q")), category=category, n_alpha=n_alpha), "3.2.2.1.1")
    assert verdict.value == pytest.approx(omega**2 / n_alpha)
    assert verdict.level == level


def test_overdamped_short_period_counts():
    modes = identify(from_matrix(np.array([[-1.0, 1.0], [-0.5, -3.0]]), ("alpha", "q")))
    assert all(m.name == "aperiodic pitch subsidence" for m in modes)
    verdict = of(assess(modes, n_alpha=5.0), "3.2.2.1.2")
    omega = math.sqrt(3.5)
    assert verdict.value == pytest.approx(4.0 / (2 * omega)) and verdict.value > 1
    assert verdict.level == 1 and "overdamped" in verdict.note


@pytest.mark.parametrize(
    ("zeta", "omega", "category", "level"),
    [
        (0.20, 1.0, "B", 1),
        (0.07, 4.0, "B", 2),  # zeta sets it
        (0.20, 0.6, "B", 2),  # zeta omega 0.12 sets it
        (0.20, 0.3, "B", BELOW),  # omega below 0.4 at every level
        (0.01, 2.0, "B", 3),
        (-0.01, 2.0, "B", BELOW),
        (0.10, 2.0, "A", 2),
        (0.11, 1.0, "C", 1),
    ],
)
def test_dutch_roll(zeta, omega, category, level):
    assert of(assess(oscillator(zeta, omega, ("beta", "r")), category=category), "3.3.1.1", "overall").level == level


def test_dutch_roll_with_strong_rolling_asks_for_more():
    """omega^2 |phi/beta| = 9 x 10 = 90: level 1 needs zeta omega 0.15 + 0.014 x 70 = 1.13."""
    mode = oscillator(0.2, 3.0, ("beta", "r"))[0]
    rolling = replace(mode, states=("beta", "phi"), eigenvector=np.array([0.1, 1.0]), kind="dutch_roll")
    product = of(assess([rolling]), "3.3.1.1", "damping ratio times frequency")
    assert product.limits["1"] == ">= 1.13" and product.limits["2"] == ">= 0.68"
    assert product.level == 3  # 0.6 against 0.005 x 70
    assert product.margin == pytest.approx(0.6 - 1.13)
    assert "raised" in product.note


@pytest.mark.parametrize(
    ("tau", "category", "level"), [(1.4, "B", 1), (2.9, "B", 2), (9.0, "B", 3), (11.0, "B", BELOW)]
)
def test_roll(tau, category, level):
    assert of(assess(real_root(-1.0 / tau * (1 + 1e-12), "p"), category=category), "3.3.1.2").level == level


@pytest.mark.parametrize(
    ("double", "category", "level"), [(21.0, "B", 1), (13.0, "B", 2), (13.0, "A", 1), (5.0, "B", 3)]
)
def test_spiral(double, category, level):
    assert of(assess(real_root(math.log(2) / double, "phi"), category=category), "3.3.1.3").level == level


@pytest.mark.parametrize(("product", "level"), [(0.6, 1), (0.4, 2), (0.2, 3), (0.1, BELOW)])
def test_coupled_roll_spiral(product, level):
    verdicts = assess(oscillator(product / 0.8, 0.8, ("phi", "p")))
    assert of(verdicts, "3.3.1.4").level == level


def test_a_divergence_in_yaw_and_roll_meets_no_level():
    """Negative directional stability: no Dutch roll is left to judge, and the bank angle doubles in a second."""
    unstable = B747_LATERAL.copy()
    unstable[1, 0], unstable[2, 0] = -0.8, 0.5
    modes = identify(from_matrix(unstable, ("beta", "r", "p", "phi")))
    fastest = max(modes, key=lambda mode: mode.eigenvalue.real)
    assert fastest.double_time < 1.0 and not fastest.oscillatory and fastest.kind != "spiral"
    judged = [v for v in assess(modes) if v.paragraph == "3.3.1.3" and v.mode == fastest.name]
    assert [v.level for v in judged] == [BELOW] and judged[0].value == pytest.approx(fastest.double_time)
    slow = identify(from_matrix(np.diag([math.log(2) / 21.0, -1.0]), ("r", "p")))
    assert of(assess(slow), "3.3.1.3").level == 1


@pytest.mark.parametrize(("double", "level"), [(1.0, BELOW), (60.0, 3)])
def test_a_growing_oscillation_of_pitch_with_roll_is_held_to_the_phugoid(double, level):
    growth, omega = math.log(2) / double, 0.5
    matrix = np.array([[growth, omega], [-omega, growth]])
    modes = identify(from_matrix(matrix, ("theta", "phi")))
    assert modes[0].kind == "coupled_oscillation"
    assert of(assess(modes), "3.2.1.2").level == level
    calm = identify(from_matrix(matrix - 2 * growth * np.eye(2), ("theta", "phi")))
    assert not of(assess(calm), "3.2.1.2").applicable


def test_aperiodic_is_not_applicable_and_says_what_is():
    modes = identify(linearise(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives()))
    verdicts = assess(modes, n_alpha=5.0)
    damping = of(verdicts, "3.2.2.1.2")
    assert not damping.applicable and damping.level is None and damping.value is None and damping.margin is None
    assert damping.note.startswith("not applicable: aperiodic") and "doubles in 0.686 s" in damping.note
    divergence = of(verdicts, "3.2.1.1")
    assert divergence.value == pytest.approx(math.log(2) / 1.0100, rel=1e-3) and divergence.level == BELOW
    assert {v.paragraph for v in verdicts} >= {"3.2.1.2", "3.2.2.1.1", "3.2.2.1.2", "3.3.1.1", "3.3.1.2", "3.3.1.3"}
    slow = assess(real_root(math.log(2) / 7.0, "alpha"))
    assert of(slow, "3.2.1.1").level == 3


def test_every_class_and_category_has_limits():
    modes = [
        *identify(from_matrix(B747_LATERAL, ("beta", "r", "p", "phi"))),
        *oscillator(0.5, 2.0, ("alpha", "q")),
    ]
    for vehicle_class in limits.CLASSES:
        for category in limits.CATEGORIES:
            verdicts = assess(modes, vehicle_class, category, n_alpha=5.0)
            assert of(verdicts, "3.3.1.2").level in (2, 3)
            for verdict in verdicts:
                assert to_record(verdict)["paragraph"].startswith("3.")


def test_class_changes_the_roll_limit():
    modes = real_root(-1 / 1.2, "p")
    assert of(assess(modes, "III", "A"), "3.3.1.2").level == 1
    assert of(assess(modes, "I", "A"), "3.3.1.2").level == 2
    assert of(assess(modes, "II-C", "A"), "3.3.1.2").level == 1  # table VII parts II-C from II-L in category C only
    assert of(assess(modes, "II-C", "C"), "3.3.1.2").level == 2


def test_bad_class_and_category():
    with pytest.raises(InputError, match="vehicle_class"):
        assess([], "V")
    with pytest.raises(InputError, match="category"):
        assess([], "III", "D")


def test_worst():
    assert worst([1, 3, 2]) == 3
    assert worst([1, BELOW, 2]) == BELOW
    assert worst([None, 2]) == 2
    assert worst([None]) is None


def test_load_factor_slope():
    """One g of lift at 0.1 rad is 10 g/rad."""
    assert load_factor_slope(4.0, 5_000.0, 50.0, 100_000.0) == pytest.approx(10.0)
