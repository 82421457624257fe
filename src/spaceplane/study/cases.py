"""What a sensitivity study is asked: a YAML file, checked, with a default for everything."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from spaceplane.errors import InputError, unknown_name
from spaceplane.files import read_yaml

BASE_PARAMETERS = (
    "fuselage_width_m",
    "fuselage_height_m",
    "nosecone_height_m",
    "fuselage_length_m",
    "fuselage_bottom_curvature_width_m",
    "fuselage_bottom_curvature_height_m",
    "wing_width_m",
    "wing_corner_width_m",
    "wing_corner_length_m",
    "wing_thickness_m",
    "winglet_bottom_length_m",
    "winglet_top_length_m",
    "winglet_length_m",
    "winglet_angle_deg",
    "winglet_angle_back_deg",
)
"""Numbers 1 to 15 of the thesis's Table 5.1: the shape without the sizes of the control surfaces."""


class SensitivityStudy(BaseModel):
    """A one-at-a-time study: the default shape, and each parameter at other values with the rest at the default.

    Attributes:
        study: the kind of study, "sensitivity".
        vehicle: name of a preset, or a vehicle's YAML file.
        set: changes of the default shape, by parameter name, m or deg.
        parameters: values to try for each parameter; an empty list means its low and its high limit.
        mach: flight points by their Mach number.
        settings: settings of `spaceplane.pipeline`, by name (mesh and flow).
        mesh_shifts: how often the default shape is computed again, moved by half a wall cell, to see what the mesh
            alone changes; 0 to 3.
        allow_outside_limits: try values beyond a parameter's limits.
        workers: processes that compute at once.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    study: str = "sensitivity"
    vehicle: str = "horus-2b"
    set: dict[str, float] = Field(default_factory=dict)
    parameters: dict[str, tuple[float, ...]] = Field(default_factory=lambda: dict.fromkeys(BASE_PARAMETERS, ()))
    mach: tuple[float, ...] = (0.8, 1.5, 2.5)
    settings: dict[str, Any] = Field(default_factory=dict)
    mesh_shifts: int = Field(default=2, ge=0, le=3)
    allow_outside_limits: bool = False
    workers: int = Field(default=1, ge=1)

    @field_validator("study")
    @classmethod
    def _known_kind(cls, value: str) -> str:
        if value != "sensitivity":
            raise ValueError("allowed: sensitivity")
        return value

    @field_validator("parameters", mode="before")
    @classmethod
    def _list_means_limits(cls, value: object) -> object:
        if isinstance(value, list | tuple):
            return dict.fromkeys(value, ())
        if isinstance(value, dict):
            return {name: () if values is None else values for name, values in value.items()}
        return value

    @field_validator("parameters")
    @classmethod
    def _some(cls, value: dict) -> dict:
        if not value:
            raise ValueError("at least one is needed")
        return value

    @field_validator("mach")
    @classmethod
    def _positive_and_distinct(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        if not value or any(not 0 < mach <= 30 for mach in value):
            raise ValueError("allowed: one or more numbers above 0 and up to 30")
        if len(set(value)) < len(value):
            raise ValueError("each Mach number once")
        return value


def load_study(path: Path | str | None = None, **changes: object) -> SensitivityStudy:
    """Read and check a study file.

    Args:
        path: YAML file; None for the default study.
        changes: fields that replace the file's (None leaves the file's).

    Raises:
        InputError: the file cannot be read, or a field is unknown or has a value that is not allowed.
    """
    fields = {} if path is None else read_yaml(path, "study file")
    fields.update({name: value for name, value in changes.items() if value is not None})
    where = "study" if path is None else str(path)
    try:
        study = SensitivityStudy.model_validate(fields)
    except ValidationError as error:
        raise InputError(f"{where}: {_first(error)}") from error
    return study


def _first(error: ValidationError) -> str:
    first = error.errors()[0]
    name = ".".join(str(part) for part in first["loc"])
    if first["type"] == "extra_forbidden":
        return unknown_name("field", name, SensitivityStudy.model_fields)
    message = first["msg"].removeprefix("Value error, ")
    shown = str(first["input"])
    return f"{name}: {shown if len(shown) < 60 else shown[:57] + '...'}; {message[0].lower()}{message[1:]}"
