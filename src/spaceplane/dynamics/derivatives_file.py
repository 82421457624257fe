"""Reader of the TOML file of `spaceplane modes`: a flight point, a vehicle and its derivatives, without any flow."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from spaceplane.aero.model.derivatives import (
    CONTROL_DERIVATIVES,
    DAMPING,
    STATIC,
    Derivatives,
    from_mapping,
    per_radian,
)
from spaceplane.dynamics import toml_tables
from spaceplane.dynamics.flightpoint import FlightPoint, flight_point
from spaceplane.dynamics.given_errors import given_error, half_widths
from spaceplane.dynamics.linearise import FORMS, check_form
from spaceplane.dynamics.sensitivity import AT_POINT, PARAMETERS, value_of
from spaceplane.errors import InputError
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

if TYPE_CHECKING:
    from spaceplane.aero.model.model import AeroModel

UNITS = ("per_degree", "per_radian")
FLIGHT_REQUIRED = ("mach", "altitude_m", "alpha_deg", "gamma_deg", "bank_deg", "CL", "CD")
FLIGHT_OPTIONAL = ("pressure_Pa", "temperature_K")
VEHICLE_REQUIRED = ("mass_kg", "Ixx_kgm2", "Iyy_kgm2", "Izz_kgm2", "area_m2", "c_ref_m", "b_ref_m")
VEHICLE_OPTIONAL = ("Ixz_kgm2",)
SAMPLES = 2000
AIRFRAME_NUMBERS = ("Cm", "elevator_deg", "rudder_per_aileron")
AIRFRAME_KEYS = ("load_factors", "speed_range")
UNCERTAINTY_KEYS = ("correlation", "samples", "seed")
MODEL_KEYS = ("form", "density_gradient", "gyroscopic", "vehicle_class", "category")


@dataclass(frozen=True)
class ModesCase:
    """What `spaceplane modes` works on, SI and rad.

    Attributes:
        point: flight point with CL and CD.
        mass: mass and inertia.
        reference: reference area and lengths; the moment centre is not known from derivatives alone and set to zero.
        derivatives: per rad and per unit Mach.
        form: form of the linear model.
        density_gradient: whether the air changes with height (`rigid-body` only).
        gyroscopic: whether gyroscopic moments of the steady turning rates are kept (`rigid-body` only).
        vehicle_class: of MIL-F-8785C.
        category: flight phase category of MIL-F-8785C.
        given: the file's content as read.
        uncertainty: name to half width of the 95 % interval, per rad and per unit Mach number; empty without any.
        correlation: pairs of uncertain names to coefficient of correlation.
        samples: draws for probabilities.
        seed: of the draws.
        airframe: what criteria on the airframe take beside: `pitching_moment`, `elevator` (rad), `load_factors` (g),
            `speed_range`, `rudder_per_aileron`, each only where it is given.
    """

    point: FlightPoint
    mass: MassProperties
    reference: ReferenceLengths
    derivatives: Derivatives
    form: str
    density_gradient: bool
    gyroscopic: bool
    vehicle_class: str
    category: str
    given: Mapping[str, Mapping[str, object]]
    uncertainty: Mapping[str, float] = field(default_factory=dict)
    correlation: Mapping[tuple[str, str], float] = field(default_factory=dict)
    samples: int = SAMPLES
    seed: int = 0
    airframe: Mapping[str, object] = field(default_factory=dict)


def read(path: str | Path) -> ModesCase:
    """Read a derivatives file.

    Raises:
        InputError: the file cannot be read or parsed, or `from_tables` refuses its content. One line.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read ({_one_line(error)})") from error
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not a TOML file ({_one_line(error)})") from error
    try:
        return from_tables(content)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def from_tables(content: Mapping[str, object]) -> ModesCase:
    """The case of a parsed file.

    Raises:
        InputError: an unknown or missing table or key, or a value that is no finite number or out of its limits.
    """
    toml_tables.known("", content, ("flight", "vehicle", "derivatives", "model", "uncertainty", "airframe"))
    flight = toml_tables.numbers(content, "flight", FLIGHT_REQUIRED, FLIGHT_OPTIONAL)
    vehicle = toml_tables.numbers(content, "vehicle", VEHICLE_REQUIRED, VEHICLE_OPTIONAL)
    for name, value in vehicle.items():
        if value <= 0 and name not in VEHICLE_OPTIONAL:
            raise InputError(f"[vehicle] {name} = {value:g}: must be above 0")
    form, density_gradient, gyroscopic, vehicle_class, category = _model(content)
    mass = MassProperties(*(vehicle[key] for key in VEHICLE_REQUIRED[:4]), vehicle.get("Ixz_kgm2", 0.0))
    check_form(form, mass)
    point, derivatives = flight_point(**flight), _derivatives(content)
    return ModesCase(
        point=point,
        mass=mass,
        reference=ReferenceLengths(vehicle["area_m2"], vehicle["c_ref_m"], vehicle["b_ref_m"], (0.0, 0.0, 0.0)),
        derivatives=derivatives,
        form=form,
        density_gradient=density_gradient,
        gyroscopic=gyroscopic,
        vehicle_class=vehicle_class,
        category=category,
        given={key: dict(toml_tables.table(content, key)) for key in content},
        **_uncertainty(content, point, derivatives),
        airframe=_airframe(content),
    )


