"""The thesis's derivatives in our units, and the count of agreeing signs."""

import math

import pytest

from spaceplane.study import thesis


def test_values_are_per_radian_and_per_unit_mach():
    original = thesis.derivatives("original")
    assert set(original) == {0.8, 1.5, 2.5}
    assert original[0.8]["CL_alpha"] == pytest.approx(0.0350 * 180 / math.pi)
    assert original[1.5]["CD_M"] == -0.1598
    assert original[2.5]["CY_beta"] == pytest.approx(-0.0107 * 180 / math.pi)
    assert set(thesis.derivatives("optimised")) == {0.8, 1.5, 2.5, 5.0, 10.0}


def test_appendix_is_whole_but_for_what_is_missing():
    rows = thesis.sensitivities()
    assert len(rows) == 15 * 2 * 3 * 9 - 2 * 2 * 3
    assert not any(row.parameter == "wing_thickness_m" and row.derivative in ("Cl_beta", "Cn_beta") for row in rows)
    wide = next(
        r for r in rows if (r.parameter, r.side, r.mach, r.derivative) == ("wing_width_m", "high", 0.8, "CL_alpha")
    )
    assert wide.value == pytest.approx(0.0418 * 180 / math.pi) and wide.sign == 1


def test_appendix_agrees_with_table_7_1():
    """The appendix's original shape is Table 7.1's, to its printed digits."""
    table = thesis.derivatives("original")
    for row in thesis.sensitivities():
        printed = table[row.mach][row.derivative]
        assert abs(row.default - printed) <= max(row.noise, 0.6e-4 * thesis.unit_factor(row.derivative)), row


def test_the_thesis_agrees_with_itself_and_not_with_its_negative():
    own = thesis.sensitivities()
    rows = thesis.agreement(own)
    assert {row["verdict"] for row in rows} == {"agree", "both too small"}
    flipped = [
        thesis.Sensitivity(
            r.parameter, r.side, r.parameter_value, r.mach, r.derivative, r.default - r.change, r.default, r.noise
        )
        for r in own
    ]
    assert {row["verdict"] for row in thesis.agreement(flipped)} == {"disagree", "both too small"}
    table = thesis.agreement_table(rows, "derivative")
    assert [line["derivative"] for line in table] == list(thesis.DERIVATIVES)
    assert sum(line["agree"] + line["disagree"] + line["too small to tell"] for line in table) == len(rows)
    assert all(line["agreement_percent"] == 100.0 for line in table)


def test_slopes_account_for_different_steps():
    published = next(r for r in thesis.sensitivities() if (r.parameter, r.side) == ("fuselage_height_m", "high"))
    step = published.parameter_value - 1.57
    double = thesis.Sensitivity(
        published.parameter,
        "high",
        1.57 + 2 * step,
        published.mach,
        published.derivative,
        published.default + 2 * published.change,
        published.default,
        0.0,
    )
    (row,) = thesis.agreement([double])
    assert row["slope"] == pytest.approx(row["slope_thesis"])
