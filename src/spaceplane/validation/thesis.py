"""The thesis's eigenvalues, reproduced: what its Tables 6.2, 6.3 and 7.2 to 7.9 come from.

A reproduction is named and states what it does: which ambient state, whether the per-degree derivatives were turned
into per-radian ones, and which form of the linear model. `tables` writes the tables of docs/reproduction.md from them.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np

from spaceplane.aero.model.derivatives import from_mapping, per_degree, per_radian
from spaceplane.dynamics.flightpoint import FlightPoint, flight_point, trajectory_altitude
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import Mode, identify
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.errors import InputError
from spaceplane.study import thesis as published
from spaceplane.vehicle.presets import horus_2b

# C_L and C_D at the point are not printed: these are of the published tables (horus_2b) with the flaps of Table 6.1.
LIFT, DRAG = 0.36, 0.20
FAST_MODES = ("former short period, stable", "former short period, unstable", "lateral oscillation")


@dataclass(frozen=True)
class Reproduction:
    """How Table 6.1 is turned into eigenvalues.

    Attributes:
        name: key in `REPRODUCTIONS`.
        altitude: m.
        pressure: Pa; None for the US 1976 atmosphere's.
        temperature: K; None likewise.
        unconverted: put the per-degree derivatives into the equations as if they were per radian.
        form: of the linear model.
        gyroscopic: form "rigid-body" only.
        meaning: one line.
    """

    name: str
    altitude: float
    pressure: float | None
    temperature: float | None
    unconverted: bool
    form: str
    gyroscopic: bool
    meaning: str


REPRODUCTIONS: dict[str, Reproduction] = {
    r.name: r
    for r in (
        Reproduction(
            "reference", 26_700.0, 1967.5, 223.24, False, "thesis", False,
            "derivatives per radian, US 1976 at 26.7 km: reproduces Table 6.2",
        ),
        Reproduction(
            "unconverted", 26_700.0, None, None, True, "thesis", False,
            "per-degree values taken as per radian, US 1976 at 26.7 km: reproduces Table 6.3",
        ),
        Reproduction(
            "unconverted 25 km", 25_000.0, 2511.02, 221.65, True, "thesis", False,
            "per-degree values taken as per radian, the pressure and temperature that the thesis prints",
        ),
        Reproduction(
            "printed side force", 26_700.0, 2511.02, 221.65, False, "thesis", False,
            "Appendix A as printed, at the pressure and temperature that the thesis prints",
        ),
        Reproduction(
            "consistent side force", 26_700.0, 2511.02, 221.65, False, "rigid-body", False,
            "a side force that opposes sideslip; no gyroscopic moments, as in the thesis",
        ),
        Reproduction(
            "rigid body", 26_700.0, 2511.02, 221.65, False, "rigid-body", True,
            "all terms: also the gyroscopic moments of the steady turning rates",
        ),
    )
}  # fmt: skip
"""The named reproductions of Table 6.1's flight point."""


@cache
def printed() -> dict:
    """The thesis's numbers (data/thesis_flight_dynamics.toml)."""
    path = files("spaceplane.validation").joinpath("data/thesis_flight_dynamics.toml")
    return tomllib.loads(path.read_text(encoding="utf-8"))


def reproduce(name: str) -> StateSpace:
    """The linear model of a named reproduction.

    Raises:
        InputError: unknown name.
    """
    if name not in REPRODUCTIONS:
        raise InputError(f"reproduction = {name!r}: must be one of {', '.join(REPRODUCTIONS)}")
    chosen = REPRODUCTIONS[name]
    table = printed()["table_6_1"]
    point = flight_point(
        table["mach"], chosen.altitude, table["alpha_deg"], table["gamma_deg"], table["bank_deg"], LIFT, DRAG,
        chosen.pressure, chosen.temperature,
    )  # fmt: skip
    values = table["derivatives"]
    derivatives = from_mapping(values if chosen.unconverted else per_radian(values))
    vehicle = horus_2b()
    return linearise(point, vehicle.mass, vehicle.reference, derivatives, chosen.form, gyroscopic=chosen.gyroscopic)


def eigenvalue(system: StateSpace, near: complex) -> complex:
    """The eigenvalue, 1/s, with non-negative imaginary part that lies nearest to a value."""
    values = np.linalg.eigvals(system.A)
    values = values[values.imag >= 0]
    return complex(values[np.argmin(np.abs(values - near))])


def reproduce_table_6_3() -> dict[str, complex]:
    """The modes of Table 6.3 from per-degree derivatives left unconverted: the reproduction named "unconverted"."""
    system = reproduce("unconverted")
    return {mode: eigenvalue(system, complex(*value)) for mode, value in printed()["table_6_3"].items()}


def tables() -> dict[str, str]:
    """Markdown tables of docs/reproduction.md by name, all computed."""
    return {
        "reference": reference_table(),
        "side force": side_force_table(),
        "lateral": lateral_table(),
        "longitudinal": longitudinal_table(),
        "converted": converted_table(),
    }


def reference_table() -> str:
    """Table 6.2 and 6.3 beside their reproductions."""
    systems = {name: reproduce(name) for name in ("reference", "unconverted 25 km", "unconverted")}
    head = (
        "mode", "reference, Table 6.2", "per radian, 26.7 km", "deviation", "per degree unconverted, 2511 Pa",
        "per degree unconverted, 26.7 km", "thesis, Table 6.3", "deviation",
    )  # fmt: skip
    rows = []
    for mode, value in printed()["table_6_2"].items():
        reference, thesis = complex(*value), complex(*printed()["table_6_3"][mode])
        right = eigenvalue(systems["reference"], reference)
        near, same = eigenvalue(systems["unconverted 25 km"], thesis), eigenvalue(systems["unconverted"], thesis)
        rows.append(
            (mode, _text(reference), _text(right), _percent(right, reference), _text(near), _text(same), _text(thesis),
             _percent(same, thesis))
        )  # fmt: skip
    return _markdown(head, rows)


