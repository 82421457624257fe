"""What the symbols of a result mean: label, axes, and the sign that makes a vehicle stable."""

from __future__ import annotations

import re
from dataclasses import dataclass

from spaceplane.dynamics.statespace import STATE_UNITS

GREEK = {"alpha": "α", "beta": "β", "gamma": "γ", "sigma": "σ", "mu": "μ", "phi": "φ", "psi": "ψ", "theta": "θ"}

COEFFICIENTS = {
    "CL": ("lift", "wind axes, positive up, on q S"),
    "CD": ("drag", "wind axes, positive aft, on q S"),
    "CY": ("side force", "wind axes, positive right, on q S"),
    "Cl": ("rolling moment", "body axes, right wing down positive, on q S b"),
    "Cm": ("pitching moment", "body axes, nose up positive, on q S c"),
    "Cn": ("yawing moment", "body axes, nose right positive, on q S b"),
    "CA": ("axial force", "geometry x, positive aft, on q S"),
    "CN": ("normal force", "geometry z, positive up, on q S"),
    "CA_forebody": ("axial force of walls that face upstream", "geometry x, positive aft, on q S"),
    "CA_base": ("axial force of walls that face downstream", "geometry x, positive aft, on q S"),
    "L_over_D": ("lift over drag", ""),
    "Cp_max": ("highest wall pressure coefficient", "on q"),
    "Cp_min": ("lowest wall pressure coefficient", "on q"),
}

SOURCES = {
    "inviscid": "of the inviscid flow",
    "friction": "of skin friction",
    "base": "of the base pressure by correlation, over the inviscid one",
}
"""Where a coefficient comes from, in words."""

# physics: C_m_alpha < 0, C_n_beta > 0, C_l_beta < 0 and C_Y_beta < 0 are the stable signs, and rates are damped.
STABLE_SIGN = {
    "CL_alpha": 1,
    "Cm_alpha": -1,
    "CY_beta": -1,
    "Cl_beta": -1,
    "Cn_beta": 1,
    "Cl_p": -1,
    "Cm_q": -1,
    "Cn_r": -1,
}

_STATE_NAMES = {
    "V": "speed",
    "gamma": "flight-path angle",
    "R": "radius",
    "p": "roll rate",
    "q": "pitch rate",
    "r": "yaw rate",
    "alpha": "angle of attack",
    "beta": "sideslip",
    "sigma": "bank angle",
}
STATES = {state: (name, STATE_UNITS[state]) for state, name in _STATE_NAMES.items()}
"""State of the linear model: what it is and its unit."""

_VARIABLES = {"alpha": "α", "beta": "β", "M": "M", "mach": "M", "p": "p", "q": "q", "r": "r"}


@dataclass(frozen=True)
class Derivative:
    """A derivative's name taken apart.

    Attributes:
        coefficient: such as Cm.
        variable: what it is taken with, such as alpha or elevon_left.
        control: whether that is a control surface.
    """

    coefficient: str
    variable: str
    control: bool


def split_derivative(name: str) -> Derivative:
    """Take `Cm_elevon_left` apart into Cm and elevon_left."""
    coefficient, _, variable = name.partition("_")
    return Derivative(coefficient, variable, variable not in _VARIABLES)


def symbol(name: str) -> str:
    """HTML of a coefficient or derivative: `CL_alpha` becomes C with the subscript L alpha."""
    if name == "L_over_D":
        return "<i>L</i>/<i>D</i>"
    coefficient, _, variable = name.partition("_")
    if not coefficient.startswith("C"):
        return GREEK.get(name, name)
    head = f"<i>C</i><sub>{coefficient[1:]}"
    if not variable:
        return head + "</sub>"
    return f"{head}<span class=wrt>{_VARIABLES.get(variable, ' ' + words(variable))}</span></sub>"


def greek(text: str) -> str:
    """Text with the names of angles as Greek letters."""
    return re.sub(rf"\b({'|'.join(GREEK)})\b", lambda found: GREEK[found.group(1)], text)


def words(name: str) -> str:
    """`elevon_left` as words."""
    return name.replace("_", " ")


def meaning(name: str) -> str:
    """What a derivative says, in words."""
    parts = split_derivative(name)
    what = COEFFICIENTS.get(parts.coefficient, (parts.coefficient, ""))[0]
    named = {"alpha": "angle of attack", "beta": "sideslip", "M": "Mach number", "mach": "Mach number"}
    named |= {"p": "roll rate", "q": "pitch rate", "r": "yaw rate"}
    return f"{what} with {named.get(parts.variable, words(parts.variable))}"


def stability(name: str, value: float | None, error: float | None = None) -> str:
    """ "stable", "unstable", "undecided" (zero lies within the error), or "" when the sign says nothing."""
    sign = STABLE_SIGN.get(name)
    if sign is None or value is None:
        return ""
    if error is not None and abs(value) <= error:
        return "undecided"
    return "stable" if sign * value > 0 else "unstable"
