"""Watertight surfaces of the published test bodies.

All in geometry axes: x aft from the nose, y right, z up, metres; triangles counter-clockwise seen from the air.
"""

from __future__ import annotations

import math

import numpy as np

from spaceplane.errors import InputError
from spaceplane.vehicle.solids import solid_of, welded
from spaceplane.vehicle.surface import Surface

M6_ROOT_CHORD, M6_SEMI_SPAN, M6_TAPER = 0.8059, 1.1963, 0.562
"""Root chord and semi-span of the ONERA M6 wing, m, and tip chord over root chord."""
M6_LEADING_EDGE_SWEEP = math.radians(30.0)
M6_ORDINATES = np.fromstring(
    """
    0.0000000 0.0000000 0.0000165 0.0006914 0.0000696 0.0014416 0.0001675 0.0022554 0.0003232 0.0031382
    0.0005508 0.0040959 0.0008657 0.0051343 0.0012868 0.0062598 0.0018364 0.0074784 0.0025441 0.0087958
    0.0034428 0.0102163 0.0045704 0.0117419 0.0059751 0.0133708 0.0077112 0.0150951 0.0098413 0.0168984
    0.0124479 0.0187537 0.0156171 0.0206220 0.0194609 0.0224545 0.0241067 0.0242004 0.0297008 0.0258245
    0.0364261 0.0273317 0.0444852 0.0287912 0.0541248 0.0303278 0.0656303 0.0320138 0.0793366 0.0338372
    0.0956354 0.0357742 0.1149796 0.0377923 0.1378963 0.0398522 0.1649976 0.0419089 0.1919327 0.0436214
    0.2187096 0.0450507 0.2453310 0.0462358 0.2717978 0.0471987 0.2981113 0.0479494 0.3242726 0.0484902
    0.3502830 0.0488183 0.3761446 0.0489296 0.4018567 0.0488202 0.4274223 0.0484833 0.4528441 0.0479351
    0.4781197 0.0471661 0.5032514 0.0461903 0.5282426 0.0450209 0.5530937 0.0436741 0.5778043 0.0421684
    0.6023757 0.0405241 0.6268104 0.0387613 0.6511093 0.0368990 0.6752726 0.0349542 0.6993027 0.0329402
    0.7231995 0.0308662 0.7469658 0.0287365 0.7705998 0.0265505 0.7941055 0.0243027 0.8174828 0.0219842
    0.8407324 0.0195838 0.8638564 0.0170915 0.8868235 0.0145051 0.9061905 0.0122389 0.9225336 0.0102727
    0.9363346 0.0085827 0.9479946 0.0071423 0.9578511 0.0059224 0.9661860 0.0048907 0.9732361 0.0040180
    0.9792020 0.0032796 0.9842508 0.0026547 0.9885252 0.0021257 0.9921438 0.0016778 0.9952080 0.0012985
    0.9978030 0.0009773 1.0000000 0.0007052
    """,
    sep=" ",
).reshape(-1, 2)
"""[station, (x, z)] upper side of its symmetric section (ONERA D) on the chord; the trailing edge is 0.14 % thick."""


