"""A model that is exactly bilinear, so that interpolation has no error."""

import numpy as np

from spaceplane.aero.model.model import SLOPES, AeroModel, SurfaceTable
from spaceplane.vehicle.properties import ReferenceLengths

REFERENCE = ReferenceLengths(110.0, 23.0, 13.0, (13.0, 0.0, 0.0))
ALPHA = np.radians([0.0, 10.0, 20.0, 30.0])
MACH = np.array([1.5, 2.0, 3.0])
# value at alpha 0 and Mach 2, per rad, per Mach
BASE = {"CL": (-0.02, 1.8, -0.1), "CD": (0.08, 0.6, -0.03), "Cm": (-0.01, 0.02, 0.015)}
SLOPE = dict(zip(SLOPES, (-0.9, -0.1, 0.05, 0.9, -1.4, 0.1, -0.3, 0.04, 0.2, 0.07, -0.4), strict=True))
# per rad of deflection
ELEVON = {"CL": 0.2, "CD": 0.03, "Cm": -0.09, "CY": 0.01, "Cl": 0.05, "Cn": 0.02}
RUDDER = {"CL": 0.0, "CD": 0.02, "Cm": 0.01, "CY": 0.04, "Cl": 0.01, "Cn": -0.03}
FLAP = {"CL": 0.11, "CD": 0.04, "Cm": -0.05}
MIRROR = {"CL": 1.0, "CD": 1.0, "Cm": 1.0, "CY": -1.0, "Cl": -1.0, "Cn": -1.0}
LIMITS_DEG = {"elevon": (-40.0, 40.0), "rudder": (0.0, 40.0), "flap": (-20.0, 30.0)}


def static(name, alpha, mach):
    start, with_alpha, with_mach = BASE[name]
    return start + with_alpha * alpha + with_mach * (mach - 2.0)


def surface(slopes, limits_deg):
    lower, upper = np.radians(limits_deg)
    deflection = np.unique([lower, 0.0, upper])
    flat = np.ones((len(ALPHA), len(MACH)))
    return SurfaceTable(deflection, {name: s * deflection[:, None, None] * flat for name, s in slopes.items()})


def mirrored(slopes):
    return {name: MIRROR[name] * value for name, value in slopes.items()}


def model(slopes=None, rudders=True, **base):
    """The model; `base` replaces (value, per rad, per Mach) of a base coefficient."""
    rules = {**BASE, **base}
    alpha, mach = np.meshgrid(ALPHA, MACH, indexing="ij")
    tables = {name: a + b * alpha + c * (mach - 2.0) for name, (a, b, c) in rules.items()}
    surfaces = {
        "elevon_left": surface(ELEVON, LIMITS_DEG["elevon"]),
        "elevon_right": surface(mirrored(ELEVON), LIMITS_DEG["elevon"]),
        "body_flap": surface(FLAP, LIMITS_DEG["flap"]),
    }
    if rudders:
        surfaces["rudder_left"] = surface(RUDDER, LIMITS_DEG["rudder"])
        surfaces["rudder_right"] = surface(mirrored(RUDDER), LIMITS_DEG["rudder"])
    given = SLOPE if slopes is None else slopes
    constant = {name: np.full(alpha.shape, value) for name, value in given.items()}
    return AeroModel("linear", "made for tests", REFERENCE, ALPHA, MACH, tables, surfaces, constant)
