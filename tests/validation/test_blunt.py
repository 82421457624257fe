"""Stagnation pressure and stand-off against printed values."""

import pytest

from spaceplane.errors import InputError
from spaceplane.validation.blunt import normal_shock_pressure, stagnation_cp, standoff_billig


@pytest.mark.parametrize(
    ("mach", "cp", "standoff"),
    [(1.5, 1.5322, 0.604), (2, 1.6573, 0.322), (3, 1.7557, 0.205), (5, 1.8088, 0.163), (10, 1.8317, 0.148)],
)
def test_printed_values(mach, cp, standoff):
    assert stagnation_cp(mach) == pytest.approx(cp, abs=6e-5)
    assert standoff_billig(mach) == pytest.approx(standoff, abs=6e-4)


def test_limits():
    assert stagnation_cp(1e-3) == pytest.approx(1.0, abs=1e-5)
    assert stagnation_cp(1.0) == pytest.approx(stagnation_cp(1.0 + 1e-9), rel=1e-8)
    # Newtonian limit for gamma 1.4 (Anderson): 1.839.
    assert stagnation_cp(1e3) == pytest.approx(1.8394, abs=1e-4)
    assert normal_shock_pressure(2.0) == pytest.approx(4.5)


def test_bad_mach():
    with pytest.raises(InputError, match="mach = 0"):
        stagnation_cp(0.0)
    with pytest.raises(InputError, match="mach = 0"):
        standoff_billig(0.9)
