"""Newton's leeward side: particles that do not strike leave the pressure of the free stream, Cp = 0."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def free_stream(mach: float, gamma: float) -> Callable[[np.ndarray], np.ndarray]:
    """The law, the same at every Mach number: [panel] turning, rad -> [panel] zeros."""
    return np.zeros_like
