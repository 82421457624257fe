"""Stagnation pressure and normal shock against printed values."""

import pytest

from spaceplane.aero.exact.stagnation import normal_shock_pressure, stagnation_cp
from spaceplane.errors import InputError


@pytest.mark.parametrize(("mach", "cp"), [(1.5, 1.5322), (2, 1.6573), (3, 1.7557), (5, 1.8088), (10, 1.8317)])
def test_printed_values(mach, cp):
    assert stagnation_cp(mach) == pytest.approx(cp, abs=6e-5)


def test_limits():
    assert stagnation_cp(1e-3) == pytest.approx(1.0, abs=1e-5)
    assert stagnation_cp(1.0) == pytest.approx(stagnation_cp(1.0 + 1e-9), rel=1e-8)
    # Newtonian limit for gamma 1.4 (Anderson): 1.839.
    assert stagnation_cp(1e3) == pytest.approx(1.8394, abs=1e-4)
    assert normal_shock_pressure(2.0) == pytest.approx(4.5)


def test_bad_mach():
    with pytest.raises(InputError, match="mach = 0"):
        stagnation_cp(0.0)
