"""Skin friction on the wall of a computed inviscid flow.

Every wall face has the friction of a flat plate with the face's edge state (`edge`) at the face's running length
(`running_length`) by the reference-temperature method (`friction_laws`). What this leaves out: pressure gradients but
for their part in the edge state, cross-flow, separation, and the boundary layer's displacement of the flow outside.
"""

from __future__ import annotations

import numpy as np

from spaceplane.aero.increments.edge import Edge, along_wall, edge_of
from spaceplane.aero.increments.friction_laws import LAMINAR, LAWS, FrictionLaw, local_friction, radiative_temperature
from spaceplane.aero.increments.running_length import neighbours, running_length
from spaceplane.aero.increments.settings import Air, IncrementSettings
from spaceplane.environment.atmosphere import sutherland_viscosity
from spaceplane.flow.solution import Solution
from spaceplane.mesh.mesh import Mesh


def friction_forces(
    solution: Solution, condition: int, settings: IncrementSettings, air: Air, pairs: np.ndarray | None = None
) -> np.ndarray:
    """[piece, xyz] friction force on each piece of wall in one condition, on rho_inf a_inf^2 m2, geometry axes.

    It acts along the velocity of the wall cell, in the plane of the piece.

    Args:
        solution: flow.
        condition: number of the condition.
        settings: laminar or turbulent, wall temperature, transition.
        air: temperature and viscosity of the free streams.
        pairs: what `neighbours` found for the mesh; found anew when None.
    """
    mesh = solution.mesh
    edge = edge_of(solution, condition)
    shear = wall_shear(mesh, edge, settings, air, condition, neighbours(mesh) if pairs is None else pairs)
    direction = along_wall(edge.velocity[mesh.piece_wall], mesh.piece_area)
    size = np.linalg.norm(mesh.piece_area, axis=1)
    return (shear[mesh.piece_wall] * size)[:, None] * direction


def wall_shear(
    mesh: Mesh, edge: Edge, settings: IncrementSettings, air: Air, condition: int, pairs: np.ndarray
) -> np.ndarray:
    """[wall] shear stress, on rho_inf a_inf^2, in one condition.

    Args:
        mesh: its wall.
        edge: edge state of the condition.
        settings, air, condition, pairs: as for `friction_forces`.
    """
    ambient = float(air.temperature[condition])
    temperature = edge.temperature * ambient
    viscosity = sutherland_viscosity(temperature) / sutherland_viscosity(ambient)
    unit_reynolds = edge.density * edge.speed / viscosity * float(air.sonic_reynolds[condition])
    direction = along_wall(edge.velocity, mesh.wall_area)
    dynamic_pressure = 0.5 * edge.density * edge.speed**2
    mach = edge.speed / np.sqrt(edge.temperature)
    mass_flux = edge.density * edge.speed * float(air.sonic_reynolds[condition]) * sutherland_viscosity(ambient)

    def shear(law: FrictionLaw) -> tuple[np.ndarray, np.ndarray]:
        """Shear by one law, and the Reynolds number that it is taken at."""
        reynolds = unit_reynolds * running_length(mesh, pairs, direction, law.exponent)
        wall: float | np.ndarray | None = settings.wall_temperature_K
        if settings.emissivity is not None:
            wall = radiative_temperature(law, reynolds, mach, temperature, mass_flux, settings.emissivity, edge.gamma)
        friction = local_friction(law, reynolds, mach, temperature, wall, edge.gamma)
        return friction * dynamic_pressure, reynolds

    found, _ = shear(LAWS[settings.friction])
    if settings.transition_reynolds is None:
        return found
    laminar, reynolds = shear(LAMINAR)
    return np.where(reynolds < settings.transition_reynolds, laminar, found)
