"""What a stated uncertainty may hold."""

from __future__ import annotations

MESH, ITERATION = "mesh", "iteration"
SOURCES = (MESH, ITERATION)
"""Up to where: with the mesh's uncertainty (which takes a companion mesh) or with that of the iteration alone."""
FIRST_CELLS = 12_000
"""About the cells of the first mesh on the way to an accuracy."""
TIGHTEST, LOOSEST = 5e-4, 0.5
"""Accuracies that may be asked for, as a fraction of the force coefficient's size."""
