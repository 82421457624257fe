"""What is analysed and how, from plain values such as a YAML file's and back to them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

from spaceplane.aero.conditions import DerivativeSteps
from spaceplane.aero.increments.settings import VISCOUS, IncrementSettings, require_no_friction
from spaceplane.aero.uncertainty.settings import LOOSEST, MESH, SOURCES, TIGHTEST
from spaceplane.analysis.feedback_settings import FeedbackSettings
from spaceplane.dynamics.flightpoint import TAEM_MACH, FlightPoint, taem_point
from spaceplane.dynamics.linearise import FORMS
from spaceplane.errors import InputError, unknown_name
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import GASES, PERFECT
from spaceplane.mesh.frustum import RefinementFrustum
from spaceplane.mesh.settings import MeshSettings, RefinementBox, check_passes
from spaceplane.plain import override, plain
from spaceplane.qualities import limits
from spaceplane.vehicle.controls import ControlDeflections

DEFLECTIONS_TAEM = ControlDeflections.from_degrees(elevon_left=-17.5, elevon_right=-17.5, body_flap=-20.0)
"""Deflections of the thesis's flight points (its section 7.1)."""


def _boxes(name: str, value: Any) -> tuple[RefinementBox, ...]:
    """Refinement boxes from mappings of lower and upper corner and cell, m."""
    try:
        return tuple(RefinementBox(tuple(b["lower"]), tuple(b["upper"]), b["cell"]) for b in value)
    except (TypeError, KeyError) as error:
        raise InputError(f"{name} = {value!r}: a list of boxes, each with lower, upper and cell, is needed") from error


def _frustums(name: str, value: Any) -> tuple[RefinementFrustum, ...]:
    """Refinement frustums from mappings of their fields, m."""
    known = [f.name for f in fields(RefinementFrustum)]
    try:
        found = []
        for one in value:
            for key in one:
                if key not in known:
                    raise InputError(unknown_name("setting", f"{name}.{key}", [f"{name}.{n}" for n in known]))
            found.append(RefinementFrustum(**{k: tuple(v) if k in ("start", "end") else v for k, v in one.items()}))
        return tuple(found)
    except TypeError as error:
        wanted = "a list of frustums, each with start, end, start_radius, end_radius and cell"
        raise InputError(f"{name} = {value!r}: {wanted}, is needed") from error


def _parts(name: str, value: Any) -> tuple[str, ...]:
    """Names of parts."""
    if not isinstance(value, list | tuple) or not all(isinstance(v, str) for v in value):
        raise InputError(f"{name} = {value!r}: a list of parts' names is needed")
    return tuple(value)


