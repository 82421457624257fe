"""Stand-off against printed values."""

import pytest

from spaceplane.errors import InputError
from spaceplane.validation.blunt import standoff_billig


@pytest.mark.parametrize(("mach", "standoff"), [(1.5, 0.604), (2, 0.322), (3, 0.205), (5, 0.163), (10, 0.148)])
def test_printed_values(mach, standoff):
    assert standoff_billig(mach) == pytest.approx(standoff, abs=6e-4)


def test_bad_mach():
    with pytest.raises(InputError, match="mach = 0"):
        standoff_billig(0.9)
