"""The composition on the real vehicle, mesh, dynamics and report, with an impact method in place of the flow solver."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
import pyvista

from spaceplane import pipeline
from spaceplane.aero import bodies
from spaceplane.aero.conditions import DerivativeSteps
from spaceplane.aero.database import AeroDatabase
from spaceplane.aero.increments.settings import VISCOUS, IncrementSettings
from spaceplane.analysis import aerodynamics
from spaceplane.analysis.feedback_settings import FeedbackSettings
from spaceplane.errors import InputError
from spaceplane.flow import adapt
from spaceplane.flow.freestream import direction
from spaceplane.flow.solution import ConvergenceRecord, Solution
from spaceplane.mesh.settings import MeshSettings
from spaceplane.pipeline import AnalyseSettings, analyse
from spaceplane.report import record
from spaceplane.study.keys import result_key
from spaceplane.study.shapes import case_inputs
from spaceplane.vehicle.controls import CONTROLS, ControlDeflections
from spaceplane.vehicle.presets import horus_2b

INVISCID = IncrementSettings()
SETTINGS = AnalyseSettings(mach=(1.5, 2.5), mesh=MeshSettings(wall_cell=0.6, far_field=1.0), increments=INVISCID)


def newtonian(failing=(), oscillating=()):
    """A stand-in for `solve`: Cp = 2 cos^2 on wall that the wind sees, 0 elsewhere; some conditions do not converge."""

    def solve(mesh, conditions, settings=None, progress=None):
        normal = mesh.wall_area / np.linalg.norm(mesh.wall_area, axis=1)[:, None]
        # The wall of a turning body moves into the air.
        turned = np.cross(mesh.wall_center - conditions.center, normal) @ conditions.angular_velocity().T
        wind = direction(conditions.alpha, conditions.beta)
        met = normal @ wind.T - turned / conditions.mach
        cp = 2.0 * np.clip(met, 0.0, 1.0) ** 2 + 0.01 * conditions.mach
        pressure = 1.0 / conditions.gamma + cp * 0.5 * conditions.mach**2
        records = []
        for i in range(len(conditions)):
            verdict = "failed" if i in failing else "oscillating" if i in oscillating else "converged"
            history = np.zeros((12, 3))
            reason = "" if verdict == "converged" else "made to fail" if i in failing else "made to swing"
            records.append(ConvergenceRecord(verdict, 3.0, 12, np.zeros(12), history, history[0], history[0], reason))
        state = np.ones((mesh.cells, 5, len(conditions)), np.float32)
        state[:, 1:4] = wind.T
        state[:, 4] = 1.0 / conditions.gamma
        statistics = {"seconds": 0.1, "precision": "single"}
        return Solution(mesh, conditions, state, pressure, tuple(records), statistics)

    return solve


@pytest.fixture(scope="module")
def analysis():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bodies, "solve", newtonian())
        heard = []
        found = analyse(horus_2b(), SETTINGS, lambda *told: heard.append(told))
    assert {told[0] for told in heard} >= {"base: mesh", "elevon_left +10 deg: mesh", "flight dynamics"}
    return found


@pytest.fixture(scope="module")
def written(analysis, tmp_path_factory):
    folder = tmp_path_factory.mktemp("out")
    return pipeline.write(analysis, folder), folder


def no_constant(text):
    raise AssertionError(f"{text} in JSON")


def test_result_holds_the_whole_chain(written):
    paths, _ = written
    result = json.loads(paths["result.json"].read_text(encoding="utf-8"), parse_constant=no_constant)
    assert (result["schema"], result["schema_version"]) == ("spaceplane.result", 1)
    assert [p["name"] for p in result["flight_points"]] == ["Mach 1.5", "Mach 2.5"]
    assert result["vehicle"]["deflections_deg"]["body_flap"] == pytest.approx(-20.0)
    along = result["mode_branches"]
    assert along["flight_points"] == ["Mach 1.5", "Mach 2.5"] and along["reasons"] == []
    for k, point in zip((0, -1), result["flight_points"], strict=True):
        own = sorted(np.linalg.eigvals(point["A"]), key=lambda z: (round(z.real, 6), z.imag))
        row = sorted((complex(*z) for z in along["eigenvalues"][k]), key=lambda z: (round(z.real, 6), z.imag))
        assert np.allclose(row, own, rtol=1e-6, atol=1e-8)
    assert "The modes followed through Mach 1.5, Mach 2.5" in paths["report.html"].read_text(encoding="utf-8")
    for point in result["flight_points"]:
        assert point["alpha_source"]
        assert np.shape(point["A"]) == (9, 9)
        assert np.shape(point["B"])[0] == 9
        assert {"elevon_left", "body_flap"} <= set(point["inputs"])
        assert point["modes"] and point["verdicts"] and point["airframe_verdicts"]
        for verdict in (*point["verdicts"], *point["airframe_verdicts"]):
            assert sum(verdict["probabilities"].values()) == pytest.approx(1.0)
        assert all(min(mode["eigenvalue_error"]) >= 0 and mode["drivers"] for mode in point["modes"])
        control = point["control"]
        assert control["surfaces"] == ["elevator", "aileron", "rudder"] and not control["thrusters"]
        growing = any(mode["eigenvalue"][0] > 0 for mode in point["modes"])
        assert bool(np.any(control["gain"])) == growing  # a stable vehicle needs no feedback
        closed = [mode["eigenvalue"][0] for mode in control["closed_loop"]["modes"]]
        assert len(control["responses"]) == 5 and max(closed) <= 0.0
        parts = point["coefficients_by_part"]
        for name in ("CL", "CD", "CY", "Cl", "Cm", "Cn"):
            total = point["coefficients"][name]
            assert sum(part[name] for part in parts.values()) == pytest.approx(total, abs=1e-12)
        assert point["coefficients"]["L_over_D"] == pytest.approx(total_ratio(point))
        whole = {"CL", "CD", "CY", "Cl", "Cm", "Cn", "CA", "CN", "CA_forebody", "CA_base"}
        assert set(point["coefficient_errors"]) == {*whole, "L_over_D"}
        sources = point["coefficient_errors_by_source"]
        assert all(error == 0.0 for error in sources["iteration"].values())  # nothing wanders in this flow
        assert {name: point["coefficient_errors"][name] for name in whole} == pytest.approx(sources["mesh"])
        for name in ("CL", "CD", "Cm"):
            assert 0.0 < sources["mesh"][name] < 0.4 * abs(point["coefficients"]["CN"])
        for name in ("CY", "Cl", "Cn"):
            assert sources["mesh"][name] < 1e-6  # zero by symmetry on both meshes
        labels = [row["label"] for row in point["convergence"]]
        assert labels[:6] == ["base", "alpha+", "alpha-", "mach+", "mach-", "beta"]
        assert labels[6:10] == ["p", "q+", "q-", "r"]
        assert labels[10:] == ["elevon_left +10 deg", "rudder_left +10 deg", "body_flap +10 deg"]
    assert math.isclose(result["flight_points"][1]["alpha_deg"], 16.6)


def total_ratio(point):
    return point["coefficients"]["CL"] / point["coefficients"]["CD"]


def test_derivatives_are_those_of_the_impact_method(written, analysis):
    """Against a finer central difference of the same impact method on the surface's own triangles."""
    surface, reference = analysis.body.surface, analysis.vehicle.reference
    step = 1e-4
    alpha = analysis.points[1].point.alpha

    def lift(angle):
        wind = direction(angle, 0.0)
        area = np.linalg.norm(surface.area_vectors, axis=1)
        normal = -surface.area_vectors / np.maximum(area, 1e-300)[:, None]
        cp = 2.0 * np.clip(normal @ wind, 0.0, 1.0) ** 2
        force = (cp[:, None] * -surface.area_vectors).sum(axis=0) / reference.area
        return force @ [-np.sin(angle), 0.0, np.cos(angle)]

    exact = (lift(alpha + step) - lift(alpha - step)) / (2 * step)
    found = float(analysis.derivatives.CL_alpha.sel(part="total")[1])
    assert found == pytest.approx(exact, rel=0.05)  # wall faces of 0.6 m average the normals


