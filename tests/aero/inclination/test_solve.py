"""Bodies with closed forms, and HORUS-2B: symmetry, sums, flaps, derivatives."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from spaceplane.aero.conditions import DerivativeSteps, plan, product
from spaceplane.aero.derivatives import STABILITY, Move, by_symmetry, control_derivatives, differentiate
from spaceplane.aero.exact.conical import taylor_maccoll
from spaceplane.aero.exact.oblique import weak_shock_cp
from spaceplane.aero.exact.prandtl_meyer import expanded_cp
from spaceplane.aero.exact.stagnation import stagnation_cp
from spaceplane.aero.inclination.case import run_inclination
from spaceplane.aero.inclination.panels import panels_of
from spaceplane.aero.inclination.settings import METHODS, InclinationSettings, method
from spaceplane.aero.inclination.solve import local_inclination, pressures
from spaceplane.aero.integrate import COEFFICIENTS, PRESSURES, WITH_SPREAD, integrate, mirrored
from spaceplane.errors import InputError
from spaceplane.flow.solution import FlowConditions
from spaceplane.validation import bodies
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import CONTROLS, ControlDeflections
from spaceplane.vehicle.presets import horus_2b
from spaceplane.vehicle.properties import ReferenceLengths
from spaceplane.vehicle.surface import Surface

VEHICLE = horus_2b()
SPACING = 0.3  # m: a third of the triangles of the default shape


@dataclass(frozen=True)
class Point:
    mach: float = 6.0
    alpha: float = math.radians(25.0)
    beta: float = 0.0


def one(mach: float, alpha: float = 0.0, beta: float = 0.0):
    return product([mach], [alpha], [beta])


def total(data, name: str, condition: int = 0) -> float:
    return data[name].sel(part="total")[condition].item()


def plate(length=2.0, width=1.0, thickness=1e-3) -> Surface:
    """A thin box with the middle of its lower side at the origin."""
    x, y, z = (0.0, length), (-0.5 * width, 0.5 * width), (0.0, thickness)
    points = np.array([(a, b, c) for c in z for b in y for a in x])
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    return Surface(points, triangles, np.zeros(12, dtype=np.int32), ("plate",))


@pytest.mark.parametrize(("mach", "degrees"), [(2.5, 5.0), (5.0, 20.0), (12.0, 30.0)])
def test_a_flat_plate_has_an_oblique_shock_below_and_an_expansion_above(mach, degrees):
    alpha, body = math.radians(degrees), plate()
    assert body.volume > 0.0
    panels = panels_of(body, 0.5)
    cp = pressures(panels, one(mach, alpha), METHODS["tangent-wedge"])[:, 0]
    below, above = panels.normal[:, 2] < -0.9, panels.normal[:, 2] > 0.9
    shock, expansion = float(weak_shock_cp(mach, alpha)), float(expanded_cp(mach, alpha))
    np.testing.assert_allclose(cp[below], shock, rtol=1e-6)
    np.testing.assert_allclose(cp[above], expansion, atol=1e-7)
    data = local_inclination(
        body, one(mach, alpha), ReferenceLengths(2.0, 2.0, 1.0, (1.0, 0.0, 0.0)), METHODS["tangent"]
    )
    assert total(data, "CN") > 0.0 and total(data, "Cm") == pytest.approx(0.0, abs=1e-3)
    wedge = local_inclination(
        body, one(mach, alpha), ReferenceLengths(2.0, 2.0, 1.0, (0.0, 0.0, 0.0)), METHODS["tangent-wedge"]
    )
    assert total(wedge, "CN") == pytest.approx(shock - expansion, rel=1e-6)
    assert total(wedge, "Cm") == pytest.approx(-0.5 * (shock - expansion), rel=5e-3)  # half a chord behind, thin edges


@pytest.mark.parametrize("mach", [2.0, 5.0, 15.0])
def test_a_cone_has_the_exact_pressure_of_its_facets(mach):
    body = bodies.cone(math.radians(20.0), segments=48)
    panels = panels_of(body, 0.3)
    cp = pressures(panels, one(mach), METHODS["tangent-cone"])[:, 0]
    slope = math.asin(-panels.normal[panels.part == 0, 0].mean())
    assert math.degrees(slope) == pytest.approx(20.0, abs=0.02)
    np.testing.assert_allclose(cp[panels.part == 0], taylor_maccoll(mach, slope).surface_cp, rtol=1e-5)


def test_sphere_drag_tends_to_half_the_stagnation_pressure_with_the_square_of_the_facets():
    errors = []
    for segments in (24, 48, 96):
        sphere = bodies.sphere(segments=segments)
        reference = ReferenceLengths(math.pi, 2.0, 2.0, (1.0, 0.0, 0.0))
        data = local_inclination(sphere, one(5.0, 0.2), reference, METHODS["newtonian"])
        errors.append(abs(total(data, "CD") - 0.5 * stagnation_cp(5.0)))
        assert total(data, "CL") == pytest.approx(0.0, abs=1e-2 * (24 / segments) ** 2)
        assert total(data, "Cm") == pytest.approx(0.0, abs=1e-3 * (24 / segments) ** 2)
    assert errors[2] < 1e-3 * stagnation_cp(5.0)
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)
    assert math.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.2)


def test_cone_at_small_incidence_by_newton():
    """C_A = Cp_max sin^2 theta, C_N_alpha = Cp_max cos^2 theta on the base area, acting at 2 / (3 cos^2 theta)."""
    theta, alpha = math.radians(20.0), math.radians(0.5)
    reference = ReferenceLengths(math.pi * math.tan(theta) ** 2, 1.0, 1.0, (0.0, 0.0, 0.0))
    data = local_inclination(bodies.cone(theta), one(10.0, alpha), reference, METHODS["newtonian"])
    cp = stagnation_cp(10.0)
    assert total(data, "CA") == pytest.approx(cp * math.sin(theta) ** 2, rel=2e-3)
    assert total(data, "CN") / alpha == pytest.approx(cp * math.cos(theta) ** 2, rel=2e-3)
    assert -total(data, "Cm") / total(data, "CN") == pytest.approx(2.0 / (3.0 * math.cos(theta) ** 2), rel=2e-3)


def test_the_same_dataset_as_the_euler_solver_gives(make_solution, box, lengths):
    flow = integrate(make_solution(box, lambda c, *_: c[:, 0], mach=3.0), lengths)
    fast = local_inclination(plate(), one(3.0, 0.1), lengths)
    assert set(fast.data_vars) == set(flow.data_vars) and set(fast.coords) == set(flow.coords)
    for name in (*flow.data_vars, *flow.coords):
        assert fast[name].dims == flow[name].dims and fast[name].attrs == flow[name].attrs, name
    assert fast.attrs.keys() == flow.attrs.keys()
    assert fast.verdict.values.tolist() == ["converged"]
    for name in WITH_SPREAD:
        assert fast[f"{name}_spread"].item() == 0.0


@pytest.mark.parametrize("name", METHODS)
def test_horus_parts_sum_to_the_total_and_sides_mirror(name):
    body = build(VEHICLE.shape, spacing=SPACING)
    conditions = product([3.0, 12.0], [0.1, 0.5], [-0.05, 0.0, 0.05])
    data = local_inclination(body, conditions, VEHICLE.reference, METHODS[name])
    for coefficient in COEFFICIENTS:
        parts = data[coefficient].drop_sel(part="total").sum("part")
        np.testing.assert_allclose(parts, data[coefficient].sel(part="total"), atol=1e-13)
    straight = data.sel(part="total").isel(condition=data.beta.values == 0.0)
    for coefficient in ("CY", "Cl", "Cn"):
        assert np.abs(straight[coefficient]).max() < 1e-10
    left, right = (data.isel(condition=data.beta.values == beta) for beta in (-0.05, 0.05))
    for coefficient in (*COEFFICIENTS, *PRESSURES):
        np.testing.assert_allclose(mirrored(left)[coefficient], right[coefficient], atol=1e-10)
    assert np.abs(right.CY.sel(part="total")).min() > 1e-3


@pytest.mark.parametrize("name", METHODS)
def test_horus_lifts_more_with_incidence_and_a_tail_wind_of_sideslip_is_opposed(name):
    body = build(VEHICLE.shape, spacing=SPACING)
    step = math.radians(1.0)
    alphas = [math.radians(a) + s for a in (5.0, 15.0, 30.0) for s in (-step, step)]
    data = local_inclination(body, product([4.0, 20.0], alphas, [0.0]), VEHICLE.reference, METHODS[name])
    normal = data.CN.sel(part="total").values.reshape(2, 3, 2)
    assert (normal[..., 1] > normal[..., 0]).all()
    side = local_inclination(body, one(6.0, 0.2, 0.05), VEHICLE.reference, METHODS[name])
    assert total(side, "CY") < 0.0


SIGNS = {
    "elevon_left": {"CL": 1, "Cm": -1, "Cl": 1},
    "elevon_right": {"CL": 1, "Cm": -1, "Cl": -1},
    "rudder_left": {"CY": 1, "Cn": -1},
    "rudder_right": {"CY": -1, "Cn": 1},
    "body_flap": {"CL": 1, "Cm": -1},
}
"""Trailing edge down lifts the tail; outboard, the wind pushes the tail inboard and the nose to the rudder's side."""


