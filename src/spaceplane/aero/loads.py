"""Forces on pieces of wall summed by part, and the same as coefficients in their axes."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from spaceplane.aero.axes import geometry_to_body, wind_axes
from spaceplane.flow.solution import FlowConditions
from spaceplane.mesh.mesh import Mesh


class Reference(Protocol):
    """Reference lengths, SI: area m2, chord m, span m, moment_center [xyz] m in geometry axes."""

    area: float
    chord: float
    span: float
    moment_center: tuple[float, float, float]


def by_part(mesh: Mesh, force: np.ndarray, center: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force and moment about `center` in total and by part, each [total and parts, xyz], geometry axes.

    Args:
        mesh: its pieces say where a force acts and on which part.
        force: [piece, xyz] in any unit of force.
        center: [xyz] m.
    """
    both = np.concatenate([force, np.cross(mesh.piece_center - center, force)], axis=1)
    sums = np.zeros((len(mesh.part_names) + 1, 6))
    for column in range(6):
        sums[1:, column] = np.bincount(mesh.piece_part, both[:, column], minlength=len(mesh.part_names))
    sums[0] = sums[1:].sum(axis=0)
    return sums[:, :3], sums[:, 3:]


def coefficients_of(
    force: np.ndarray, moment: np.ndarray, conditions: FlowConditions, reference: Reference
) -> dict[str, np.ndarray]:
    """CL, CD, CY, Cl, Cm, Cn, CA and CN, each [condition, part], with the axes and signs of `integrate`.

    Args:
        force, moment: [condition, part, xyz] geometry axes, on q_inf: m2 and m3.
        conditions: free streams.
        reference: area, chord, span, SI; the moment centre is that of `moment`.
    """
    force = force / reference.area
    moment = geometry_to_body(moment) / (reference.area * np.array([reference.span, reference.chord, reference.span]))
    axes = wind_axes(conditions.alpha, conditions.beta)
    return {
        "CL": np.einsum("cpx,cx->cp", force, axes.lift),
        "CD": np.einsum("cpx,cx->cp", force, axes.drag),
        "CY": np.einsum("cpx,cx->cp", force, axes.side),
        "Cl": moment[..., 0],
        "Cm": moment[..., 1],
        "Cn": moment[..., 2],
        "CA": force[..., 0],
        "CN": force[..., 2],
    }
