"""Models that are linear about one flight point."""

import math
from dataclasses import replace

import pytest
from tests.aero.model import linear
from tests.dynamics import horus

from spaceplane.aero.model.from_derivatives import linear_model
from spaceplane.aero.model.model import OutsideTables
from spaceplane.dynamics import derivatives_file
from spaceplane.errors import InputError

POINT = {"mach": 2.5, "alpha": math.radians(16.6)}


def made(derivatives, **more):
    return linear_model("point", derivatives, linear.REFERENCE, **POINT, CL=0.36, CD=0.2, **more)


def test_derivatives_come_back():
    given = horus.derivatives(**horus.EXTRA)
    model = made(given)
    found = model.derivatives(**POINT)
    for name in (*linear.SLOPE, "CL_alpha", "CD_alpha", "Cm_alpha", "CL_M", "CD_M", "Cm_M"):
        assert getattr(found, name) == pytest.approx(getattr(given, name), rel=1e-9, abs=1e-15), name
    for name, value in given.controls.items():
        assert found.controls[name] == pytest.approx(value, rel=1e-12), name
    assert model.coefficients(**POINT) == pytest.approx({"CL": 0.36, "CD": 0.2, "CY": 0, "Cl": 0, "Cm": 0, "Cn": 0})
    assert (found.CL_alphadot, found.Cm_alphadot) == model.lag == (given.CL_alphadot, given.Cm_alphadot) == (0.6, -0.7)


def test_combined_controls_are_shared_out():
    given = horus.derivatives(Cm_elevator=-0.18, Cl_aileron=0.1, Cn_rudder=-0.06)
    found = made(given).derivatives(**POINT)
    for coefficient, control, value in (("Cm", "elevator", -0.18), ("Cl", "aileron", 0.1), ("Cn", "rudder", -0.06)):
        assert found.control(coefficient, control) == pytest.approx(value)
    assert found.control("Cl", "elevator") == pytest.approx(0.0) == found.control("Cm", "aileron")


def test_it_holds_near_its_point_only():
    model = made(horus.derivatives())
    assert "Cl_p" in model.unknown() and "Cn_beta" not in model.unknown()
    with pytest.raises(OutsideTables, match=r"alpha = 22 deg: outside the tables, which run from 11\.6 to 21\.6 deg"):
        model.coefficients(2.5, math.radians(22.0))
    with pytest.raises(InputError, match="Cm_alphadot = nan: must be a finite number"):
        replace(model, lag=(0.0, math.nan))
    with pytest.raises(InputError, match="mach_range = 0"):
        made(horus.derivatives(), mach_range=0.0)


def test_a_derivatives_file_gives_a_model():
    vehicle = {"mass_kg": 26e3, "Ixx_kgm2": 119e3, "Iyy_kgm2": 769e3, "Izz_kgm2": 806e3}
    vehicle |= {"area_m2": 110.0, "c_ref_m": 23.0, "b_ref_m": 13.0}
    flight = {"mach": 2.5, "altitude_m": 26.7e3, "alpha_deg": 16.6, "gamma_deg": -8.4, "bank_deg": 55.0}
    content = {
        "flight": flight | {"CL": 0.36, "CD": 0.2},
        "vehicle": vehicle,
        "derivatives": {"unit": "per_degree", **horus.PER_DEGREE},
    }
    model = derivatives_file.aero_model(derivatives_file.from_tables(content))
    assert model.reference.chord == 23.0 and not model.center_known
    with pytest.raises(InputError, match="does not say where its own is"):
        model.moved((0.1, 0.0, 0.0))
    lifted = model.coefficients(2.5, math.radians(17.6))["CL"]
    assert lifted == pytest.approx(0.36 + horus.PER_DEGREE["CL_alpha"])
