"""Deviation, verdict and the written tables."""

import json

import pytest

from spaceplane import validation
from spaceplane.errors import InputError
from spaceplane.validation.records import Record


def record(computed, **changes):
    row = dict(case="cones", quantity="surface Cp", condition="Mach 3", unit="-", published=0.2, computed=computed)
    row |= dict(band=0.02, kind="relative", source="somewhere") | changes
    return Record(**row)


def test_relative_and_absolute_deviation():
    assert record(0.203).deviation == pytest.approx(0.015)
    assert record(0.203).verdict == "pass"
    assert record(0.205).verdict == "fail"
    assert record(-0.196, published=-0.2).deviation == pytest.approx(0.02)
    assert record(0.205, kind="absolute").deviation == pytest.approx(0.005)


def test_rounding_of_the_published_value_is_always_allowed():
    assert record(-0.026, published=-0.02, band=0.2).verdict == "fail"
    assert record(-0.026, published=-0.02, band=0.2, floor=0.007).verdict == "pass"
    zero = record(0.0004, published=0.0, floor=0.0005)
    assert zero.deviation is None and zero.verdict == "pass"
    assert record(0.0006, published=0.0, floor=0.0005).verdict == "fail"


@pytest.mark.parametrize("missing", [None, float("nan"), float("inf")])
def test_an_unconverged_value_never_passes(missing):
    assert record(missing).verdict == "fail"
    assert not validation.passed([record(missing)])


def test_rows_that_do_not_gate_are_shown_but_not_judged():
    outside = record(0.5, gate=False)
    assert outside.verdict == "outside"
    assert validation.passed([outside, record(0.2)])


def test_write_and_read_back(tmp_path):
    rows = (record(0.203, note="coarse"), record(None))
    json_path, page_path = validation.write(rows, tmp_path / "new")
    assert validation.read(json_path) == rows
    assert json.loads(json_path.read_text())["passed"] is False
    page = page_path.read_text()
    assert "not converged" in page and "+1.5 %" in page and "coarse" in page


def test_unwritable_folder(tmp_path):
    blocker = tmp_path / "file"
    blocker.write_text("")
    with pytest.raises(InputError, match=r"out: .*cannot be written"):
        validation.write((record(0.2),), blocker / "sub")


def test_unknown_case_names_the_nearest():
    with pytest.raises(InputError, match="did you mean 'cones'"):
        validation.run(["cone"])
