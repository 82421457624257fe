"""Bad input to the flow solver is refused with one line that names it."""

from __future__ import annotations

import numpy as np
import pytest

from spaceplane.errors import InputError
from spaceplane.flow.settings import FlowSettings, check
from spaceplane.flow.solution import FlowConditions


@pytest.mark.parametrize(
    ("field", "value", "hint"),
    [
        ("flux", "hlcc", "hllc"),
        ("limiter", "venkatakrishna", "venkatakrishnan"),
        ("precision", "singel", "single"),
        ("order", 3, "1 or 2"),
        ("cfl_max", float("nan"), "allowed"),
        ("iterations", 0, "allowed"),
    ],
)
def test_bad_setting_names_field_and_what_is_allowed(field, value, hint):
    with pytest.raises(InputError) as error:
        FlowSettings(**{field: value})
    assert field in str(error.value) and hint in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("mach", "alpha", "beta", "word"),
    [
        ([0.0], [0.0], [0.0], "mach"),
        ([-1.0], [0.0], [0.0], "mach"),
        ([np.nan], [0.0], [0.0], "mach"),
        ([2.0], [np.inf], [0.0], "alpha"),
        ([2.0], [0.0], [np.nan], "beta"),
        ([2.0, 3.0], [0.0], [0.0, 0.0], "conditions"),
        ([], [], [], "conditions"),
        (["fast"], [0.0], [0.0], "mach"),
    ],
)
def test_conditions_no_flow_can_have(mach, alpha, beta, word):
    with pytest.raises(InputError, match=word):
        check(FlowConditions(mach, alpha, beta))


def test_conditions_come_back_as_float_arrays():
    good = check(FlowConditions([2], [0.1], [0]))
    assert good.mach.dtype == np.float64 and len(good) == 1


def test_deeper_runs_have_more_iterations():
    usual = FlowSettings()
    deep, shallow = usual.falling(6.0), usual.falling(2.0)
    assert (deep.residual_drop, deep.iterations) == (6.0, 2 * usual.iterations)
    assert (shallow.residual_drop, shallow.iterations) == (2.0, usual.iterations)