def test_derivatives_state_what_the_mesh_and_the_step_do_to_them(written, analysis):
    paths, _ = written
    result = json.loads(paths["result.json"].read_text(encoding="utf-8"))
    assert result["uncertainty"]["sources"] == ["iteration", "mesh"]
    assert result["uncertainty"]["wall_cell_m"] == pytest.approx(2.0 * result["mesh"]["wall_cell_m"])
    assert result["uncertainty"]["cells"] < 0.6 * result["mesh"]["cells"]
    assert any("companion" in phase for phase in result["solver"]["seconds_by_phase"])
    for point in result["flight_points"]:
        for name in ("CL_alpha", "Cm_alpha", "CY_beta", "Cl_p", "Cm_q", "CL_elevon_left"):
            found = point["derivatives"][name]
            step, mesh = found["error_by_source"]["difference"], found["error_by_source"]["mesh"]
            assert mesh > 0.0 and found["error"] == pytest.approx(math.hypot(step, mesh)), name
    base, moved = analysis.coefficients, analysis.control_runs[0].coefficients
    for data in (base, moved):
        error = data.CL_mesh_error
        assert error.dims == ("condition",) and error.attrs["units"] == "1" and (error > 0.0).all()
    page = paths["report.html"].read_text(encoding="utf-8")
    assert "coarser companion mesh" in page


