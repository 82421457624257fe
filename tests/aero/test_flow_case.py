"""One small body through mesh and solver, as `spaceplane flow` asks for it."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from spaceplane.aero import flow_case
from spaceplane.aero.flow_case import run_flow
from spaceplane.aero.free_streams import FreeStreams
from spaceplane.aero.increments.friction_laws import LAMINAR, local_friction
from spaceplane.aero.increments.settings import IncrementSettings
from spaceplane.aero.integrate import integrate
from spaceplane.aero.records import records
from spaceplane.environment.atmosphere import sutherland_viscosity, us1976
from spaceplane.errors import InputError
from spaceplane.flow.settings import FlowSettings
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation.bodies import cone
from spaceplane.vehicle.properties import ReferenceLengths

KEYS = {
    "mach", "alpha_deg", "beta_deg", "p_hat", "q_hat", "r_hat",
    "CL", "CD", "CY", "Cl", "Cm", "Cn", "CA", "CN", "CA_forebody", "CA_base",
    "Cp_max", "Cp_min", "converged", "verdict", "residual_drop", "iterations", "seconds", "cells", "reason",
    "coefficient_errors", "coefficient_errors_by_source",
}  # fmt: skip
HALF_ANGLE = math.radians(20.0)
REFERENCE = ReferenceLengths(math.pi * math.tan(HALF_ANGLE) ** 2, 1.0, 1.0, (0.0, 0.0, 0.0))
MESH = MeshSettings(wall_cell=0.05, far_field=1.0)
ALPHA = math.radians(2.0)
ANGLES = [0.0, ALPHA], [0.0, ALPHA]


@pytest.fixture(scope="module")
def case():
    return run_flow(cone(HALF_ANGLE), FreeStreams([3.0], *ANGLES), REFERENCE, MESH, FlowSettings())


def test_records_have_the_documented_keys_for_every_combination(case):
    assert [(r["alpha_deg"], r["beta_deg"]) for r in case.records] == [(0, 0), (0, 2), (2, 0), (2, 2)]
    for record in case.records:
        assert set(record) == KEYS
        assert record["converged"] and record["verdict"] == "converged"
        assert set(record["coefficient_errors_by_source"]) == {"iteration"}
        assert 0.0 <= record["coefficient_errors"]["CA"] < 1e-3 * record["CA"]
        assert record["cells"] == case.mesh.cells
        assert record["CA"] == pytest.approx(record["CA_forebody"] + record["CA_base"])
    json.loads(json.dumps(case.records, allow_nan=False))


def test_a_cone_meets_the_exact_pressure_drag_and_pitch_equals_yaw(case):
    """Taylor-Maccoll at Mach 3, 20 deg: Cp 0.28427. 20 cells along the cone test the plumbing, not the accuracy."""
    straight, yawed, pitched, _ = case.records
    assert straight["CA_forebody"] == pytest.approx(0.28427, rel=0.08)
    assert pitched["CN"] / ALPHA == pytest.approx(1.686, rel=0.08)
    # Wind from the right pushes left and, about the apex, turns the nose right; as lift pitches the nose down.
    body_side = yawed["CY"] * math.cos(ALPHA) - yawed["CD"] * math.sin(ALPHA)
    assert body_side == pytest.approx(-pitched["CN"], rel=0.04)
    assert yawed["Cn"] == pytest.approx(-pitched["Cm"], rel=0.04)
    assert pitched["Cm"] < 0.0
    for name in ("CY", "Cl", "Cn"):
        assert abs(straight[name]) < 1e-4


def test_a_cone_that_pitches_about_its_apex_resists():
    """Wall that moves into the air is pressed back, and q c/2V is what the record says."""
    body, q = cone(HALF_ANGLE), 0.06
    streams = FreeStreams([3.0], rates=(0.0, q, 0.0))
    (turning,) = run_flow(body, streams, REFERENCE, MESH, FlowSettings()).records
    assert turning["q_hat"] == pytest.approx(q / (2 * 3.0))
    # Strips that each take the cone's slope at their own incidence q x/V: 17 % short of the flow, on finer cells too.
    strips = -0.5 * 1.686 * q / 3.0 / math.cos(HALF_ANGLE) ** 2
    assert turning["Cm"] == pytest.approx(strips, rel=0.25)
    for name in ("CY", "Cl", "Cn"):
        assert abs(turning[name]) < 1e-4


def test_increments_of_a_cone_are_listed_by_source(monkeypatch, case):
    """Laminar friction of the 20 deg cone by hand: 2/sqrt(3) times that of a plate of its slant length, plus edges."""
    monkeypatch.setattr(flow_case, "_solved", lambda *_: case.solution)
    increments = IncrementSettings(friction="laminar", base="correlation")
    streams = FreeStreams([3.0], *ANGLES, increments=increments)
    with pytest.raises(InputError, match="friction = 'laminar': needs the altitude"):
        run_flow(cone(HALF_ANGLE), streams, REFERENCE, MESH, FlowSettings())
    ambient = us1976(25_000.0)
    streams = replace(streams, ambient=ambient)
    found = run_flow(cone(HALF_ANGLE), streams, REFERENCE, MESH, FlowSettings()).records
    assert set(found[0]) == KEYS | {"by_source"}
    for record, plain in zip(found, case.records, strict=True):
        assert record["by_source"]["inviscid"]["CD"] == pytest.approx(plain["CD"])
        for name in ("CL", "CD", "CY", "Cl", "Cm", "Cn", "CA", "CN"):
            total = sum(source[name] for source in record["by_source"].values())
            assert total == pytest.approx(record[name], abs=1e-12)
    # Taylor-Maccoll at Mach 3, 20 deg: surface Cp 0.28427, shock at 29.615 deg.
    cp, normal = 0.28427, 9.0 * math.sin(math.radians(29.615)) ** 2
    pressure, behind = 1.0 + 6.3 * cp, (7.0 * normal - 1.0) / 6.0
    shocked = behind * (normal + 5.0) / (6.0 * normal)
    temperature = shocked * (pressure / behind) ** (2.0 / 7.0)
    mach = math.sqrt(5.0 * (2.8 / temperature - 1.0))
    slant = 1.0 / math.cos(HALF_ANGLE)
    edge = us1976(25_000.0).temperature * temperature
    unit = pressure / temperature * mach * math.sqrt(temperature) * ambient.speed_of_sound * ambient.density
    reynolds = unit * slant / sutherland_viscosity(edge)
    friction = local_friction(LAMINAR, np.array([reynolds]), np.array([mach]), np.array([edge]), None)[0]
    mean = friction * math.sqrt(3.0) * 4.0 / 3.0 * pressure * mach**2 / 9.0
    wetted = math.pi * math.tan(HALF_ANGLE) * slant / REFERENCE.area
    exact = mean * wetted * math.cos(HALF_ANGLE)
    assert found[0]["by_source"]["friction"]["CA"] == pytest.approx(exact, rel=0.1)
    # -0.25 / 3 on the base of the reference area in place of the computed pressure
    assert found[0]["CA_base"] == pytest.approx(0.25 / 3.0, rel=0.02)


def test_failed_conditions_have_no_values(case):
    bad = replace(case.solution.records[1], verdict="failed", reason="not a number", residual_drop=math.nan)
    solution = replace(case.solution, records=(case.solution.records[0], bad, *case.solution.records[2:]))
    good, failed = records(solution, integrate(solution, REFERENCE))[:2]
    assert failed["CL"] is None and failed["Cp_max"] is None and failed["residual_drop"] is None
    assert (failed["converged"], failed["reason"]) == (False, "not a number")
    assert good["CD"] == pytest.approx(case.records[0]["CD"])


def test_bad_conditions_are_refused_before_meshing(monkeypatch):
    monkeypatch.setattr(flow_case, "generate", lambda *_: pytest.fail("meshed"))
    for machs, alphas, message in (([0.0], [0.0], "mach"), ([2.0], [math.nan], "alpha"), ([], [0.0], "at least one")):
        with pytest.raises(InputError, match=message):
            run_flow(cone(HALF_ANGLE), FreeStreams(machs, alphas), REFERENCE, MESH, FlowSettings())


def test_rates_that_are_no_numbers_are_named():
    streams = FreeStreams([2.0], rates=(0.0, math.nan, 0.0))
    with pytest.raises(InputError, match=r"rates: \(0.0, nan, 0.0\), three finite"):
        streams.conditions(REFERENCE, cone(HALF_ANGLE).points)
