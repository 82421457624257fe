"""Trim over Mach number and angle of attack: cell by cell what the single trim gives, reasons elsewhere."""

import math

import numpy as np
import pytest
from tests.aero.model import linear

from spaceplane.dynamics.trim.longitudinal import trim_elevator
from spaceplane.dynamics.trim.maps import trim_map
from spaceplane.errors import InputError
from spaceplane.report.trim_figures import write_trim_map

MACHS, ALPHAS = [1.6, 2.2, 3.5], np.radians([2.0, 14.0, 29.0])


@pytest.fixture(scope="module")
def found():
    return trim_map(linear.model(Cm=(-0.09, 0.1, 0.0)), MACHS, ALPHAS, {1.0: -0.1, 2.0: -0.1}, limits=LIMITS)


LIMITS = {"elevon_left": (math.radians(-25.0), math.radians(25.0))}


def test_cells_are_single_trims(found):
    model = linear.model(Cm=(-0.09, 0.1, 0.0))
    for mach, flap in ((1.6, -0.1), (2.2, None)):
        for alpha in ALPHAS:
            cell = found.sel(mach=mach, alpha=alpha)
            single = trim_elevator(model, mach, alpha, flap, limits=LIMITS)
            assert bool(cell.trimmable) == bool(single.trims) and int(cell.trims) == len(single.trims)
            assert str(cell.reason.values) == single.reason
            if single.best:
                for name in ("elevator", "body_flap", "margin", "CL", "lift_to_drag"):
                    assert float(cell[name]) == getattr(single.best, name)
                assert float(cell.static_margin) == single.best.static.margin
                assert abs(float(cell.elevator)) <= math.radians(25.0)
            else:
                assert np.isnan(cell.elevator) and float(cell.elevator_needed) == single.needed
    assert {bool(v) for v in found.trimmable.sel(mach=1.6)} == {True, False}


def test_a_chosen_flap_trims_more(found):
    """Where the schedule holds the flap, the first angle has no trim; where it is free, it has."""
    assert not found.trimmable.sel(mach=1.6)[0] and found.trimmable.sel(mach=2.2)[0]
    assert "needs elevator" in str(found.reason.sel(mach=1.6).values[0])


def test_outside_the_tables_is_said(found):
    outside = found.sel(mach=3.5)
    assert not outside.trimmable.any()
    assert all(str(text).startswith("outside the tables: mach = 3.5") for text in outside.reason.values)


def test_everything_has_units_and_the_file_comes_back(found, tmp_path):
    import xarray as xr

    assert all("units" in found[name].attrs for name in found.variables)
    assert found.attrs["moment_center_m"] == [13.0, 0.0, 0.0] and "Mach 1: -5.7" in found.attrs["body_flap"]
    found.to_netcdf(tmp_path / "map.nc")
    xr.testing.assert_equal(xr.load_dataset(tmp_path / "map.nc").drop_vars("reason"), found.drop_vars("reason"))


@pytest.mark.parametrize("mach", [[], [2.0, 2.0], [2.0, math.nan]])
def test_axes_are_checked(mach):
    with pytest.raises(InputError, match="mach: must be finite, increasing"):
        trim_map(linear.model(), mach, ALPHAS)


def test_picture(found, tmp_path):
    write_trim_map(found, tmp_path / "map.png")
    empty = trim_map(linear.model(), [4.0, 5.0], ALPHAS)
    write_trim_map(empty, tmp_path / "empty.png")
    assert (tmp_path / "map.png").read_bytes() != (tmp_path / "empty.png").read_bytes()
