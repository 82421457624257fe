"""Meshes of cells longer along x than across: made about a squeezed body, then stretched with it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from spaceplane.errors import InputError
from spaceplane.mesh.mesh import Mesh
from spaceplane.vehicle.surface import Surface


def squeezed(surface: Surface, factor: float) -> Surface:
    """The surface with every x divided by `factor`: what to mesh before `stretched` is called with that factor.

    Raises:
        InputError: a factor that is not a finite number above 0.
    """
    _check(factor)
    return replace(surface, points=surface.points / [factor, 1.0, 1.0])


def stretched(mesh: Mesh, factor: float) -> Mesh:
    """The mesh with every x multiplied by `factor`.

    An affine map keeps plane faces plane, centroids centroids and closed cells closed: area vectors take the map's
    cofactors, volumes its determinant. The cells are boxes then and no octree's cubes: like an imported mesh, the
    result can be solved on, but neither coarsened nor refined. Make the coarse levels first (`flow.coarsen.sequence`).

    Args:
        mesh: any mesh.
        factor: length of a cell along x on its length before.

    Raises:
        InputError: a factor that is not a finite number above 0.
    """
    _check(factor)
    place, area = np.array([factor, 1.0, 1.0]), np.array([1.0, factor, factor])
    volume = mesh.cell_volume * factor
    return replace(
        mesh,
        cell_volume=volume,
        cell_center=mesh.cell_center * place,
        cell_size=mesh.cell_size * math.cbrt(factor),
        face_area=mesh.face_area * area,
        face_center=mesh.face_center * place,
        wall_area=mesh.wall_area * area,
        wall_center=mesh.wall_center * place,
        far_area=mesh.far_area * area,
        far_center=mesh.far_center * place,
        piece_area=mesh.piece_area * area,
        piece_center=mesh.piece_center * place,
        record={},
        cell_cube_center=None,
        merged_cubes=None,
        wall_wetted=None,
    )


def _check(factor: float) -> None:
    if not (math.isfinite(factor) and factor > 0.0):
        raise InputError(f"factor: {factor}, must be a finite number above 0")
