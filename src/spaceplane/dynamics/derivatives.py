"""The aerodynamic derivatives that the equations of motion take: the record of `spaceplane.aero.model.derivatives`."""

from __future__ import annotations

from spaceplane.aero.model.derivatives import (
    COEFFICIENTS,
    COMBINED,
    CONTROL_DERIVATIVES,
    CONTROLS,
    DAMPING,
    DAMPING_LATERAL,
    DAMPING_PITCH,
    PAIRS,
    STATIC,
    SURFACES,
    Derivatives,
    from_mapping,
    is_per_angle,
    per_degree,
    per_radian,
)

__all__ = [
    "COEFFICIENTS",
    "COMBINED",
    "CONTROLS",
    "CONTROL_DERIVATIVES",
    "DAMPING",
    "DAMPING_LATERAL",
    "DAMPING_PITCH",
    "PAIRS",
    "STATIC",
    "SURFACES",
    "Derivatives",
    "from_mapping",
    "is_per_angle",
    "per_degree",
    "per_radian",
]
