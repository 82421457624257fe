"""Oscillations of roll against simulated responses, closed forms and mirror images; figures 4 and 5; their levels."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.signal import residue, ss2tf

from qualities.test_airframe import airframe, arguments, level_point, of
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.errors import InputError
from spaceplane.qualities.assess_airframe import assess_airframe
from spaceplane.qualities.roll_control import roll_response
from spaceplane.qualities.roll_figures import abscissa, curve_limits
from spaceplane.qualities.roll_oscillation import oscillatory_share, roll_oscillation
from spaceplane.qualities.roll_step import LATERAL, lateral_part, roll_row

RATE, BANK = "3.3.2.2.1", "3.3.2.3"
FIGURES = ("roll_rate_oscillation_small", "bank_oscillation")


def lateral(A, b, alpha=0.0):
    return StateSpace(
        np.array(A, float), np.array(b, float)[:, None], LATERAL, ("aileron",), reference={"alpha": alpha}
    )


def yawing(omega=2.0, zeta=0.1, push=1.0, dihedral=-3.0, tau=0.5):
    """beta'' + 2 zeta omega beta' + omega^2 beta = push a; p' = -p / tau + dihedral beta + a; sigma' = p."""
    A = np.zeros((4, 4))
    A[0, 0], A[0, 2], A[3, 0] = -1 / tau, dihedral, 1.0
    A[1, 1], A[1, 2], A[2, 1] = -2 * zeta * omega, -(omega**2), 1.0
    return lateral(A, [1.0, push, 0.0, 0.0])


CASES = {
    "light": {},
    "adverse": {"Cn_aileron": -0.02},
    "proverse": {"Cn_aileron": 0.05},
    "slow roll": {"Cn_aileron": 0.01},
    "damped": {"Cn_r": -4.0, "CY_beta": -4.0, "Cl_p": -1.0, "Cn_aileron": -0.05},
    "negative dihedral": {"Cl_beta": 0.03},
    "unstable": {"Cn_r": 0.9},
    "banked": {"Cn_aileron": -0.01},
}


def case(name):
    point = level_point(alpha_deg=4.0, **({"bank_deg": 40.0, "gamma_deg": -8.0} if name == "banked" else {}))
    return airframe(point, **{"Cl_p": -0.3, **CASES[name]})


def simulated(system, row, impulse):
    """First maximum, minimum and maximum of a response by an adaptive integrator and root finding on its slope."""
    A, b = lateral_part(system)
    start, forcing = (b, 0 * b) if impulse else (0 * b, b)
    end = 6.0 * roll_oscillation(system).period
    path = solve_ivp(
        lambda t, x: A @ x + forcing, (0, end), start, method="DOP853", rtol=1e-12, atol=1e-16, dense_output=True
    )

    def slope(t):
        return row @ (A @ path.sol(t) + forcing)

    times = np.linspace(1e-6 * end, end, 4001)
    slopes = np.array([slope(t) for t in times])
    turns = np.flatnonzero(np.sign(slopes[:-1]) != np.sign(slopes[1:]))
    turns = turns[np.flatnonzero(slopes[turns] > 0)[0] :][:3] if np.any(slopes[turns] > 0) else []
    return [row @ path.sol(brentq(slope, times[k], times[k + 1], xtol=1e-14)) for k in turns]


@pytest.mark.parametrize("name", CASES)
def test_ratios_against_a_simulated_response(name):
    system = linearise(*arguments(case(name)))
    found = roll_oscillation(system)
    for value, row, impulse in ((found.rate_ratio, roll_row(system), False), (found.bank_ratio, np.eye(4)[3], True)):
        y = simulated(system, row, impulse)
        if name == "damped":
            exact = (y[0] - y[1]) / (y[0] + y[1])
        else:
            exact = (y[0] + y[2] - 2 * y[1]) / (y[0] + y[2] + 2 * y[1])
        assert 0.001 < exact < 1 and value == pytest.approx(exact, rel=1e-7)
    assert (found.damping_ratio > 0.2) == (name == "damped")
    assert (found.damping_ratio < 0) == (name == "unstable")