@pytest.mark.parametrize("name", METHODS)
def test_each_flap_of_horus_moves_what_it_should(name):
    conditions = one(5.0, math.radians(10.0))

    def coefficients(**degrees):
        body = build(VEHICLE.shape, ControlDeflections.from_degrees(**degrees), spacing=SPACING)
        return local_inclination(body, conditions, VEHICLE.reference, METHODS[name])

    base = coefficients()
    assert set(SIGNS) == set(CONTROLS)
    for surface, signs in SIGNS.items():
        moved = coefficients(**{surface: 15.0})
        for coefficient, sign in signs.items():
            assert sign * (total(moved, coefficient) - total(base, coefficient)) > 1e-4, (surface, coefficient)


def test_derivatives_of_horus_by_the_usual_pipeline():
    """Richardson's values agree with much finer differences to their own error estimate; control derivatives mirror."""
    body = build(VEHICLE.shape, spacing=SPACING)

    def slopes(steps):
        made = plan([Point(), Point(mach=12.0)], steps)
        return differentiate(local_inclination(body, made.conditions, VEHICLE.reference), made)

    found = slopes(DerivativeSteps(two_step_sizes=True))
    fine = slopes(DerivativeSteps(math.radians(0.25), math.radians(0.5), 0.01))
    for name in (name for name in STABILITY if f"{name}_status" in found):
        assert found[f"{name}_status"].values.tolist() == ["converged"] * 2
        value = found[name].sel(part="total").values
        gap = np.abs(value - fine[name].sel(part="total").values)
        assert (gap <= found[f"{name}_error"].values + 1e-3 * np.abs(value) + 3e-4).all(), name
    assert (found.CL_alpha.sel(part="total") > 0.5).all() and (found.CY_beta.sel(part="total") < 0.0).all()

    conditions = product([6.0], [Point().alpha], [0.0])
    base = local_inclination(body, conditions, VEHICLE.reference)
    step = math.radians(5.0)
    deflected = build(VEHICLE.shape, ControlDeflections(elevon_left=step), spacing=SPACING)
    move = Move(step, base, local_inclination(deflected, conditions, VEHICLE.reference))
    control = control_derivatives(by_symmetry({"elevon_left": [move]}))
    assert total(control, "Cm_elevon_left") < 0.0 < total(control, "Cl_elevon_left")
    assert total(control, "Cl_elevon_right") == pytest.approx(-total(control, "Cl_elevon_left"))


