"""Errors of derivatives as users state them: absolute, relative, for all; and what is no such error."""

import tomllib
from pathlib import Path

import pytest

from spaceplane.dynamics import derivatives_file
from spaceplane.dynamics.given_errors import GivenError, half_widths, read_errors
from spaceplane.dynamics.sensitivity import PARAMETERS
from spaceplane.errors import InputError
from spaceplane.qualities.modes_record import analyse_modes

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
