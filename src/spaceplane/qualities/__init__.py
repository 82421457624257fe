"""How it handles: military flying-quality criteria."""

from spaceplane.qualities.modes_record import analyse_modes

__all__ = ["analyse_modes"]
