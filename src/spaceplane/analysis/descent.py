"""Flight dynamics along a descent from aerodynamic tables, without any flow computation."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.model.derivatives import PAIRS
from spaceplane.aero.model.model import LAG, AeroModel, OutsideTables
from spaceplane.analysis.controllability import Controllability, controllability
from spaceplane.analysis.feedback_settings import FeedbackSettings
from spaceplane.analysis.likelihood import Likelihood, likelihood
from spaceplane.analysis.tracked import Tracked, track
from spaceplane.dynamics.flightpoint import FlightPoint, taem_point
from spaceplane.dynamics.given_errors import GivenError
from spaceplane.dynamics.glide import glide_bank, glide_path_angle, tabulated_slope
from spaceplane.dynamics.linearise import FORMS, check_form, linearise
from spaceplane.dynamics.modes import Mode
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.dynamics.tracking import Branches
from spaceplane.dynamics.trim.longitudinal import PitchTrim, schedule_at, trim_elevator
from spaceplane.dynamics.trim.maps import trim_map
from spaceplane.errors import InputError, unknown_name
from spaceplane.progress import Progress, silent
from spaceplane.qualities import limits
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.probability import assess_all
from spaceplane.qualities.verdict import Verdict
from spaceplane.vehicle.controls import CONTROLS
from spaceplane.vehicle.properties import MassProperties

if TYPE_CHECKING:
    import xarray as xr

MACHS = (1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.5, 10.0, 12.5, 15.0, 17.5, 20.0)
GIVEN = ("alpha_deg", "altitude_m", "gamma_deg", "bank_deg")
"""What of each flight point may be given."""
MAP_STEP = math.radians(1.0)
"""Step of the trim map in angle of attack, rad."""
SAMPLES = 1000
"""Draws of uncertain derivatives at each flight point: probabilities within 0.03."""
MOST_SAMPLES = 1_000_000


@dataclass(frozen=True)
class DescentSettings:
    """How a descent is flown.

    Attributes:
        machs: increasing Mach numbers.
        alpha_deg: angle of attack at each, deg; None takes the documented schedule.
        altitude_m: altitude at each, m; None takes the descent of thesis Table 4.1.
        gamma_deg: flight-path angle at each, deg; None takes the one on which drag slows the glider down as fast as it
            descends through these altitudes.
        bank_deg: bank angle at each, deg; None takes the one that holds the path angle, 0 where lift is too little.
        body_flap: rad, everywhere; a schedule Mach number -> rad, linear in between; None, and where the schedule ends,
            chooses the one that leaves the elevator the largest margin.
        form: of the linear model, see `dynamics.linearise.FORMS`.
        vehicle_class, category: of MIL-F-8785C.
        uncertainty: errors of derivatives, C_L and C_D, for probabilities of levels; empty for none.
        correlation: pairs of uncertain names to coefficient of correlation, -1 to 1.
        samples: draws at each flight point.
        feedback: what a stabilising feedback is put to; None leaves it out.

    Raises:
        InputError: Mach numbers that do not increase or lie outside the descent of the thesis, not one value for each,
            an angle or number of draws out of range, or an unknown form, class or category.
    """

    machs: Sequence[float] = MACHS
    alpha_deg: Sequence[float] | None = None
    altitude_m: Sequence[float] | None = None
    gamma_deg: Sequence[float] | None = None
    bank_deg: Sequence[float] | None = None
    body_flap: float | Mapping[float, float] | None = None
    form: str = FORMS[0]
    vehicle_class: str = "III"
    category: str = "B"
    uncertainty: Mapping[str, GivenError] = field(default_factory=dict)
    correlation: Mapping[tuple[str, str], float] = field(default_factory=dict)
    samples: int = SAMPLES
    feedback: FeedbackSettings | None = field(default_factory=FeedbackSettings)

    def __post_init__(self) -> None:
        machs = np.asarray(self.machs, dtype=float)
        if machs.ndim != 1 or not len(machs) or not (np.diff(machs) > 0.0).all():
            raise InputError(f"mach = {', '.join(f'{m:g}' for m in machs.ravel())}: increasing values are needed")
        for name in GIVEN:
            values = getattr(self, name)
            if values is not None and len(values) != len(machs):
                raise InputError(f"{name}: {len(values)} values for {len(machs)} Mach numbers; give one for each")
        if self.gamma_deg is None and self.altitude_m is not None and len(machs) < 2:
            raise InputError("gamma_deg: is needed with a single altitude, which says nothing of how the path goes on")
        if self.form not in FORMS:
            raise InputError(f"form = {self.form!r}: must be one of {', '.join(FORMS)}")
        limits.check(self.vehicle_class, self.category)
        if not 1 <= self.samples <= MOST_SAMPLES:
            raise InputError(f"samples = {self.samples}: must be a whole number from 1 to {MOST_SAMPLES}")
        self.flight_points()

    def flight_points(self) -> list[FlightPoint]:
        """One for each Mach number, without coefficients; path and bank angle are 0 until they are known.

        Raises:
            InputError: a Mach number outside the descent of the thesis, or an angle out of range.
        """
        return [self.flight_point(mach) for mach in self.machs]

    def flight_point(self, mach: float) -> FlightPoint:
        """That at one Mach number, what is given linear between the Mach numbers."""
        known = {"gamma_deg": 0.0, "bank_deg": 0.0}
        for name in GIVEN:
            if (values := getattr(self, name)) is not None:
                known[name] = float(np.interp(mach, self.machs, values))
        return taem_point(mach, **known)

    def slope(self, mach: float) -> float | None:
        """Slope dh/dV, m per m/s, of the altitudes at a Mach number; None where path angles are given instead."""
        if self.gamma_deg is not None:
            return None
        if self.altitude_m is None:
            return tabulated_slope(mach)
        points = self.flight_points()
        slopes = np.gradient([p.altitude for p in points], [p.velocity for p in points])
        return float(np.interp(mach, self.machs, slopes))


@dataclass(frozen=True)
class DescentPoint:
    """What was found at one Mach number.

    Attributes:
        point: flight point; with the trimmed CL and CD where there is a trim.
        trim: the one with the largest margin; None where there is none.
        system: linear model about the trim; None without.
        modes, verdicts: of it.
        reason: why there is no trim or no linear model; empty where there is.
        likelihood: what moves the modes and how certain they are; None without a linear model.
        control: what the controls can do; None without a linear model or where none was asked for.
    """

    point: FlightPoint
    trim: PitchTrim | None = None
    system: StateSpace | None = None
    modes: tuple[Mode, ...] = ()
    verdicts: tuple[Verdict, ...] = ()
    reason: str = ""
    likelihood: Likelihood | None = None
    control: Controllability | None = None


@dataclass(frozen=True)
class Descent:
    """Trim, modes and flying qualities along a descent.

    Attributes:
        model: tables it is made of.
        mass: kg, kg m2.
        settings: how it is flown.
        trim_map: over Mach number and angle of attack, see `dynamics.trim.maps.trim_map`.
        points: by Mach number.
        tracked: modes followed along the Mach number.
    """

    model: AeroModel
    mass: MassProperties
    settings: DescentSettings
    trim_map: xr.Dataset
    points: tuple[DescentPoint, ...]
    tracked: Tracked

    @property
    def branches(self) -> Branches | None:
        """Modes along the Mach number; None where no two neighbours can be joined."""
        return self.tracked.branches


def descend(
    model: AeroModel, mass: MassProperties, settings: DescentSettings | None = None, progress: Progress | None = None
) -> Descent:
    """Trim map, then trim, linear model, modes and verdicts at every Mach number, and the modes followed between them.

    Nothing is extrapolated: a Mach number at which the tables hold no trim is told with the reason.

    Args:
        model: aerodynamics about the centre of mass.
        mass: kg, kg m2.
        settings: defaults when None.
        progress: called with (phase, done, total, text).

    Raises:
        InputError: a model without elevons, an error of a derivative that the model does not know, or the form
            "thesis" with a product of inertia.
    """
    settings = settings or DescentSettings()
    check_form(settings.form, mass)
    _check_errors(settings.uncertainty, model)
    say = progress or silent
    points = settings.flight_points()
    say("trim map", 0, 1, "")
    within = [m for m in settings.machs if model.mach[0] <= m <= model.mach[-1]]
    machs = np.unique(np.concatenate([model.mach, within]))
    alphas = np.arange(model.alpha[0], model.alpha[-1] + 0.5 * MAP_STEP, MAP_STEP)
    found = trim_map(model, machs.tolist(), alphas.clip(max=model.alpha[-1]).tolist(), settings.body_flap)
    flown = []
    for number, point in enumerate(points):
        say("flight dynamics", number, len(points), point.name)
        flown.append(_at(model, mass, point.mach, settings))
    say("modes between the flight points", 0, 1, "")

    def system_at(mach: float) -> StateSpace | None:
        try:
            airframe = _trimmed(model, mass, mach, settings)[2]
        except InputError:  # no glide through the altitudes in between, which takes nothing from the points flown
            return None
        if airframe is None:
            return None
        return linearise(airframe.point, mass, model.reference, airframe.derivatives, settings.form)

    tracked = track(points, [one.system for one in flown], system_at)
    return Descent(model, mass, settings, found, tuple(flown), tracked)


def _trimmed(
    model: AeroModel, mass: MassProperties, mach: float, settings: DescentSettings
) -> tuple[DescentPoint, dict[str, float], Airframe | None]:
    """Flight point and trim at one Mach number, the deflections, rad, and the airframe; None where there is none."""
    point, slope, flap = settings.flight_point(mach), settings.slope(mach), settings.body_flap
    flap = schedule_at(flap, mach) if isinstance(flap, Mapping) else flap
    trims = trim_elevator(model, mach, point.alpha, flap)
    trim = trims.best
    if trim is None:
        return DescentPoint(point, reason=trims.reason), {}, None
    deflections = {"elevon_left": trim.elevator, "elevon_right": trim.elevator}
    if "body_flap" in model.surfaces:
        deflections["body_flap"] = trim.body_flap
    point = point.with_coefficients(trim.CL, trim.CD)
    if slope is not None:
        point = replace(point, gamma=glide_path_angle(point, mass.mass, model.reference.area, slope))
    if settings.bank_deg is None:
        point = replace(point, bank=glide_bank(point, mass.mass, model.reference.area))
    try:
        derivatives = model.derivatives(point.mach, point.alpha, deflections)
    except OutsideTables as error:
        return DescentPoint(point, trim, reason=str(error)), deflections, None
    airframe = Airframe(point, mass, model.reference, derivatives, 0.0, trim.elevator)
    return DescentPoint(point, trim), deflections, airframe


def _at(model: AeroModel, mass: MassProperties, mach: float, settings: DescentSettings) -> DescentPoint:
    """Trim, linear model, modes and verdicts at one Mach number."""
    found, deflections, airframe = _trimmed(model, mass, mach, settings)
    if airframe is None:
        return found
    judged = (settings.vehicle_class, settings.category)
    assessed = assess_all(airframe, *judged, settings.form)
    asked = settings.feedback
    return replace(
        found,
        system=assessed.system,
        modes=assessed.modes,
        verdicts=assessed.verdicts,
        likelihood=likelihood(
            airframe, assessed, settings.uncertainty, *judged, settings.form, settings.samples, settings.correlation
        ),
        control=controllability(airframe, assessed.system, deflections, asked, *judged) if asked else None,
    )


def _check_errors(errors: Mapping[str, GivenError], model: AeroModel) -> None:
    """Refuse errors that cannot act, before anything is computed: a misspelt one must not pass for certain."""
    unknown = (*model.unknown(), *(name for name, value in zip(LAG, model.lag, strict=True) if not value))
    for name, error in errors.items():
        surface = name.split("_", 1)[-1]
        if surface in PAIRS or (surface in CONTROLS and name in unknown):
            known = [f"{c}_{s}" for s, table in model.surfaces.items() for c in table.increments]
            raise InputError(f"uncertainty {unknown_name('derivative of this model', name, known)}")
        if error.relative and name in unknown:
            raise InputError(f"uncertainty {name}: the model takes it as zero; give its half width, not a share")
