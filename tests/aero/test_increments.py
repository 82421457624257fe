"""Base pressure, and increments beside the inviscid coefficients."""

import numpy as np
import pytest

from spaceplane.aero.increments.add import WITH_SOURCES, integrate_with
from spaceplane.aero.increments.base_pressure import base_cp, is_base
from spaceplane.aero.increments.settings import Air, IncrementSettings
from spaceplane.aero.integrate import COEFFICIENTS, integrate, mirrored

BASE = IncrementSettings(base="correlation")
BOTH = IncrementSettings(friction="turbulent", base="correlation")


def waves(center, mach, alpha, beta):
    x, y, z = center.T
    return np.cos(x + 0.3) - 3.0 * alpha * z + np.sin(2.0 * y + 1.0) * (0.2 + beta)


def air(mach):
    return Air.at_reynolds(1e6, np.atleast_1d(mach), 220.0)


@pytest.mark.parametrize(
    ("mach", "measured", "band"),
    [
        (3.0, -0.23 / 2.56, 0.010),  # HB-2, AEDC-TDR-64-137, base of 1.6 calibres
        (6.0, -0.065 / 2.56, 0.010),
    ],
)
def test_base_pressure_against_measurements(mach, measured, band):
    assert float(base_cp(mach)) == pytest.approx(measured, abs=band)


def test_base_pressure_is_continuous_and_never_below_vacuum():
    mach = np.linspace(0.01, 30.0, 6000)
    cp = base_cp(mach)
    assert np.abs(np.diff(cp)).max() < 0.002
    assert (1.0 + 0.7 * mach**2 * cp > 0.0).all()
    assert float(base_cp(1.0)) == pytest.approx(-0.25)
    assert float(base_cp(0.0)) == pytest.approx(-0.12)
    assert float(0.7 * 30.0**2 * base_cp(30.0)) == pytest.approx(-0.93, abs=0.02)


def test_base_is_wall_that_faces_aft_and_away_from_the_wind(box):
    base = is_base(box, 0.2, 0.1)
    assert base.sum() == 4 * 3
    assert (box.piece_center[base, 0] == 2.0).all()
    assert not is_base(box, np.radians(100.0), 0.0).any()


def test_base_increment_puts_the_correlation_in_place_of_the_wall_pressure(make_solution, box, lengths):
    mach = [0.5, 2.0]
    solution = make_solution(box, waves, mach=mach, alpha=0.1)
    inviscid, found = integrate(solution, lengths), integrate_with(solution, lengths, BASE)
    expected = -base_cp(mach) * 2.0 / 8.0
    np.testing.assert_allclose(found.CA_base.sel(part="total"), expected, atol=1e-12)
    np.testing.assert_allclose(found.CA_forebody, inviscid.CA_forebody)
    np.testing.assert_allclose(found.CA, found.CA_forebody + found.CA_base, atol=1e-12)
    change = found.CA_by_source.sel(source="base")
    np.testing.assert_allclose(change, found.CA - inviscid.CA, atol=1e-12)
    np.testing.assert_allclose(found.CN, inviscid.CN, atol=1e-12)


def test_base_at_the_correlation_s_pressure_gives_no_increment(make_solution, box, lengths):
    solution = make_solution(box, lambda center, mach, *_: np.full(len(center), float(base_cp(mach))), mach=2.0)
    found = integrate_with(solution, lengths, BASE).sel(source="base")
    for name in WITH_SOURCES:
        assert np.abs(found[f"{name}_by_source"]).max() < 1e-12


def test_sources_sum_to_the_coefficient_and_parts_to_the_total(make_solution, box, lengths):
    solution = make_solution(box, waves, mach=[0.8, 3.0], alpha=[0.1, 0.3], beta=[0.05, 0.0])
    solution.state[:, 4] = 1.0 / 1.4
    data = integrate_with(solution, lengths, BOTH, air([0.8, 3.0]))
    inviscid = integrate(solution, lengths)
    assert list(data.source.values) == ["inviscid", "friction", "base"]
    for name in WITH_SOURCES:
        shares = data[f"{name}_by_source"]
        np.testing.assert_allclose(shares.sum("source"), data[name], atol=1e-14)
        np.testing.assert_allclose(shares.sel(source="inviscid"), inviscid[name])
        np.testing.assert_allclose(shares.drop_sel(part="total").sum("part"), shares.sel(part="total"), atol=1e-14)
        assert shares.attrs | {"long_name": ""} == inviscid[name].attrs | {"long_name": ""}
    assert (data.CD_by_source.sel(source="friction", part="total") > 0.0).all()


def test_increments_off_leave_everything_as_it_is(make_solution, box, lengths):
    solution = make_solution(box, waves, alpha=0.2)
    assert integrate_with(solution, lengths, IncrementSettings()).identical(integrate(solution, lengths))


def test_a_failed_condition_has_no_increments(make_solution, box, lengths):
    solution = make_solution(box, waves, mach=2.0, alpha=[0.0, 0.1], verdicts=["failed", "converged"])
    solution.state[..., 0] = np.nan
    solution.state[:, 4, 1] = 1.0 / 1.4
    data = integrate_with(solution, lengths, BOTH, air([2.0, 2.0]))
    for name in (*COEFFICIENTS, *(f"{n}_by_source" for n in WITH_SOURCES)):
        assert np.isnan(data[name].values[0]).all(), name
        assert np.isfinite(data[name].values[1]).all(), name


def test_mirror_image_reverses_lateral_sources_too(make_solution, box, lengths):
    solution = make_solution(box, waves, mach=2.0, alpha=0.1, beta=0.1)
    data = integrate_with(solution, lengths, BASE)
    flipped = mirrored(data)
    for name in WITH_SOURCES:
        sign = -1.0 if name in ("CY", "Cl", "Cn") else 1.0
        here, there = data[f"{name}_by_source"], flipped[f"{name}_by_source"]
        np.testing.assert_allclose(there.sel(part="total"), sign * here.sel(part="total"))
        np.testing.assert_allclose(there.sel(part="wing_left"), sign * here.sel(part="wing_right"))
        np.testing.assert_allclose(there.sum("source"), flipped[name], atol=1e-14)
