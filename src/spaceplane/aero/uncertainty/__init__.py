"""Numerical uncertainty of coefficients and derivatives: from the iteration and from the mesh."""