@pytest.mark.parametrize("name", CASES)
def test_phase_against_the_residue_of_the_transfer_function(name):
    """Maxima of the Dutch roll's part, from the partial fractions of beta / aileron / s."""
    system = linearise(*arguments(case(name)))
    found, (A, b) = roll_oscillation(system), lateral_part(system)
    numerator, denominator = ss2tf(A, b[:, None], np.eye(4)[2:3], np.zeros((1, 1)))
    for phase, poles in ((found.rate_phase, np.append(denominator, 0.0)), (found.bank_phase, denominator)):
        shares, roots, _ = residue(numerator[0], poles)
        k = np.argmax(roots.imag)
        t = np.linspace(0, found.period, 200_001)
        part = 2 * np.real(shares[k] * np.exp(roots[k] * t)) * np.exp(-roots[k].real * t)  # without its decay ...
        slope = np.real(shares[k] * roots[k] * np.exp(1j * roots[k].imag * t))  # ... and the sign of its slope with it
        tops = t[:-1][(slope[:-1] > 0) & (slope[1:] <= 0)]
        assert len(tops) == 1 and np.interp(tops[0], t, part) > 0
        assert (phase + 2 * math.pi * tops[0] / found.period + math.pi) % (2 * math.pi) == pytest.approx(
            math.pi, abs=1e-3
        )


def test_phase_is_that_of_late_maxima_of_the_sideslip():
    """As the specification words it: -360 t_n / T_d + 360 (n - 1) with a late maximum of the whole response."""
    system = linearise(*arguments(case("adverse")))
    found, (A, b) = roll_oscillation(system), lateral_part(system)
    t = np.linspace(0, 8 * found.period, 80_001)
    slip = solve_ivp(lambda t, x: A @ x + b, (0, t[-1]), 0 * b, method="DOP853", rtol=1e-11, atol=1e-14, t_eval=t).y[2]
    tops = t[1:-1][(slip[1:-1] > slip[:-2]) & (slip[1:-1] >= slip[2:])]
    lag = -360 * tops[4] / found.period + 360 * 4
    assert (math.degrees(found.rate_phase) - lag + 180) % 360 - 180 == pytest.approx(0.0, abs=6.0)


@pytest.mark.parametrize("zeta", [0.02, 0.1, 0.3])
def test_phase_of_a_pure_yawing_motion(zeta):
    """A step swings beta about its new place: maxima at half periods. An impulse: first maximum at acos(zeta)."""
    adverse, proverse = roll_oscillation(yawing(zeta=zeta)), roll_oscillation(yawing(zeta=zeta, push=-1.0))
    assert adverse.rate_phase == pytest.approx(-math.pi, abs=1e-9)
    assert math.cos(proverse.rate_phase) == pytest.approx(1.0, abs=1e-9)
    assert adverse.bank_phase == pytest.approx(-math.acos(zeta), abs=1e-9)
    assert proverse.bank_phase == pytest.approx(-math.acos(zeta) - math.pi, abs=1e-9)
    assert adverse.damping_ratio == pytest.approx(zeta) and adverse.period == pytest.approx(
        math.pi / math.sqrt(1 - zeta**2)
    )


def test_positive_dihedral_makes_roll_rate_lead():
    """p = dihedral beta / (lambda + 1 / tau): slow roll mode 90 deg ahead, fast one 180; negative dihedral the rest."""
    assert math.degrees(roll_oscillation(yawing(zeta=1e-6, tau=1e6)).lead) == pytest.approx(90, abs=0.01)
    assert math.degrees(roll_oscillation(yawing(zeta=1e-6, tau=1e-4)).lead) == pytest.approx(180, abs=0.02)
    assert math.degrees(roll_oscillation(yawing(zeta=1e-6, tau=1e6, dihedral=3.0)).lead) == pytest.approx(270, abs=0.01)
    assert roll_oscillation(yawing(dihedral=0.0)).lead is None
    lead = math.degrees(roll_oscillation(linearise(*arguments(case("light")))).lead)
    assert 45 < lead < 225
    assert not 45 < math.degrees(roll_oscillation(linearise(*arguments(case("negative dihedral")))).lead) < 225