def test_without_the_companion_mesh_errors_are_those_of_iteration_and_step(monkeypatch, analysis):
    monkeypatch.setattr(bodies, "solve", newtonian())
    found = analyse(horus_2b(), replace(SETTINGS, mach=(2.5,), controls=False, uncertainty="iteration"))
    assert found.aerodynamics.companion is None and not any("companion" in phase for phase in found.seconds())
    result = record.result(found)
    assert result["uncertainty"] == {"sources": ["iteration"]}
    (point,) = result["flight_points"]
    assert set(point["coefficient_errors_by_source"]) == {"iteration"}
    # errors of iteration and step alone would call levels certain that are not
    assert not any(verdict["probabilities"] for verdict in (*point["verdicts"], *point["airframe_verdicts"]))
    assert set(point["coefficient_errors"].values()) == {0.0}
    both = analysis.derivatives.isel(point=1)
    for name in ("CL_alpha", "Cn_beta"):
        assert point["derivatives"][name]["error"] == pytest.approx(float(both[f"{name}_step_error"]))
        assert set(point["derivatives"][name]["error_by_source"]) == {"difference"}
    with pytest.raises(InputError, match="uncertainty = 'mash': allowed are mesh, iteration"):
        replace(SETTINGS, uncertainty="mash")


def test_a_failed_companion_leaves_the_error_open_and_says_so(monkeypatch):
    """The fine mesh is solved first: what fails after it is the companion."""
    calls = []

    def solve(*args):
        calls.append(args)
        return newtonian(failing={0} if len(calls) == 2 else ())(*args)

    monkeypatch.setattr(bodies, "solve", solve)
    found = analyse(horus_2b(), replace(SETTINGS, mach=(2.5,), controls=False))
    (point,) = record.result(found)["flight_points"]
    assert point["coefficients"]["CL"] is not None and point["coefficient_errors"]["CL"] is None
    assert point["modes"] and all(row["verdict"] == "converged" for row in point["convergence"])
    assert any(line.startswith("companion mesh: 1 of 10 conditions did not converge") for line in found.warnings)


def test_an_accuracy_chooses_the_mesh_and_is_judged_on_it(monkeypatch):
    monkeypatch.setattr(bodies, "solve", newtonian())
    monkeypatch.setattr(aerodynamics, "solve", newtonian())
    mesh = MeshSettings(far_field=1.0, target_cells=45_000)
    settings = AnalyseSettings(mach=(2.5,), controls=False, mesh=mesh, increments=INVISCID, accuracy=0.3)
    found = analyse(horus_2b(), settings)
    result = record.result(found)
    asked = result["accuracy"]
    assert asked["met"] and asked["reached"] <= 0.3 and asked["needed_cells"] is None
    assert [one["reached"] is None for one in asked["meshes"]] == [True] + [False] * (len(asked["meshes"]) - 1)
    assert result["mesh"]["wall_cell_m"] == pytest.approx(asked["meshes"][-1]["wall_cell"])
    assert result["mesh"]["cells"] == asked["meshes"][-1]["cells"] <= 45_000
    assert result["settings"]["accuracy"] == 0.3 and result["settings"]["mesh"]["target_cells"] == 45_000
    (point,) = result["flight_points"]
    force = math.hypot(point["coefficients"]["CL"], point["coefficients"]["CD"])
    worst = max(point["coefficient_errors"][name] for name in ("CL", "CD", "Cm")) / force
    assert worst == pytest.approx(asked["reached"])
    missed = record.result(analyse(horus_2b(), replace(settings, accuracy=0.0005)))["accuracy"]
    assert not missed["met"] and missed["needed_cells"] > 45_000


