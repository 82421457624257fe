"""The published static coefficients of HORUS-2B, as the validation compares with: see `aero.model.published`."""

from __future__ import annotations

import math

from spaceplane.aero.model.published import COEFFICIENTS, SOURCE, SURFACES, base, increment, lateral_point

__all__ = ["COEFFICIENTS", "LATERAL_POINT", "SOURCE", "SURFACES", "base", "increment"]

LATERAL_POINT = {name: math.radians(values[0]) for name, values in lateral_point().values.items()}
"""Per degree at Mach 2.5, alpha 16.6 deg (thesis Table 6.1, after Mooij)."""