def aero_model(case: ModesCase, name: str = "derivatives file") -> AeroModel:
    """The aerodynamics of a case, linear about its flight point and trimmed there without deflections.

    The file does not say where its moment centre is, so the model cannot be moved to another.

    Args:
        case: as read.
        name: of the model.
    """
    from spaceplane.aero.model.from_derivatives import linear_model  # the reader alone needs no aerodynamics

    point = case.point
    CL, CD = point.coefficients()
    return linear_model(name, case.derivatives, case.reference, point.mach, point.alpha, CL, CD, center_known=False)


def _derivatives(content: Mapping[str, object]) -> Derivatives:
    table = toml_tables.table(content, "derivatives")
    if "unit" not in table:
        raise InputError('[derivatives] unit: missing; give "per_degree" or "per_radian"')
    if table["unit"] not in UNITS:
        raise InputError(f"[derivatives] unit = {table['unit']!r}: must be one of {', '.join(UNITS)}")
    values = toml_tables.numbers(content, "derivatives", STATIC, (*DAMPING, *CONTROL_DERIVATIVES), ignore=("unit",))
    return from_mapping(per_radian(values) if table["unit"] == "per_degree" else values)


def _airframe(content: Mapping[str, object]) -> dict[str, object]:
    if "airframe" not in content:
        return {}
    table = toml_tables.table(content, "airframe")
    numbers = toml_tables.numbers(content, "airframe", (), AIRFRAME_NUMBERS, ignore=AIRFRAME_KEYS)
    found: dict[str, object] = {}
    if "Cm" in numbers:
        found["pitching_moment"] = numbers["Cm"]
    if "elevator_deg" in numbers:
        found["elevator"] = math.radians(numbers["elevator_deg"])
    if "rudder_per_aileron" in numbers:
        found["rudder_per_aileron"] = numbers["rudder_per_aileron"]
    if "speed_range" in table:
        found["speed_range"] = table["speed_range"]
    if "load_factors" in table:
        pair = table["load_factors"]
        good = isinstance(pair, list) and len(pair) == 2
        if not (good and all(isinstance(x, int | float) and not isinstance(x, bool) for x in pair)):
            raise InputError(
                f"[airframe] load_factors = {pair!r}: must be two numbers, a least below 1 g and a greatest"
            )
        found["load_factors"] = (float(pair[0]), float(pair[1]))
    return found


def _uncertainty(content: Mapping[str, object], point: FlightPoint, derivatives: Derivatives) -> dict:
    """Half widths in the unit of `[derivatives]` or as shares, C_L and C_D among them; correlations, samples, seed."""
    if "uncertainty" not in content:
        return {}
    table = toml_tables.table(content, "uncertainty")
    errors = {}
    per_degree = toml_tables.table(content, "derivatives")["unit"] == "per_degree"
    for name, value in table.items():
        if name in UNCERTAINTY_KEYS:
            continue
        one = given_error("[uncertainty]", name, value)
        if not one.relative and name not in AT_POINT and per_degree:
            one = replace(one, amount=per_radian({name: one.amount})[name])
        if one.relative and one.amount and name in PARAMETERS and not value_of(name, point, derivatives):
            raise InputError(f"[uncertainty] {name} = {value!r}: a share of nothing, since {name} is 0")
        errors[name] = one
    widths = half_widths(errors, point, derivatives, "[uncertainty]")
    whole = {}
    for key, default, least in (("samples", SAMPLES, 1), ("seed", 0, 0)):
        value = table.get(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= 1_000_000:
            raise InputError(f"[uncertainty] {key} = {value!r}: must be a whole number from {least} to 1000000")
        whole[key] = value
    return {"uncertainty": widths, "correlation": _correlation(table, widths), **whole}


def _correlation(table: Mapping[str, object], widths: Mapping[str, float]) -> dict[tuple[str, str], float]:
    rows = table.get("correlation", [])
    wanted = 'a list of ["name", "name", coefficient] with different names of this table and -1 to 1'
    if not isinstance(rows, list):
        raise InputError(f"[uncertainty] correlation = {rows!r}: must be {wanted}")
    found = {}
    for row in rows:
        good = isinstance(row, list) and len(row) == 3 and all(isinstance(name, str) for name in row[:2])
        good = good and len(set(row[:2])) == 2 and set(row[:2]) <= set(widths)
        good = good and isinstance(row[2], int | float) and not isinstance(row[2], bool) and abs(row[2]) <= 1
        if not good:
            raise InputError(f"[uncertainty] correlation {row!r}: must be {wanted}")
        found[row[0], row[1]] = float(row[2])
    return found


def _model(content: Mapping[str, object]) -> tuple[str, bool, bool, str, str]:
    table = toml_tables.table(content, "model") if "model" in content else {}
    toml_tables.known("model", table, MODEL_KEYS)
    form = table.get("form", FORMS[0])
    if form not in FORMS:
        raise InputError(f"[model] form = {form!r}: must be one of {', '.join(FORMS)}")
    switches = []
    for key in ("density_gradient", "gyroscopic"):
        value = table.get(key, True)
        if not isinstance(value, bool):
            raise InputError(f"[model] {key} = {value!r}: must be true or false")
        switches.append(value)
    texts = []
    for key, default in (("vehicle_class", "III"), ("category", "B")):
        value = table.get(key, default)
        if not isinstance(value, str):
            raise InputError(f"[model] {key} = {value!r}: must be a text, such as {default!r}")
        texts.append(value)
    return str(form), switches[0], switches[1], texts[0], texts[1]


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
