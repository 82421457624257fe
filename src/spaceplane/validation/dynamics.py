"""Validation case: published eigenmodes of the Boeing 747, the Navion, the DC-8 and HORUS-2B at the TAEM interface."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spaceplane.aero.model.derivatives import from_mapping
from spaceplane.dynamics.flightpoint import flight_point
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import Mode, identify
from spaceplane.dynamics.statespace import StateSpace, from_matrix
from spaceplane.environment.constants import GAS_CONSTANT_AIR, RATIO_OF_SPECIFIC_HEATS
from spaceplane.qualities.assess import assess
from spaceplane.validation import thesis
from spaceplane.validation.cases import Progress
from spaceplane.validation.records import Record
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

CASE = "dynamics"
HEFFLEY = "Franklin, Powell and Emami-Naeini, Feedback Control of Dynamic Systems, after Heffley and Jewell (1972)"
ETKIN = "Etkin and Reid, Dynamics of Flight, 3rd ed. (1996), chapter 6"
NELSON = "Nelson, Flight Stability and Automatic Control, 2nd ed. (1998), Appendix B and chapters 4 and 5"
COOK = "Cook, Flight Dynamics Principles, 3rd ed. (2013), example 7.1, after Teper (1969)"
MOOIJ = "Mooij (2015), as quoted in Table 6.2 of Reijne (2022)"
REIJNE = "Reijne (2022), Table 6.3"

# States beta, r, p, phi.
LATERAL_747 = np.array(
    [
        [-0.0558, -0.9968, 0.0802, 0.0415],
        [0.598, -0.115, -0.0318, 0.0],
        [-3.05, 0.388, -0.465, 0.0],
        [0.0, 0.0805, 1.0, 0.0],
    ]
)

# States v (ft/s), p, r, phi.
LATERAL_DC8 = np.array(
    [
        [-0.1008, 0.0, -468.2, 32.2],
        [-0.00579, -1.232, 0.397, 0.0],
        [0.00278, -0.0346, -0.257, 0.0],
        [0.0, 1.0, 0.0, 0.0],
    ]
)
FOOT, POUND, SLUG = 0.3048, 0.45359237, 14.593903
"""m, kg and kg."""


def run(fine: bool, progress: Progress) -> list[Record]:
    """Every mode that has a published value; takes no time, fine or not.

    Args:
        fine: without effect, there is no mesh.
        progress: told what runs.
    """
    progress("Boeing 747", 0.0)
    records = [*lateral_747(), *from_derivatives_747()]
    progress("Navion, DC-8", 0.25)
    records += [*navion(), *lateral_dc8()]
    progress("HORUS-2B", 0.5)
    return [*records, *horus()]


def lateral_747() -> list[Record]:
    """Lateral modes of a 4 x 4 matrix and the verdicts on them."""
    modes = {mode.kind: mode for mode in identify(from_matrix(LATERAL_747, ("beta", "r", "p", "phi")))}
    where = "Boeing 747 lateral"
    records = _pair("Dutch roll", where, -0.03294 + 0.94665j, modes["dutch_roll"], 1e-3, HEFFLEY)
    records.append(_record("roll mode", where, "1/s", -0.56265, modes["roll"].eigenvalue.real, 1e-3, HEFFLEY))
    records.append(_record("spiral", where, "1/s", -0.00728, modes["spiral"].eigenvalue.real, 1e-3, HEFFLEY))
    verdicts = {v.quantity: v for v in assess(tuple(modes.values())) if v.paragraph == "3.3.1.1"}
    for quantity, level in (("damping ratio", 2), ("damping ratio times frequency", 3), ("overall", 3)):
        found = verdicts[quantity].level
        computed = float(found) if isinstance(found, int) else None
        source = "MIL-F-8785C 3.3.1.1, class III, category B"
        records.append(_record(f"Dutch roll level, {quantity}", where, "-", level, computed, 0.0, source))
    return records


def from_derivatives_747() -> list[Record]:
    """Modes of the nine-state model, with the book's derivatives turned into ours and its product of inertia."""
    modes = {mode.kind: mode for mode in identify(system_747())}
    note = "thrust, which the nine-state model lacks, is put into CL_alpha, CD_alpha and CD_M"
    where, tensor = "Boeing 747 lateral, derivatives", "published to two or three digits; I_zx = -0.212e7 kg m2"
    return [
        *_pair("short period", "Boeing 747 longitudinal", -0.3719 + 0.8875j, modes["short_period"], 0.01, ETKIN, note),
        *_pair("phugoid", "Boeing 747 longitudinal", -0.003289 + 0.06723j, modes["phugoid"], 0.01, ETKIN, note),
        *_pair("Dutch roll", where, -0.033 + 0.947j, modes["dutch_roll"], 0.01, ETKIN, tensor),
        _record("roll mode", where, "1/s", -0.563, modes["roll"].eigenvalue.real, 0.01, ETKIN, tensor),
        _record("spiral", where, "1/s", -0.0073, modes["spiral"].eigenvalue.real, 0.01, ETKIN, tensor),
    ]