def test_bank_after_an_impulse_is_roll_rate_after_a_step():
    """Where sigma' = p both are the integral of the same response, so the two ratios are one."""
    for system in (yawing(), yawing(push=-0.4), yawing(zeta=0.3)):
        found = roll_oscillation(system)
        assert found.bank_ratio == pytest.approx(found.rate_ratio, rel=1e-9)
        assert found.rate_ratio > 0


def test_size_sense_and_time_scale_change_nothing():
    system = linearise(*arguments(case("banked")))
    A, b = lateral_part(system)
    alpha = system.reference["alpha"]
    plain = roll_oscillation(system)
    for other in (lateral(A, 0.01 * b, alpha), lateral(A, -3 * b, alpha), lateral(7 * A, 7 * b, alpha)):
        found = roll_oscillation(other)
        for name in ("rate_ratio", "bank_ratio", "rate_phase", "bank_phase", "lead", "damping_ratio"):
            assert getattr(found, name) == pytest.approx(getattr(plain, name), rel=1e-7)


@pytest.mark.parametrize("name", CASES)
def test_the_sign_of_sideslip_turns_both_angles_and_no_limit(name):
    """With beta counted the other way round the vehicle rolls alike: same ratios, both angles half a turn on."""
    system = linearise(*arguments(case(name)))
    A, b = lateral_part(system)
    mirror = np.diag([1.0, 1.0, -1.0, 1.0])
    found = roll_oscillation(system)
    other = roll_oscillation(lateral(mirror @ A @ mirror, mirror @ b, system.reference["alpha"]))
    assert other.rate_ratio == pytest.approx(found.rate_ratio) and other.bank_ratio == pytest.approx(found.bank_ratio)
    for criterion, phase in ((FIGURES[0], "rate_phase"), (FIGURES[1], "bank_phase")):
        places = []
        for one in (found, other):
            places.append(abscissa(math.degrees(getattr(one, phase)), math.degrees(one.lead), (45.0, 225.0)))
        assert places[0] == pytest.approx(places[1], abs=1e-6)
        assert curve_limits(criterion, "B", places[0]) == pytest.approx(curve_limits(criterion, "B", places[1]))


def test_adverse_yaw_lies_where_the_figure_allows_more():
    adverse, proverse = (roll_oscillation(linearise(*arguments(case(name)))) for name in ("adverse", "proverse"))
    assert -270 < math.degrees(adverse.rate_phase) < -130
    assert not -270 < math.degrees(proverse.rate_phase) < -90
    limits = [of(assess_airframe(case(name)), RATE).limits["1"] for name in ("adverse", "proverse")]
    assert float(limits[0][3:]) > 2 * float(limits[1][3:])


def test_peaks_to_ratio():
    assert oscillatory_share([1.0, 0.5, 0.8], 0.1) == pytest.approx((1.8 - 1.0) / (1.8 + 1.0))
    assert oscillatory_share([1.0, 0.5, 0.8], 0.3) == pytest.approx(0.5 / 1.5)
    assert oscillatory_share([1.0], 0.1) == 0.0 and oscillatory_share([], 0.1) == 0.0
    assert oscillatory_share([1.0, -1.5, 0.8], 0.1) is None


@pytest.mark.parametrize(
    ("criterion", "at", "category", "expected"),
    [
        (FIGURES[0], 0.0, "A", (0.05, 0.10)),
        (FIGURES[0], -110.0, "B", (0.10, 0.20)),
        (FIGURES[0], -155.0, "A", (0.15, 0.10 + 0.5 * 35 / 80)),
        (FIGURES[0], -225.0, "C", (0.25, 0.60)),
        (FIGURES[0], -280.0, "B", (0.60 - 0.5 * 10 / 90, 1.00)),
        (FIGURES[0], -315.0, "A", (0.15, 0.35)),
        (FIGURES[0], -360.0, "B", (0.10, 0.20)),
        (FIGURES[1], -10.0, "B", (0.10, 0.20)),
        (FIGURES[1], -70.0, "A", (0.15, 0.10 + 0.5 * 45 / 80)),
        (FIGURES[1], -150.0, "B", (0.60, 1.00)),
        (FIGURES[1], -230.0, "C", (0.15, 0.60 - 0.5 * 55 / 80)),
        (FIGURES[1], -300.0, "A", (0.05, 0.10)),
    ],
)
def test_figures_between_their_corners(criterion, at, category, expected):
    assert curve_limits(criterion, category, at) == pytest.approx(expected)