@pytest.mark.parametrize(
    ("change", "naming"),
    [
        ({"accuracy": 1.0}, "accuracy = 1.0: allowed are 0.0005 to 0.5"),
        ({"accuracy": "1%"}, "accuracy"),
        ({"accuracy": 0.01, "uncertainty": "iteration"}, "accuracy = 0.01: needs uncertainty = 'mesh'"),
        ({"accuracy": 0.01, "mesh": {"wall_cell": 0.2}}, "mesh.wall_cell = 0.2: accuracy chooses it"),
    ],
)
def test_accuracies_that_no_analysis_has(change, naming):
    with pytest.raises(InputError, match=naming):
        AnalyseSettings.from_mapping(change)


def test_signs_of_control_derivatives_and_mirror_images(analysis):
    slopes = analysis.derivatives.sel(part="total")
    at = {
        name: float(slopes[name][1])
        for name in slopes.data_vars
        if name.count("_") >= 2 and "error" not in name and "step" not in name and "status" not in name
    }
    assert at["CL_elevon_left"] > 0.0
    assert at["Cm_elevon_left"] < 0.0
    assert at["Cl_elevon_left"] > 0.0  # left elevon down rolls right wing down
    assert at["Cm_body_flap"] < 0.0
    assert abs(at["Cl_body_flap"]) < 1e-6
    for name in ("CL", "CD", "CY", "Cl", "Cm", "Cn"):
        sign = -1.0 if name in ("CY", "Cl", "Cn") else 1.0
        assert at[f"{name}_elevon_right"] == pytest.approx(sign * at[f"{name}_elevon_left"], abs=1e-12)
        assert at[f"{name}_rudder_right"] == pytest.approx(sign * at[f"{name}_rudder_left"], abs=1e-12)


