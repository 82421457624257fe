"""Coefficients and derivatives in stated axes."""
