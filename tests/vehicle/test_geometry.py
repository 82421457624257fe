"""The vehicle's surface: measures, validity, symmetry, and that every input moves it the right way."""

from functools import lru_cache

import manifold3d
import numpy as np
import pytest

from spaceplane.vehicle.build import PART_NAMES, build
from spaceplane.vehicle.controls import CONTROL_LIMITS_DEG, ControlDeflections
from spaceplane.vehicle.flaps import elevon_hinge, rudder_hinge
from spaceplane.vehicle.layout import Layout
from spaceplane.vehicle.shape import PARAMETERS, ShapeParameters
from spaceplane.vehicle.surface import Surface
from spaceplane.vehicle.validity import GeometryError, check, component_count, edge_faults, genus, overlaps

COARSE = 0.25  # m, triangle size that keeps these tests quick


@lru_cache(maxsize=64)
def shaped(name: str = "", value: float = 0.0, spacing: float = COARSE) -> Surface:
    return build(ShapeParameters.create({name: value} if name else {}), spacing=spacing)


def deflected(**degrees: float) -> Surface:
    return build(ShapeParameters(), ControlDeflections.from_degrees(**degrees), spacing=COARSE)


def points_of(surface: Surface, *parts: str) -> np.ndarray:
    chosen = np.isin(surface.part, [PART_NAMES.index(p) for p in parts])
    return surface.points[np.unique(surface.triangles[chosen])]


def silhouette(surface: Surface) -> float:
    """Area seen from above, m2."""
    solid = manifold3d.Manifold(manifold3d.Mesh64(surface.points, surface.triangles.astype(np.uint64)))
    return solid.project().area()


def winding(surface: Surface, at: np.ndarray) -> np.ndarray:
    """[point] solid angle over 4 pi: 1 inside a closed surface, 0 outside (van Oosterom and Strackee 1983)."""
    result = []
    for p in at:
        a, b, c = np.moveaxis(surface.corners - p, 1, 0)
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        numerator = np.einsum("ij,ij->i", a, np.cross(b, c))
        dots = [np.einsum("ij,ij->i", u, v) for u, v in ((a, b), (b, c), (c, a))]
        result.append(
            np.arctan2(numerator, la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb).sum() / (2 * np.pi)
        )
    return np.array(result)


def test_default_has_the_dimensions_of_horus_2b():
    surface = shaped(spacing=0.12)
    low, high = surface.bounds
    fuselage = points_of(surface, "fuselage")
    assert high[0] - low[0] == pytest.approx(25.0, rel=0.01)
    assert high[1] - low[1] == pytest.approx(13.0, rel=0.01)
    assert np.ptp(fuselage[:, 1]) == pytest.approx(5.4, rel=0.01)
    assert np.ptp(fuselage[:, 2]) == pytest.approx(4.5, rel=0.01)
    assert silhouette(surface) - 3.4 * 2.0 == pytest.approx(152.0, rel=0.01)  # without the body flap
    assert low[0] == pytest.approx(0.0, abs=1e-6)
    assert 50_000 < len(surface.triangles) < 130_000


def test_default_is_one_closed_body_with_all_parts():
    surface = shaped(spacing=0.12)
    unpaired, repeated = edge_faults(surface.triangles)
    assert not len(unpaired) and not len(repeated)
    assert component_count(surface) == 1 and genus(surface) == 0
    assert surface.part_names == PART_NAMES
    assert set(surface.part) == set(range(len(PART_NAMES)))
    closure = np.abs(surface.area_vectors.sum(axis=0)).max()
    assert closure < 1e-10 * surface.area
    solid = manifold3d.Manifold(manifold3d.Mesh64(surface.points, surface.triangles.astype(np.uint64)))
    assert solid.status() == manifold3d.Error.NoError
    assert solid.volume() == pytest.approx(surface.volume, rel=1e-9)


def mirrored_triangles(surface: Surface, flip: bool) -> set:
    corners = surface.corners * ([1.0, -1.0, 1.0] if flip else [1.0, 1.0, 1.0])
    names = [n.replace("right", "left") for n in surface.part_names]
    return {
        (names[p], *sorted(map(tuple, (corner + 0.0).tolist())))
        for p, corner in zip(surface.part, corners, strict=True)
    }


def test_symmetric_deflections_give_a_surface_symmetric_to_the_last_bit():
    surface = deflected(elevon_left=-17.5, elevon_right=-17.5, rudder_left=10, rudder_right=10, body_flap=-20)
    assert mirrored_triangles(surface, False) == mirrored_triangles(surface, True)