def test_laws_by_part_and_by_bluntness_act_where_they_should():
    """HB-2: its flare by a wedge, its blunt nose by Newton, the rest by a cone."""
    body = bodies.hb2()
    settings = InclinationSettings(
        windward="tangent_cone", by_part={"forebody": "tangent_wedge"}, blunt="newtonian", blunt_radius=0.08
    )
    panels = panels_of(body, 0.05)
    cp = pressures(panels, one(6.0), settings)[:, 0]
    pure = {
        law: pressures(panels, one(6.0), InclinationSettings(windward=law))[:, 0]
        for law in ("newtonian", "tangent_wedge")
    }
    nose, flare = panels.center[:, 0] < 0.15, (panels.center[:, 0] > 4.0) & (panels.center[:, 0] < 4.85)
    np.testing.assert_array_equal(cp[nose], pure["newtonian"][nose])
    np.testing.assert_array_equal(cp[flare], pure["tangent_wedge"][flare])
    assert np.abs(pure["newtonian"] - pure["tangent_wedge"])[flare].min() > 0.01
    assert settings.law_of("forebody") == "tangent_wedge" and settings.law_of("base") == "tangent_cone"
    assert method("tangent").law_of("elevon_left") == "tangent_wedge"


def test_records_have_the_keys_of_the_euler_solver():
    case = run_inclination(plate(), [3.0, 6.0], [0.0, 0.2], [0.0], ReferenceLengths(2.0, 2.0, 1.0, (0.0, 0.0, 0.0)))
    assert [(r["mach"], round(r["alpha_deg"], 3)) for r in case.records] == [(3, 0), (3, 11.459), (6, 0), (6, 11.459)]
    for record in case.records:
        assert record["converged"] and record["verdict"] == "inclination"
        assert (record["cells"], record["iterations"], record["residual_drop"]) == (0, 0, None)
        assert record["CA"] == pytest.approx(record["CA_forebody"] + record["CA_base"])


@pytest.mark.parametrize("mach", [0.8, 1.99, math.nan])
def test_low_mach_numbers_are_refused(mach):
    with pytest.raises(InputError, match=r"mach = .*Mach 2"):
        local_inclination(plate(), FlowConditions(np.array([mach]), np.zeros(1), np.zeros(1)), VEHICLE.reference)


def test_bad_settings_are_refused_by_name():
    with pytest.raises(InputError, match="windward law 'newton': did you mean 'newtonian'"):
        InclinationSettings(windward="newton")
    with pytest.raises(InputError, match="windward law"):
        InclinationSettings(by_part={"wing": "wedge"})
    with pytest.raises(InputError, match="leeward law"):
        InclinationSettings(leeward="vacuum")
    with pytest.raises(InputError, match=r"panel = 0\.0"):
        InclinationSettings(panel=0.0)
    with pytest.raises(InputError, match="blunt_radius = -1"):
        InclinationSettings(blunt_radius=-1.0)
    with pytest.raises(InputError, match="method 'newtonain': did you mean 'newtonian'"):
        method("newtonain")
