"""Names, numbers and records of eigenmodes."""

import json
import math

import numpy as np
import pytest

from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.mode_names import KINDS, name_mode
from spaceplane.dynamics.modes import identify, to_record
from spaceplane.dynamics.statespace import StateSpace, from_matrix
from spaceplane.errors import InputError

from . import horus

# Boeing 747, Mach 0.8, 40 000 ft; states beta, r, p, phi (Heffley and Jewell 1972, as in the MATLAB control examples).
B747_LATERAL = np.array(
    [
        [-0.0558, -0.9968, 0.0802, 0.0415],
        [0.598, -0.115, -0.0318, 0.0],
        [-3.05, 0.388, -0.465, 0.0],
        [0.0, 0.0805, 1.0, 0.0],
    ]
)


def etkin_longitudinal() -> np.ndarray:
    """Boeing 747-100, states u, w, q, theta (Etkin and Reid, Dynamics of Flight, 3rd ed., equation 6.2,1)."""
    weight, area, chord, inertia, density, speed = 2.83176e6, 511.0, 8.324, 0.449e8, 0.3045, 235.9
    g = 9.80665
    mass, qS = weight / g, density * speed * area / 2
    Cw = weight / (density * speed**2 * area / 2)
    Xu, Xw = qS * -0.1080, qS * 0.2193
    Zu, Zw = -2 * qS * Cw + qS * -0.106, qS * -4.92
    Zq, Zwdot = qS * chord / 2 * -5.92, density * area * chord / 4 * 5.9
    Mu, Mw = qS * chord * 0.1043, qS * chord * -1.023
    Mq, Mwdot = qS * chord**2 / 2 * -23.92, density * area * chord**2 / 4 * -6.314
    lag = mass - Zwdot
    return np.array(
        [
            [Xu / mass, Xw / mass, 0.0, -g],
            [Zu / lag, Zw / lag, (Zq + mass * speed) / lag, 0.0],
            [
                (Mu + Mwdot * Zu / lag) / inertia,
                (Mw + Mwdot * Zw / lag) / inertia,
                (Mq + Mwdot * (Zq + mass * speed) / lag) / inertia,
                0.0,
            ],
            [0.0, 0.0, 1.0, 0.0],
        ]
    )


def test_boeing_747_lateral():
    dutch_roll, roll, spiral = identify(from_matrix(B747_LATERAL, ("beta", "r", "p", "phi")))
    assert [m.name for m in (dutch_roll, roll, spiral)] == ["Dutch roll", "roll mode", "spiral"]
    assert dutch_roll.eigenvalue == pytest.approx(-0.03294 + 0.94665j, abs=1e-5)
    assert roll.eigenvalue == pytest.approx(-0.56265, abs=1e-5)
    assert spiral.eigenvalue == pytest.approx(-0.00728, abs=1e-5)
    assert dutch_roll.period == pytest.approx(2 * math.pi / 0.94665, rel=1e-4)
    assert dutch_roll.damping_ratio == pytest.approx(0.0348, abs=1e-4)
    assert spiral.half_time == pytest.approx(math.log(2) / 0.00728, rel=1e-3)
    assert spiral.double_time is None and spiral.damping_ratio is None and spiral.period is None


def test_boeing_747_longitudinal():
    short_period, phugoid = identify(from_matrix(etkin_longitudinal(), ("u", "w", "q", "theta")))
    assert (short_period.name, phugoid.name) == ("short period", "phugoid")
    assert short_period.eigenvalue == pytest.approx(-0.3719 + 0.8875j, abs=1e-3)
    assert phugoid.eigenvalue == pytest.approx(-0.003289 + 0.06723j, abs=1e-4)


def test_order_of_states_and_units_do_not_change_names():
    """Participation does not depend on the units of the states, nor on their order."""
    scale = np.diag([57.3, 1e-3, 40.0, 0.2])
    order = [2, 0, 3, 1]
    scaled = (scale @ B747_LATERAL @ np.linalg.inv(scale))[np.ix_(order, order)]
    before = identify(from_matrix(B747_LATERAL, ("beta", "r", "p", "phi")))
    after = identify(from_matrix(scaled, ("p", "beta", "phi", "r")))
    for a, b in zip(before, after, strict=True):
        assert a.name == b.name
        assert a.eigenvalue == pytest.approx(b.eigenvalue, rel=1e-9)
        assert a.share("phi") == pytest.approx(b.share("phi"), abs=1e-9)