def test_damping_derivatives_damp_and_reach_the_equations(written, analysis):
    """Signs that hold for any body behind and beside its moment centre in impact flow, and their place in A."""
    slopes = analysis.derivatives.sel(part="total")
    for name in ("Cl_p", "Cm_q", "Cn_r"):
        assert (slopes[name] < 0.0).all(), name
    paths, _ = written
    result = json.loads(paths["result.json"].read_text(encoding="utf-8"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bodies, "solve", newtonian())
        still = analyse(horus_2b(), replace(SETTINGS, mach=(2.5,), controls=False, steps=DerivativeSteps(rate=0.0)))
    assert "Cm_q" not in still.derivatives
    states = list(still.points[0].system.states)
    q = states.index("q")
    turning, without = np.array(result["flight_points"][1]["A"]), still.points[0].system.A
    assert turning[q, q] < without[q, q] - 1e-3


def test_files_read_back(written, analysis):
    paths, folder = written
    assert sorted(p.name for p in folder.iterdir()) == sorted(paths)
    body = pyvista.read(paths["surface.vtp"])
    assert {"Cp_Mach 1.5", "Cp_Mach 2.5", "part"} <= set(body.cell_data)
    database = AeroDatabase.load(paths["aero.nc"]).data
    assert list(database.point.values) == ["Mach 1.5", "Mach 2.5"]
    assert database.sizes["case"] == 20 + 3 * 2
    moved = database.sel(case=database.label == "elevon_left +10 deg")
    np.testing.assert_allclose(np.degrees(moved.elevon_left), -7.5)
    assert "Mach 2.5" in paths["report.html"].read_text(encoding="utf-8")


def test_asymmetric_deflections_solve_every_surface_and_both_sideslips(monkeypatch):
    monkeypatch.setattr(bodies, "solve", newtonian())
    deflections = ControlDeflections.from_degrees(elevon_left=-10.0, elevon_right=10.0)
    settings = AnalyseSettings(mach=(2.5,), deflections=deflections, mesh=SETTINGS.mesh)
    found = analyse(horus_2b(), settings)
    assert [run.surface for run in found.control_runs] == list(CONTROLS)
    assert found.plan.labels[5:] == ("beta+", "beta-", "p+", "p-", "q+", "q-", "r+", "r-")
    assert abs(float(found.coefficients.Cl.sel(part="total")[0])) > 1e-3


def test_two_step_sizes_halve_every_step_and_shrink_the_truncation_error(monkeypatch, analysis):
    monkeypatch.setattr(bodies, "solve", newtonian())
    steps = replace(SETTINGS.steps, two_step_sizes=True)
    found = analyse(horus_2b(), replace(SETTINGS, mach=(2.5,), steps=steps))
    assert len(found.plan.conditions) == 1 + 2 * 9
    halves = [math.degrees(run.step) for run in found.control_runs]
    assert halves == pytest.approx([10.0, 5.0] * 3)
    one, two = (data.derivatives.sel(part="total").isel(point=-1) for data in (analysis, found))
    for name in ("CL_alpha", "CD_alpha", "CD_M", "CY_beta"):
        assert float(two[name]) == pytest.approx(float(one[name]), rel=0.05)
    assert float(two.CD_alpha_step_error) < 0.1 * float(one.CD_alpha_step_error)


def test_a_failed_condition_poisons_what_rests_on_it_and_says_so(monkeypatch, tmp_path):
    monkeypatch.setattr(bodies, "solve", newtonian(failing={1, 10}))  # Mach 1.5 alpha+, Mach 2.5 base
    settings = AnalyseSettings(mach=(1.5, 2.5), controls=False, mesh=SETTINGS.mesh)
    found = analyse(horus_2b(), settings)
    paths = pipeline.write(found, tmp_path)
    result = json.loads(paths["result.json"].read_text(encoding="utf-8"), parse_constant=no_constant)
    first, second = result["flight_points"]
    assert first["derivatives"]["CL_alpha"]["value"] is None
    assert first["derivatives"]["CL_alpha"]["status"] == "failed"
    assert first["derivatives"]["CY_beta"]["value"] is not None
    assert (first["A"], first["modes"]) == (None, [])
    assert second["coefficients"]["CL"] is None
    assert second["coefficient_errors"]["Cm"] is None
    assert second["equilibrium"]["p_rads"] is None
    text = "\n".join(result["warnings"])
    assert "Mach 1.5, condition alpha+: failed: made to fail" in text
    assert "CL_alpha" in text
    assert "Mach 2.5: the flow of the base condition failed" in text


def test_modes_on_an_oscillating_condition_are_shown_with_a_warning(monkeypatch):
    monkeypatch.setattr(bodies, "solve", newtonian(oscillating={3}))  # mach+
    found = analyse(horus_2b(), AnalyseSettings(mach=(2.5,), controls=False, mesh=SETTINGS.mesh))
    assert found.points[0].modes
    assert "Mach 2.5, condition mach+: oscillating: made to swing" in found.warnings
    assert any("rest on CD_M, CL_M, Cm_M" in line for line in found.warnings)


def test_an_unwritable_folder_is_found_before_anything_is_computed(monkeypatch, tmp_path):
    def never(*_, **__):
        raise AssertionError("computed all the same")

    monkeypatch.setattr(bodies, "solve", never)
    monkeypatch.setattr(bodies, "generate", never)
    (tmp_path / "file").write_text("here")
    with pytest.raises(InputError, match="file"):
        pipeline.run(horus_2b(), SETTINGS, tmp_path / "file" / "out")


def test_increments_travel_through_coefficients_derivatives_and_files(monkeypatch, analysis, tmp_path):
    """Totals are the sums of their sources; thinner air has more friction; control derivatives have it too."""
    monkeypatch.setattr(bodies, "solve", newtonian())
    increments = IncrementSettings(friction="turbulent", base="correlation")
    found = analyse(horus_2b(), replace(SETTINGS, increments=increments))
    drag = float(found.coefficients.CD.sel(part="total")[10])
    assert drag == pytest.approx(found.points[1].point.CD)
    paths = pipeline.write(found, tmp_path)
    result = json.loads(paths["result.json"].read_text(encoding="utf-8"), parse_constant=no_constant)
    for point, plain in zip(result["flight_points"], record.result(analysis)["flight_points"], strict=True):
        sources = point["coefficients_by_source"]
        assert list(sources) == ["inviscid", "friction", "base"]
        assert list(plain["coefficients_by_source"]) == ["inviscid"]
        for name, value in sources["inviscid"].items():
            assert value == pytest.approx(plain["coefficients"][name], abs=1e-12)
            assert sum(s[name] for s in sources.values()) == pytest.approx(point["coefficients"][name], abs=1e-12)
            if name not in ("CA", "CN"):
                parts = sum(part[name] for part in point["coefficients_by_part"].values())
                assert parts == pytest.approx(point["coefficients"][name], abs=1e-12)
        assert 0.001 < sources["friction"]["CD"] < 0.02
        pressure = point["coefficients"]["CA_forebody"] + point["coefficients"]["CA_base"]
        assert pressure + sources["friction"]["CA"] == pytest.approx(point["coefficients"]["CA"])
    database = AeroDatabase.load(paths["aero.nc"]).data
    assert list(database.source.values) == ["inviscid", "friction", "base"]
    assert database.CD_by_source.dims == ("case", "part", "source")
    assert {"units", "axes", "positive", "reference"} <= set(database.CD_by_source.attrs)
    moved = [float(d.derivatives.CD_elevon_left.sel(part="total")[1]) for d in (analysis, found)]
    assert moved[0] != moved[1]
    page = paths["report.html"].read_text(encoding="utf-8")
    assert "turbulent skin friction (adiabatic wall) and base pressure by correlation" in page
    assert page.count("of skin friction") >= 3


def test_friction_grows_with_altitude(monkeypatch, analysis):
    monkeypatch.setattr(bodies, "solve", newtonian())
    monkeypatch.setattr(bodies, "build", lambda *_: analysis.body.surface)
    monkeypatch.setattr(bodies, "generate", lambda *_: analysis.body.solution.mesh)
    drags = []
    for altitude in (20_000.0, 40_000.0):
        increments = IncrementSettings(friction="turbulent")
        settings = AnalyseSettings(
            mach=(2.5,), altitude_m=(altitude,), controls=False, mesh=SETTINGS.mesh, increments=increments
        )
        (point,) = record.result(analyse(horus_2b(), settings))["flight_points"]
        drags.append(point["coefficients_by_source"]["friction"]["CD"])
    assert 1.3 < drags[1] / drags[0] < 2.0


def test_yaml_s_off_is_the_word():
    read = AnalyseSettings.from_mapping({"increments": {"friction": False}})
    assert read.increments == IncrementSettings(base="correlation")


@pytest.mark.parametrize(
    ("change", "moved"),
    [
        ({"alpha_deg": (12.0,)}, lambda r: r["coefficients"]["CL"]),
        ({"altitude_m": (30_000.0,)}, lambda r: r["dynamic_pressure_Pa"]),
        ({"gamma_deg": (-15.0,)}, lambda r: r["A"]),
        ({"bank_deg": (0.0,)}, lambda r: r["equilibrium"]),
        ({"form": "thesis"}, lambda r: r["A"]),
        ({"vehicle_class": "IV"}, lambda r: [v["vehicle_class"] for v in r["verdicts"]]),
        ({"category": "C"}, lambda r: [v["category"] for v in r["verdicts"]]),
        ({"increments": IncrementSettings(friction="laminar")}, lambda r: r["coefficients"]["CD"]),
        (
            {"increments": IncrementSettings("turbulent", transition_reynolds=1e6, wall_temperature_K=400.0)},
            lambda r: r["coefficients"]["CD"],
        ),
        ({"increments": IncrementSettings()}, lambda r: r["coefficients"]["CA_base"]),
        ({"steps": DerivativeSteps(alpha=0.05)}, lambda r: r["derivatives"]["CL_alpha"]["value"]),
        ({"steps": DerivativeSteps(beta=0.1)}, lambda r: r["derivatives"]["CY_beta"]["value"]),
        ({"steps": DerivativeSteps(mach_fraction=0.1)}, lambda r: r["derivatives"]["CL_M"]["step"]),
        ({"feedback": FeedbackSettings(decay=1.0)}, lambda r: r["control"]["gain"]),
        ({"feedback": FeedbackSettings(gust=20.0)}, lambda r: r["control"]["responses"][2]["open"]["alpha"]),
        ({"feedback": FeedbackSettings(offset=0.1)}, lambda r: r["control"]["responses"][0]["open"]["alpha"]),
    ],
)
def test_every_setting_moves_what_it_should(monkeypatch, analysis, change, moved):
    monkeypatch.setattr(bodies, "solve", newtonian())
    monkeypatch.setattr(bodies, "build", lambda *_: analysis.body.surface)
    monkeypatch.setattr(bodies, "generate", lambda *_: analysis.body.solution.mesh)
    settings = AnalyseSettings(mach=(2.5,), controls=False, mesh=SETTINGS.mesh)
    before, after = (
        record.result(analyse(horus_2b(), s))["flight_points"][0] for s in (settings, replace(settings, **change))
    )
    assert moved(before) != moved(after)


def test_settings_survive_a_round_trip_through_plain_values():
    settings = AnalyseSettings.from_mapping(
        {
            "mach": [2.5, 5],
            "alpha_deg": [16, 20],
            "deflections": {"body_flap": 0},
            "control_step_deg": 4,
            "steps": {"alpha_deg": 0.5, "two_step_sizes": True},
            "mesh": {
                "wall_cell": 0.3,
                "target_cells": None,
                "domain": [[-50, -50, -50], [100, 50, 50]],
                "boxes": [{"lower": [0, -1, -1], "upper": [5, 1, 1], "cell": 0.2}],
                "frustums": [
                    {
                        "start": [0, 0, 0],
                        "end": [5, 0, 1],
                        "start_radius": 0,
                        "end_radius": 2,
                        "cell": 0.2,
                        "end_hole": 1,
                    }
                ],
                "fine_parts": ["wing"],
            },
            "flow": {"precision": "double"},
            "increments": {"friction": "turbulent", "base": "correlation", "wall_temperature_K": 800},
            "feedback": {"gust": 15, "offset_deg": 2, "decay": 0.3},
        }
    )
    assert settings.feedback.offset == pytest.approx(math.radians(2.0))
    assert settings.steps.alpha == pytest.approx(math.radians(0.5))
    assert settings.control_step == pytest.approx(math.radians(4.0))
    assert settings.deflections.elevon_left == pytest.approx(math.radians(-17.5))
    again = AnalyseSettings.from_mapping(json.loads(json.dumps(settings.as_dict())))
    assert again.deflections.to_degrees() == pytest.approx(settings.deflections.to_degrees())
    assert replace(again, deflections=settings.deflections) == settings


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"mch": [2]}, "did you mean 'mach'"),
        ({"mesh": {"wall_cel": 1.0}}, r"mesh\.wall_cel"),
        ({"mesh": 3}, "mesh"),
        ({"mesh": {"domain": [[0, 0, 0], [1, 1]]}}, r"mesh\.domain.*upper corner"),
        ({"mesh": {"boxes": [{"lower": [0, 0, 0]}]}}, r"mesh\.boxes.*upper"),
        ({"mesh": {"frustums": [{"start": [0, 0, 0]}]}}, r"mesh\.frustums.*end_radius"),
        ({"mesh": {"frustums": [{"begin": [0, 0, 0]}]}}, r"mesh\.frustums\.begin"),
        ({"mesh": {"frustums": 3}}, r"mesh\.frustums = 3"),
        ({"mesh": {"fine_parts": "wing"}}, r"mesh\.fine_parts"),
        ({"mach": ["fast"]}, "mach"),
        ({"mach": [-1.0]}, "mach = -1"),
        ({"mach": []}, "mach"),
        ({"alpha_deg": [1.0]}, "alpha_deg"),
        ({"flow": {"precision": "half"}}, "precision"),
        ({"steps": {"alpha_deg": 0}}, "alpha"),
        ({"form": "magic"}, "form"),
        ({"increments": {"friction": "on"}}, "friction = 'on': allowed are off, laminar, turbulent"),
        ({"increments": {"friction": 3}}, r"increments\.friction = 3: a word"),
        ({"increments": {"base": False}}, r"increments\.base = False"),
        ({"increments": {"wall_temperature": 300}}, "did you mean 'increments.wall_temperature_K'"),
        ({"increments": {"friction": "laminar", "wall_temperature_K": -3}}, "wall_temperature_K = -3"),
        ({"increments": "turbulent"}, "increments"),
        ({"vehicle_class": "V"}, "vehicle_class"),
        ({"feedback": {"gust": 0}}, "gust = 0 m/s"),
        ({"feedback": {"gusts": 3}}, "did you mean 'feedback.gust'"),
        ({"feedback": {"offset_deg": 30}}, "offset = 30 deg"),
        ({"feedback": 3}, "feedback"),
        ({"control_step": 0.0}, "control_step"),
        ({"deflections": {"elevon": 3}}, "elevon"),
        ({"deflections": {"body_flap": -30}}, "body_flap"),
    ],
)
def test_bad_settings_are_named(values, message):
    with pytest.raises(InputError, match=message):
        AnalyseSettings.from_mapping(values)


