"""Tudat: aerodynamic coefficient files, one per coefficient, and a README that says how to read them.

The file format of Tudat (Delft University of Technology), "coefficients on a structured grid": lines that start with #
are comments; the first other line is the number of independent variables; then each variable's values, one line each;
then the values, a line for each value of the first variable with a column for each of the second, and such a block for
each value of the third.

Tudat's drag, side force and lift are positive along the *negative* axes of the aerodynamic frame (x along the velocity,
z down in the plane of symmetry, y right), so its C_S is -CY; its moments are about the body axes x forward, y right,
z down as here. It has one reference length for all three moments: that of Cm, on which Cl and Cn are put here.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from spaceplane.aero.model.model import AeroModel
from spaceplane.decks import statement
from spaceplane.decks.full import full_part
from spaceplane.files import write_text
from spaceplane.vehicle.controls import CONTROLS

MACH, ALPHA, BETA = "mach_number_dependent", "angle_of_attack_dependent", "sideslip_angle_dependent"
DEFLECTION = "control_surface_deflection_dependent"
"""Tudat's names of the independent variables."""

# Coefficient here -> (file's ending with Tudat's key and name, force or moment).
FILES = {
    "CD": "force_0_CD",
    "CY": "force_1_CS",
    "CL": "force_2_CL",
    "Cl": "moment_0_Cl",
    "Cm": "moment_1_Cm",
    "Cn": "moment_2_Cn",
}


def write(model: AeroModel, folder: Path | str) -> list[Path]:
    """Write the coefficient files of the vehicle, those of each control surface, and README.txt.

    The vehicle's are over Mach number, alpha and, where a sideslip slope is known, beta; an increment over Mach number,
    alpha and deflection; angles in rad. Coefficients that are unknown have no file, which Tudat takes as zero.

    Args:
        model: tables; its largest block without empty cells is written, and said so.
        folder: to write into; made if missing.

    Returns:
        Paths written, README.txt last.

    Raises:
        InputError: a model without a block of known values.
        OSError: the folder cannot be written.
    """
    full = full_part(model)
    files = {f"{FILES[name]}.dat": text for name, text in _vehicle(full).items()}
    for surface in (name for name in CONTROLS if name in full.surfaces):
        files |= {f"{surface}_{FILES[name]}.dat": text for name, text in _increments(full, surface).items()}
    files["README.txt"] = _readme(model, full, tuple(files))
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        write_text(text, target / name)
    return [target / name for name in files]


def scale(coefficient: str, model: AeroModel) -> float:
    """What a coefficient is multiplied by to become Tudat's: a sign, or b_ref / c_ref."""
    if coefficient == "CY":
        return -1.0
    return model.reference.span / model.reference.chord if coefficient in ("Cl", "Cn") else 1.0


def file_text(variables: Mapping[str, np.ndarray], values: np.ndarray, lines: tuple[str, ...] = ()) -> str:
    """One coefficient file.

    Args:
        variables: name -> [node] of two or three independent variables, in order.
        values: [node of the first, node of the second(, node of the third)].
        lines: comments for the head.
    """
    head = [*lines, "independent variables: " + ", ".join(variables)]
    text = [f"# {line}" for line in head]
    text += [str(len(variables)), "", *(_row(axis) for axis in variables.values())]
    for block in np.moveaxis(values, 2, 0) if values.ndim == 3 else [values]:
        text += ["", *(_row(row) for row in block)]
    return "\n".join(text) + "\n"


def _row(values: np.ndarray) -> str:
    return "\t".join(f"{float(value) + 0.0:.12g}" for value in values)  # + 0.0: no "-0"


def sideslips(model: AeroModel) -> np.ndarray:
    """[beta] rad: the limits and 0, between which the coefficients are linear; empty where nothing depends on it."""
    if model.beta_limit == 0.0 or not any(name.endswith("_beta") for name in model.slopes):
        return np.zeros(0)
    return np.array([-model.beta_limit, 0.0, model.beta_limit])


def _vehicle(model: AeroModel) -> dict[str, str]:
    """Text by coefficient; tables here are [alpha, mach], in the file [mach, alpha, beta]."""
    beta = sideslips(model)
    variables = {MACH: model.mach, ALPHA: model.alpha} | ({BETA: beta} if len(beta) else {})
    tables = {}
    for name, table in model.base.items():
        tables[name] = np.repeat(table.T[:, :, None], len(beta), axis=2) if len(beta) else table.T
    if len(beta):
        slopes = {name.split("_")[0]: table for name, table in model.slopes.items() if name.endswith("_beta")}
        tables |= {name: table.T[:, :, None] * beta for name, table in slopes.items()}
    return {name: _text(model, name, tables[name], variables) for name in FILES if name in tables}


