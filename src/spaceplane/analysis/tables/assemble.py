"""The blocks of a database put together as an aerodynamic model, and what is not as it should be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spaceplane import __version__
from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.integrate import LATERAL, mirrored_name
from spaceplane.aero.model.model import BASE, SLOPES, AeroModel, SurfaceTable
from spaceplane.analysis.tables.settings import EULER, TableSettings
from spaceplane.analysis.tables.solve import Block
from spaceplane.errors import InputError
from spaceplane.plain import degrees
from spaceplane.vehicle.presets import Vehicle

FAILED = "failed"


@dataclass(frozen=True)
class Remark:
    """A condition, or a whole block, that did not converge.

    Attributes:
        shape: label of the block.
        condition: "base", "beta", "p", "q+", "q-" or "r"; empty for a whole block.
        mach: Mach number; None for a whole block.
        alpha_deg: deg; None for a whole block.
        verdict: "oscillating" (its mean is in the tables) or "failed" (its cells are empty).
        reason: why.
    """

    shape: str
    condition: str
    mach: float | None
    alpha_deg: float | None
    verdict: str
    reason: str

    @property
    def line(self) -> str:
        """In words."""
        where = "" if self.mach is None else f" at Mach {self.mach:g}, alpha {self.alpha_deg:g} deg ({self.condition})"
        return f"{self.shape}{where}: {self.verdict}: {self.reason}"


def remarks(blocks: Sequence[Block], results: Sequence[dict | None], reasons: Sequence[str]) -> tuple[Remark, ...]:
    """What did not converge, in the order of the blocks.

    Args:
        blocks: what was asked.
        results: of `solve.solve_block`; None for a block that could not be computed.
        reasons: why each block could not be computed; empty where it could.
    """
    found = []
    for block, result, reason in zip(blocks, results, reasons, strict=True):
        if result is None:
            found.append(Remark(block.label, "", None, None, FAILED, reason))
            continue
        for bad in result["bad"]:
            own = (bad["label"], bad["mach"], bad["alpha_deg"], bad["verdict"], bad["reason"])
            found.append(Remark(block.label, *own))
    return tuple(found)


def model_of(
    vehicle: Vehicle, settings: TableSettings, blocks: Sequence[Block], results: Sequence[dict | None]
) -> AeroModel:
    """The aerodynamic model of the results; cells of what failed are empty.

    Surfaces to the right are the mirror images of those to the left: CY, Cl and Cn have the opposite sign. A body flap
    has no lateral effect. Each surface was moved alone.

    Args:
        vehicle: with its name and reference lengths.
        settings: of the database.
        blocks, results: as for `remarks`.

    Raises:
        InputError: nothing at all is known of the undeflected vehicle.
    """
    shape = (len(settings.alphas), len(settings.machs))
    of = {("", 0.0): _Tables.empty(shape)}
    for block, result in zip(blocks, results, strict=True):
        tables = of.setdefault((block.surface, block.deflection), _Tables.empty(shape))
        for node in result["nodes"] if result is not None else ():
            tables.enter(node, _index(settings, node))
    base = of.pop(("", 0.0))
    if not any(np.isfinite(base.values[name]).any() for name in BASE):
        raise InputError("the undeflected vehicle has no result at any Mach number and angle of attack")
    surfaces = {}
    for name, deflections in settings.deflections.items():
        surfaces |= _surface(name, deflections, {d: of[name, d] for d in deflections if d != 0.0}, base)
    return AeroModel(
        name=f"{vehicle.name}-{settings.tier}",
        source=_source(vehicle, settings, results),
        reference=vehicle.reference,
        alpha=np.array(settings.alphas),
        mach=np.array(settings.machs),
        base={name: base.values[name] for name in BASE},
        surfaces=surfaces,
        slopes={name: table for name, table in base.slopes.items() if np.isfinite(table).any()},
    )


@dataclass(frozen=True)
class _Tables:
    """Coefficients and slopes of one shape, each [alpha, mach]."""

    values: dict[str, np.ndarray]
    slopes: dict[str, np.ndarray]

    @classmethod
    def empty(cls, shape: tuple[int, int]) -> _Tables:
        values, slopes = ({name: np.full(shape, np.nan) for name in names} for names in (FORCES_AND_MOMENTS, SLOPES))
        return cls(values, slopes)

    def enter(self, node: dict, place: tuple[int, int]) -> None:
        for tables, known in ((self.values, node), (self.slopes, node.get("slopes", {}))):
            for name, table in tables.items():
                if known.get(name) is not None:
                    table[place] = known[name]


def _index(settings: TableSettings, node: dict) -> tuple[int, int]:
    alpha = int(np.argmin(np.abs(np.array(settings.alphas) - math.radians(node["alpha_deg"]))))
    return alpha, int(np.argmin(np.abs(np.array(settings.machs) - node["mach"])))


def _surface(
    name: str, deflections: Sequence[float], moved: dict[float, _Tables], base: _Tables
) -> dict[str, SurfaceTable]:
    """Increments of a surface, and of its mirror image where it has one."""
    other = mirrored_name(name)
    lateral = other != name
    tables = {}
    for coefficient in FORCES_AND_MOMENTS:
        if coefficient in LATERAL and not lateral:
            continue
        still = base.values[coefficient]
        tables[coefficient] = np.stack(
            [np.zeros_like(still) if d == 0.0 else moved[d].values[coefficient] - still for d in deflections]
        )
    found = {name: SurfaceTable(np.array(deflections), tables)}
    if lateral:
        turned = {c: -table if c in LATERAL else table for c, table in tables.items()}
        found[other] = SurfaceTable(np.array(deflections), turned)
    return found


def _source(vehicle: Vehicle, settings: TableSettings, results: Sequence[dict | None]) -> str:
    known = [result for result in results if result is not None]
    steps = settings.steps
    parts = [f"spaceplane {__version__}, shape {vehicle.name}"]
    if settings.tier == EULER:
        cells = sorted(result["cells"] for result in known)
        cell = max(result["wall_cell_m"] for result in known)
        parts.append(f"Euler flow on meshes of {cells[0]} to {cells[-1]} cells, {cell:.3g} m at the wall")
        friction, base = settings.increments.friction, settings.increments.base
        added = [f"{friction} skin friction"] * (friction != "off") + [f"{base} base pressure"] * (base != "inviscid")
        parts.append(" and ".join(added) + " added" if added else "inviscid")
        if settings.needs_air:
            at = "the descent of thesis Table 4.1" if settings.altitude_m is None else f"{settings.altitude_m:g} m"
            parts.append(f"air at the altitude of {at}" if settings.altitude_m is None else f"air at {at}")
    else:
        parts.append(f"local inclination ({settings.method}), inviscid")
    beta = f"slopes from {degrees(steps.beta):g} deg of sideslip"
    parts.append(beta + (f" and reduced rates of {steps.rate:g}" if steps.rate > 0.0 else ""))
    parts.append("each control surface moved alone, those to the right mirrored")
    bad = sum(len(result["bad"]) for result in known)
    total = sum(result["conditions"] for result in known)
    parts.append(f"{total - bad} of {total} conditions converged")
    lost = len(results) - len(known)
    return "; ".join(parts + [f"{lost} of {len(results)} blocks without result"] * (lost > 0))
