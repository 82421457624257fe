"""The flow about one shape of a database, the vehicle with at most one control surface moved, as plain values."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.bodies import solve_vehicle
from spaceplane.aero.conditions import ConditionPlan, plan
from spaceplane.aero.derivatives import CONVERGED, differentiate
from spaceplane.aero.inclination.settings import method
from spaceplane.aero.inclination.solve import local_inclination
from spaceplane.aero.increments.add import integrate_with
from spaceplane.aero.increments.settings import Air
from spaceplane.aero.integrate import TOTAL
from spaceplane.aero.model.model import SLOPES
from spaceplane.analysis.settings import AnalyseSettings
from spaceplane.analysis.tables.settings import EULER, FAST, TableSettings, default_settings
from spaceplane.environment.atmosphere import Ambient, us1976
from spaceplane.flow.settings import check
from spaceplane.plain import degrees, finite, plain
from spaceplane.progress import Progress
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.presets import Vehicle
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths
from spaceplane.vehicle.shape import ShapeParameters

if TYPE_CHECKING:
    import xarray as xr

CONDITIONS_IN_BLOCK = 96
"""Most conditions in one block: what an interruption loses, some minutes at most."""
VARIED = ("beta", "p", "q", "r")
BESIDE = {False: 2, True: 6}
"""Conditions at each node of the undeflected vehicle, without rates and with them."""


@dataclass(frozen=True)
class Block:
    """One shape at some of the Mach numbers and all angles of attack: what is computed and stored in one piece.

    Attributes:
        surface: the control surface that is moved; empty for the undeflected vehicle.
        deflection: of it, rad.
        machs: Mach numbers.
    """

    surface: str
    deflection: float
    machs: tuple[float, ...]

    @property
    def label(self) -> str:
        """What a person calls it, such as elevon_left -10 deg, Mach 0.8 to 20."""
        shape = f"{self.surface} {math.degrees(self.deflection):+.3g} deg" if self.surface else "undeflected"
        ends = dict.fromkeys((self.machs[0], self.machs[-1]))
        return f"{shape}, Mach {' to '.join(f'{m:g}' for m in ends)}"

    @property
    def deflections(self) -> ControlDeflections:
        """Of all surfaces."""
        return ControlDeflections(**({self.surface: self.deflection} if self.surface else {}))


@dataclass(frozen=True)
class _Node:
    """A flight point as the condition plan takes it."""

    mach: float
    alpha: float
    ambient: Ambient | None
    beta: float = 0.0


def blocks(settings: TableSettings) -> tuple[Block, ...]:
    """All that a database needs: the undeflected vehicle, then each surface of `MOVED` at each deflection but 0."""
    shapes = [("", 0.0)] + [(name, d) for name, values in settings.deflections.items() for d in values if d != 0.0]
    found = []
    for surface, deflection in shapes:
        about = 1 if surface else BESIDE[settings.steps.rate > 0.0]
        fitting = max(CONDITIONS_IN_BLOCK // (about * len(settings.alphas)), 1)
        many = fitting if settings.tier == EULER else len(settings.machs)
        found += [Block(surface, deflection, settings.machs[k : k + many]) for k in range(0, len(settings.machs), many)]
    return tuple(found)


def inputs_of(vehicle: Vehicle, settings: TableSettings, block: Block) -> dict:
    """Everything that determines the result of a block, as JSON values; of the settings what its tier reads."""
    found: dict[str, Any] = {
        "kind": "aerodynamic table",
        "shape": asdict(vehicle.shape),
        "reference": asdict(vehicle.reference),
        "tier": settings.tier,
        "surface": block.surface,
        "deflection_deg": degrees(block.deflection),
        "machs": list(block.machs),
        "alphas_deg": [degrees(a) for a in settings.alphas],
        "beta_step_deg": degrees(settings.steps.beta),
        "rate_step": settings.steps.rate,
    }
    if settings.tier == FAST:
        return found | {"method": settings.method}
    solver = {name: plain(getattr(settings, name)) for name in ("mesh", "flow", "increments")}
    return found | {"solver": solver, "altitude_m": settings.altitude_m}


def evaluate(inputs: dict) -> dict:
    """Compute the block that `inputs_of` describes; see `solve_block`. Worker processes call it by name.

    Raises:
        InputError: as `solve_block`.
    """
    steps = {"beta": math.radians(inputs["beta_step_deg"]), "rate": inputs["rate_step"]}
    given: dict[str, Any] = {"method": inputs["method"]} if inputs["tier"] == FAST else _solver(inputs)
    # Mach numbers and deflection are those of the block, not of a table.
    settings = default_settings(
        inputs["tier"],
        alphas=tuple(math.radians(a) for a in inputs["alphas_deg"]),
        deflections={},
        steps=replace(AnalyseSettings().steps, **steps),
        **given,
    )
    block = Block(inputs["surface"], math.radians(inputs["deflection_deg"]), tuple(inputs["machs"]))
    # The flow about a shape knows no mass.
    unused = MassProperties(1.0, 1.0, 1.0, 1.0)
    reference = ReferenceLengths(**inputs["reference"])
    return solve_block(Vehicle("", ShapeParameters(**inputs["shape"]), unused, reference), settings, block)


def _solver(inputs: Mapping) -> dict:
    chosen = AnalyseSettings.from_mapping(inputs["solver"])
    found = {name: getattr(chosen, name) for name in ("mesh", "flow", "increments")}
    return found | {"altitude_m": inputs["altitude_m"]}


def solve_block(vehicle: Vehicle, settings: TableSettings, block: Block, progress: Progress | None = None) -> dict:
    """Coefficients of one shape, and of the undeflected vehicle its slopes with sideslip and rates.

    Args:
        vehicle: shape and reference lengths.
        settings: of the database.
        block: the shape and its Mach numbers.
        progress: called with (phase, done, total, text).

    Returns:
        JSON values: `nodes`, one for each Mach number and angle of attack (the latter varying faster) with mach,
        alpha_deg, CL, CD, CY, Cl, Cm, Cn, verdict and, undeflected, `slopes` of `SLOPES` (None after a failure);
        `conditions`, how many were solved; `bad`, those not converged with label, verdict and reason; `cells` and
        `wall_cell_m` of the mesh, None without one; `seconds`.

    Raises:
        InputError: a shape that cannot be built, or a mesh or condition that is not allowed.
    """
    began = time.perf_counter()
    nodes = _nodes(settings, block.machs)
    quantities = () if block.surface else VARIED
    made = plan(nodes, settings.steps, reference=vehicle.reference, quantities=quantities)
    check(made.conditions)
    mesh: dict[str, Any] = {"cells": None, "wall_cell_m": None}
    if settings.tier == FAST:
        body = build(vehicle.shape, block.deflections)
        found = local_inclination(body, made.conditions, vehicle.reference, method(settings.method))
    else:
        solved = solve_vehicle(
            vehicle,
            block.deflections,
            made.conditions,
            settings.mesh,
            settings.flow,
            progress,
            block.label,
            resolved=True,
        )
        air = Air.of([nodes[i].ambient for i in made.point]) if settings.needs_air else None
        found = integrate_with(solved.solution, vehicle.reference, settings.increments, air)
        record = solved.solution.mesh
        mesh = {"cells": record.cells, "wall_cell_m": float(record.record["wall_cell_m"])}
    return {
        "nodes": _node_records(found.sel(part=[TOTAL]), made),
        "conditions": len(made.labels),
        "bad": _bad(found, made.labels),
        "seconds": round(time.perf_counter() - began, 3),
        **mesh,
    }


def _nodes(settings: TableSettings, machs: Sequence[float]) -> list[_Node]:
    air = {mach: us1976(settings.altitude(mach)) if settings.needs_air else None for mach in machs}
    return [_Node(mach, alpha, air[mach]) for mach in machs for alpha in settings.alphas]


def _node_records(found: xr.Dataset, made: ConditionPlan) -> list[dict]:
    slopes = differentiate(found, made) if made.points[0].variations else None
    records = []
    for number, point in enumerate(made.points):
        one = found.isel(condition=point.base, part=0)
        record = {"mach": float(one.mach), "alpha_deg": degrees(float(one.alpha)), "verdict": str(one.verdict.item())}
        record |= {name: finite(one[name].item()) for name in FORCES_AND_MOMENTS}
        if slopes is not None:
            known = [name for name in SLOPES if name in slopes]
            record["slopes"] = {name: finite(slopes[name].values[number, 0]) for name in known}
        records.append(record)
    return records


def _bad(found: xr.Dataset, labels: Sequence[str]) -> list[dict]:
    verdicts = found.verdict.values
    return [
        {
            "label": labels[i],
            "mach": float(found.mach[i]),
            "alpha_deg": degrees(float(found.alpha[i])),
            "verdict": str(verdicts[i]),
            "reason": str(found.reason.values[i]),
        }
        for i in np.flatnonzero(verdicts != CONVERGED)
    ]
