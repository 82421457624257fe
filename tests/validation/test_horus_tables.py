"""The reader of the published HORUS-2B tables, checked against derivatives printed elsewhere."""

import numpy as np
import pytest

from spaceplane.validation import horus_tables


def slope(table, deflection_deg=0.0):
    """Mean of Mach 2 and 3, difference quotient between alpha 15 and 20 deg."""
    mean = lambda alpha: 0.5 * sum(table.at(mach, alpha, deflection_deg) for mach in (2.0, 3.0))  # noqa: E731
    return (mean(20.0) - mean(15.0)) / 5.0


# Per degree at Mach 2.5, alpha 16.6 deg as printed in the thesis's Table 6.1.
BASE = {"CD": 0.019, "CL": 0.033, "Cm": 0.0004}
BODY_FLAP = {"CD": -0.0007, "CL": -0.0003, "Cm": 0.00011}
ELEVON_PAIR = {"CD": -0.0004, "CL": -0.0004, "Cm": 0.0002}


@pytest.mark.parametrize("coefficient", horus_tables.COEFFICIENTS)
def test_reader_reproduces_the_printed_derivatives(coefficient):
    assert slope(horus_tables.base(coefficient)) == pytest.approx(BASE[coefficient], abs=1e-6)
    flap = horus_tables.increment(coefficient, "bodyflap")
    assert slope(flap, -20.0) == pytest.approx(BODY_FLAP[coefficient], abs=1e-6)
    elevon = horus_tables.increment(coefficient, "one_elevon")
    assert 2.0 * slope(elevon, -10.0) == pytest.approx(ELEVON_PAIR[coefficient], abs=1e-6)


@pytest.mark.parametrize("surface", horus_tables.SURFACES)
@pytest.mark.parametrize("coefficient", horus_tables.COEFFICIENTS)
def test_increment_vanishes_without_deflection(coefficient, surface):
    table = horus_tables.increment(coefficient, surface)
    assert np.all(table.values[table.deflection_deg == 0.0] == 0.0)
    assert np.all(np.diff(table.deflection_deg) > 0.0) and np.all(np.diff(table.alpha_deg) > 0.0)


def test_rows_are_where_they_were_printed():
    assert horus_tables.base("CL").at(1.5, 20.0) == 0.79
    assert horus_tables.base("CD").at(3.0, 0.0) == 0.07
    assert horus_tables.increment("Cm", "bodyflap").at(2.0, 10.0, -20.0) == 0.0065


def test_no_extrapolation():
    with pytest.raises(ValueError, match="out of bounds"):
        horus_tables.base("CL").at(0.8, 10.0)
