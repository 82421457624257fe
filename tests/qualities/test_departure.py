"""Departure criteria against what they are derived from: stiffness of sideslip free, and with the wings held."""

import math
from dataclasses import replace

import numpy as np
import pytest

from dynamics import horus
from spaceplane.dynamics.linearise import linearise
from spaceplane.errors import InputError
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.assess_airframe import assess_airframe
from spaceplane.qualities.departure import (
    coordinating_rudder,
    dynamic_directional,
    lateral_control_departure,
    region,
)

CONTROLS = {"Cl_aileron": 0.05, "Cn_aileron": -0.02, "Cl_rudder": 0.01, "Cn_rudder": -0.05}


def lateral(point, derivatives, mass):
    """(A, system) of p, r, beta without gravity and gyroscopic moments."""
    system = linearise(point, mass, horus.REFERENCE, derivatives, gyroscopic=False)
    rows = [system.index(name) for name in ("p", "r", "beta")]
    return system.A[np.ix_(rows, rows)], system


@pytest.mark.parametrize("alpha", [0.0, 16.6, 40.0])
@pytest.mark.parametrize("Cn_beta", [-0.0275, 0.05])
@pytest.mark.parametrize("mass", [horus.MASS, horus.TILTED], ids=["symmetric", "Ixz"])
def test_dynamic_directional_stability_is_the_stiffness_of_sideslip(alpha, Cn_beta, mass):
    d = horus.derivatives(Cn_beta=Cn_beta, CY_beta=0.0)
    point = horus.point(alpha_deg=alpha, bank_deg=0.0, gamma_deg=0.0)
    A, _ = lateral(point, d, mass)
    square = -max(np.linalg.eigvals(A) ** 2, key=abs)
    stiffness = dynamic_directional(d, mass, point.alpha)
    wanted = stiffness * point.dynamic_pressure * 110.0 * 13.0 / mass.Izz
    assert square.real == pytest.approx(wanted, rel=1e-9)
    if mass.Ixz == 0.0:
        plain = Cn_beta * math.cos(point.alpha) - mass.Izz / mass.Ixx * d.Cl_beta * math.sin(point.alpha)
        assert stiffness == pytest.approx(plain, rel=1e-15)


@pytest.mark.parametrize("mass", [horus.MASS, horus.TILTED], ids=["symmetric", "Ixz"])
def test_lcdp_is_the_yaw_stiffness_with_the_wings_held(mass):
    """The aileron that cancels the rolling moment of sideslip leaves N_beta = LCDP q S b / Izz."""
    d = horus.derivatives(**CONTROLS)
    A, system = lateral(horus.point(), d, mass)
    b = system.B[[system.index("p"), system.index("r")], system.inputs.index("aileron")]
    aileron = -A[0, 2] / b[0]
    held = A[1, 2] + b[1] * aileron
    force = horus.point().dynamic_pressure * 110.0 * 13.0 / horus.MASS.Izz
    assert lateral_control_departure(d, mass) * force == pytest.approx(held, rel=1e-12)


def test_rudder_with_the_aileron():
    d = horus.derivatives(**CONTROLS)
    mix = coordinating_rudder(d)
    for mass in (horus.MASS, horus.TILTED):
        assert lateral_control_departure(d, mass, mix) == pytest.approx(0.0, abs=1e-15)
        less, more = (lateral_control_departure(d, mass, mix + step) for step in (-0.5, 0.5))
        assert less * more < 0
    plain = horus.derivatives()
    assert lateral_control_departure(plain, horus.MASS) is None and coordinating_rudder(plain) is None


@pytest.mark.parametrize(
    ("lcdp", "directional", "name"),
    [
        (0.001, 0.005, "A"),
        (-0.001, 0.005, "B"),
        (-0.001, 0.002, "C"),
        (-0.001, -0.001, "D"),
        (0.001, 0.002, "F"),
        (0.001, -0.001, "U"),
    ],
)
def test_regions(lcdp, directional, name):
    assert region(math.degrees(lcdp), math.degrees(directional)).name == name


def test_horus_at_the_taem_interface():
    """C_n_beta -0.00048 and C_l_beta -0.00139 per deg at 16.6 deg: -0.00046 + 6.773 x 0.00139 x 0.2857 = 0.00223."""
    plain = Airframe(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives())
    found = {(v.criterion, v.quantity): v for v in assess_airframe(plain) if v.criterion.startswith("departure")}
    first, guideline, lcdp, where = found.values()
    assert first.met and first.value == pytest.approx(0.00223, abs=1e-5)
    assert not guideline.met and guideline.margin == pytest.approx(0.00223 - 0.004, abs=1e-5)
    assert not lcdp.applicable and not where.applicable
    aileron = replace(plain, derivatives=horus.derivatives(Cl_aileron=0.05, Cn_aileron=-0.02))
    lcdp, where = assess_airframe(aileron)[-2:]
    assert lcdp.value == pytest.approx(-0.00048 - 0.00139 * 0.4, rel=1e-9) and not lcdp.met
    assert "region C" in where.note and not where.met


def test_region_of_no_number():
    with pytest.raises(InputError, match="finite"):
        region(math.nan, 0.0)
