"""Slope limiters: one to a file, chosen by name; the number is what the kernels compare."""

from __future__ import annotations

from spaceplane.flow.limiters.barth_jespersen import barth_jespersen
from spaceplane.flow.limiters.venkatakrishnan import venkatakrishnan

NONE, VENKATAKRISHNAN, BARTH_JESPERSEN = 0, 1, 2

#: Name -> number used by the kernels.
LIMITERS = {"none": NONE, "venkatakrishnan": VENKATAKRISHNAN, "barth_jespersen": BARTH_JESPERSEN}

__all__ = ["BARTH_JESPERSEN", "LIMITERS", "NONE", "VENKATAKRISHNAN", "barth_jespersen", "venkatakrishnan"]
