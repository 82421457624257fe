"""Aerodynamics over Mach number, angle of attack and deflections, as flight dynamics, trim and exports take them."""