def test_swapped_deflections_give_the_mirror_image():
    one = deflected(elevon_left=-30, elevon_right=20, rudder_left=40, body_flap=10)
    other = deflected(elevon_left=20, elevon_right=-30, rudder_right=40, body_flap=10)
    assert one.volume == pytest.approx(other.volume, rel=1e-12)
    assert np.allclose(one.bounds[:, [0, 2]], other.bounds[:, [0, 2]], atol=1e-12)
    assert np.allclose(one.bounds[:, 1], -other.bounds[::-1, 1], atol=1e-12)


def wing_depth(surface: Surface) -> float:
    """Thickness of the winglet's fixed part half-way up, where its section is thickest."""
    layout = Layout(ShapeParameters())
    q = np.array([layout.panel_length + 1.6])
    y, z, elevation = layout.path(q)
    p = points_of(surface, "winglet_right")
    along = (p[:, 1] - y) * np.cos(elevation) + (p[:, 2] - z) * np.sin(elevation)
    across = -(p[:, 1] - y) * np.sin(elevation) + (p[:, 2] - z) * np.cos(elevation)
    return float(np.ptp(across[np.abs(along) < 0.2]))


def span_y(s: Surface) -> float:
    return s.bounds[1, 1]


def leading_x(s: Surface, y: float) -> float:
    p = points_of(s, "wing_right")
    return float(p[np.abs(p[:, 1] - y) < 0.15, 0].min())


def top_chord_start(s: Surface) -> float:
    p = points_of(s, "winglet_right")
    return float(p[p[:, 2] > p[:, 2].max() - 0.6, 0].min())


def nose_curvature_radius(s: Surface) -> float:
    p = points_of(s, "nose")
    p = p[(p[:, 0] > 0.01) & (p[:, 0] < 0.05)]
    return float(np.mean(((p**2).sum(axis=1)) / (2 * p[:, 0])))


def corner_distance(s: Surface) -> float:
    layout = Layout(ShapeParameters())
    angle = (layout.panel_length * np.cos(layout.dihedral), layout.panel_length * np.sin(layout.dihedral))
    corner = np.array([layout.chine + angle[0], layout.z_keel + float(layout.underside(layout.chine)) + angle[1]])
    p = points_of(s, "wing_right", "winglet_right")
    return float(np.linalg.norm(p[:, 1:] - corner, axis=1).min())


COS12, SIN12 = np.cos(np.radians(12)), np.sin(np.radians(12))
DEFAULT = Layout(ShapeParameters())
HALF_TURN = 0.5 * (DEFAULT.winglet_elevation - DEFAULT.dihedral)

