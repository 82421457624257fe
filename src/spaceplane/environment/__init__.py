"""Where it flies: atmosphere, gravity, constants, validity of the gas model."""
