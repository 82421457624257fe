"""The aerodynamic model: exact on what is bilinear, never outside its tables, moments about any centre."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.aero.model import linear

from spaceplane.aero.axes import geometry_to_body, wind_axes
from spaceplane.aero.model.model import AeroModel, OutsideTables, SurfaceTable
from spaceplane.errors import InputError

POINT = {"mach": 2.2, "alpha": math.radians(13.0)}
DEFLECTED = {"elevon_left": 0.1, "elevon_right": -0.05, "body_flap": -0.2, "rudder_left": 0.3}


def test_coefficients_of_a_bilinear_model_are_exact():
    found = linear.model().coefficients(**POINT, beta=0.03, rates=(0.01, 0.02, -0.03), deflections=DEFLECTED)
    motion = {"beta": 0.03, "p": 0.01, "q": 0.02, "r": -0.03}
    rules = {
        "elevon_left": linear.ELEVON,
        "elevon_right": linear.mirrored(linear.ELEVON),
        "body_flap": linear.FLAP,
        "rudder_left": linear.RUDDER,
    }
    for name, value in found.items():
        expected = linear.static(name, POINT["alpha"], POINT["mach"]) if name in linear.BASE else 0.0
        expected += sum(rules[s].get(name, 0.0) * d for s, d in DEFLECTED.items())
        expected += sum(linear.SLOPE.get(f"{name}_{q}", 0.0) * v for q, v in motion.items())
        assert value == pytest.approx(expected, abs=1e-13), name


def test_derivatives_of_a_bilinear_model_are_exact():
    found = linear.model().derivatives(**POINT, deflections=DEFLECTED)
    for name, (_, with_alpha, with_mach) in linear.BASE.items():
        assert getattr(found, f"{name}_alpha") == pytest.approx(with_alpha, rel=1e-12)
        assert getattr(found, f"{name}_M") == pytest.approx(with_mach, rel=1e-12)
    for name, value in linear.SLOPE.items():
        assert getattr(found, name) == pytest.approx(value, rel=1e-12)
    assert found.control("Cm", "elevator") == pytest.approx(-0.18)
    assert found.control("Cl", "aileron") == pytest.approx(0.1)
    assert found.control("Cn", "rudder") == pytest.approx(-0.06)
    assert found.control("CD", "body_flap") == pytest.approx(0.04)


def kinked(empty=False):
    alpha, mach = np.radians([0.0, 10.0, 20.0]), np.array([1.0, 2.0])
    rise = np.array([[0.0, 0.0], [0.1, 0.1], [0.4, 0.4]])
    if empty:
        rise[2] = np.nan
    base = {"CL": rise, "CD": 0.1 + 0 * rise, "Cm": 0 * rise}
    table = {"Cm": np.array([-0.2, 0.0, 0.1])[:, None, None] * np.ones((3, 2))}
    surface = SurfaceTable(np.radians([-10.0, 0.0, 10.0]), table)
    return AeroModel("kink", "test", linear.REFERENCE, alpha, mach, base, {"body_flap": surface})


def test_slope_at_a_node_is_the_mean_of_both_sides():
    per_rad = 1.0 / math.radians(10.0)
    found = kinked().derivatives(1.5, math.radians(10.0))
    assert found.CL_alpha == pytest.approx(0.2 * per_rad)
    assert found.controls["Cm_body_flap"] == pytest.approx(0.15 * per_rad)
    assert kinked().derivatives(1.5, math.radians(9.0)).CL_alpha == pytest.approx(0.1 * per_rad)
    assert kinked().derivatives(1.5, math.radians(20.0)).CL_alpha == pytest.approx(0.3 * per_rad)
    assert kinked().derivatives(1.5, 0.1, {"body_flap": -0.05}).controls["Cm_body_flap"] == pytest.approx(0.2 * per_rad)


def test_empty_cells_are_refused_up_to_their_edge():
    model = kinked(empty=True)
    assert model.coefficients(1.5, math.radians(10.0))["CL"] == pytest.approx(0.1)
    assert model.derivatives(1.5, math.radians(10.0)).CL_alpha == pytest.approx(0.1 / math.radians(10.0))
    with pytest.raises(OutsideTables, match=r"CL: the tables of kink are empty at Mach 1.5, alpha 11 deg"):
        model.coefficients(1.5, math.radians(11.0))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mach": 3.01}, "mach = 3.01: outside the tables, which run from 1.5 to 3"),
        ({"mach": 1.0}, "mach = 1: outside"),
        ({"alpha": math.radians(-1.0)}, "alpha = -1 deg: outside the tables, which run from 0 to 30 deg"),
        ({"beta": math.radians(11.0)}, "beta = 11 deg: the slopes hold from -10 to 10 deg"),
        ({"deflections": {"rudder_left": -0.01}}, "rudder_left = -0.57.* deg: outside .* 0 to 40 deg"),
        ({"deflections": {"body_flap": math.radians(31.0)}}, "body_flap = 31 deg: outside .* -20 to 30 deg"),
    ],
)
def test_nothing_is_extrapolated(change, message):
    with pytest.raises(OutsideTables, match=message) as caught:
        linear.model().coefficients(**{**POINT, **change})
    assert caught.value.quantity in message
    lower, upper = caught.value.limits
    assert not lower <= caught.value.value <= upper


@pytest.mark.parametrize("change", [{"mach": math.nan}, {"beta": math.nan}, {"rates": (0.0, math.inf, 0.0)}])
def test_numbers_must_be_finite(change):
    with pytest.raises(InputError, match="finite"):
        linear.model().coefficients(**{**POINT, **change})


def test_surfaces_by_name():
    with pytest.raises(InputError, match="did you mean 'body_flap'"):
        linear.model().coefficients(**POINT, deflections={"bodyflap": 0.1})
    bare = linear.model(rudders=False)
    with pytest.raises(InputError, match=r"rudder_left = 5.7.* deg: linear has no table of it"):
        bare.coefficients(**POINT, deflections={"rudder_left": 0.1})
    assert bare.coefficients(**POINT, deflections={"rudder_left": 0.0}) == bare.coefficients(**POINT)
    assert "CY_rudder_left" in bare.unknown() and "Cl_body_flap" not in bare.unknown()
    assert "Cn_beta" in linear.model(slopes={}).unknown() and "Cn_beta" not in linear.model().unknown()


def test_limits_are_reached_exactly():
    model = linear.model()
    limit = math.radians(40.0)
    model.coefficients(3.0, math.radians(30.0), deflections={"elevon_left": limit, "elevon_right": -limit})
    assert model.limits("rudder_left") == pytest.approx((0.0, limit))


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("alpha", [0.0, 0.2, 0.1, 0.3], "increasing"),
        ("mach", [1.0], "two"),
        ("base", {"CL": np.zeros((4, 3))}, "CD is missing"),
        ("base", {"CL": np.zeros((3, 3)), "CD": np.zeros((4, 3)), "Cm": np.zeros((4, 3))}, "CL: has shape"),
        ("slopes", {"Cn_bta": np.zeros((4, 3))}, "did you mean 'Cn_beta'"),
        ("beta_limit", -0.1, "beta_limit"),
    ],
)
def test_records_are_checked(field, value, message):
    model = linear.model()
    given = {name: getattr(model, name) for name in model.__dataclass_fields__}
    with pytest.raises(InputError, match=message):
        AeroModel(**{**given, field: value})


def test_surface_tables_are_checked():
    with pytest.raises(InputError, match="0 must be one"):
        SurfaceTable([-0.1, 0.1], {})
    with pytest.raises(InputError, match="0 at deflection 0"):
        SurfaceTable([0.0, 0.1], {"Cm": np.ones((2, 4, 3))})
    with pytest.raises(InputError, match="unknown coefficient"):
        SurfaceTable([0.0, 0.1], {"CM": np.zeros((2, 4, 3))})


def quasi_steady(model, center, mach, alpha, beta, rates, deflections):
    """Coefficients about another centre from first principles: the motion of the old centre, then the forces' arms."""
    ref = model.reference
    shift = np.subtract(center, ref.moment_center)
    lengths = np.array([ref.span, ref.chord, ref.span])
    velocity = geometry_to_body(-wind_axes(alpha, beta).drag)  # of the vehicle, over V, at the new centre
    spin = 2.0 * np.array(rates) / lengths  # over V
    at_old = velocity - np.cross(spin, geometry_to_body(shift))
    speed = np.linalg.norm(at_old)
    alpha_old, beta_old = math.atan2(at_old[2], at_old[0]), math.asin(at_old[1] / speed)
    found = model.coefficients(mach * speed, alpha_old, beta_old, tuple(np.array(rates) / speed), deflections)
    axes = wind_axes(alpha_old, beta_old)
    force = speed**2 * (found["CL"] * axes.lift + found["CD"] * axes.drag + found["CY"] * axes.side)
    moment = speed**2 * np.array([found[name] for name in ("Cl", "Cm", "Cn")])
    moment = moment - geometry_to_body(np.cross(shift, force)) / lengths
    now = wind_axes(alpha, beta)
    return {
        "CL": force @ now.lift,
        "CD": force @ now.drag,
        "CY": force @ now.side,
        **dict(zip(("Cl", "Cm", "Cn"), moment, strict=True)),
    }