# parameter: (new value, what is measured, change expected, tolerance); expected None: only that it grows, (-) shrinks.
EFFECTS = {
    "fuselage_width_m": (3.0, lambda s: points_of(s, "fuselage")[:, 1].max(), 0.5, 0.01),
    "fuselage_height_m": (2.0, lambda s: points_of(s, "fuselage")[:, 2].max(), 0.43, 0.01),
    "nosecone_height_m": (1.8, lambda s: s.points[s.points[:, 0].argmin(), 2], 0.3, 0.01),
    "fuselage_length_m": (12.0, lambda s: points_of(s, "fuselage")[:, 0].max(), 2.0, 1e-6),
    "fuselage_bottom_curvature_width_m": (6.6, lambda s: s.bounds[1, 2], None, "-"),
    "fuselage_bottom_curvature_height_m": (2.0, lambda s: s.bounds[1, 2], None, "+"),
    "wing_width_m": (3.5, span_y, 0.4, 0.01),
    "wing_corner_width_m": (2.0, silhouette, None, "+"),
    "wing_corner_length_m": (5.3, lambda s: leading_x(s, 4.2), -0.5, 0.15),
    "wing_thickness_m": (0.3, wing_depth, 0.0925, 0.02),
    "winglet_bottom_length_m": (4.0, lambda s: points_of(s, "winglet_right")[:, 0].min(), 0.5, 0.1),
    "winglet_top_length_m": (3.3, top_chord_start, -0.8, 0.2),
    "winglet_length_m": (4.0, lambda s: s.bounds[1, 2], 0.8 * COS12, 0.01),
    "winglet_angle_deg": (20.0, span_y, 3.2 * (np.sin(np.radians(20)) - SIN12), 0.02),
    "winglet_angle_back_deg": (30.0, lambda s: points_of(s, "rudder_right")[:, 0].max(), 0.683, 0.03),
    "elevon_length_m": (1.8, lambda s: points_of(s, "elevon_right")[:, 0].min(), -0.41, 0.05),
    "rudder_length_m": (1.4, lambda s: points_of(s, "rudder_right")[:, 0].min(), -0.2, 0.05),
    "rudder_height_bottom_m": (1.1, lambda s: points_of(s, "rudder_right")[:, 2].min(), 0.3 * COS12, 0.03),
    "body_flap_length_m": (2.4, lambda s: points_of(s, "body_flap")[:, 0].max(), 0.4, 1e-6),
    "nose_radius_m": (0.5, nose_curvature_radius, -0.3, 0.03),
    "nosecone_length_m": (14.0, lambda s: points_of(s, "fuselage")[:, 0].max(), 1.0, 1e-6),
    "fuselage_flare_m": (0.3, lambda s: points_of(s, "fuselage")[:, 1].max(), 0.1, 0.01),
    "fuselage_crown_ratio": (1.1, lambda s: points_of(s, "fuselage")[:, 2].max(), 0.175, 0.01),
    "strake_length_m": (9.5, lambda s: points_of(s, "wing_right")[:, 0].min(), 2.2, 0.4),
    "leading_edge_radius_m": (0.1, lambda s: s.volume, None, "-"),
    "wing_root_thickness_m": (0.8, lambda s: s.volume, None, "+"),
    "trailing_edge_sweep_deg": (20.0, lambda s: points_of(s, "rudder_right")[:, 0].max(), 0.298, 0.02),
    "trailing_edge_thickness_m": (0.06, lambda s: np.ptp(points_of(s, "body_flap")[:, 2]), None, "="),
    "winglet_bend_radius_m": (0.6, corner_distance, -(0.6268 - 0.6 * np.tan(HALF_TURN)) * np.tan(HALF_TURN / 2), 0.04),
    "body_flap_width_m": (2.6, lambda s: points_of(s, "body_flap")[:, 1].max(), -0.4, 1e-6),
}


def test_effects_cover_every_parameter():
    assert set(EFFECTS) == {p.name for p in PARAMETERS}


@pytest.mark.parametrize("name", sorted(EFFECTS))
def test_every_parameter_moves_the_geometry_as_it_says(name):
    value, measure, expected, tolerance = EFFECTS[name]
    change = measure(shaped(name, value)) - measure(shaped())
    if name == "trailing_edge_thickness_m":
        rear = points_of(shaped(name, value), "body_flap")
        rear = rear[rear[:, 0] > rear[:, 0].max() - 1e-6]
        assert np.ptp(rear[:, 2]) == pytest.approx(value, abs=1e-6)
    elif expected is None:
        assert change * (1 if tolerance == "+" else -1) > 1e-3
    else:
        assert change == pytest.approx(expected, abs=tolerance)


def hinge_shift(angle: float, chord: float) -> float:
    return chord * np.sin(np.radians(angle))


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("angle", [-40.0, -10.0, 10.0, 40.0])
def test_elevon_positive_trailing_edge_down(side, angle):
    hinge = elevon_hinge(DEFAULT)
    name = f"elevon_{side}"
    sign = 1 if side == "right" else -1
    up = hinge.up * [1, sign, 1]
    rear = hinge.origin * [1, sign, 1]
    p = points_of(deflected(**{name: angle}), name)
    height = (p - rear) @ up
    end = height[np.argmax(np.abs(height))]
    assert end == pytest.approx(-hinge_shift(angle, hinge.chord), abs=0.05)


@pytest.mark.parametrize("side", ["left", "right"])
def test_rudder_positive_outboard(side):
    hinge = rudder_hinge(DEFAULT)
    before, after = (
        np.abs(points_of(deflected(**{f"rudder_{side}": a}), f"rudder_{side}")[:, 1]).max() for a in (0.0, 40.0)
    )
    assert after - before == pytest.approx(hinge_shift(40.0, hinge.chord) * abs(hinge.up[1]), abs=0.05)


@pytest.mark.parametrize("angle", [-20.0, 30.0])
def test_body_flap_positive_trailing_edge_down(angle):
    p0, p1 = (points_of(deflected(body_flap=a), "body_flap") for a in (0.0, angle))
    ends = [p[p[:, 0] > p[:, 0].max() - 0.02, 2].mean() for p in (p0, p1)]
    assert ends[1] - ends[0] == pytest.approx(-hinge_shift(angle, 1.95), abs=0.05)


