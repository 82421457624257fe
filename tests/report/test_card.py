"""Sentences on the card of a flight point."""

import pytest

from spaceplane.report.card import absence, yaw_sentence
from spaceplane.report.flight_point import point

from .example_result import example_result

SPLIT = (
    "not applicable: aperiodic. Instead aperiodic pitch subsidence: halves in 1.02 s; aperiodic pitch divergence: "
    "doubles in 1.91 s; spiral: doubles in 9 s."
)
OPEN = "not applicable at the nominal derivatives, but within their uncertainty"


@pytest.mark.parametrize(
    ("verdict", "text"),
    [
        ({"note": SPLIT}, "aperiodic pitch subsidence and aperiodic pitch divergence and more instead"),
        (
            {"mode": "spiral", "note": "not applicable: no spiral. Instead pitch/roll subsidence: halves in 29 s."},
            "pitch/roll subsidence instead",
        ),
        ({"mode": "roll mode", "note": "not applicable: no roll mode."}, "no such mode"),
        ({"mode": "roll mode", "note": "not applicable: n/alpha is not known"}, "n/alpha is not known"),
        ({"note": OPEN, "probabilities": {"1": 0.04, "not applicable": 0.96}}, "arises with 4 % within the errors"),
        ({}, ""),
    ],
)
def test_why_a_criterion_does_not_apply(verdict, text):
    assert absence({"mode": "", **verdict}) == text


def with_yaw(value, error=None):
    return {"derivatives": {"Cn_beta": {"value": value, "error": error}}}


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (-0.11, 0.05, "Unstable in yaw: Cn_beta = −0.11 ± 0.05 per rad."),
        (0.11, 0.05, "Stable in yaw: Cn_beta = 0.11 ± 0.05 per rad."),
        (
            -0.05,
            0.18,
            "Stable or unstable in yaw is open: Cn_beta = −0.05 ± 0.18 per rad, and zero lies within the error.",
        ),
        (-0.11, None, "Unstable in yaw: Cn_beta = −0.110 per rad."),
        (None, None, ""),
    ],
)
def test_yaw_in_one_sentence(value, error, text):
    assert yaw_sentence(with_yaw(value, error)) == text


def test_every_criterion_is_a_chip_or_has_a_reason():
    """None is lost on the way to the card, and what does not apply says why."""
    for p in example_result()["flight_points"]:
        shown = point(p)
        criteria = {v["criterion"] for v in p["verdicts"]}
        assert len(shown["level_chips"]) + len(shown["absent"]) == len(criteria)
        assert not any("n/a" in chip["text"] for chip in shown["level_chips"])
        for one in shown["absent"]:
            assert one["name"] and one["title"]


def test_what_moves_instead_goes_before_what_may_arise():
    split = {"mode": "a", "criterion": "c", "quantity": "ratio", "applicable": False, "level": None, "note": SPLIT}
    arises = split | {"quantity": "overall", "note": OPEN, "probabilities": {"not applicable": 0.9}}
    found = point({**example_result()["flight_points"][0], "verdicts": [split, arises]})["absent"]
    assert [one["reason"] for one in found] == [absence(split)]