def _increments(model: AeroModel, surface: str) -> dict[str, str]:
    table = model.surfaces[surface]
    variables = {MACH: model.mach, ALPHA: model.alpha, DEFLECTION: table.deflection}
    return {
        name: _text(model, name, np.transpose(table.increments[name], (2, 1, 0)), variables, surface)
        for name in FILES
        if name in table.increments
    }


def _text(
    model: AeroModel, name: str, values: np.ndarray, variables: Mapping[str, np.ndarray], surface: str = ""
) -> str:
    what = f"increment of {name} by {surface}" if surface else name
    change = {"CY": " as C_S = -CY, positive to the left", "Cl": " on c_ref", "Cn": " on c_ref"}.get(name, "")
    lines = (statement.title(model), f"{what}{change}; angles in rad; axes, reference and limits: README.txt")
    return file_text(variables, scale(name, model) * values, lines)


def _readme(model: AeroModel, full: AeroModel, files: tuple[str, ...]) -> str:
    r = full.reference
    x, y, z = r.moment_center
    place = (
        f"    moment_reference_point    {-x + 0.0:.10g}, {y:.10g}, {-z + 0.0:.10g} m, body axes, from the nose; where",
        "      your centre of mass is given from another point, give this from there too",
    )
    if not full.center_known:
        place = ("    moment_reference_point    your centre of mass, wherever that lies",)
    base = [name for name in files if name.startswith(("force", "moment"))]
    surfaces = [name for name in CONTROLS if name in full.surfaces]
    variables = [MACH, ALPHA, *([BETA] if len(sideslips(full)) else [])]
    lost = [name for name in full.slopes if not name.endswith("_beta")]
    lines = [
        statement.title(model) + ": aerodynamic coefficient files for Tudat",
        "",
        f"Source: {model.source}",
        "",
        "Files",
        *(f"  {name}" for name in files),
        "  The number is Tudat's key of the file: 0, 1, 2 for the x-, y- and z-axis. Give the files to",
        f"  aerodynamic_coefficients.tabulated_from_files with independent variables {', '.join(variables)}:",
        f"    force_coefficient_files   {_keys(base, 'force')}",
        f"    moment_coefficient_files  {_keys(base, 'moment')}",
        f"    reference_length {r.chord:.10g} m, reference_area {r.area:.10g} m2",
        "    force_coefficients_frame  negative_aerodynamic_frame_coefficients",
        "    moment_coefficients_frame positive_body_fixed_frame_coefficients",
        *place,
    ]
    if surfaces:
        lines += [
            "  Each control surface: tabulated_from_files_control_surface with independent variables",
            f"  {MACH}, {ALPHA}, {DEFLECTION}; add_single_control_surface under its name:",
        ]
        for surface in surfaces:
            own = [name.removeprefix(f"{surface}_") for name in files if name.startswith(f"{surface}_")]
            for kind in ("force", "moment"):
                lines.append(f"    {surface} {kind} {_keys(own, kind, f'{surface}_')}")
    lines += [
        "",
        "Axes and positive senses, in the terms of the source",
        *(f"  {line}" for line in statement.AXES),
        *(f"  deflection of {line}" for line in statement.deflection_lines(full)),
        "",
        "What differs in these files",
        "  C_S = -CY: Tudat's force coefficients are positive along the negative axes of the aerodynamic frame, so its",
        "    side force is positive to the left; drag downstream and lift up are as above.",
        f"  Cl and Cn are multiplied by b_ref/c_ref = {r.span / r.chord:.10g}: Tudat has one reference length for all",
        "    moments.",
        "  All angles are in rad.",
        "",
        "Reference",
        *(f"  {line}" for line in statement.reference_lines(full)),
        "",
        "Limits: the data hold inside these only. Set the boundary_interpolation of Tudat's interpolator settings to",
        "throw_exception_at_boundary, or it may go on outside without a word.",
        *(f"  {line}" for line in statement.limit_lines(full)),
        *(f"  {line}" for line in [statement.cut_line(model, full)] if line),
        "",
        "Not in these files",
        f"  {statement.unknown_line(full)}",
        *([f"  known, but Tudat's files have no rates: {', '.join(lost)}"] if lost else []),
        *(f"  {line}" for line in [statement.lag_line(full)] if line),
    ]
    return "\n".join(lines) + "\n"


def _keys(names: list[str], kind: str, prefix: str = "") -> str:
    """Such as `{0: "force_0_CD.dat"}`."""
    found = [(name.split("_")[1], name) for name in names if name.startswith(kind)]
    return "{" + ", ".join(f'{key}: "{prefix}{name}"' for key, name in found) + "}"