def test_flight_points_beyond_the_tables_need_altitude_and_alpha():
    with pytest.raises(InputError, match="give the value"):
        AnalyseSettings(mach=(0.3,)).flight_points()
    (point,) = AnalyseSettings(mach=(0.3,), altitude_m=(2000.0,), alpha_deg=(8.0,)).flight_points()
    assert point.alpha_source == "given"
    with pytest.raises(InputError, match="twice"):
        AnalyseSettings(mach=(2.5, 2.5)).flight_points()
    two = AnalyseSettings(mach=(2.5, 2.5), alpha_deg=(10.0, 12.0)).flight_points()
    assert len({p.name for p in two}) == 2


def test_the_command_line_asks_for_the_increments_of_the_settings():
    import inspect

    from spaceplane.commands.analyse import analyse as command

    given = inspect.signature(command).parameters
    assert (given["friction"].default, given["base"].default) == (VISCOUS.friction, VISCOUS.base)
    assert AnalyseSettings().increments == VISCOUS


def near_the_nose(mesh, conditions, settings=None, progress=None):
    """The impact method's flow with a bump of pressure at the nose."""
    solution = newtonian()(mesh, conditions, settings, progress)
    away = np.linalg.norm(mesh.cell_center - [0.0, 0.0, -0.5], axis=1)
    solution.state[:, 4] *= 1.0 + np.exp(-((away / 2.0) ** 2))[:, None]
    return solution