def side_force_table() -> str:
    """The lateral oscillation at the thesis's ambient values with the printed and with a consistent side force."""
    rows = [
        (REPRODUCTIONS[name].meaning, _text(eigenvalue(reproduce(name), 1.58j)))
        for name in ("printed side force", "consistent side force", "rigid body")
    ]
    return _markdown(("form", "lateral oscillation, 1/s"), rows)


def chapter_7_system(
    shape: str, mach: float, form: str = "thesis", unconverted: bool = True, swapped: bool = False
) -> StateSpace:
    """The model of a flight point of chapter 7 from the thesis's own derivatives.

    Angle of attack, path angle, bank angle, C_L and C_D are those of Table 6.1: the thesis prints no others.

    Args:
        shape: "original" or "optimised".
        mach: a Mach number of Tables 7.1, 7.6 or 7.8.
        form: form of the linear model.
        unconverted: leave the per-degree values as they are.
        swapped: turn the sign of C_n_beta and divide by I_xx in place of I_zz.
    """
    entry = next(e for e in printed()["chapter_7"] if (e["shape"], e["mach"]) == (shape, mach))
    values = dict(published.derivatives(shape)[mach])
    vehicle = horus_2b()
    if swapped:
        values["Cn_beta"] *= -vehicle.mass.Izz / vehicle.mass.Ixx
    derivatives = from_mapping(per_degree(values) if unconverted else values)
    return linearise(_point(entry), vehicle.mass, vehicle.reference, derivatives, form)


def _point(entry: dict) -> FlightPoint:
    table = printed()["table_6_1"]
    return flight_point(
        entry["mach"], trajectory_altitude(entry["mach"]), table["alpha_deg"], table["gamma_deg"], table["bank_deg"],
        LIFT, DRAG, entry["pressure_Pa"], entry["temperature_K"],
    )  # fmt: skip


def lateral_table() -> str:
    """The lateral oscillation of Tables 7.2 to 7.9 as printed, from Appendix A, and with the two slips of Table 7.4."""
    rows = []
    for entry in printed()["chapter_7"]:
        value = complex(*entry["lateral"])
        plain = chapter_7_system(entry["shape"], entry["mach"])
        swapped = chapter_7_system(entry["shape"], entry["mach"], swapped=True)
        fast = max(np.linalg.eigvals(plain.A), key=lambda z: (z.imag > 0, abs(z)))
        found = eigenvalue(swapped, value)
        rows.append(
            (entry["table"], entry["shape"], f"{entry['mach']:g}", _text(value), _text(complex(fast)), _text(found),
             _percent(found, value))
        )  # fmt: skip
    head = (
        "Table",
        "shape",
        "Mach",
        "printed",
        "Appendix A, fastest oscillation",
        "with the two slips",
        "deviation",
    )
    return _markdown(head, rows)


def longitudinal_table() -> str:
    """The C_m_alpha that the printed longitudinal eigenvalues need, beside the printed one."""
    rows = []
    for entry in printed()["chapter_7"]:
        needed = needed_pitch_stiffness(entry)
        value = published.derivatives(entry["shape"])[entry["mach"]]["Cm_alpha"] * math.pi / 180.0
        roots = ", ".join(_text(complex(*root)) for root in entry["longitudinal"])
        rows.append((entry["table"], entry["shape"], f"{entry['mach']:g}", roots, f"{value:.2g}", f"{needed:.2g}"))
    head = ("Table", "shape", "Mach", "printed eigenvalues, 1/s", "printed C_m_alpha, 1/deg", "needed")
    return _markdown(head, rows)


def needed_pitch_stiffness(entry: dict) -> float:
    """C_m_alpha, per the unit that was put into the equations, that three printed eigenvalues need.

    Speed, angle of attack and pitch rate give s^3 - a_q,alpha s + c = 0 when the small dampings are left out, so the
    sum of the products of the eigenvalues by pairs is -a_q,alpha = -C_m_alpha q S c / I_yy.
    """
    roots = [complex(*root) for root in entry["longitudinal"]]
    roots += [root.conjugate() for root in roots if root.imag]
    a, b, c = roots
    vehicle = horus_2b()
    scale = _point(entry).dynamic_pressure * vehicle.reference.area * vehicle.reference.chord / vehicle.mass.Iyy
    return -(a * b + b * c + a * c).real / scale


def converted_table() -> str:
    """Fast modes from the thesis's derivatives of chapter 7, converted to per radian, in the rigid-body form."""
    rows = []
    for entry in printed()["chapter_7"]:
        system = chapter_7_system(entry["shape"], entry["mach"], "rigid-body", unconverted=False)
        fast = [mode for mode in identify(system) if abs(mode.eigenvalue) > 0.2]
        text = "; ".join(f"{mode.name} {_text(mode.eigenvalue)}" for mode in fast)
        rows.append((entry["shape"], f"{entry['mach']:g}", text, _doubling(fast)))
    return _markdown(("shape", "Mach", "modes faster than 0.2 1/s", "shortest time to double, s"), rows)


def _doubling(modes: list[Mode]) -> str:
    times = [mode.double_time for mode in modes if mode.double_time is not None]
    return f"{min(times):.2f}" if times else "-"


def _text(value: complex) -> str:
    return f"{value.real:+.4f}" if value.imag == 0 else f"{value.real:+.4f} ± {abs(value.imag):.4f}i"


def _percent(value: complex, reference: complex) -> str:
    return f"{100 * abs(value - reference) / abs(reference):.1f} %"


def _markdown(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