@pytest.mark.parametrize("form", ["rigid-body", "thesis"])
def test_horus_has_no_textbook_longitudinal_modes(form):
    """C_m_alpha > 0 splits the short period: one half diverges and is no phugoid."""
    modes = identify(linearise(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(), form))
    names = [m.name for m in modes]
    assert {"aperiodic pitch subsidence", "aperiodic pitch divergence"} <= set(names)
    assert names[0] == "lateral oscillation (roll and sideslip)"
    for mode in modes:
        if not mode.oscillatory and mode.double_time is not None:
            assert "divergence" in mode.name or mode.kind in ("height", "spiral")
        assert mode.kind not in ("short_period", "phugoid", "dutch_roll")
        assert np.linalg.norm(mode.eigenvector) == pytest.approx(1.0)
        assert mode.participation.sum() == pytest.approx(1.0)


def test_stable_horus_gets_its_textbook_names():
    """With stiffness and damping in all axes the same vehicle flies textbook modes."""
    derivatives = horus.derivatives(
        Cm_alpha=-0.2, Cm_M=0.0, Cm_q=-3.0, Cn_beta=0.12, Cl_beta=-0.05, Cl_p=-0.35, Cn_r=-0.4, Cn_p=0.0
    )
    point = horus.point(alpha_deg=4.0, bank_deg=0.0, gamma_deg=-3.0, CL=0.15)
    kinds = {m.kind for m in identify(linearise(point, horus.MASS, horus.REFERENCE, derivatives))}
    assert {"short_period", "phugoid", "dutch_roll", "roll", "spiral"} <= kinds


def test_names_of_divergences():
    assert name_mode(0.9 + 0j, {"alpha": 0.5, "q": 0.5}).name == "aperiodic pitch divergence"
    assert name_mode(-0.9 + 0j, {"alpha": 0.5, "q": 0.5}).name == "aperiodic pitch subsidence"
    assert name_mode(0.5 + 0j, {"p": 0.9, "sigma": 0.1}).name == "aperiodic roll divergence"
    assert name_mode(-0.5 + 0j, {"p": 0.9, "sigma": 0.1}).name == "roll mode"
    assert name_mode(0.5 + 0j, {"beta": 0.5, "r": 0.5}).name == "aperiodic yaw divergence"
    assert name_mode(0.01 + 0j, {"sigma": 0.8, "r": 0.2}).name == "spiral"
    assert name_mode(0.5 + 0j, {"sigma": 0.8, "r": 0.2}).name == "aperiodic roll/yaw divergence"
    assert name_mode(0.03 + 0j, {"V": 0.4, "sigma": 0.3, "r": 0.3}).name == "aperiodic pitch/roll divergence"
    assert name_mode(0.1 + 0.2j, {"V": 0.4, "alpha": 0.3, "q": 0.3}).name == "third oscillation (pitch and speed)"
    assert name_mode(0.1 + 0.2j, {"sigma": 0.5, "p": 0.5}).kind == "roll_spiral_oscillation"
    assert name_mode(0.1 + 0.9j, {"p": 0.49, "r": 0.4, "beta": 0.11}).kind == "lateral_oscillation"
    assert name_mode(-0.1 + 0.9j, {"beta": 0.46, "r": 0.33, "p": 0.21}).kind == "dutch_roll"
    assert name_mode(0j, {"R": 1.0}).name == "neutral mode"
    assert len(set(KINDS.values())) == len(KINDS)


def test_eigenvector_is_one():
    system = linearise(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives())
    for mode in identify(system):
        residual = system.A @ mode.eigenvector - mode.eigenvalue * mode.eigenvector
        assert np.abs(residual).max() < 1e-9
        largest = mode.eigenvector[np.argmax(np.abs(mode.eigenvector))]
        assert largest.imag == pytest.approx(0.0, abs=1e-12) and largest.real > 0


def test_defective_eigenvalues_have_names_too():
    """Without aerodynamics speed, height and heading only integrate: double zeros without a common state."""
    modes = identify(from_matrix(np.array([[0.0, 1.0], [0.0, 0.0]]), ("beta", "p")))
    assert [m.name for m in modes] == ["neutral mode", "neutral mode"]
    assert all(np.isfinite(m.participation).all() and m.participation.sum() == pytest.approx(1.0) for m in modes)


def test_record_is_json():
    for mode in identify(linearise(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(), "thesis")):
        text = json.dumps(to_record(mode), allow_nan=False)
        assert json.loads(text)["name"] == mode.name


def test_state_space_checks_its_shape():
    with pytest.raises(InputError, match="state space"):
        StateSpace(np.eye(3), np.zeros((3, 0)), ("a", "b"))
    with pytest.raises(InputError, match="finite"):
        from_matrix(np.array([[np.nan]]), ("V",))
