"""Deviation, verdict and the written tables."""

import base64
import io
import json

import pytest
from rich.console import Console

from spaceplane import validation
from spaceplane.errors import InputError
from spaceplane.validation import figures
from spaceplane.validation.records import Record
from spaceplane.validation.terminal import print_table


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
    files = validation.write(rows, tmp_path / "new")
    assert validation.read(files["json"]) == rows
    assert json.loads(files["json"].read_text())["passed"] is False
    page = files["md"].read_text()
    assert "not converged" in page and "+1.5 %" in page and "coarse" in page


def test_page_carries_the_pictures(tmp_path):
    """Beside the Markdown page as files, inside the HTML page; both say which row is nearest to its edge."""
    rows = (record(0.203), record(0.7, case="sphere", condition="Mach 5", published=0.5, band=0.1))
    files = validation.write(rows, tmp_path)
    page, whole = files["md"].read_text(), files["html"].read_text()
    for case in ("cones", "sphere"):
        data = files[case].read_bytes()
        assert data.startswith(b"\x89PNG") and len(data) > 5000
        assert f"](validation-{case}.png)" in page
        assert base64.b64encode(data).decode() in whole
    assert "surface Cp, Mach 5: +40.0 %, band 10 %" in page and "1 of 2 judged rows" in whole


def test_conditions_are_read_as_places():
    cones = [record(0.2, condition=f"Mach {m:g}, half angle {a:g} deg") for m in (1.5, 3) for a in (10, 20)]
    found = figures.places(cones)
    assert (found.name, found.x) == ("half angle, deg", (10, 20, 10, 20))
    assert found.series == ("Mach 1.5", "Mach 1.5", "Mach 3", "Mach 3")
    spheres = figures.places([record(0.2, condition=f"Mach {m:g}") for m in (1.5, 3)])
    assert (spheres.name, spheres.x, set(spheres.series)) == ("Mach", (1.5, 3), {""})
    words = figures.places([record(0.2, condition=text) for text in ("Boeing 747 lateral", "HORUS-2B")])
    assert words.labels == ("Boeing 747 lateral", "HORUS-2B")


def test_table_on_the_terminal_shows_deviation_and_band():
    console = Console(file=io.StringIO())
    print_table([record(0.203), record(0.3)], console)
    text = console.file.getvalue()
    assert "+1.5 %" in text and "2 %" in text and "pass" in text and "fail" in text


def test_unwritable_folder(tmp_path):
    blocker = tmp_path / "file"
    blocker.write_text("")
    with pytest.raises(InputError, match=r"out: .*cannot be written"):
        validation.write((record(0.2),), blocker / "sub")


def test_unknown_case_names_the_nearest():
    with pytest.raises(InputError, match="did you mean 'cones'"):
        validation.run(["cone"])