def system_747() -> StateSpace:
    """The nine-state model of the Boeing 747-100 at Mach 0.8 and 40 000 ft, in uniform air as in the book."""
    mach, density, speed, area, weight = 0.8, 0.3045, 235.9, 511.0, 2.83176e6
    temperature = (speed / mach) ** 2 / (RATIO_OF_SPECIFIC_HEATS * GAS_CONSTANT_AIR)
    lift, drag = weight / (0.5 * density * speed**2 * area), 0.043
    point = flight_point(
        mach, 12_192.0, 0.0, 0.0, 0.0, lift, drag, density * GAS_CONSTANT_AIR * temperature, temperature
    )
    mass = MassProperties(weight / point.gravity, 0.247e8, 0.449e8, 0.673e8, -0.212e7)
    derivatives = from_mapping(
        {
            "CD_alpha": lift - 0.2193, "CL_alpha": 4.92, "Cm_alpha": -1.023,
            "CY_beta": -0.8771, "Cl_beta": -0.2797, "Cn_beta": 0.1946,
            "CD_M": (0.1080 - 2 * drag) / mach, "CL_M": 0.106 / mach, "Cm_M": 0.1043 / mach,
            "CL_q": 5.92, "Cm_q": -23.92, "CL_alphadot": -5.9, "Cm_alphadot": -6.314,
            "Cl_p": -0.3295, "Cn_p": -0.04073, "Cl_r": 0.304, "Cn_r": -0.2737,
        }
    )  # fmt: skip
    lengths = ReferenceLengths(area, 8.324, 59.64, (0.0, 0.0, 0.0))
    return linearise(point, mass, lengths, derivatives, density_gradient=False)


def navion() -> list[Record]:
    """Modes of the nine-state model of a light aircraft at sea level from its published derivatives."""
    modes = {mode.kind: mode for mode in identify(navion_system())}
    where = "Navion"
    note = "C_L_q left out, as by the source; uniform air"
    spiral = "the source's printed numbers give -0.0082 (derivatives) to -0.0089 (matrix): two digits are not theirs"
    return [
        *_pair("short period", where, -2.51 + 2.59j, modes["short_period"], 0.01, NELSON, note),
        *_pair("phugoid", where, -0.0171 + 0.213j, modes["phugoid"], 0.01, NELSON, note),
        *_pair("Dutch roll", where, -0.487 + 2.335j, modes["dutch_roll"], 0.01, NELSON, note),
        _record("roll mode", where, "1/s", -8.435, modes["roll"].eigenvalue.real, 0.01, NELSON, note),
        replace(
            _record("spiral", where, "1/s", -0.00877, modes["spiral"].eigenvalue.real, 0.01, NELSON, spiral), gate=False
        ),
    ]