def _corners(name: str, value: Any) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Lower and upper corner, m."""
    if not (
        isinstance(value, list | tuple)
        and len(value) == 2
        and all(isinstance(corner, list | tuple) and len(corner) == 3 for corner in value)
        and all(isinstance(v, int | float) and not isinstance(v, bool) for corner in value for v in corner)
    ):
        raise InputError(f"{name} = {value!r}: lower and upper corner, three numbers each, are needed")
    return tuple(value[0]), tuple(value[1])


def _word(name: str, value: Any) -> str:
    """A word; YAML reads a bare `off` as False."""
    if value is False:
        return "off"
    if not isinstance(value, str):
        raise InputError(f"{name} = {value!r}: a word is needed")
    return value


READERS = {
    "mesh.boxes": _boxes,
    "mesh.frustums": _frustums,
    "mesh.domain": _corners,
    "mesh.fine_parts": _parts,
    "increments.friction": _word,
}
"""Settings that are not numbers or words, and how each is read."""


QUICK_MESH = MeshSettings(wall_cell=0.3, growth_layers=2, fine_edges=True, edge_levels=2)
"""Of meshes of 75 000 to 90 000 cells about HORUS-2B the one nearest to a fine mesh, see docs/method.md."""


@dataclass(frozen=True)
class AnalyseSettings:
    """What is analysed and how; every field has a default.

    Attributes:
        mach: Mach number of each flight point.
        alpha_deg: angle of attack of each, deg; None takes the documented schedule.
        altitude_m: altitude of each, m; None takes the descent of thesis Table 4.1.
        gamma_deg: flight-path angle of each, deg; None takes the thesis's.
        bank_deg: bank angle of each, deg; None takes the thesis's.
        deflections: control surfaces of the base body, rad.
        controls: whether control derivatives are computed (one more body and mesh per surface).
        control_step: deflection step of control derivatives, rad.
        steps: steps of the stability derivatives.
        mesh: how to mesh; the default, wall cells of 0.3 m and finer ones at sharp edges, is meant to answer in about
            two minutes on two cores.
        adapt: passes, 0 to 3, that adapt the mesh to the flow at the base conditions; the last mesh has
            `mesh.target_cells`.
        flow: how to solve.
        gas: perfect, or equilibrium air at each point's altitude, without skin friction.
        increments: viscous increments over the inviscid coefficients: turbulent skin friction and a correlated base.
        uncertainty: "mesh" solves everything again on a coarser companion mesh, for the uncertainty of coefficients and
            derivatives by the mesh (a third more time); "iteration" leaves that out.
        accuracy: choose the wall cell such that the uncertainty of C_L, C_D and C_m at the base conditions falls below
            this fraction of the force coefficient's size; `mesh.target_cells` is then the most cells, what fits into
            memory without it.
        form: form of the linear model.
        vehicle_class: class of MIL-F-8785C.
        category: flight phase category of MIL-F-8785C.
        feedback: what a stabilising feedback is put to.
    """

    mach: tuple[float, ...] = TAEM_MACH
    alpha_deg: tuple[float, ...] | None = None
    altitude_m: tuple[float, ...] | None = None
    gamma_deg: tuple[float, ...] | None = None
    bank_deg: tuple[float, ...] | None = None
    deflections: ControlDeflections = DEFLECTIONS_TAEM
    controls: bool = True
    control_step: float = math.radians(10.0)
    steps: DerivativeSteps = field(default_factory=DerivativeSteps)
    mesh: MeshSettings = QUICK_MESH
    adapt: int = 0
    flow: FlowSettings = field(default_factory=FlowSettings)
    gas: str = PERFECT
    increments: IncrementSettings = VISCOUS
    uncertainty: str = MESH
    accuracy: float | None = None
    form: str = "rigid-body"
    vehicle_class: str = "III"
    category: str = "B"
    feedback: FeedbackSettings = field(default_factory=FeedbackSettings)

    def __post_init__(self) -> None:
        if not self.mach:
            raise InputError("mach: at least one Mach number is needed")
        for mach in self.mach:
            if not (math.isfinite(mach) and mach > 0.0):
                raise InputError(f"mach = {mach}: a positive number is needed")
        for name in ("alpha_deg", "altitude_m", "gamma_deg", "bank_deg"):
            values = getattr(self, name)
            if values is not None and len(values) != len(self.mach):
                raise InputError(f"{name}: {len(values)} values for {len(self.mach)} Mach numbers; give one for each")
        if check_passes("adapt", self.adapt):
            if self.mesh.target_cells is None:
                raise InputError(f"adapt = {self.adapt}: needs mesh.target_cells, the number of cells of the last mesh")
            if self.accuracy is not None:
                raise InputError(f"adapt = {self.adapt}: not allowed with accuracy, which refines the whole mesh")
        if self.accuracy is not None:
            if not TIGHTEST <= self.accuracy <= LOOSEST:
                raise InputError(f"accuracy = {self.accuracy}: allowed are {TIGHTEST:g} to {LOOSEST:g}")
            if self.uncertainty != MESH:
                raise InputError(f"accuracy = {self.accuracy}: needs uncertainty = '{MESH}'")
        if not 0.0 < self.control_step <= math.radians(20.0):
            raise InputError(f"control_step = {math.degrees(self.control_step):g} deg: above 0 and at most 20 deg")
        for name, value, allowed in (
            ("form", self.form, FORMS),
            ("vehicle_class", self.vehicle_class, limits.CLASSES),
            ("category", self.category, limits.CATEGORIES),
            ("uncertainty", self.uncertainty, SOURCES),
            ("gas", self.gas, GASES),
        ):
            if value not in allowed:
                raise InputError(f"{name} = {value!r}: allowed are {', '.join(allowed)}")
        require_no_friction(self.gas, self.increments)

    @classmethod
    def from_mapping(cls, values: Mapping) -> AnalyseSettings:
        """Settings from nested plain values, such as a YAML file's: {"mach": [2.5], "mesh": {"wall_cell": 0.2}}.

        A field kept in rad may be given in degrees with `_deg` at the end of its name; deflections are given in degrees
        by name of the surface. What is not named keeps its default.

        Raises:
            InputError: unknown name (with the nearest valid one) or a value that is not allowed.
        """
        values = dict(values)
        deflections = values.pop("deflections", None)
        mesh = values.get("mesh")
        if isinstance(mesh, Mapping) and "wall_cell" in mesh:
            if values.get("accuracy") is not None:
                raise InputError(f"mesh.wall_cell = {mesh['wall_cell']!r}: accuracy chooses it; give one of the two")
            # a wall cell that is asked for is not for the target to move
            values["mesh"] = {"target_cells": None, **mesh}
        settings = override(cls(), values, READERS)
        if deflections is None:
            return settings
        if not isinstance(deflections, Mapping):
            raise InputError(f"deflections = {deflections!r}: degrees by name of the surface are needed")
        merged = DEFLECTIONS_TAEM.to_degrees() | dict(deflections)
        return replace(settings, deflections=ControlDeflections.from_degrees(merged))

    def as_dict(self) -> dict:
        """Resolved settings as plain values that `from_mapping` takes back; deflections in degrees."""
        return plain(self) | {"deflections": self.deflections.to_degrees()}

    def flight_points(self) -> tuple[FlightPoint, ...]:
        """The flight points, with names of their own.

        Raises:
            InputError: a Mach number outside the tables without altitude or angle of attack given.
        """
        points = []
        for i, mach in enumerate(self.mach):
            given = {
                name: getattr(self, name)[i]
                for name in ("alpha_deg", "altitude_m", "gamma_deg", "bank_deg")
                if getattr(self, name) is not None
            }
            point = taem_point(mach, **given)
            if self.mach.count(mach) > 1:
                point = replace(point, name=f"{point.name}, alpha {math.degrees(point.alpha):g} deg")
            if point.name in (p.name for p in points):
                raise InputError(f"mach: {point.name} is asked twice")
            points.append(point)
        return tuple(points)
