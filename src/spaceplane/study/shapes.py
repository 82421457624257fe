"""Studies and the pipeline: a parameter's range, a case's resolved inputs, and its computation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from spaceplane.vehicle.shape import PARAMETERS


@dataclass(frozen=True)
class ParameterRange:
    """Default and limits of one shape parameter, in its `unit` (m or deg)."""

    default: float
    lower: float
    upper: float
    unit: str


def parameter_ranges(vehicle: str, changes: dict[str, float]) -> dict[str, ParameterRange]:
    """Return the range of every shape parameter, `changes` being part of the default."""
    from spaceplane.vehicle import presets

    shape = presets.load(vehicle, changes, allow_outside=True).shape.as_dict()
    return {info.name: ParameterRange(shape[info.name], info.lower, info.upper, info.unit) for info in PARAMETERS}


def case_inputs(
    vehicle: str, changes: dict[str, float], mach: Sequence[float], settings: dict, allow_outside_limits: bool = False
) -> dict:
    """Return everything that determines the analysis of one shape, resolved, as JSON values."""
    raise NotImplementedError


def evaluate(inputs: dict) -> dict:
    """Run the pipeline on the inputs of `case_inputs`; return what result.json would hold, histories left out."""
    raise NotImplementedError
