"""A cone on two coarse meshes: the stated uncertainty holds the exact slope, and grows with the cell."""

import math

import pytest

from spaceplane.aero.exact.conical import center_of_pressure
from spaceplane.aero.exact.inclined_cone import normal_force_slope
from spaceplane.aero.flow_case import run_flow, run_to_accuracy
from spaceplane.aero.free_streams import FreeStreams
from spaceplane.aero.uncertainty.accuracy import Accuracy
from spaceplane.flow.settings import FlowSettings
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation.bodies import cone
from spaceplane.vehicle.properties import ReferenceLengths

HALF_ANGLE = math.radians(20.0)
REFERENCE = ReferenceLengths(math.pi * math.tan(HALF_ANGLE) ** 2, 1.0, 1.0, (0.0, 0.0, 0.0))
ALPHA = math.radians(2.0)
STREAMS = FreeStreams([3.0], [ALPHA], [0.0, ALPHA])
SLOPE = normal_force_slope(3.0, math.radians(20.0))


def mesh(cell):
    return MeshSettings(wall_cell=cell, far_field=1.0)


@pytest.fixture(scope="module")
def cases():
    return {
        cell: run_flow(cone(HALF_ANGLE), STREAMS, REFERENCE, mesh(cell), FlowSettings(), uncertainty="mesh")
        for cell in (0.04, 0.08)
    }


def test_it_holds_the_exact_normal_force_and_moment(cases):
    """First-order theory of small incidence (Stone); yaw is pitch turned by a right angle."""
    exact = {"CN": SLOPE * ALPHA, "Cm": -SLOPE * ALPHA * center_of_pressure(HALF_ANGLE)}
    for record in cases[0.04].records:
        for name, value in exact.items():
            error = record["coefficient_errors"][name]
            assert abs(record[name] - value) < error < 0.5 * abs(value), (name, record[name], error)
    yawed = cases[0.04].records[1]
    assert abs(yawed["Cn"] + yawed["Cm"]) < yawed["coefficient_errors"]["Cn"]


def test_smaller_cells_are_more_certain(cases):
    fine, coarse = cases[0.04], cases[0.08]
    assert fine.companion.cells == pytest.approx(coarse.mesh.cells, rel=0.4)
    for a, b in zip(fine.records, coarse.records, strict=True):
        first, second = (math.hypot(r["coefficient_errors"]["CA"], r["coefficient_errors"]["CN"]) for r in (a, b))
        assert first < 0.8 * second
        assert a["coefficient_errors"]["CY"] >= a["coefficient_errors_by_source"]["mesh"]["CY"]
    straight = fine.records[0]
    assert straight["coefficient_errors"]["CY"] < 1e-4  # zero by symmetry


def test_refining_to_an_accuracy_reaches_it_or_says_that_it_did_not():
    args = cone(HALF_ANGLE), STREAMS, REFERENCE, mesh(1.0), FlowSettings()
    case, found = run_to_accuracy(*args, Accuracy(0.27, 100_000))
    assert found.met and found.reached <= 0.27
    for record in case.records:
        assert record["cells"] == found.trials[-1].cells == case.mesh.cells
        force = math.hypot(record["CL"], record["CD"], record["CY"])
        worst = max(record["coefficient_errors"][name] for name in ("CL", "CD", "Cm")) / force
        assert record["accuracy"] == {"target": 0.27, "reached": pytest.approx(worst), "met": True}
    case, found = run_to_accuracy(*args, Accuracy(0.001, 40_000))
    assert not found.met and found.trials[-1].cells <= 40_000 and found.needed > 40_000
    assert not any(record["accuracy"]["met"] for record in case.records if record["accuracy"]["reached"] > 0.001)
