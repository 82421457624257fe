"""Rounding to what is known."""

from __future__ import annotations

import math

import pytest

from spaceplane.report.numbers import MISSING, duration, fixed, grouped, measured, number, unbroken


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (1.23456, 0.0123, "1.235 ± 0.012"),
        (1.23456, 0.0456, "1.23 ± 0.05"),
        (-0.0123, 0.0004, "−0.0123 ± 0.0004"),
        (-1.2345e-5, 4.2e-7, "(−1.23 ± 0.04)·10⁻⁵"),
        (1.0e-6, 0.02, "0.000 ± 0.020"),
        (-1.0e-6, 0.02, "0.000 ± 0.020"),
        (2.5e7, 3.0e5, "(2.50 ± 0.03)·10⁷"),
        (123.4, 20.0, "123 ± 20"),
        (0.5, 0.0, "0.5000"),
        (0.5, None, "0.5000"),
        (None, 0.1, MISSING),
        (math.nan, 0.1, MISSING),
    ],
)
def test_value_is_rounded_to_its_error(value, error, text):
    assert str(measured(value, error)) == text


def test_an_error_below_the_printed_digits_is_said_to_be_so():
    assert measured(1.0, 1e-12).error == "<0.00000001"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1234.5678, "1235"),
        (-0.001234567, "−0.001235"),
        (1.5e-7, "1.500·10⁻⁷"),
        (None, MISSING),
        (math.inf, MISSING),
    ],
)
def test_number(value, text):
    assert number(value) == text


def test_round_off_is_not_written_as_minus_zero():
    assert fixed(-1e-9, 3) == "0.000"


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.5, "0.500 s"), (4.0, "4.00 s"), (83.2, "83 s"), (185, "3 min 05 s"), (7800, "2 h 10 min"), (900000, "10 days"),
     (1e12, "over a year"), (None, MISSING)],
)  # fmt: skip
def test_duration(seconds, text):
    assert duration(seconds) == text


def test_counts_are_grouped():
    assert grouped(1234567) == "1\u202f234\u202f567"


def test_no_line_break_between_a_number_and_its_unit():
    assert unbroken("79 % of it, 0.31 m on cells of 0.15 m") == "79\u00a0% of it, 0.31\u00a0m on cells of 0.15\u00a0m"
    assert unbroken("2 more, 3 of 4") == "2 more, 3 of 4"
