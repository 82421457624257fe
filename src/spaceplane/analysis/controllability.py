"""What the controls can do at one flight point, the least feedback that stabilises it, and whether they suffice.

Measures: controllable rank, Popov-Belevitch-Hautus distance and reach of each input by mode, the largest offset that
limited surfaces hold, least energy by the Gramian (`spaceplane.control`). The feedback is the linear quadratic
regulator of least effort; with it modes and MIL-F-8785C levels, and what gusts and offsets ask of the surfaces.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from spaceplane.analysis.control_demand import Demand, demand, disturbances
from spaceplane.analysis.control_inputs import Inputs, unknown_damping, usable_inputs
from spaceplane.analysis.feedback_settings import FeedbackSettings
from spaceplane.analysis.time_responses import Response, responses
from spaceplane.control.closed_loop import ClosedLoop, close
from spaceplane.control.gramians import energy_to_rest
from spaceplane.control.holding import Held, largest_held
from spaceplane.control.measures import ModalControl, controllable_rank, modal_control
from spaceplane.control.regulator import Regulator, minimum_effort
from spaceplane.dynamics.linearise import FORMS
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.environment.constants import STANDARD_GRAVITY
from spaceplane.errors import InputError
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.assess import load_factor_slope

SLOW = math.log(2.0) / 55.0
"""1/s: what takes 55 s or more to double needs no feedback (level 3 of the phugoid, MIL-F-8785C 3.2.1.2)."""
UNREACHED = 1e-12
"""Of the norm of A: a mode nearer than this to an uncontrollable one is out of reach."""


@dataclass(frozen=True)
class ModeControl:
    """What the inputs can do to one mode.

    Attributes:
        by_all: by surfaces and thrusters.
        by_surfaces: by the surfaces alone; None without any.
    """

    by_all: ModalControl
    by_surfaces: ModalControl | None

    @property
    def growing(self) -> bool:
        """Whether the motion grows."""
        return self.by_all.mode.eigenvalue.real > 0.0


@dataclass(frozen=True)
class Controllability:
    """What was found at one flight point.

    Attributes:
        settings: gust, offset, limits.
        inputs: surfaces and thrusters; None where `reason` says why.
        unknown: damping derivatives that the linear model lacks.
        moved: number of states that all inputs together move, and the surfaces alone.
        states: number of states.
        modes: every mode, fastest first.
        uncontrolled: names of the modes that the surfaces alone cannot reach.
        held: {"alpha": ..., "beta": ...} the largest offsets, rad, that the surfaces hold whatever the law, growth
            slower than `SLOW` left aside; only those whose axis has a surface.
        energy: {"alpha": ..., "beta": ...} least energy, s, that brings the offset of the settings to rest.
        regulator: least-effort feedback; None where `reason` says why.
        demands: what each disturbance asks of it.
        closed: the closed loop with its modes and levels.
        responses: motions of open and closed loop.
        reason: why something is missing; empty where nothing is.
    """

    settings: FeedbackSettings
    inputs: Inputs | None = None
    unknown: tuple[str, ...] = ()
    moved: tuple[int, int] = (0, 0)
    states: int = 0
    modes: tuple[ModeControl, ...] = ()
    uncontrolled: tuple[str, ...] = ()
    held: Mapping[str, Held] = field(default_factory=dict)
    energy: Mapping[str, float] = field(default_factory=dict)
    regulator: Regulator | None = None
    demands: tuple[Demand, ...] = ()
    closed: ClosedLoop | None = None
    responses: tuple[Response, ...] = ()
    reason: str = ""

    @property
    def within(self) -> bool | None:
        """Whether every disturbance leaves all surfaces within their limits; None without a feedback or surfaces."""
        if self.regulator is None or self.inputs is None or not self.inputs.surfaces:
            return None
        return all(one.within for one in self.demands)


def controllability(
    airframe: Airframe,
    system: StateSpace,
    trim: Mapping[str, float],
    settings: FeedbackSettings | None = None,
    vehicle_class: str = "III",
    category: str = "B",
) -> Controllability:
    """Measures, feedback, demands and closed loop at one flight point; the reason where there is no feedback.

    Args:
        airframe: vehicle at its flight point.
        system: its linear model, rigid-body form.
        trim: deflections of surfaces there, rad.
        settings: defaults when None.
        vehicle_class: I, II-L, II-C, III or IV.
        category: flight phase category A, B or C.

    Raises:
        InputError: unknown class or category.
    """
    settings = settings or FeedbackSettings()
    if system.form != FORMS[0]:
        return Controllability(settings, reason=f"only the {FORMS[0]} form has the axes of the controls and gusts")
    unknown = unknown_damping(airframe.derivatives)
    try:
        inputs = usable_inputs(airframe.derivatives, trim, settings.thruster)
    except InputError as error:
        return Controllability(settings, unknown=unknown, reason=str(error))
    measured = _measures(system, inputs, settings)
    try:
        regulator = minimum_effort(system, inputs.limits, settings.decay)
    except InputError as error:
        return Controllability(settings, inputs, unknown, **measured, reason=str(error))
    events = disturbances(airframe, settings)
    a = airframe
    weight = a.mass.mass * STANDARD_GRAVITY
    n_alpha = load_factor_slope(a.derivatives.CL_alpha, a.point.dynamic_pressure, a.reference.area, weight)
    return Controllability(
        settings,
        inputs,
        unknown,
        **measured,
        regulator=regulator,
        demands=tuple(demand(event, regulator, system, settings) for event in events),
        closed=close(regulator, vehicle_class, category, n_alpha),
        responses=responses(regulator, events),
    )


def _measures(system: StateSpace, inputs: Inputs, settings: FeedbackSettings) -> dict:
    """Rank, modal control, held offsets and energy."""
    surfaces = inputs.of_surfaces()
    by_all = modal_control(system, inputs.limits)
    by_surfaces = modal_control(system, surfaces) if surfaces else (None,) * len(by_all)
    modes = tuple(ModeControl(*pair) for pair in zip(by_all, by_surfaces, strict=True))
    bound = UNREACHED * float(np.linalg.norm(system.A))
    out = tuple(one.by_all.mode.name for one in modes if one.by_surfaces is None or one.by_surfaces.distance <= bound)
    axes = {"alpha": {"elevator"}, "beta": {"aileron", "rudder"}}
    held = {axis: controls & set(inputs.surfaces) for axis, controls in axes.items()}
    return {
        "moved": (
            controllable_rank(system, inputs.limits),
            controllable_rank(system, surfaces) if surfaces else 0,
        ),
        "states": len(system.states),
        "modes": modes,
        "uncontrolled": out,
        "held": {axis: largest_held(system, surfaces, {axis: 1.0}, SLOW) for axis in axes if held[axis] and surfaces},
        "energy": {axis: energy_to_rest(system, inputs.limits, {axis: settings.offset}) for axis in axes},
    }