CENTER = (14.7, 0.0, -0.6)
AT_NODE = {"mach": 2.0, "alpha": math.radians(20.0)}


def test_moved_moments_have_the_arms_of_the_forces():
    model = linear.model()
    turned = {"elevon_left": linear.surface(linear.ELEVON, (-40.0, 40.0)).limits[1], "body_flap": math.radians(-20.0)}
    expected = quasi_steady(model, CENTER, **AT_NODE, beta=0.0, rates=(0.0, 0.0, 0.0), deflections=turned)
    found = model.moved(CENTER).coefficients(**AT_NODE, deflections=turned)
    assert model.moved(CENTER).reference.moment_center == CENTER
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, abs=1e-14), name
    assert found["Cm"] > model.coefficients(**AT_NODE, deflections=turned)["Cm"]  # lift acts ahead of a centre aft


@pytest.mark.parametrize("quantity", ["beta", "p", "q", "r"])
def test_moved_slopes_are_those_of_the_motion_of_the_old_centre(quantity):
    model, step = linear.model(), 1e-5
    names = ("p", "q", "r")

    def first_principles(value):
        rates = tuple(value if name == quantity else 0.0 for name in names)
        beta = value if quantity == "beta" else 0.0
        return quasi_steady(model, CENTER, **AT_NODE, beta=beta, rates=rates, deflections={})

    plus, minus = first_principles(step), first_principles(-step)
    found = model.moved(CENTER).derivatives(**AT_NODE)
    checked = 0
    for name in ("CL", "CY", "Cl", "Cm", "Cn"):
        if f"{name}_{quantity}" in linear.SLOPE:
            slope = (plus[name] - minus[name]) / (2 * step)
            assert getattr(found, f"{name}_{quantity}") == pytest.approx(slope, abs=1e-7), name
            checked += 1
    assert checked == (2 if quantity == "q" else 3)


