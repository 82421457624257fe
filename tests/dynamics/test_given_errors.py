"""Errors of derivatives as users state them: absolute, relative, for all; and what is no such error."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from spaceplane.analysis.descent import DescentSettings, descend
from spaceplane.decks.source import read_source
from spaceplane.dynamics import derivatives_file
from spaceplane.dynamics.given_errors import GivenError, by_surface, half_widths, read_errors
from spaceplane.dynamics.sensitivity import PARAMETERS
from spaceplane.errors import InputError
from spaceplane.qualities.modes_record import analyse_modes
from spaceplane.qualities.probability import NORMAL_95, Uncertainty

from . import horus

EXAMPLE = Path(__file__).parents[2] / "examples" / "horus_2b_taem.toml"


def test_shares_follow_the_value_and_absolute_errors_do_not():
    errors = read_errors("--uncertainty", " Cm_alpha = 10%, Cn_beta=0.01 ,CL = 5 % ")
    assert errors == {"Cm_alpha": GivenError(0.1, True), "Cn_beta": GivenError(0.01), "CL": GivenError(0.05, True)}
    point = horus.point()
    for size in (-0.4, 0.1):
        found = half_widths(errors, point, horus.derivatives(Cm_alpha=size, Cn_beta=10 * size))
        assert found["Cm_alpha"] == pytest.approx(0.1 * abs(size))
        assert found["Cn_beta"] == 0.01
        assert found["CL"] == pytest.approx(0.05 * point.CL)


def test_all_is_everything_that_is_not_zero_and_yields_to_entries_of_their_own():
    derivatives = horus.derivatives(**{**horus.EXTRA, "Cl_p": 0.0, "Cn_r": -0.5})
    found = half_widths(read_errors("--u", "all=20%,Cn_r=0.01"), horus.point(), derivatives)
    assert found["Cn_r"] == 0.01
    assert "Cl_p" not in found
    given = {name: value for name, value in derivatives.controls.items() if value}
    assert given and all(found[name] == pytest.approx(0.2 * abs(value)) for name, value in given.items())
    assert {name for name in found if name in PARAMETERS} >= {"Cm_alpha", "CL", "CD", "CL_M"}


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "name=value"),
        ("Cm_alpha", "name=value"),
        ("Cm_alpha=", "name=value"),
        ("Cm_alpha=10%,,", "name=value"),
        ("Cm_alpa=10%", "Cm_alpha"),
        ("Cm_alpha=ten", "Cm_alpha = 'ten'"),
        ("Cm_alpha=nan", "nan"),
        ("Cm_alpha=-1%", "0 to 1000 %"),
        ("Cm_alpha=inf%", "0 to 1000 %"),
        ("Cm_alpha=%", "Cm_alpha"),
        ("Cm_alpha=1,Cm_alpha=2", "twice"),
        ("all=0.1", "share"),
    ],
)
def test_what_is_no_error_is_named(text, match):
    with pytest.raises(InputError, match=match):
        read_errors("--uncertainty", text)


def test_a_control_that_the_vehicle_lacks_is_refused():
    with pytest.raises(InputError, match="has no Cm_rudder"):
        half_widths({"Cm_rudder": GivenError(0.1)}, horus.point(), horus.derivatives())


def test_errors_of_combined_controls_are_those_of_their_surfaces():
    """An aileron's error, drawn through its two elevons, is the aileron's again; so is its correlation."""
    errors, pairs = by_surface({"Cl_aileron": 0.02, "Cn_beta": 0.01}, {("Cl_aileron", "Cn_beta"): 0.5})
    assert errors["Cl_elevon_left"] == errors["Cl_elevon_right"] == GivenError(0.01)
    widths = {name: one.amount for name, one in errors.items()}
    uncertainty = Uncertainty(widths, pairs | {("Cl_elevon_left", "Cl_elevon_right"): -1.0})
    draws = dict(zip(uncertainty.names, uncertainty.draw(4000, 0).T, strict=True))
    aileron = draws["Cl_elevon_left"] - draws["Cl_elevon_right"]
    assert aileron.std() == pytest.approx(0.02 / NORMAL_95, rel=0.04)
    assert np.corrcoef(aileron, draws["Cn_beta"])[0, 1] == pytest.approx(0.5, abs=0.04)


def test_a_descent_takes_the_errors_of_a_derivatives_file(tmp_path):
    text = EXAMPLE.read_text(encoding="utf-8")
    text = text.replace("Cm_M = 0.01195", "Cm_M = 0.01195\nCm_elevator = -0.001\nCL_elevator = 0.002")
    path = tmp_path / "case.toml"
    path.write_text(text + '\n[uncertainty]\nCm_alpha = "50%"\nCm_elevator = 0.0002\n', encoding="utf-8")
    source = read_source(str(path))
    settings = DescentSettings((2.5,), uncertainty=source.errors, correlation=source.correlation, samples=50)
    one = descend(source.model, source.mass, settings).points[0]
    widths = one.likelihood.uncertainty.half_width
    per_rad = 57.29577951308232
    assert widths["Cm_alpha"] == pytest.approx(0.5 * 0.00071 * per_rad)
    assert widths["Cm_elevon_left"] == widths["Cm_elevon_right"] == pytest.approx(0.0001 * per_rad)
    assert one.likelihood.uncertainty.correlation["Cm_elevon_left", "Cm_elevon_right"] == 1.0


def content(**table):
    return {**tomllib.loads(EXAMPLE.read_text(encoding="utf-8")), "uncertainty": table}


def test_shares_in_a_derivatives_file():
    """Beside absolute ones, which are in the unit of the file; C_L is per nothing."""
    case = derivatives_file.from_tables(content(all="10 %", Cn_beta=0.0005, Cm_alpha="0%"))
    derivatives = case.derivatives
    assert case.uncertainty["Cl_beta"] == pytest.approx(0.1 * abs(derivatives.Cl_beta))
    assert case.uncertainty["Cn_beta"] == pytest.approx(0.0005 * 57.29577951308232)
    assert case.uncertainty["CL"] == pytest.approx(0.1 * case.point.CL)
    assert case.uncertainty["Cm_alpha"] == 0.0


def test_a_larger_share_leaves_levels_more_open():
    """The chance of the most likely outcome, over all criteria that apply: it falls as the errors grow."""
    sure = []
    for share in ("1%", "20%", "80%"):
        record = analyse_modes(derivatives_file.from_tables(content(all=share, samples=200)))
        sure.append(sum(max(v["probabilities"].values()) for v in record["verdicts"] if v["applicable"]))
    assert sure[0] > sure[1] > sure[2]


@pytest.mark.parametrize(
    ("table", "match"),
    [
        ({"Cm_alpha": "ten"}, r"\[uncertainty\] Cm_alpha"),
        ({"all": 0.1}, r"\[uncertainty\] all"),
        ({"Cm_q": "10%"}, "a share of nothing"),
        ({"Cm_alpha": True}, r"\[uncertainty\] Cm_alpha"),
        ({"Cm_alpha": [1]}, r"\[uncertainty\] Cm_alpha"),
        ({"Cm_elevon_lef": "1%"}, "Cm_elevon_left"),
    ],
)
def test_bad_shares_in_a_file(table, match):
    with pytest.raises(InputError, match=match):
        derivatives_file.from_tables(content(**table))