def revolve(profile: np.ndarray, segments: int, base_from: int | None = None) -> Surface:
    """Turn a meridian about the x axis into a closed surface.

    Args:
        profile: [station, (x, r)] m from the nose (r = 0) to the tail (r = 0), r > 0 between.
        segments: number of facets around the axis; a multiple of 4 keeps the surface symmetric in y and z.
        base_from: first station of the base; the strips from there on are tagged `base`, all others `forebody`.

    Returns:
        A surface with parts `forebody` and `base`. Its facets are inscribed: the enclosed area of each section is
        smaller than the circle's by the factor sin(2 pi / segments) / (2 pi / segments).

    Raises:
        InputError: a profile that does not begin and end on the axis, or too few segments.
    """
    profile = np.asarray(profile, float)
    if profile[0, 1] != 0.0 or profile[-1, 1] != 0.0 or np.any(profile[1:-1, 1] <= 0.0):
        raise InputError("profile: the radius must be zero at both ends and positive between")
    if segments < 8 or segments % 4:
        raise InputError(f"segments = {segments}: a multiple of 4, at least 8, is needed")
    inner = profile[1:-1]
    rings = np.empty((len(inner), segments, 3))
    rings[..., 0] = inner[:, :1]
    rings[..., 1] = inner[:, 1:] * _exact_cosine(segments)
    rings[..., 2] = inner[:, 1:] * np.roll(_exact_cosine(segments), segments // 4)
    points = np.vstack([[profile[0, 0], 0.0, 0.0], rings.reshape(-1, 3), [profile[-1, 0], 0.0, 0.0]])

    around = np.arange(segments)
    following = (around + 1) % segments
    triangles, strip = [np.stack([np.zeros_like(around), 1 + following, 1 + around], axis=1)], [np.zeros(segments, int)]
    for ring in range(len(inner) - 1):
        a, b = 1 + ring * segments + around, 1 + ring * segments + following
        c, d = a + segments, b + segments
        triangles += [np.stack([a, b, d], axis=1), np.stack([a, d, c], axis=1)]
        strip += [np.full(2 * segments, ring + 1)]
    last = 1 + (len(inner) - 1) * segments
    triangles.append(np.stack([np.full_like(around, len(points) - 1), last + around, last + following], axis=1))
    strip.append(np.full(segments, len(inner)))

    first_base = len(profile) if base_from is None else base_from
    part = (np.concatenate(strip) >= first_base).astype(np.int32)
    return Surface(points, np.concatenate(triangles).astype(np.int64), part, ("forebody", "base"))


def cone(half_angle: float, length: float = 1.0, segments: int = 96, base_rings: int = 1, tail: float = 0.0) -> Surface:
    """A circular cone with a flat base, apex at the origin.

    Args:
        half_angle: half angle, rad.
        length: length of the part `forebody` along the axis, m.
        segments: facets around the axis.
        base_rings: concentric rings of the base.
        tail: length by which the cone goes on behind the forebody, m; that piece belongs to the part `base`.
    """
    # Facets of equal area to the circle, so that the normal force on the base area is not short by the inscription.
    slope = math.tan(half_angle) * _equal_area_factor(segments)
    end = length + tail
    base = [(end, end * slope * (1.0 - ring / base_rings)) for ring in range(base_rings + 1)]
    waist = [(length, length * slope)] if tail > 0.0 else []
    return revolve(np.array([(0.0, 0.0), *waist, *base]), segments, base_from=1)


def sphere(radius: float = 1.0, segments: int = 96) -> Surface:
    """A sphere of the true volume about (radius, 0, 0), m; `segments` facets around, half as many nose to tail."""
    polar = np.linspace(0.0, math.pi, segments // 2 + 1)
    profile = np.stack([radius * (1.0 - np.cos(polar)), radius * np.sin(polar)], axis=1)
    profile[[0, -1], 1] = 0.0
    # Facets of the sphere's own volume: the polyhedron is then neither systematically thin nor thick.
    inscribed = revolve(profile, segments, base_from=segments // 4)
    scale = (4.0 / 3.0 * math.pi * radius**3 / inscribed.volume) ** (1.0 / 3.0)
    center = np.array([radius, 0.0, 0.0])
    points = center + (inscribed.points - center) * scale
    return Surface(points, inscribed.triangles, inscribed.part, inscribed.part_names)


def hb2(diameter: float = 1.0, segments: int = 96, arc_points: int = 24) -> Surface:
    """The AGARD HB-2 hypervelocity ballistic model.

    Spherical nose, 25 deg cone, fairing arc, cylinder, flare fairing arc, 10 deg flare, flat base; in cylinder
    diameters the length is 4.9, the nose radius 0.3, the arcs' radii 0.7 and 4.0, the base diameter 1.6.

    Args:
        diameter: diameter of the cylinder, m.
        segments: facets around the axis.
        arc_points: stations on each arc.

    Source: Gray, AEDC-TDR-64-137 (1964), figure 1.
    """
    cone_angle, flare_angle, nose, shoulder, fairing = math.radians(25.0), math.radians(10.0), 0.3, 0.7, 4.0
    polar = np.linspace(0.0, 0.5 * math.pi - cone_angle, arc_points)
    cap = np.stack([nose * (1.0 - np.cos(polar)), nose * np.sin(polar)], axis=1)
    # Shoulder arc: tangent to the 25 deg cone and to the cylinder of radius 0.5, centre below the cylinder's surface.
    turn = np.linspace(cone_angle, 0.0, arc_points)
    x_cone, r_cone = cap[-1]
    r_tangent = 0.5 - shoulder * (1.0 - math.cos(cone_angle))
    x_tangent = x_cone + (r_tangent - r_cone) / math.tan(cone_angle)
    x_center = x_tangent + shoulder * math.sin(cone_angle)
    arc = np.stack([x_center - shoulder * np.sin(turn), 0.5 - shoulder * (1.0 - np.cos(turn))], axis=1)
    # Flare arc: tangent to the cylinder and to the 10 deg flare that ends at radius 0.8, x = 4.9.
    r_flare = 0.5 + fairing * (1.0 - math.cos(flare_angle))
    x_flare = 4.9 - (0.8 - r_flare) / math.tan(flare_angle)
    x_start = x_flare - fairing * math.sin(flare_angle)
    turn = np.linspace(0.0, flare_angle, arc_points)
    flare = np.stack([x_start + fairing * np.sin(turn), 0.5 + fairing * (1.0 - np.cos(turn))], axis=1)
    profile = np.vstack([cap, arc, flare, [[4.9, 0.8], [4.9, 0.0]]])
    profile[0] = 0.0
    profile = profile * [1.0, _equal_area_factor(segments)]
    return revolve(profile * diameter, segments, base_from=len(profile) - 2)


def basic_finner(segments: int = 96) -> Surface:
    """The Basic Finner: a cone-cylinder of 10 calibres with four square fins, one calibre being 1 m.

    10 deg cone, cylinder, flat base; fins of one calibre in chord and exposed span in the planes y = 0 and z = 0, flush
    with the base, wedges from a sharp leading edge to a thickness of 0.08 at the trailing edge.

    Args:
        segments: facets around the axis.

    Returns:
        A surface with the parts `forebody`, `base` and `fins`.

    Source: Dupuis and Hathaway, DREV-TM-9703 (1997), figure 1.
    """
    nose, radius = 0.5 / math.tan(math.radians(10.0)), 0.5 * _equal_area_factor(segments)
    body = revolve(np.array([(0.0, 0.0), (nose, radius), (10.0, radius), (10.0, 0.0)]), segments, base_from=2)
    # Leading edge, upper and lower trailing edge at the root (inside the body) and at the tip.
    section = np.array([(9.0, 0.0), (10.0, 0.04), (10.0, -0.04)])
    points = np.array([(x, span, z) for span in (0.3, 1.5) for x, z in section])
    triangles = np.array([(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (0, 3, 5), (0, 5, 2), (1, 2, 5), (1, 5, 4)])
    quarter = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    fins = [points @ np.linalg.matrix_power(quarter, k).T for k in range(4)]
    return union(body, [Surface(fin, triangles, np.zeros(len(triangles), np.int32), ("fins",)) for fin in fins])


def union(body: Surface, others: list[Surface]) -> Surface:
    """Closed surface of a body and others that stick out of it; equal part names are one part.

    Raises:
        GeometryError: a surface that is not closed.
    """
    import manifold3d

    names = tuple(dict.fromkeys(name for surface in (body, *others) for name in surface.part_names))
    solids = []
    for surface in (body, *others):
        number = np.array([names.index(name) for name in surface.part_names])
        what = " and ".join(surface.part_names)
        solids.append(solid_of(surface.points, surface.triangles, what, number[surface.part]))
    mesh = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add).to_mesh64()
    points, triangles = welded(mesh)
    used, compact = np.unique(triangles, return_inverse=True)
    return Surface(points[used], compact.reshape(-1, 3).astype(np.int64), np.array(mesh.face_id, dtype=np.int32), names)


def m6(stations: int = 24) -> Surface:
    """The ONERA M6 wing, both halves, from 0 at the leading edge of the root; flat tips.

    Args:
        stations: strips from root to tip.

    Source: Schmitt and Charpin, AGARD AR-138 (1979), chapter B1; ordinates as in the NPARC archive.
    """
    ring = np.concatenate([M6_ORDINATES[::-1], (M6_ORDINATES * [1.0, -1.0])[1:]])
    count, rows = len(ring), 2 * stations + 1
    side = np.arange(-stations, stations + 1) / stations
    chord = M6_ROOT_CHORD * (1.0 - (1.0 - M6_TAPER) * np.abs(side))
    points = np.empty((rows, count, 3))
    sweep = M6_SEMI_SPAN * math.tan(M6_LEADING_EDGE_SWEEP)
    points[..., 0] = sweep * np.abs(side)[:, None] + chord[:, None] * ring[:, 0]
    points[..., 1] = M6_SEMI_SPAN * side[:, None]
    points[..., 2] = chord[:, None] * ring[:, 1]
    here = (count * np.arange(rows - 1)[:, None] + np.arange(count)).ravel()
    following = (count * np.arange(rows - 1)[:, None] + (np.arange(count) + 1) % count).ravel()
    # The ring runs from the upper trailing edge over the nose to the lower one.
    triangles = [
        np.stack([here, following + count, following], axis=1),
        np.stack([here, here + count, following + count], axis=1),
    ]
    # Each tip is a strip between the upper and the lower side, which meet at the nose.
    nose = count // 2
    up, low = np.arange(nose), count - 1 - np.arange(nose)
    cap = np.concatenate([np.stack([up, low - 1, low], axis=1), np.stack([up, up + 1, low - 1], axis=1)[:-1]])
    triangles += [cap, (rows - 1) * count + cap[:, ::-1]]
    every = np.concatenate(triangles).astype(np.int64)
    return Surface(points.reshape(-1, 3), every, np.zeros(len(every), np.int32), ("wing",))


def _exact_cosine(segments: int) -> np.ndarray:
    """[segments] cosine of equally spaced angles, symmetric to the last bit about both axes."""
    quarter = np.sin(0.5 * math.pi * np.arange(segments // 4 + 1) / (segments // 4))
    quarter[-1] = 1.0
    up, down = quarter[:-1], quarter[:0:-1]
    return np.concatenate([down, -up, -down, up])


def _equal_area_factor(segments: int) -> float:
    """Radius factor that gives a regular polygon the area of its circle."""
    step = 2.0 * math.pi / segments
    return math.sqrt(step / math.sin(step))