def navion_system() -> StateSpace:
    """The nine-state model of the Navion at Mach 0.158 in level flight; the source's units turned into SI."""
    mach, speed, density = 0.158, 176.0 * FOOT, 0.002378 * SLUG / FOOT**3
    temperature = (speed / mach) ** 2 / (RATIO_OF_SPECIFIC_HEATS * GAS_CONSTANT_AIR)
    pressure = density * GAS_CONSTANT_AIR * temperature
    point = flight_point(mach, 0.0, 0.0, 0.0, 0.0, 0.41, 0.05, pressure, temperature)
    mass = MassProperties(2750.0 * POUND, *(moment * SLUG * FOOT**2 for moment in (1048.0, 3000.0, 3530.0)))
    derivatives = from_mapping(
        {
            "CD_alpha": 0.33, "CL_alpha": 4.44, "Cm_alpha": -0.683,
            "CY_beta": -0.564, "Cl_beta": -0.074, "Cn_beta": 0.071,
            "CD_M": 0.0, "CL_M": 0.0, "Cm_M": 0.0, "Cm_q": -9.96, "Cm_alphadot": -4.36,
            "Cl_p": -0.410, "Cn_p": -0.0575, "Cl_r": 0.107, "Cn_r": -0.125,
        }
    )  # fmt: skip
    lengths = ReferenceLengths(184.0 * FOOT**2, 5.7 * FOOT, 33.4 * FOOT, (0.0, 0.0, 0.0))
    return linearise(point, mass, lengths, derivatives, density_gradient=False)


def lateral_dc8() -> list[Record]:
    """Lateral modes of a 4 x 4 matrix in ft/s and rad."""
    modes = {mode.kind: mode for mode in identify(from_matrix(LATERAL_DC8, ("v", "p", "r", "phi")))}
    where = "Douglas DC-8 lateral"
    pair = complex(-0.127, (1.433 - 0.127**2) ** 0.5)  # s^2 + 0.254 s + 1.433
    return [
        *_pair("Dutch roll", where, pair, modes["dutch_roll"], 0.01, COOK),
        _record("roll mode", where, "1/s", -1.329, modes["roll"].eigenvalue.real, 0.01, COOK),
        _record("spiral", where, "1/s", -0.0065, modes["spiral"].eigenvalue.real, 0.01, COOK),
    ]


def horus() -> list[Record]:
    """Fast modes of Table 6.2, and of Table 6.3 from derivatives left per degree."""
    records = []
    for name, table, band, source, note in (
        ("reference", "table_6_2", 0.07, MOOIJ, "form thesis, derivatives of Table 6.1 per radian, 26.7 km"),
        ("unconverted", "table_6_3", 0.03, REIJNE, "form thesis, per-degree derivatives taken as per radian, 26.7 km"),
    ):
        system = thesis.reproduce(name)
        for mode in thesis.FAST_MODES:
            published = complex(*thesis.printed()[table][mode])
            found = thesis.eigenvalue(system, published)
            where = f"HORUS-2B, {name}"
            if published.imag:
                records.append(_record(f"{mode}, Im", where, "1/s", published.imag, found.imag, band, source, note))
            records.append(_record(f"{mode}, Re", where, "1/s", published.real, found.real, band, source, note))
    return records


def _pair(
    name: str, where: str, published: complex, mode: Mode, band: float, source: str, note: str = ""
) -> list[Record]:
    found = mode.eigenvalue
    return [
        _record(f"{name}, Re", where, "1/s", published.real, found.real, band, source, note),
        _record(f"{name}, Im", where, "1/s", published.imag, found.imag, band, source, note),
    ]


def _record(
    quantity: str,
    where: str,
    unit: str,
    published: float,
    computed: float | None,
    band: float,
    source: str,
    note: str = "",
) -> Record:
    return Record(CASE, quantity, where, unit, published, computed, band, "relative", source, note=note)