def test_the_mesh_follows_the_flow_when_asked(monkeypatch):
    """Base mesh, its companion and those of moved surfaces have cells of the adapted sizes; the record tells them."""
    for place in (bodies, adapt):
        monkeypatch.setattr(place, "solve", near_the_nose)
    mesh = MeshSettings(target_cells=20_000, far_field=1.0)
    found = analyse(horus_2b(), replace(SETTINGS, mach=(2.5,), mesh=mesh, adapt=1))
    cells = found.aerodynamics.adapted.cells
    assert len(cells) == 2 and cells[1] == found.body.solution.mesh.cells == pytest.approx(20_000, rel=0.15)
    made = found.body.solution.mesh
    near = np.linalg.norm(made.wall_center - [0.0, 0.0, -0.5], axis=1) < 1.5
    size = made.cell_size[made.wall_cell]
    assert size[near].max() < 0.6 * size[~near].max()
    companion = found.aerodynamics.companion
    assert companion.wall_cell == pytest.approx(2.0 * made.record["wall_cell_m"])
    assert companion.cells < 0.5 * made.cells
    assert all(run.cells == pytest.approx(made.cells, rel=0.1) for run in found.control_runs)
    told = record.result(found)
    assert told["mesh"]["adaptation"] == {"passes": 1, "cells": list(cells)}
    assert told["settings"]["adapt"] == 1 and "flow (adaptation)" in told["solver"]["seconds_by_phase"]


def test_a_stored_result_is_not_taken_for_one_on_another_kind_of_mesh():
    """Passes are part of the key; a study that resumes finds the same key again."""
    settings = {"mesh": {"target_cells": 20_000}}
    inputs = [case_inputs("horus-2b", {}, [2.5], {**settings, "adapt": passes}) for passes in (0, 1, 2, 1)]
    keys = [result_key(one, "code") for one in inputs]
    assert len(set(keys)) == 3 and keys[1] == keys[3]
    assert AnalyseSettings.from_mapping(inputs[1]["settings"]).adapt == 1


@pytest.mark.parametrize(
    ("change", "naming"),
    [
        ({"adapt": 1}, "target_cells"),
        ({"adapt": 4, "mesh": {"target_cells": 20_000}}, "adapt: 4"),
        ({"adapt": 1, "mesh": {"target_cells": 20_000}, "accuracy": 0.05}, "accuracy"),
    ],
)
def test_adaptations_that_no_analysis_has(change, naming):
    with pytest.raises(InputError, match=naming):
        AnalyseSettings.from_mapping(change)