def test_figures_are_nested_periodic_and_one_shape():
    """Level 2 allows more than level 1; figure 5 is figure 4 a quarter turn on, as an impulse is to a step."""
    angles = np.arange(-360.0, 0.5, 1.0)
    plateau = []
    for criterion in FIGURES:
        low, middle = np.array([curve_limits(criterion, "A", at) for at in angles]).T
        also, high = np.array([curve_limits(criterion, "B", at) for at in angles]).T
        assert np.array_equal(middle, also) and np.all(low < middle) and np.all(middle < high)
        assert low[0] == low[-1] and high[0] == high[-1]
        assert curve_limits(criterion, "B", None) == [middle.min(), high.min()] == [0.10, 0.20]
        plateau.append(angles[middle == middle.max()].mean())
    assert 80 < plateau[1] - plateau[0] < 110


def test_second_abscissa_lies_half_a_turn_on():
    bounds = (45.0, 225.0)
    assert abscissa(-40.0, 100.0, bounds) == -40.0 and abscissa(-200.0, 300.0, bounds) == -20.0
    assert abscissa(-20.0, 300.0, bounds) == -200.0 and abscissa(-180.0, 10.0, bounds) == 0.0
    assert abscissa(-100.0, 45.0, bounds) == abscissa(-100.0, 225.0, bounds) == -100.0


def test_verdicts_of_a_vehicle():
    """Stronger dihedral rolls more in the oscillation; levels are those of the limits; the reading's doubt is said."""
    values = []
    for dihedral in (-0.02, -0.06, -0.2):
        verdicts = assess_airframe(airframe(level_point(alpha_deg=4.0), Cl_beta=dihedral, Cl_p=-0.3))
        rate, bank = of(verdicts, RATE), of(verdicts, BANK)
        for v in (rate, bank):
            assert v.applicable and "±10 deg" in v.note and v.limits["3"] == "not specified"
            assert v.margin == pytest.approx(float(v.limits["1"][3:]) - v.value, abs=1e-3)
            assert v.level == (1 if v.margin >= 0 else 2 if v.value <= float(v.limits["2"][3:]) else 3)
        values.append(rate.value)
    assert values == sorted(values)


def test_where_it_does_not_apply():
    for v in (assess_airframe(airframe(Cn_beta=-0.3, Cl_beta=0.0)), assess_airframe(airframe(Cl_aileron=0.0))):
        for paragraph in (RATE, BANK):
            assert not of(v, paragraph).applicable and of(v, paragraph).level is None
    assert "nothing lateral oscillates" in of(assess_airframe(airframe(Cn_beta=-0.3, Cl_beta=0.0)), RATE).note
    with pytest.raises(InputError, match="lacks the states beta"):
        roll_oscillation(StateSpace(np.zeros((3, 3)), np.ones((3, 1)), ("p", "r", "sigma"), ("aileron",)))


@pytest.mark.filterwarnings("error")
def test_a_fast_divergence_neither_overflows_nor_passes_for_a_quiet_roll():
    """60 /s for 20 s is e^1200: the response is cut short, and the criterion does not apply."""
    system = yawing()
    A, b = system.A.copy(), system.B[:, 0]
    A[0, 0] = 60.0
    assert roll_oscillation(lateral(A, b)) is None
    response = roll_response(lateral(A, b), 0.1)
    assert np.all(np.isfinite(response.bank)) and len(response.time) == len(response.bank)
    t = response.time_to_bank(math.radians(30))
    assert t == pytest.approx(math.log(math.radians(30) * 60**2 / 0.1) / 60, rel=0.1)
