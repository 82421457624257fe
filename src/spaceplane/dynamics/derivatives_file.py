"""Reader of the TOML file of `spaceplane modes`: a flight point, a vehicle and its derivatives, without any flow."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from spaceplane.dynamics.derivatives import (
    CONTROL_DERIVATIVES,
    DAMPING,
    STATIC,
    Derivatives,
    from_mapping,
    per_radian,
)
from spaceplane.dynamics.flightpoint import FlightPoint, flight_point
from spaceplane.dynamics.linearise import FORMS
from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

if TYPE_CHECKING:
    from spaceplane.aero.model.model import AeroModel

UNITS = ("per_degree", "per_radian")
FLIGHT_REQUIRED = ("mach", "altitude_m", "alpha_deg", "gamma_deg", "bank_deg", "CL", "CD")
FLIGHT_OPTIONAL = ("pressure_Pa", "temperature_K")
VEHICLE_REQUIRED = ("mass_kg", "Ixx_kgm2", "Iyy_kgm2", "Izz_kgm2", "area_m2", "c_ref_m", "b_ref_m")
MODEL_KEYS = ("form", "density_gradient", "gyroscopic", "vehicle_class", "category")


@dataclass(frozen=True)
class ModesCase:
    """What `spaceplane modes` works on, SI and rad.

    Attributes:
        point: flight point with CL and CD.
        mass: mass and moments of inertia.
        reference: reference area and lengths; the moment centre is not known from derivatives alone and set to zero.
        derivatives: per rad and per unit Mach.
        form: form of the linear model.
        density_gradient: whether the air changes with height (`rigid-body` only).
        gyroscopic: whether gyroscopic moments of the steady turning rates are kept (`rigid-body` only).
        vehicle_class: of MIL-F-8785C.
        category: flight phase category of MIL-F-8785C.
        given: the file's content as read.
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
    _known("", content, ("flight", "vehicle", "derivatives", "model"))
    flight = _numbers(content, "flight", FLIGHT_REQUIRED, FLIGHT_OPTIONAL)
    vehicle = _numbers(content, "vehicle", VEHICLE_REQUIRED, ())
    for name, value in vehicle.items():
        if value <= 0:
            raise InputError(f"[vehicle] {name} = {value:g}: must be above 0")
    form, density_gradient, gyroscopic, vehicle_class, category = _model(content)
    return ModesCase(
        point=flight_point(**flight),
        mass=MassProperties(*(vehicle[key] for key in VEHICLE_REQUIRED[:4])),
        reference=ReferenceLengths(vehicle["area_m2"], vehicle["c_ref_m"], vehicle["b_ref_m"], (0.0, 0.0, 0.0)),
        derivatives=_derivatives(content),
        form=form,
        density_gradient=density_gradient,
        gyroscopic=gyroscopic,
        vehicle_class=vehicle_class,
        category=category,
        given={key: dict(_table(content, key)) for key in content},
    )


def aero_model(case: ModesCase, name: str = "derivatives file") -> AeroModel:
    """The aerodynamics of a case, linear about its flight point and trimmed there without deflections.

    The file does not say where its moment centre is, so the model should not be moved to another.

    Args:
        case: as read.
        name: of the model.
    """
    from spaceplane.aero.model.from_derivatives import linear_model  # the reader alone needs no aerodynamics

    point = case.point
    CL, CD = point.coefficients()
    return linear_model(name, case.derivatives, case.reference, point.mach, point.alpha, CL, CD)


def _derivatives(content: Mapping[str, object]) -> Derivatives:
    table = _table(content, "derivatives")
    if "unit" not in table:
        raise InputError('[derivatives] unit: missing; give "per_degree" or "per_radian"')
    if table["unit"] not in UNITS:
        raise InputError(f"[derivatives] unit = {table['unit']!r}: must be one of {', '.join(UNITS)}")
    values = _numbers(content, "derivatives", STATIC, (*DAMPING, *CONTROL_DERIVATIVES), ignore=("unit",))
    return from_mapping(per_radian(values) if table["unit"] == "per_degree" else values)


def _model(content: Mapping[str, object]) -> tuple[str, bool, bool, str, str]:
    table = _table(content, "model") if "model" in content else {}
    _known("model", table, MODEL_KEYS)
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


def _table(content: Mapping[str, object], name: str) -> Mapping[str, object]:
    table = content.get(name)
    if table is None:
        raise InputError(f"[{name}]: the table is missing")
    if not isinstance(table, Mapping):
        raise InputError(f"{name} = {table!r}: must be a table [{name}]")
    return table


def _numbers(
    content: Mapping[str, object],
    name: str,
    required: tuple[str, ...],
    optional: tuple[str, ...],
    ignore: tuple[str, ...] = (),
) -> dict[str, float]:
    """The finite numbers of a table."""
    table = _table(content, name)
    _known(name, table, (*required, *optional, *ignore))
    missing = [key for key in required if key not in table]
    if missing:
        raise InputError(f"[{name}] {', '.join(missing)}: missing")
    numbers = {}
    for key, value in table.items():
        if key in ignore:
            continue
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise InputError(f"[{name}] {key} = {value!r}: must be a finite number")
        numbers[key] = float(value)
    return numbers


def _known(table: str, content: Mapping[str, object], allowed: tuple[str, ...]) -> None:
    for key in content:
        if key not in allowed:
            message = unknown_name("key" if table else "table", key, allowed)
            raise InputError(f"[{table}] {message}" if table else message)


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
