"""The published aerodynamics of HORUS-2B.

Source: E. Mooij, "The HORUS-2B reference vehicle", memorandum M-692, TU Delft (1995), after an MBB study of 1988.
Wind axes for C_L and C_D, pitching moment nose up positive on 23 m, reference area 110 m2. The moment centre is not
printed with the tables; 13.0 m behind the nose is reported once. The single lateral point is that of thesis Table 6.1
(after Mooij), per degree, its side force printed as C_S_beta.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

from spaceplane.aero.model.model import AeroModel
from spaceplane.aero.model.table_set import SLOPES_FILE, SlopeTable, Table, read_slopes, read_table, read_table_set
from spaceplane.vehicle.properties import HORUS_REFERENCE

COEFFICIENTS = ("CL", "CD", "Cm")
SURFACES = ("bodyflap", "one_elevon")
SOURCE = "Mooij, memorandum M-692, TU Delft (1995)"
FOLDER = Path(__file__).parent / "data" / "horus_2b"
NAME = "HORUS-2B, published tables"


@cache
def base(coefficient: str) -> Table:
    """The clean, untrimmed vehicle's `CL`, `CD` or `Cm`."""
    return read_table(FOLDER / f"{coefficient}0.csv")


@cache
def increment(coefficient: str, surface: str) -> Table:
    """Increment of `CL`, `CD` or `Cm` by `bodyflap` or by `one_elevon` (one side; double it for the pair)."""
    return read_table(FOLDER / f"d{coefficient}_{surface}.csv")


@cache
def lateral_point() -> SlopeTable:
    """CY_beta, Cl_beta and Cn_beta at Mach 2.5, alpha 16.6 deg: the only lateral derivatives published."""
    return read_slopes(FOLDER / SLOPES_FILE)


@cache
def horus_2b_published() -> AeroModel:
    """HORUS-2B from its published tables, Mach 1.5 to 20, alpha 0 to 45 deg, about 13.0 m behind the nose.

    No damping derivative, no rudder and no rolling or yawing moment of a single elevon was published.
    """
    source = f"{SOURCE}; moment centre reported once, with low confidence"
    return read_table_set(FOLDER, HORUS_REFERENCE, NAME, source)