def test_moving_there_and_back_restores_the_static_tables():
    model = linear.model()
    back = model.moved(CENTER).moved(model.reference.moment_center)
    for name, table in model.base.items():
        assert back.base[name] == pytest.approx(table, abs=1e-15)
    for name in ("CY_beta", "Cl_beta", "Cn_beta"):
        assert back.slopes[name] == pytest.approx(model.slopes[name], abs=1e-15)


def test_moving_leaves_the_plane_of_symmetry_never_and_invents_nothing():
    with pytest.raises(InputError, match=r"y = 0.1 m: must stay at 0 m"):
        linear.model().moved((13.0, 0.1, 0.0))
    partial = linear.model(slopes={"Cn_beta": 0.05, "Cm_q": -1.0})
    assert set(partial.moved(CENTER).slopes) == set()  # the side force and lift that act on the arm are unknown
    assert set(partial.moved((13.0, 0.0, 0.0)).slopes) == {"Cn_beta", "Cm_q"}


def test_a_lag_is_known_about_its_own_centre_only():
    model = replace(linear.model(), lag=(0.0, -0.5))
    assert model.moved(model.reference.moment_center).lag == (0.0, -0.5)
    with pytest.raises(InputError, match="CL_alphadot and Cm_alphadot of linear hold about its own only"):
        model.moved((12.0, 0.0, 0.0))


def test_mirrored_flight_gives_mirrored_coefficients():
    model = linear.model()
    there = model.coefficients(**POINT, beta=0.05, rates=(0.02, 0.01, -0.03), deflections=DEFLECTED)
    flipped = {"elevon_right": 0.1, "elevon_left": -0.05, "body_flap": -0.2, "rudder_right": 0.3}
    back = model.coefficients(**POINT, beta=-0.05, rates=(-0.02, 0.01, 0.03), deflections=flipped)
    for name, sign in linear.MIRROR.items():
        assert back[name] == pytest.approx(sign * there[name], abs=1e-15)
