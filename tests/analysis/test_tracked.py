"""Modes followed through flight points: exact at each of them, and refused where neighbours differ too much."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from dynamics import horus
from spaceplane.analysis.tracked import track
from spaceplane.dynamics.flightpoint import taem_point
from spaceplane.dynamics.linearise import linearise
from spaceplane.report import branches
from spaceplane.report.figures_dynamics import over_parameter

MACHS = (1.5, 2.0, 2.5)


def points(machs=MACHS):
    return [taem_point(mach).with_coefficients(0.3, 0.2) for mach in machs]


def systems(flight):
    return [linearise(p, horus.MASS, horus.REFERENCE, horus.derivatives(Cm_q=-1.0, Cn_r=-0.4)) for p in flight]


def sorted_values(values):
    return sorted(values, key=lambda z: (round(z.real, 9), round(z.imag, 9)))


def test_at_the_flight_points_the_branches_are_their_eigenvalues():
    flight = points()
    models = systems(flight)
    found = track(flight, models)
    assert found.used == (0, 1, 2) and found.reasons == ()
    data, values = found.branches.dataset, found.branches.eigenvalues()
    given = data["mach"].values[data["given"].values]
    assert given.tolist() == list(MACHS)
    for mach, model in zip(MACHS, models, strict=True):
        row = values[int(np.flatnonzero(data["mach"].values == mach)[0])]
        exact = np.linalg.eigvals(model.A)
        assert np.allclose(sorted_values(row), sorted_values(exact), rtol=1e-7, atol=1e-9)


def test_the_order_of_the_flight_points_does_not_matter():
    flight = points()
    models = systems(flight)
    shuffled = [2, 0, 1]
    one, other = track(flight, models), track([flight[k] for k in shuffled], [models[k] for k in shuffled])
    assert [shuffled[k] for k in other.used] == list(one.used)
    assert np.array_equal(one.branches.eigenvalues(), other.branches.eigenvalues())


def test_a_point_without_a_model_parts_the_run():
    flight = points((1.5, 2.0, 2.5, 3.0))
    models = systems(flight)
    models[1] = None
    found = track(flight, models)
    assert found.used == (2, 3)
    assert found.reasons == ("no linear model at Mach 2",)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda p: replace(p, mach=4.5), "the Mach number grows 3 times, at most 2"),
        (lambda p: replace(p, mach=1.5), "the Mach number is the same"),
        (lambda p: replace(p, bank=p.bank - math.radians(31.0)), "the bank angle changes by 31 deg"),
        (lambda p: replace(p, gamma=math.radians(25.0)), "the path angle changes by 33.4 deg"),
        (lambda p: replace(p, alpha=math.radians(45.0)), "the angle of attack changes by 33 deg"),
        (
            lambda p: replace(p, ambient=replace(p.ambient, density=4.0 * p.ambient.density)),
            "the dynamic pressure changes",
        ),
    ],
)
def test_neighbours_that_differ_too_much_are_not_joined(change, reason):
    first, second = points((1.5, 2.0))
    flight = [first, change(second)]
    found = track(flight, systems(flight))
    assert found.branches is None and found.used == ()
    assert reason in found.reasons[0]
    assert track([first, second], systems([first, second])).branches is not None


def test_a_single_point_says_so():
    flight = points((2.0,))
    assert track(flight, systems(flight)).reasons == ("a single flight point",)


def test_the_record_holds_what_the_picture_needs():
    flight = points()
    found = track(flight, systems(flight))
    written = json.loads(json.dumps(branches.record(found, [p.name for p in flight]), allow_nan=False))
    back = branches.from_record(written)
    assert np.array_equal(back.eigenvalues(), found.branches.eigenvalues())
    assert [(e.kind, e.parameter, e.branches) for e in back.events] == [
        (e.kind, e.parameter, e.branches) for e in found.branches.events
    ]
    assert over_parameter(back)[:4] == b"\x89PNG"
    assert written["flight_points"] == ["Mach 1.5", "Mach 2", "Mach 2.5"]
    assert len(branches.event_rows(written)) == sum(e.kind != "name" for e in found.branches.events)
