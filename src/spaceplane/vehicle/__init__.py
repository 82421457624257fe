"""What flies: shape, deflections, mass, reference lengths and the one watertight surface."""
