"""The generated blocks of the page on the linear model: where the rigid body and the thesis's Appendix A differ."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from blocks import demo, table
from scipy.optimize import linear_sum_assignment

from spaceplane.aero.model.derivatives import COEFFICIENTS, COMBINED, DAMPING, Derivatives, from_mapping, per_radian
from spaceplane.dynamics.flightpoint import FlightPoint, flight_point
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import identify
from spaceplane.dynamics.statespace import STATES, StateSpace
from spaceplane.validation import thesis
from spaceplane.vehicle.presets import horus_2b

# The thesis's p, r and beta have the opposite sense: its axes point aft and up.
SENSE = np.array([1.0, 1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0])
# Entries that differ by less than this share of themselves are equal.
EQUAL = 1e-12
# A change of an eigenvalue below this is not shown, 1/s.
SHOWN = 5e-6

DENSITY = "air that changes with height, density and speed of sound"
GYROSCOPIC = "gyroscopic moment of the steady turning rates"
TRIM = "the control moment that balances the gyroscopic one grows with dynamic pressure"
ROLLING = "steady roll rate about the velocity, p0 cos(alpha) + r0 sin(alpha)"
WHY: dict[tuple[str, str], str] = {
    ("V", "R"): f"{DENSITY} (drag)",
    ("gamma", "R"): f"{DENSITY} (lift)",
    ("gamma", "beta"): "sign of the side force",
    ("p", "V"): TRIM,
    ("p", "R"): f"{TRIM}, here by density",
    ("p", "q"): GYROSCOPIC,
    ("p", "r"): GYROSCOPIC,
    ("q", "V"): TRIM,
    ("q", "R"): f"{DENSITY} (Mach number in the pitching moment)",
    ("q", "p"): GYROSCOPIC,
    ("q", "r"): GYROSCOPIC,
    ("r", "V"): TRIM,
    ("r", "R"): f"{TRIM}, here by density",
    ("r", "p"): GYROSCOPIC,
    ("r", "q"): GYROSCOPIC,
    ("alpha", "R"): f"{DENSITY} (lift)",
    ("alpha", "beta"): f"{ROLLING}, which turns sideslip into angle of attack",
    ("beta", "alpha"): f"{ROLLING}, which turns angle of attack into sideslip",
    ("beta", "beta"): "sign of the side force: with the thesis's it drives sideslip on",
    ("sigma", "gamma"): "1/cos2(gamma) of the derivative of tan(gamma)",
    ("sigma", "R"): f"{DENSITY} (lift)",
    ("sigma", "alpha"): "steady rate r0 cos(alpha) - p0 sin(alpha), left out beside the change of lift",
    ("sigma", "beta"): "sign of the side force in its part with tan(gamma)",
}
"""Why an entry of A differs."""


@cache
def interface() -> tuple[FlightPoint, Derivatives]:
    """The TAEM interface of Table 6.1, air of the US 1976 atmosphere at 26.7 km, derivatives per radian."""
    t = thesis.printed()["table_6_1"]
    point = flight_point(
        t["mach"], t["altitude_m"], t["alpha_deg"], t["gamma_deg"], t["bank_deg"], thesis.LIFT, thesis.DRAG,
    )  # fmt: skip
    return point, from_mapping(per_radian(t["derivatives"]))


def system(form: str, **extra: float) -> StateSpace:
    """The linear model of one form at the interface, with further derivatives per rad or per reduced rate."""
    point, derivatives = interface()
    static = {name: getattr(derivatives, name) for name in derivatives.__dataclass_fields__ if name != "controls"}
    vehicle = horus_2b()
    return linearise(point, vehicle.mass, vehicle.reference, from_mapping({**static, **extra}), form)


def own_derivatives(names: tuple[str, ...]) -> dict[str, float]:
    """Derivatives of this project's analysis of HORUS-2B at Mach 2.5, where it has them."""
    found = next(p for p in demo()["flight_points"] if p["mach"] == 2.5)["derivatives"]
    return {name: found[name]["value"] for name in names if name in found}


def pairs() -> tuple[np.ndarray, np.ndarray]:
    """A of both forms in this project's axes."""
    return system("rigid-body").A, SENSE[:, None] * system("thesis").A * SENSE


def differing() -> list[tuple[int, int]]:
    """Rows and columns at which they differ."""
    ours, printed = pairs()
    size = np.maximum(np.abs(ours), np.abs(printed))
    return [(int(i), int(j)) for i, j in np.argwhere(np.abs(ours - printed) > EQUAL * size)]


def name(i: int, j: int) -> str:
    """Such as a_beta,alpha."""
    return f"a_{STATES[i]},{STATES[j]}"


