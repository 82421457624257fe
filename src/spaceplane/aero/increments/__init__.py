"""Viscous loads that an inviscid flow does not have, computed on its surface flow and listed apart from it."""
