"""Names, values and limits of shape parameters and deflections; vehicles from YAML."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from spaceplane.errors import InputError
from spaceplane.vehicle import presets, properties
from spaceplane.vehicle.controls import CONTROL_LIMITS_DEG, ControlDeflections
from spaceplane.vehicle.shape import PARAMETERS, THESIS_PARAMETERS, ShapeParameters, parameter_info

# Thesis Table 5.1: default, upper, lower.
TABLE_5_1 = {
    "fuselage_width_m": (2.5, 4.5, 2.0),
    "fuselage_height_m": (1.57, 3.0, 1.0),
    "nosecone_height_m": (1.5, 2.0, 1.0),
    "fuselage_length_m": (10.0, 15.0, 5.0),
    "fuselage_bottom_curvature_width_m": (5.5, 6.6, 4.5),
    "fuselage_bottom_curvature_height_m": (1.5, 2.0, 1.0),
    "wing_width_m": (3.1, 3.9, 2.8),
    "wing_corner_width_m": (1.5, 2.5, 1.2),
    "wing_corner_length_m": (4.8, 5.5, 4.6),
    "wing_thickness_m": (0.2, 0.3, 0.18),
    "winglet_bottom_length_m": (4.5, 4.7, 4.0),
    "winglet_top_length_m": (2.5, 3.5, 2.2),
    "winglet_length_m": (3.2, 4.5, 2.5),
    "winglet_angle_deg": (12.0, 25.0, 5.0),
    "winglet_angle_back_deg": (20.0, 30.0, 10.0),
    "elevon_length_m": (1.4, 2.0, 1.3),
    "rudder_length_m": (1.2, 1.4, 1.1),
    "rudder_height_bottom_m": (0.8, 1.2, 0.6),
    "body_flap_length_m": (2.0, 2.5, 1.8),
}


def test_table_of_the_thesis_is_carried_over():
    assert tuple(TABLE_5_1) == THESIS_PARAMETERS
    for name, numbers in TABLE_5_1.items():
        info = parameter_info(name)
        assert (info.default, info.upper, info.lower) == numbers


def test_every_parameter_is_documented_with_unit_and_limits_round_its_default():
    assert [p.name for p in PARAMETERS] == [f.name for f in fields(ShapeParameters)]
    for p in PARAMETERS:
        assert p.lower < p.upper and p.lower <= p.default <= p.upper
        assert p.description and p.source and p.unit in ("m", "deg", "1")


@pytest.mark.parametrize("name", [p.name for p in PARAMETERS])
def test_out_of_limits_names_parameter_value_and_limits(name):
    info = parameter_info(name)
    for value in (0.9 * info.lower, 1.1 * info.upper):
        with pytest.raises(InputError, match=rf"{name} = .*allowed {info.lower:g} to {info.upper:g}"):
            ShapeParameters.create({name: value})
        assert getattr(ShapeParameters.create({name: value}, allow_outside_limits=True), name) == value


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, "wide", None, [1.0], True, -1.0, 0.0])
def test_values_that_are_no_length_are_refused_even_outside_limits(value):
    with pytest.raises(InputError, match="wing_width_m"):
        ShapeParameters.create({"wing_width_m": value}, allow_outside_limits=True)


def test_unknown_name_suggests_the_nearest():
    with pytest.raises(InputError, match=r"'wing_widht_m'.*did you mean 'wing_width_m'"):
        ShapeParameters.create({"wing_widht_m": 3.0})


def test_deflections_round_trip_and_are_checked():
    degrees = {"elevon_left": -10.0, "elevon_right": 5.0, "rudder_left": 20.0, "rudder_right": 0.0, "body_flap": -20.0}
    deflections = ControlDeflections.from_degrees(degrees)
    assert deflections.elevon_left == pytest.approx(math.radians(-10))
    assert deflections.to_degrees() == pytest.approx(degrees)
    for name, (lower, upper) in CONTROL_LIMITS_DEG.items():
        ControlDeflections.from_degrees({name: lower})
        ControlDeflections.from_degrees({name: upper})
        for value in (lower - 0.1, upper + 0.1, math.nan):
            with pytest.raises(InputError, match=name):
                ControlDeflections.from_degrees({name: value})
    with pytest.raises(InputError, match="did you mean 'body_flap'"):
        ControlDeflections.from_degrees(bodyflap=3.0)


def test_horus_2b_has_the_published_numbers():
    vehicle = presets.horus_2b()
    assert vehicle.mass == properties.MassProperties(26_000, 119_000, 769_000, 806_000)
    reference = vehicle.reference
    assert (reference.area, reference.chord, reference.span) == (110.0, 23.0, 13.0)
    assert reference.moment_center == (13.0, 0.0, 0.0)
    assert presets.load("horus-2b") == vehicle


def test_optimised_preset_changes_five_parameters():
    shape = presets.load("horus-2b-optimised").shape
    default = ShapeParameters()
    changed = {p.name for p in PARAMETERS if getattr(shape, p.name) != getattr(default, p.name)}
    assert changed == set(presets.OPTIMISED_SHAPE) and len(changed) == 5


def test_moment_centre_moves_with_length_and_height_only():
    for p in PARAMETERS:
        value = p.upper if p.upper != p.default else p.lower
        center = properties.scaled_moment_center(ShapeParameters.create({p.name: value}))
        if p.name == "fuselage_length_m":
            assert center == pytest.approx((13.0 + 5.0 * 13 / 25, 0.0, 0.0))
        elif p.name == "fuselage_height_m":
            assert center == pytest.approx((13.0, 0.0, 1.43 / 3))
        else:
            assert center == (13.0, 0.0, 0.0)


@pytest.mark.parametrize("seed", range(5))
def test_products_of_inertia_are_those_of_a_rigid_body(seed):
    """Of random masses in pairs at +y and -y: accepted; a little beyond the limit: principal moments of no body."""
    rng = np.random.default_rng(seed)
    m, x, y, z = rng.uniform(0.1, 1.0, 8), *rng.normal(size=(3, 8)) * [[5.0], [1.0], [1.0]]
    x, z = x - m @ x / m.sum(), z - m @ z / m.sum()
    moments = (float(m @ v) for v in (y**2 + z**2, x**2 + z**2, x**2 + y**2, x * z))
    found = properties.MassProperties(m.sum(), *moments)
    bound = 0.5 * math.sqrt(found.Iyy**2 - (found.Ixx - found.Izz) ** 2)
    for Ixz, allowed in (
        (0.999 * bound, True),
        (-0.999 * bound, True),
        (1.001 * bound, False),
        (-1.001 * bound, False),
    ):
        small, middle, large = np.sort(
            np.linalg.eigvalsh([[found.Ixx, 0.0, -Ixz], [0.0, found.Iyy, 0.0], [-Ixz, 0.0, found.Izz]])
        )
        assert bool(small > 0 and small + middle >= large) is allowed
        if allowed:
            assert replace(found, Ixz=Ixz).Ixz == Ixz
        else:
            with pytest.raises(InputError, match="Ixz = "):
                replace(found, Ixz=Ixz)


def test_yaml_file_with_overrides(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(
        "name: mine\nbase: horus-2b-optimised\nshape: {wing_width_m: 3.5}\nmass: {mass_kg: 25000, Ixz_kgm2: -9.0e3}\n"
        "reference: {moment_center_station_m: 13.5, moment_center_height_m: 0.2}\n"
    )
    vehicle = presets.load(path, {"winglet_length_m": 3.0})
    assert vehicle.name == "mine"
    assert (vehicle.shape.wing_width_m, vehicle.shape.winglet_length_m, vehicle.shape.fuselage_width_m) == (3.5, 3, 3)
    assert (vehicle.mass.mass, vehicle.mass.Ixx, vehicle.mass.Ixz) == (25_000, 119_000, -9_000)
    assert presets.horus_2b().mass.Ixz == 0.0
    assert vehicle.reference.moment_center[0] == 13.5
    assert vehicle.reference.moment_center[2] == pytest.approx(0.2 - 0.57 * 1.7 / 4.5)
    assert presets.load(path, {"moment_center_station_m": 12.5}).reference.moment_center[0] == 12.5


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("shap: {}", "unknown key 'shap': did you mean 'shape'"),
        ("mass: {mas_kg: 3}", "unknown key 'mas_kg': did you mean 'mass_kg'"),
        ("mass: {mass_kg: heavy}", "mass.mass_kg = 'heavy'"),
        ("mass: {mass_kg: -3}", "mass = -3: must be positive"),
        ("mass: {Ixx_kgm2: 9.0e9}", "Ixx, Iyy, Izz"),
        ("mass: {Ixz_kgm2: 2.0e5}", "Ixz = 200000 kg m2: allowed with these moments are -172766 to 172766 kg m2"),
        ("mass: {Ixz_kgm2: .nan}", "Ixz = nan"),
        ("shape: {wing_width_m: 9}", "wing_width_m = 9 m: allowed 2.8 to 3.9"),
        ("base: horus-2c", "unknown vehicle preset 'horus-2c': did you mean 'horus-2b'"),
        ("- 1\n- 2", "must hold keys"),
        ("shape: {a: [", "not YAML at line"),
        ("reference: {area_m2: 0}", "area = 0: must be positive"),
    ],
)
def test_bad_yaml_is_named_in_one_line(tmp_path, text, message):
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        presets.load(path)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_unknown_vehicles_are_refused(tmp_path):
    with pytest.raises(InputError, match="did you mean 'horus-2b'"):
        presets.load("horus2b")
    with pytest.raises(InputError, match="does not exist"):
        presets.load(tmp_path / "none.yaml")
    with pytest.raises(InputError, match="moment_center_station_m"):
        presets.load("horus-2b", {"moment_center_station_m": "aft"})
