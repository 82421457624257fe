"""The bodies that scripts/check_uncertainty.py judges the stated uncertainty by: conditions, meshes, references."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from spaceplane.aero.conditions import ConditionPlan, DerivativeSteps, plan
from spaceplane.analysis.settings import DEFLECTIONS_TAEM, QUICK_MESH
from spaceplane.dynamics.flightpoint import flight_point, taem_point
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies, finner, hb2, m6
from spaceplane.validation.flowcase import reference_of
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.presets import horus_2b
from spaceplane.vehicle.properties import ReferenceLengths
from spaceplane.vehicle.surface import Surface

HORUS, WIDE, FINNER, HB2, M6 = "HORUS-2B", "wide vehicle", "Basic Finner", "HB-2", "ONERA M6"
FINNER_DEFAULT = "Basic Finner, default mesh"
MACHS, OTHER_MACHS = (0.8, 1.5, 2.5, 5.0), (1.2, 2.0, 3.5)
WIDER = {
    "fuselage_width_m": 3.5,
    "wing_width_m": 3.8,
    "wing_thickness_m": 0.28,
    "winglet_angle_deg": 22.0,
    "winglet_length_m": 4.0,
    "nose_radius_m": 0.5,
    "fuselage_length_m": 8.0,
}
"""Shape parameters of the wide vehicle that differ from those of HORUS-2B."""
WIDE_DEFLECTIONS = ControlDeflections.from_degrees(elevon_left=5.0, elevon_right=5.0, body_flap=10.0)
CONTROL_STEP = math.radians(10.0)
CALIBRES = DerivativeSteps(rate=0.002)
"""Steps of bodies on reference lengths of one calibre: rates move their ends ten times as fast."""


@dataclass(frozen=True)
class Body:
    """A body whose reference is a fine mesh.

    Attributes:
        surface: the body.
        reference: lengths.
        plan: conditions.
        mesh: settings of the mesh whose uncertainty is stated.
        fine: settings of the reference mesh.
        moved: control surface to the body with that surface moved by CONTROL_STEP.
    """

    surface: Surface
    reference: ReferenceLengths
    plan: ConditionPlan
    mesh: MeshSettings
    fine: MeshSettings
    moved: Mapping[str, Surface] = field(default_factory=dict)


def finer(settings: MeshSettings, cell: float, growth_layers: int) -> MeshSettings:
    """Settings of a reference mesh."""
    return replace(settings, wall_cell=cell, edge_levels=1, growth_layers=growth_layers)


def horus() -> Body:
    """HORUS-2B with the deflections and the mesh that `analyse` takes by default."""
    vehicle = horus_2b()
    more = {5.0: {"alpha_deg": 10.0, "altitude_m": 20_000.0}}
    points = [taem_point(mach, **more.get(mach, {})) for mach in MACHS]
    return Body(
        build(vehicle.shape, DEFLECTIONS_TAEM),
        vehicle.reference,
        plan(points, DerivativeSteps(), True, reference=vehicle.reference),
        QUICK_MESH,
        MeshSettings(wall_cell=0.08),
        moved_surfaces(vehicle.shape, DEFLECTIONS_TAEM, ("elevon_left",)),
    )


def wide() -> Body:
    """Another vehicle, with other deflections."""
    vehicle = horus_2b()
    shape = replace(vehicle.shape, **WIDER)
    points = [taem_point(mach) for mach in OTHER_MACHS]
    return Body(
        build(shape, WIDE_DEFLECTIONS),
        vehicle.reference,
        plan(points, DerivativeSteps(), True, reference=vehicle.reference),
        QUICK_MESH,
        finer(QUICK_MESH, 0.125, 3),
        moved_surfaces(shape, WIDE_DEFLECTIONS, ("elevon_left",)),
    )


def validated_finner() -> Body:
    """The Basic Finner on the mesh and at the Mach numbers of the validation case, inclined by 4 deg."""
    reference = reference_of(math.pi / 4.0, 1.0, (finner.MOMENT_STATION, 0.0, 0.0))
    points = [flight_point(mach, 10_000.0, 4.0) for mach in finner.MEASURED]
    mesh = finner.mesh_settings(False)
    conditions = plan(points, CALIBRES, True, reference=reference)
    return Body(bodies.basic_finner(), reference, conditions, mesh, replace(mesh, wall_cell=0.4 * mesh.wall_cell))


def default_finner() -> Body:
    """The Basic Finner on a mesh as fine as the default one of `analyse` is on HORUS-2B's 25 m."""
    reference = reference_of(math.pi / 4.0, 1.0, (finner.MOMENT_STATION, 0.0, 0.0))
    points = [flight_point(mach, 10_000.0, 4.0) for mach in OTHER_MACHS]
    usual = replace(QUICK_MESH, wall_cell=QUICK_MESH.wall_cell * 10.0 / 25.0)
    conditions = plan(points, CALIBRES, True, reference=reference)
    fine = finer(usual, 0.35 * usual.wall_cell, usual.growth_layers)
    return Body(bodies.basic_finner(), reference, conditions, usual, fine)


def hb2_body() -> Body:
    """The HB-2 on the two meshes of the validation case, inclined by 2 deg."""
    reference = reference_of(math.pi / 4.0, 1.0, (hb2.MOMENT_STATION, 0.0, 0.0))
    points = [flight_point(mach, 10_000.0, 2.0) for mach in hb2.MEASURED]
    meshes = (hb2.mesh_settings(1.0 / count) for count in (12, 30))
    return Body(bodies.hb2(), reference, plan(points, DerivativeSteps()), *meshes)


def m6_body() -> Body:
    """The ONERA M6 wing on the two meshes of the validation case."""
    area = bodies.M6_ROOT_CHORD * (1.0 + bodies.M6_TAPER) * bodies.M6_SEMI_SPAN
    points = [flight_point(m6.MACH, 10_000.0, math.degrees(m6.ALPHA))]
    meshes = (m6.mesh_settings(fine) for fine in (False, True))
    return Body(bodies.m6(), reference_of(area, bodies.M6_ROOT_CHORD), plan(points, DerivativeSteps()), *meshes)


def moved_surfaces(shape, deflections: ControlDeflections, names: tuple[str, ...]) -> dict[str, Surface]:
    """The vehicle with each of the surfaces moved."""
    return {
        name: build(shape, replace(deflections, **{name: getattr(deflections, name) + CONTROL_STEP})) for name in names
    }


BODIES: dict[str, Callable[[], Body]] = {
    HORUS: horus,
    WIDE: wide,
    FINNER: validated_finner,
    FINNER_DEFAULT: default_finner,
    HB2: hb2_body,
    M6: m6_body,
}
HELD_OUT = (WIDE, FINNER, FINNER_DEFAULT, HB2, M6)
"""Bodies that neither the order nor the factors of safety were fitted with."""
