"""Nonlinear motion of a rigid, unpowered vehicle over a planet: body form and trajectory form of the same equations."""
