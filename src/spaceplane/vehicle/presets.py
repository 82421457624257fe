"""Named vehicles, and vehicles from YAML files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from spaceplane.errors import InputError, unknown_name
from spaceplane.files import read_yaml
from spaceplane.vehicle.properties import (
    HORUS_MASS,
    HORUS_REFERENCE,
    MOMENT_CENTER_HEIGHT,
    MOMENT_CENTER_STATION,
    MassProperties,
    ReferenceLengths,
    scaled_reference,
)
from spaceplane.vehicle.shape import ShapeParameters, finite_number

OPTIMISED_SHAPE: dict[str, float] = {
    "winglet_length_m": 4.0,
    "fuselage_height_m": 1.0,
    "fuselage_width_m": 3.0,
    "wing_width_m": 3.9,
    "winglet_top_length_m": 3.0,
}
"""What the thesis's optimised shape changes (its chapter 7)."""

_PRESET_SHAPES: dict[str, dict[str, float]] = {"horus-2b": {}, "horus-2b-optimised": OPTIMISED_SHAPE}

PRESETS: tuple[str, ...] = tuple(_PRESET_SHAPES)
"""Names that `load` knows."""


@dataclass(frozen=True)
class Vehicle:
    """One vehicle: name, shape, mass properties and reference lengths."""

    name: str
    shape: ShapeParameters
    mass: MassProperties
    reference: ReferenceLengths


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid")


class _MassSection(_Section):
    mass_kg: float | None = None
    Ixx_kgm2: float | None = None
    Iyy_kgm2: float | None = None
    Izz_kgm2: float | None = None
    Ixz_kgm2: float | None = None


class _ReferenceSection(_Section):
    area_m2: float | None = None
    chord_m: float | None = None
    span_m: float | None = None
    moment_center_station_m: float | None = None
    moment_center_height_m: float | None = None


class _VehicleFile(_Section):
    name: str | None = None
    base: str = "horus-2b"
    shape: dict[str, object] = {}
    mass: _MassSection = _MassSection()
    reference: _ReferenceSection = _ReferenceSection()


def horus_2b() -> Vehicle:
    """HORUS-2B with its default shape."""
    return Vehicle("horus-2b", ShapeParameters(), HORUS_MASS, HORUS_REFERENCE)


def load(
    name_or_path: str | Path, overrides: Mapping[str, object] | None = None, allow_outside: bool = False
) -> Vehicle:
    """A vehicle by preset name or from a YAML file.

    The file may hold `name`, `base` (a preset to start from), `shape` (names as in `ShapeParameters`), `mass`
    (mass_kg, Ixx_kgm2, Iyy_kgm2, Izz_kgm2, Ixz_kgm2) and `reference` (area_m2, chord_m, span_m,
    moment_center_station_m, moment_center_height_m: the moment centre of the default shape, m behind the nose and
    above the reference axis; it moves with the shape by `properties.scaled_moment_center`).

    Args:
        name_or_path: a name from `PRESETS` or a path that ends in .yaml or .yml.
        overrides: shape parameters, and the two moment-centre keys, that win over the file.
        allow_outside: accept shape values outside their limits.

    Raises:
        InputError: unknown preset, file missing or damaged, unknown key, or value out of limits.
    """
    text = str(name_or_path)
    if text in _PRESET_SHAPES:
        content = _VehicleFile(name=text, base=text)
    elif text.lower().endswith((".yaml", ".yml")):
        content = _validated(Path(text), read_yaml(text, "vehicle file"))
    elif Path(text).exists():
        raise InputError(f"vehicle '{text}': a vehicle file must end in .yaml or .yml")
    else:
        raise InputError(unknown_name("vehicle preset", text, PRESETS) + " (a file must end in .yaml)")
    if content.base not in _PRESET_SHAPES:
        raise InputError(f"{text}: base: " + unknown_name("vehicle preset", content.base, PRESETS))

    overrides = dict(overrides or {})
    reference = content.reference.model_dump(exclude_none=True)
    for key in ("moment_center_station_m", "moment_center_height_m"):
        if key in overrides:
            reference[key] = finite_number(key, overrides.pop(key))
    shape = ShapeParameters.create(_PRESET_SHAPES[content.base] | content.shape | overrides, allow_outside)
    station = reference.get("moment_center_station_m", MOMENT_CENTER_STATION)
    height = reference.get("moment_center_height_m", MOMENT_CENTER_HEIGHT)
    base = ReferenceLengths(
        reference.get("area_m2", HORUS_REFERENCE.area),
        reference.get("chord_m", HORUS_REFERENCE.chord),
        reference.get("span_m", HORUS_REFERENCE.span),
        HORUS_REFERENCE.moment_center,
    )
    mass = content.mass
    return Vehicle(
        content.name or Path(text).stem,
        shape,
        MassProperties(
            HORUS_MASS.mass if mass.mass_kg is None else mass.mass_kg,
            HORUS_MASS.Ixx if mass.Ixx_kgm2 is None else mass.Ixx_kgm2,
            HORUS_MASS.Iyy if mass.Iyy_kgm2 is None else mass.Iyy_kgm2,
            HORUS_MASS.Izz if mass.Izz_kgm2 is None else mass.Izz_kgm2,
            HORUS_MASS.Ixz if mass.Ixz_kgm2 is None else mass.Ixz_kgm2,
        ),
        scaled_reference(shape, base, station, height),
    )


_SECTIONS: dict[str, type[BaseModel]] = {"mass": _MassSection, "reference": _ReferenceSection}


def _validated(path: Path, raw: dict) -> _VehicleFile:
    try:
        return _VehicleFile.model_validate({k: ({} if v is None and k != "name" else v) for k, v in raw.items()})
    except ValidationError as err:
        first = err.errors()[0]
        where = [str(x) for x in first["loc"]]
        if first["type"] == "extra_forbidden":
            model = _SECTIONS.get(where[0], _VehicleFile) if len(where) > 1 else _VehicleFile
            raise InputError(
                f"vehicle file '{path}': " + unknown_name("key", where[-1], tuple(model.model_fields))
            ) from err
        raise InputError(
            f"vehicle file '{path}': {'.'.join(where)} = {first['input']!r}: {first['msg'].lower()}"
        ) from err
