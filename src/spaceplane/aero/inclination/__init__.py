"""Local inclination: the pressure on each panel from its own angle to the stream; milliseconds for a condition."""
