"""From a surface and free streams to pressures, and to the coefficients that the Euler solver gives too.

A body that turns at steady rates meets the stream at each panel with the velocity V - w x (r - c) at its centroid: its
inclination, its dynamic pressure and, to first order in the rates, its Mach number are those of that velocity. Shadows
stay those of the free stream.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.inclination.laws import LEEWARD, WINDWARD
from spaceplane.aero.inclination.panels import Panels, blunt_triangles, panels_of
from spaceplane.aero.inclination.settings import InclinationSettings, require_mach
from spaceplane.aero.inclination.shadow import hidden
from spaceplane.aero.integrate import WITH_SPREAD, Judgement, Reference, WallPieces, coefficients
from spaceplane.flow.freestream import direction
from spaceplane.flow.solution import FlowConditions
from spaceplane.vehicle.surface import Surface

if TYPE_CHECKING:
    import xarray as xr

MACH_STEP = 0.01
"""Step of a pressure law's slope with the Mach number, as a fraction of it."""


def local_inclination(
    surface: Surface,
    conditions: FlowConditions,
    reference: Reference,
    settings: InclinationSettings | None = None,
) -> xr.Dataset:
    """Coefficients of every condition by local inclination, in total and by part.

    Args:
        surface: closed surface.
        conditions: free streams, from `settings.LEAST_MACH` up, with steady rates or without.
        reference: area, chord, span and moment centre, SI.
        settings: which law acts where.

    Returns:
        As `integrate.coefficients` gives, the same as for the Euler solver. Nothing iterates: every verdict is
        "converged" and every spread zero. What that leaves out is the error of the theory, which no spread would show.

    Raises:
        InputError: a Mach number below `settings.LEAST_MACH`.
    """
    settings = settings or InclinationSettings()
    panels = panels_of(surface, settings.panel * _size(surface))
    return loads(panels, pressures(panels, conditions, settings), conditions, reference)


def loads(panels: Panels, cp: np.ndarray, conditions: FlowConditions, reference: Reference) -> xr.Dataset:
    """Coefficients of [panel, condition] pressure coefficients, see `local_inclination`."""
    pieces = WallPieces(-panels.area[:, None] * panels.normal, panels.center, panels.part, panels.surface.part_names)
    count = len(conditions)
    judgement = Judgement(["converged"] * count, [""] * count)
    return coefficients(pieces, cp, conditions, reference, judgement, {name: np.zeros(count) for name in WITH_SPREAD})


def pressures(panels: Panels, conditions: FlowConditions, settings: InclinationSettings) -> np.ndarray:
    """[panel, condition] pressure coefficients.

    Args:
        panels: of a closed surface.
        conditions: free streams, with steady rates or without.
        settings: which law acts where.

    Raises:
        InputError: a Mach number below `settings.LEAST_MACH`.
    """
    require_mach(conditions.mach)
    groups = law_groups(panels, settings)
    cp = np.empty((len(conditions), len(panels)))
    winds = direction(conditions.alpha, conditions.beta)
    turns = conditions.angular_velocity() / np.asarray(conditions.mach, dtype=float)[:, None]
    for wind in np.unique(winds, axis=0):
        shaded = hidden(panels, wind) if settings.shadow else np.zeros(len(panels), dtype=bool)
        alike = np.flatnonzero((winds == wind).all(axis=1))
        for turn in np.unique(turns[alike], axis=0):
            stream = _stream(panels, wind, turn, conditions.center)
            for c in alike[(turns[alike] == turn).all(axis=1)]:
                cp[c] = _condition(stream, shaded, groups, settings, float(conditions.mach[c]), conditions.gamma)
    return cp.T


@dataclass(frozen=True)
class _Stream:
    """What strikes the panels.

    Attributes:
        inclination: [panel] rad, negative where the panel looks away.
        speed: [panel] on the free stream's; None where nothing turns.
    """

    inclination: np.ndarray
    speed: np.ndarray | None


def _stream(panels: Panels, wind: np.ndarray, turn: np.ndarray, center: tuple[float, float, float]) -> _Stream:
    """The stream as the panels of a body meet it that turns by `turn` [xyz], 1/m, about `center`, m."""
    if not turn.any():
        return _Stream(np.arcsin(np.clip(-(panels.normal @ wind), -1.0, 1.0)), None)
    local = wind - np.cross(turn, panels.center - np.asarray(center, dtype=float))
    speed = np.linalg.norm(local, axis=1)
    sine = -np.einsum("px,px->p", panels.normal, local) / np.maximum(speed, 1e-300)
    return _Stream(np.arcsin(np.clip(sine, -1.0, 1.0)), speed)


def _condition(
    stream: _Stream,
    shaded: np.ndarray,
    groups: dict[str, np.ndarray],
    settings: InclinationSettings,
    mach: float,
    gamma: float,
) -> np.ndarray:
    """[panel] pressure coefficients, on the free stream's dynamic pressure, at one Mach number."""
    struck = (stream.inclination > 0.0) & ~shaded
    lee = np.flatnonzero(~struck)
    chosen = {name: group[struck[group]] for name, group in groups.items()}

    def at(mach: float) -> np.ndarray:
        """[panel] on each panel's own dynamic pressure."""
        cp = np.empty(len(struck))
        cp[lee] = LEEWARD[settings.leeward](mach, gamma)(np.maximum(-stream.inclination[lee], 0.0))
        for name, group in chosen.items():
            cp[group] = WINDWARD[name](mach, gamma)(stream.inclination[group])
        return cp

    cp = at(mach)
    if stream.speed is None:
        return cp
    change = (at(mach * (1.0 + MACH_STEP)) - at(mach * (1.0 - MACH_STEP))) / (2.0 * MACH_STEP)
    return (cp + change * (stream.speed - 1.0)) * stream.speed**2


def law_groups(panels: Panels, settings: InclinationSettings) -> dict[str, np.ndarray]:
    """Windward law -> [panel of its own] indices of the panels that it acts on."""
    surface = panels.surface
    names = list(WINDWARD)
    law = np.array([names.index(settings.law_of(name)) for name in surface.part_names])[panels.part]
    if settings.blunt is not None and settings.blunt_radius > 0.0:
        blunt = blunt_triangles(surface, settings.blunt_radius * _size(surface))
        law[blunt[panels.triangle]] = names.index(settings.blunt)
    groups = {name: np.flatnonzero(law == number) for number, name in enumerate(names)}
    return {name: group for name, group in groups.items() if len(group)}


def _size(surface: Surface) -> float:
    return float(np.ptp(surface.bounds, axis=0).max())
