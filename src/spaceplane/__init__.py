"""From the shape of a winged re-entry vehicle to its flying qualities."""

__version__ = "0.1.0"
