"""The model of a derivatives file gives its derivatives back."""

from pathlib import Path

import numpy as np
import pytest

from spaceplane.decks.about_point import model_about
from spaceplane.decks.source import read_source
from spaceplane.dynamics import derivatives_file
from spaceplane.dynamics.derivatives import COEFFICIENTS, STATIC
from spaceplane.dynamics.linearise import linearise
from spaceplane.errors import InputError

EXAMPLE = Path(__file__).parents[2] / "examples" / "horus_2b_taem.toml"
MORE = {
    "Cm_q": -1.8,
    "Cl_p": -0.3,
    "Cn_r": -0.4,
    "Cm_elevator": -0.2,
    "CL_elevator": 0.4,
    "Cl_aileron": 0.11,
    "Cn_aileron": -0.02,
    "Cn_rudder": -0.03,
    "CY_rudder": 0.05,
    "Cm_body_flap": -0.05,
}


def case(**more):
    content = {name: dict(table) for name, table in derivatives_file.read(EXAMPLE).given.items()}
    values = {name: value for name, value in content["derivatives"].items() if name in (*STATIC, "unit")}
    assert values["unit"] == "per_degree"
    angles = {
        name: x * np.pi / 180 if "_" in name and name[-2:] not in ("_q", "_p", "_r") else x for name, x in more.items()
    }
    return derivatives_file.from_tables({**content, "derivatives": values | angles})


def test_derivatives_come_back():
    given = case(**MORE)
    model = model_about(given)
    found = model.derivatives(given.point.mach, given.point.alpha)
    for name in (*STATIC, "Cm_q", "Cl_p", "Cn_r", "CL_q", "Cn_p"):
        assert getattr(found, name) == pytest.approx(getattr(given.derivatives, name), rel=1e-9, abs=1e-14), name
    for control in ("elevator", "aileron", "rudder", "body_flap"):
        for coefficient in COEFFICIENTS:
            expected = given.derivatives.control(coefficient, control)
            assert found.control(coefficient, control) == pytest.approx(expected, rel=1e-9, abs=1e-14), control
    C = model.coefficients(given.point.mach, given.point.alpha)
    assert (C["CL"], C["CD"]) == pytest.approx(given.point.coefficients()) and C["Cm"] == 0.0


def test_linear_model_is_the_same():
    given = case(**MORE)
    slopes = model_about(given).derivatives(given.point.mach, given.point.alpha)
    ours, theirs = (linearise(given.point, given.mass, given.reference, d) for d in (given.derivatives, slopes))
    assert np.allclose(theirs.A, ours.A, rtol=1e-9, atol=1e-13)


def test_source(tmp_path):
    found = read_source(str(EXAMPLE))
    given = derivatives_file.read(EXAMPLE)
    assert found.mass == given.mass and found.model.reference == given.reference
    assert np.degrees(found.model.alpha) == pytest.approx([14.6, 16.6, 18.6])
    assert found.model.mach == pytest.approx([2.4, 2.5, 2.6])
    with pytest.raises(InputError, match="--vehicle"):
        read_source(str(EXAMPLE), "horus-2b")


@pytest.mark.parametrize("name", ["alpha_range_deg", "mach_range", "deflection_range_deg", "beta_range_deg"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan")])
def test_bad_ranges_are_refused(name, value):
    with pytest.raises(InputError, match=name):
        model_about(case(), **{name: value})


def test_what_tables_cannot_hold_is_refused():
    with pytest.raises(InputError, match="Cm_alphadot"):
        model_about(case(Cm_alphadot=-0.5))
    with pytest.raises(InputError, match="mach_range = 3"):
        model_about(case(), mach_range=3.0)