def number(value: float) -> str:
    """Four digits."""
    return "0" if value == 0 else f"{value:.4g}"


def shift(change: complex) -> str:
    """A change of an eigenvalue, 1/s."""
    if abs(change) < SHOWN:
        return "."
    imaginary = f" {change.imag:+.2g}i" if abs(change.imag) >= SHOWN else ""
    real = f"{change.real:+.2g}" if abs(change.real) >= SHOWN else "0"
    return real + imaginary


def changes(base: np.ndarray, changed: np.ndarray) -> list[complex]:
    """How the eigenvalues of `base` with non-negative imaginary part move, fastest first, 1/s."""
    old, new = np.linalg.eigvals(base), np.linalg.eigvals(changed)
    rows, columns = linear_sum_assignment(np.abs(old[:, None] - new))
    moved = dict(zip(rows, columns, strict=True))
    order = [k for k in np.argsort(-np.abs(old), kind="stable") if old[k].imag >= 0]
    return [complex(new[moved[k]] - old[k]) for k in order]


def heads() -> list[str]:
    """The modes of the rigid-body form with their eigenvalues."""
    found = []
    for mode in identify(system("rigid-body")):
        value = mode.eigenvalue
        text = f"{value.real:+.4f}" + (f" ± {value.imag:.4f}i" if mode.oscillatory else "")
        found.append(f"{mode.name} {text}")
    return found


def terms() -> str:
    """Every entry of A that differs, with both values."""
    ours, printed = pairs()
    rows = [(name(i, j), number(ours[i, j]), number(printed[i, j]), WHY[STATES[i], STATES[j]]) for i, j in differing()]
    return table(("entry", "rigid body", "Appendix A", "what differs"), rows, "lrrl")


def effects() -> str:
    """How the eigenvalues of the rigid-body form move when one entry alone is replaced by that of Appendix A."""
    ours, printed = pairs()
    rows = []
    for i, j in differing():
        one = ours.copy()
        one[i, j] = printed[i, j]
        rows.append((name(i, j), *(shift(change) for change in changes(ours, one))))
    rows.append(("all of them", *(shift(change) for change in changes(ours, printed))))
    return table(("entry replaced", *heads()), rows, "l" + "r" * len(heads()))


def damping() -> str:
    """Entries that rate damping adds to the rigid-body form, and what each derivative does to the eigenvalues."""
    base = system("rigid-body").A
    known = own_derivatives(DAMPING)
    rows = []
    for derivative, value in known.items():
        changed = system("rigid-body", **{derivative: value}).A
        entries = ", ".join(
            f"{name(i, j)} {changed[i, j] - base[i, j]:+.2g}"
            for i, j in np.argwhere(np.abs(changed - base) > EQUAL * np.abs(base).max(axis=1, keepdims=True))
        )
        rows.append((derivative, f"{value:.3f}", entries, *(shift(change) for change in changes(base, changed))))
    every = system("rigid-body", **known).A
    rows.append(("all of them", "", "", *(shift(change) for change in changes(base, every))))
    return table(("derivative", "value", "adds to", *heads()), rows, "lrl" + "r" * len(heads()))


def control() -> str:
    """Entries of B that Appendix A leaves out, for one radian of each control, and what it keeps beside them."""
    surfaces = ("elevon_left", "elevon_right", "rudder_left", "rudder_right")
    names = tuple(f"{coefficient}_{surface}" for surface in surfaces for coefficient in COEFFICIENTS)
    extra = own_derivatives(names)
    ours, printed = system("rigid-body", **extra), system("thesis", **extra)
    rows = []
    for k, state in enumerate(STATES):
        for control_name in COMBINED:
            mine = ours.B[k, ours.inputs.index(control_name)]
            theirs = printed.B[k, printed.inputs.index(control_name)]
            largest = np.abs(ours.B[k, [ours.inputs.index(c) for c in COMBINED]]).max()
            if abs(mine - theirs) > 1e-9 * largest:
                force = {"V": "drag", "gamma": "lift and side force", "alpha": "lift", "beta": "side force"}.get(state)
                why = f"{force or 'lift and side force'} of the control" if k not in (3, 4, 5) else "its moment"
                rows.append((f"b_{state},{control_name}", number(mine), number(theirs), why))
    return table(("entry", "rigid body", "Appendix A", "what is left out"), rows, "lrrl")


BLOCKS: dict[str, Callable[[], str]] = {
    "linear model terms": terms,
    "linear model effects": effects,
    "linear model damping": damping,
    "linear model control": control,
}
