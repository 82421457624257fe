"""Tables from our own flow: nodes, slopes and increments by an independent route, signs, what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spaceplane.aero.conditions import product, turning
from spaceplane.aero.flow_case import run_flow
from spaceplane.aero.free_streams import FreeStreams
from spaceplane.aero.inclination.case import run_inclination
from spaceplane.aero.inclination.solve import local_inclination
from spaceplane.aero.increments.settings import VISCOUS, IncrementSettings
from spaceplane.aero.model.model import SLOPES, OutsideTables
from spaceplane.analysis.tables.assemble import model_of, remarks
from spaceplane.analysis.tables.settings import TableSettings, default_settings
from spaceplane.analysis.tables.solve import blocks, evaluate, inputs_of
from spaceplane.environment.atmosphere import us1976
from spaceplane.errors import InputError
from spaceplane.flow.settings import FlowSettings
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import CONTROLS, ControlDeflections

from .databases import ALPHAS_DEG, DEFLECTIONS_DEG, MACHS, VEHICLE, radians, small_model, small_results, small_settings

REFERENCE = VEHICLE.reference
CRUDE = MeshSettings(wall_cell=0.7, growth_layers=1, fine_edges=True)


def total(data, name):
    return data[name].sel(part="total").values


@pytest.mark.parametrize(("i", "j"), [(0, 0), (1, 2), (2, 1)])
def test_a_node_is_what_flow_says_of_that_condition(i, j):
    model = small_model()
    alpha = math.radians(ALPHAS_DEG[i])
    direct = run_inclination(build(VEHICLE.shape), [MACHS[j]], [alpha], [0.0], REFERENCE).records[0]
    found = model.coefficients(MACHS[j], alpha)
    for name in ("CL", "CD", "Cm"):
        assert found[name] == pytest.approx(direct[name], rel=1e-9, abs=1e-12)


def test_slopes_are_differences_of_the_whole_vehicle_on_both_sides():
    """The tables mirror one side; here both sides are computed."""
    model, mach, alpha = small_model(), MACHS[1], math.radians(ALPHAS_DEG[1])
    body, settings = build(VEHICLE.shape), small_settings()
    for quantity, step in (("beta", settings.steps.beta), ("p", 0.01), ("q", 0.01), ("r", 0.01)):
        sides = []
        for sign in (1.0, -1.0):
            streams = product([mach], [alpha], [sign * step if quantity == "beta" else 0.0])
            if quantity != "beta":
                reduced = np.zeros((1, 3))
                reduced[0, "pqr".index(quantity)] = sign * step
                streams = turning(streams, reduced, REFERENCE)
            sides.append(local_inclination(body, streams, REFERENCE))
        for name in (name for name in SLOPES if name.endswith(f"_{quantity}")):
            first, second = (total(side, name.split("_")[0])[0] for side in sides)
            assert model.slopes[name][1, 1] == pytest.approx((first - second) / (2.0 * step), rel=1e-6, abs=1e-9), name


@pytest.mark.parametrize("surface", CONTROLS)
def test_increments_of_each_side_are_those_of_a_body_deflected_there(surface):
    """The tables mirror the left ones; here the right ones are built and computed too."""
    model, mach, alpha = small_model(), MACHS[0], math.radians(ALPHAS_DEG[2])
    deflection = model.surfaces[surface].deflection[-1]
    streams = product([mach], [alpha], [0.0])
    moved, still = (
        local_inclination(build(VEHICLE.shape, ControlDeflections(**{surface: d})), streams, REFERENCE)
        for d in (deflection, 0.0)
    )
    found = model.coefficients(mach, alpha, deflections={surface: deflection})
    for name, value in found.items():
        base = model.coefficients(mach, alpha)[name]
        direct = total(moved, name)[0] - total(still, name)[0]
        # Panels on the two sides are cut differently where shadows fall.
        assert value - base == pytest.approx(direct, rel=0.02, abs=3e-5), name


def test_every_surface_has_the_right_sign():
    model, mach, alpha = small_model(), 6.0, math.radians(20.0)

    def by(**deflections_deg):
        moved = model.coefficients(mach, alpha, deflections={k: math.radians(v) for k, v in deflections_deg.items()})
        still = model.coefficients(mach, alpha)
        return {name: moved[name] - still[name] for name in still}

    down, up = (by(elevon_left=d, elevon_right=d) for d in (20.0, -20.0))
    assert down["Cm"] < -1e-3 < 1e-3 < up["Cm"] and down["CL"] > 1e-3 > -1e-3 > up["CL"]
    assert all(abs(down[name]) < 1e-12 for name in ("CY", "Cl", "Cn"))
    aileron = by(elevon_left=20.0, elevon_right=-20.0)
    assert aileron["Cl"] > 1e-3
    flap = by(body_flap=15.0)
    assert flap["Cm"] < -1e-3 and by(body_flap=-15.0)["Cm"] > 1e-3 and flap["Cl"] == 0.0
    rudder = by(rudder_left=30.0)
    assert rudder["CY"] > 1e-3 and rudder["Cn"] < -1e-3 and by(rudder_right=30.0)["Cn"] > 1e-3
    assert rudder["CD"] > 1e-3


def test_nothing_is_unknown_and_the_source_says_what_was_done():
    model = small_model()
    assert model.unknown() == () and set(model.surfaces) == set(CONTROLS)
    for text in ("local inclination (newtonian-expansion)", "inviscid", "2 deg of sideslip", "mirrored"):
        assert text in model.source
    conditions = 9 * 6 + 9 * sum(len(values) for values in DEFLECTIONS_DEG.values())
    assert f"{conditions} of {conditions} conditions converged" in model.source


def test_what_failed_stays_empty_and_is_listed():
    settings, asked = small_settings(), blocks(small_settings())
    results = [dict(result) for result in small_results()]
    failed = {"label": "base", "mach": 6.0, "alpha_deg": 20.0, "verdict": "failed", "reason": "diverged"}
    names = ("CL", "CD", "CY", "Cl", "Cm", "Cn")
    hollow = [
        node | dict.fromkeys(names) | {"slopes": dict.fromkeys(SLOPES)}
        if (node["mach"], node["alpha_deg"]) == (6.0, 20.0)
        else node
        for node in results[0]["nodes"]
    ]
    results[0] |= {"nodes": hollow, "bad": [failed]}
    results[3] = None
    model = model_of(VEHICLE, settings, asked, results)
    listed = remarks(asked, results, ["", "", "", "no mesh", "", ""])
    assert [r.line for r in listed] == [
        "undeflected, Mach 3 to 12 at Mach 6, alpha 20 deg (base): failed: diverged",
        "rudder_left +30 deg, Mach 3 to 12: failed: no mesh",
    ]
    assert np.isnan(model.base["CL"]).sum() == 1 and np.isfinite(model.base["CL"][0]).all()
    with pytest.raises(OutsideTables, match="empty at Mach 6, alpha 20 deg"):
        model.coefficients(6.0, math.radians(20.0))
    assert np.isnan(model.surfaces["rudder_right"].increments["Cn"][1]).all()
    assert "1 of 6 blocks without result" in model.source
    with pytest.raises(InputError, match="undeflected vehicle has no result"):
        model_of(VEHICLE, settings, asked, [None] * len(asked))


def test_without_rates_damping_is_unknown():
    settings = replace(small_settings(), steps=replace(small_settings().steps, rate=0.0), deflections={})
    result = evaluate(inputs_of(VEHICLE, settings, blocks(settings)[0]))
    model = model_of(VEHICLE, settings, blocks(settings), [result])
    assert set(SLOPES) - set(model.slopes) == {n for n in SLOPES if not n.endswith("_beta")}
    assert "Cl_p" in model.unknown() and "Cm_body_flap" in model.unknown()


def euler(**given) -> TableSettings:
    return default_settings(
        "euler", machs=(2.5, 5.0), alphas=radians(10.0, 25.0), mesh=CRUDE, flow=FlowSettings(iterations=60), **given
    )


def test_an_euler_node_is_what_flow_says_of_that_condition():
    """Forces and friction by `flow` on the same mesh; there the conditions stand in another ensemble."""
    still = replace(small_settings().steps, rate=0.0)
    settings = euler(deflections={"elevon_left": radians(15.0)}, increments=VISCOUS, steps=still)
    asked = blocks(settings)
    assert [block.surface for block in asked] == ["", "elevon_left"]
    results = [evaluate(inputs_of(VEHICLE, settings, block)) for block in asked]
    model = model_of(VEHICLE, settings, asked, results)
    assert results[0]["conditions"] == 4 * 2 and results[1]["conditions"] == 4
    for mach, deflections in ((2.5, {}), (5.0, {"elevon_left": math.radians(15.0)})):
        body = build(VEHICLE.shape, ControlDeflections(**deflections))
        streams = FreeStreams((mach,), settings.alphas, increments=VISCOUS, ambient=us1976(settings.altitude(mach)))
        for record in run_flow(body, streams, REFERENCE, CRUDE, settings.flow).records:
            found = model.coefficients(mach, math.radians(record["alpha_deg"]), deflections=deflections)
            for name in ("CL", "CD", "Cm"):
                assert found[name] == pytest.approx(record[name], rel=2e-3, abs=2e-4), (name, record)
    assert (model.slopes["Cl_beta"] < 0.0).all() and (model.slopes["CY_beta"] < 0.0).all()
    elevator = model.surfaces["elevon_right"].increments
    assert (elevator["Cm"][1] < 0.0).all() and (elevator["Cl"][1] < 0.0).all()
    assert "turbulent skin friction and correlation base pressure added" in model.source


def test_friction_off_needs_no_air_and_on_needs_it():
    with pytest.raises(InputError, match=r"mach = 0\.5: the altitude table runs from Mach 0\.8"):
        default_settings("euler", machs=(0.5, 2.0))
    assert default_settings("euler", machs=(0.5, 2.0), altitude_m=9000.0).altitude(0.5) == 9000.0
    settings = default_settings("euler", machs=(0.5, 2.0), increments=IncrementSettings())
    assert not settings.needs_air and "altitude_m" in inputs_of(VEHICLE, settings, blocks(settings)[0])


@pytest.mark.parametrize(
    ("tier", "given", "naming"),
    [
        ("euler", {"machs": (2.0, 1.5)}, "mach = 2, 1.5: must increase"),
        ("euler", {"machs": (2.0, 2.0)}, "must increase"),
        ("euler", {"machs": (2.0,)}, "mach = 2: two or more"),
        ("euler", {"machs": ()}, "mach = nothing: two or more"),
        ("euler", {"machs": (0.0, 2.0)}, "mach = 0: must be above 0"),
        ("euler", {"machs": (2.0, math.nan)}, "mach = nan"),
        ("fast", {"machs": (1.5, 3.0)}, "mach = 1.5: local inclination needs Mach 2"),
        ("euler", {"alphas": radians(0.0, 95.0)}, "alpha = 95 deg: allowed -90 to 90 deg"),
        ("euler", {"alphas": radians(10.0, 5.0)}, "alpha = 10, 5 deg: must increase"),
        ("euler", {"alphas": ()}, "alpha = nothing"),
        ("slow", {}, "unknown tier 'slow'"),
        ("fast", {"method": "newton"}, "method 'newton'"),
        ("fast", {"deflections": {"elevon_left": radians(50.0)}}, "elevon_left = 50 deg: allowed -40 to 40"),
        ("fast", {"deflections": {"rudder_left": radians(-5.0)}}, "rudder_left = -5 deg: allowed 0 to 40"),
        ("fast", {"deflections": {"elevon_right": radians(5.0)}}, "control surface to move 'elevon_right'"),
        ("fast", {"deflections": {"elevon_left": radians(5.0, 5.0)}}, "5 deg: given twice"),
        ("fast", {"deflections": {"elevon_left": (0.0,)}}, "a deflection other than 0"),
        ("fast", {"deflections": {"elevon_left": (math.nan,)}}, "elevon_left = nan"),
    ],
)
def test_bad_grids_are_refused(tier, given, naming):
    with pytest.raises(InputError, match=naming.replace("(", r"\(")):
        default_settings(tier, **given)


def test_blocks_hold_what_an_interruption_may_cost():
    asked = blocks(default_settings("euler"))
    assert [b.label for b in asked[:3]] == [
        "undeflected, Mach 0.8 to 1.5",
        "undeflected, Mach 2.5 to 10",
        "undeflected, Mach 20",
    ]
    assert len(asked) == 3 + 6 + 2 + 3 and asked[3].label == "elevon_left -40 deg, Mach 0.8 to 20"
    assert len(blocks(default_settings("fast"))) == 1 + 8 + 4 + 5
