"""From a surface and free streams to pressures, and to the coefficients that the Euler solver gives too."""

from __future__ import annotations

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


def local_inclination(
    surface: Surface,
    conditions: FlowConditions,
    reference: Reference,
    settings: InclinationSettings | None = None,
) -> xr.Dataset:
    """Coefficients of every condition by local inclination, in total and by part.

    Args:
        surface: closed surface.
        conditions: free streams, from `settings.LEAST_MACH` up.
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
        conditions: free streams.
        settings: which law acts where.

    Raises:
        InputError: a Mach number below `settings.LEAST_MACH`.
    """
    require_mach(conditions.mach)
    groups = law_groups(panels, settings)
    cp = np.empty((len(conditions), len(panels)))
    winds = direction(conditions.alpha, conditions.beta)
    for wind in np.unique(winds, axis=0):
        inclination = np.arcsin(np.clip(-(panels.normal @ wind), -1.0, 1.0))
        struck = inclination > 0.0
        if settings.shadow:
            struck &= ~hidden(panels, wind)
        lee = np.flatnonzero(~struck)
        turning = np.maximum(-inclination[lee], 0.0)
        chosen = {name: group[struck[group]] for name, group in groups.items()}
        angles = {name: inclination[group] for name, group in chosen.items()}
        for c in np.flatnonzero((winds == wind).all(axis=1)):
            mach = float(conditions.mach[c])
            cp[c, lee] = LEEWARD[settings.leeward](mach, conditions.gamma)(turning)
            for name, group in chosen.items():
                cp[c, group] = WINDWARD[name](mach, conditions.gamma)(angles[name])
    return cp.T


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
