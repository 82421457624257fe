"""Decks for other programs: JSBSim, Tudat, python-control, CSV and NetCDF."""