def test_one_deflection_leaves_the_other_parts_alone():
    default, moved = deflected(), deflected(elevon_right=-20)
    for part in set(PART_NAMES) - {"elevon_right", "wing_right"}:
        a, b = (s.area_vectors[s.part == PART_NAMES.index(part)] for s in (default, moved))
        assert np.abs(a).sum() == pytest.approx(np.abs(b).sum(), rel=2e-3), part


@pytest.mark.parametrize("angle", [-40.0, -5.0, 0.0, 5.0, 40.0])
def test_hinges_do_not_leak(angle):
    """The whole hinge line lies inside the body at every angle: no slot between wing and flap."""
    surface = deflected(elevon_right=angle, rudder_right=abs(angle))
    for hinge in (elevon_hinge(DEFAULT), rudder_hinge(DEFAULT)):
        # Past the ends the line is in the wing too; the rudder's upper end is the winglet's tip.
        t = np.linspace(0.0, hinge.length - 0.03, 9)
        line = hinge.origin + t[:, None] * hinge.along - 0.1 * min(hinge.radius) * hinge.aft
        assert winding(surface, line) == pytest.approx(np.ones(9), abs=1e-6)


def random_case(rng: np.random.Generator, corner: bool) -> tuple[ShapeParameters, ControlDeflections]:
    def draw(low: float, high: float) -> float:
        return float(rng.choice([low, high]) if corner else rng.uniform(low, high))

    shape = ShapeParameters.create({p.name: draw(p.lower, p.upper) for p in PARAMETERS})
    return shape, ControlDeflections.from_degrees({n: draw(*limits) for n, limits in CONTROL_LIMITS_DEG.items()})


@pytest.mark.parametrize("seed", range(10))
def test_hundred_random_shapes_and_corners_are_valid(seed):
    """Ten of each seed, every second one a corner of the limits; `build` itself refuses what is not valid."""
    rng = np.random.default_rng(seed)
    for index in range(10):
        shape, deflections = random_case(rng, corner=index % 2 == 1)
        surface = build(shape, deflections, spacing=0.2)
        assert genus(surface) == 0 and component_count(surface) == 1 and surface.volume > 50
        assert set(surface.part) == set(range(len(PART_NAMES)))


def test_absurd_shapes_are_refused_with_a_reason():
    cases = (
        ({"nose_radius_m": 2.0}, "nose_radius_m"),
        ({"wing_corner_width_m": 6.0}, "wing_corner_width_m"),
        ({"elevon_length_m": 7.0}, "elevon"),
        ({"body_flap_width_m": 8.0}, "body_flap_width_m"),
        ({"rudder_height_bottom_m": 3.1}, "rudder_height_bottom_m"),
        ({"winglet_angle_deg": 80.0}, "winglet_angle_deg"),
    )
    for values, message in cases:
        shape = ShapeParameters.create(values, allow_outside_limits=True)
        with pytest.raises(GeometryError, match=message):
            build(shape, spacing=COARSE)


def test_gate_refuses_damaged_surfaces():
    good = shaped()
    hole = Surface(good.points, good.triangles[1:], good.part[1:], good.part_names)
    with pytest.raises(GeometryError, match="not closed"):
        check(hole, "test")
    turned = Surface(good.points, np.ascontiguousarray(good.triangles[:, ::-1]), good.part, good.part_names)
    with pytest.raises(GeometryError, match="volume"):
        check(turned, "test")
    twice = Surface(
        np.concatenate([good.points, good.points + 100.0]),
        np.concatenate([good.triangles, good.triangles + len(good.points)]),
        np.concatenate([good.part, good.part]),
        good.part_names,
    )
    with pytest.raises(GeometryError, match="2 pieces"):
        check(twice, "test")


def test_overlap_is_found_by_rays_and_not_invented():
    good = shaped()
    assert len(overlaps(good, 0.1)) == 0
    shifted = Surface(
        np.concatenate([good.points, good.points + np.array([0.0, 0.0, 0.5])]),
        np.concatenate([good.triangles, good.triangles + len(good.points)]),
        np.concatenate([good.part, good.part]),
        good.part_names,
    )
    places = overlaps(shifted)
    assert len(places) > 100
    assert (places >= shifted.bounds[0] - 1e-9).all() and (places <= shifted.bounds[1] + 1e-9).all()
