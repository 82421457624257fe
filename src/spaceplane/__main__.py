"""`python -m spaceplane`, the same as `spaceplane`."""

from __future__ import annotations

from spaceplane.cli import main

main()
