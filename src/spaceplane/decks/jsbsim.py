"""JSBSim: a folder `NAME/NAME.xml` with an aircraft that flies on the tables of an aerodynamic model.

JSBSim (J. S. Berndt, AIAA 2004-4923) has the same body axes (x forward, y right, z down), angles and rates, and its
structural axes (x aft, y right, z up) are the geometry axes here. Its LIFT, DRAG and SIDE are in wind axes, positive
up, aft and to the right; ROLL, PITCH and YAW are body-axes moments about AERORP. So each coefficient passes with its
sign. JSBSim takes the air's angles at the centre of gravity, so the tables are written about that point.

Outside a table JSBSim takes the value at its edge without a word: the file states the limits, and its property
`aero/inside-tables` is 1 inside all of them and 0 outside.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from spaceplane import __version__
from spaceplane.aero.model.model import AeroModel
from spaceplane.decks import statement
from spaceplane.decks.full import full_part
from spaceplane.environment import constants
from spaceplane.errors import InputError
from spaceplane.files import write_text
from spaceplane.vehicle.controls import CONTROLS
from spaceplane.vehicle.properties import MassProperties

ALPHA, BETA, MACH = "aero/alpha-rad", "aero/beta-rad", "velocities/mach"
INSIDE = "aero/inside-tables"
MOTION = {
    "beta": (BETA,),
    "p": ("velocities/p-aero-rad_sec", "aero/bi2vel"),
    "q": ("velocities/q-aero-rad_sec", "aero/ci2vel"),
    "r": ("velocities/r-aero-rad_sec", "aero/bi2vel"),
}
"""What a slope is multiplied by: sideslip, or a rate times b/2V or c/2V."""

# Axis of JSBSim, coefficient, length that makes it a moment.
AXES = (
    ("LIFT", "CL", ()),
    ("DRAG", "CD", ()),
    ("SIDE", "CY", ()),
    ("ROLL", "Cl", ("metrics/bw-ft",)),
    ("PITCH", "Cm", ("metrics/cbarw-ft",)),
    ("YAW", "Cn", ("metrics/bw-ft",)),
)


def deflection_property(surface: str) -> str:
    """JSBSim's property of a control surface's deflection, rad."""
    return f"fcs/{surface}-rad"


def write(
    model: AeroModel,
    mass: MassProperties,
    folder: Path | str,
    name: str | None = None,
    center_of_mass: Sequence[float] | None = None,
) -> list[Path]:
    """Write `folder/NAME/NAME.xml`, the aircraft, and beside it `planet.xml`, the Earth of the linear model.

    Load it with `fdm.set_aircraft_path(folder)` and `fdm.load_model(NAME)`. Deflections are the properties
    `fcs/elevon_left-rad` and so on, rad, as they act; there is no pilot, actuator or landing gear. The planet is
    optional (`fdm.load_planet`, before the model): a sphere that does not turn, instead of JSBSim's WGS 84.

    Args:
        model: tables; its largest block without empty cells is written, and said so.
        mass: mass kg and inertia kg m2.
        folder: to write into; made if missing.
        name: of the aircraft; that of the model by default, with - for other than letters, digits, - and _.
        center_of_mass: x aft of the nose, y right, z up, m, to which the moments move; by default the moment centre of
            the model.

    Returns:
        Paths written.

    Raises:
        InputError: a name or centre of mass that cannot be, or a model without a block of known values.
        OSError: the folder cannot be written.
    """
    text = xml(model, mass, name, center_of_mass)
    aircraft = aircraft_name(model.name if name is None else name, exact=name is not None)
    target = Path(folder) / aircraft
    target.mkdir(parents=True, exist_ok=True)
    files = {target / f"{aircraft}.xml": text, target / "planet.xml": planet_xml()}
    for path, content in files.items():
        write_text(content, path)
    return list(files)


def aircraft_name(name: str, exact: bool = False) -> str:
    """A name that JSBSim and file systems take: letters, digits, - and _.

    Args:
        name: wanted.
        exact: refuse other characters instead of replacing them.

    Raises:
        InputError: nothing is left of it, or `exact` and it has other characters.
    """
    plain = re.sub(r"[^A-Za-z0-9_-]+", "-", name).strip("-")
    if not plain or (exact and plain != name):
        raise InputError(f"name = {name!r}: allowed are letters, digits, - and _")
    return plain


def xml(
    model: AeroModel,
    mass: MassProperties,
    name: str | None = None,
    center_of_mass: Sequence[float] | None = None,
) -> str:
    """The aircraft file as text; arguments and errors as for `write`."""
    full = full_part(model)
    if center_of_mass is not None:
        full = full.moved(tuple(center_of_mass))
    aircraft = aircraft_name(model.name if name is None else name, exact=name is not None)
    root = ET.Element("fdm_config", name=aircraft, version="2.0", release="BETA")
    _header(root, model, full)
    _metrics(root, full)
    _mass(root, mass, full.reference.moment_center)
    ET.SubElement(root, "ground_reactions")
    control = ET.SubElement(root, "flight_control", name="deflections as they act, rad")
    for surface in _surfaces(full):
        ET.SubElement(control, "property", value="0").text = deflection_property(surface)
    _aerodynamics(root, full)
    ET.indent(root, "  ")
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def planet_xml() -> str:
    """The Earth of `spaceplane.dynamics.equations` for JSBSim: a sphere that does not turn, inverse-square gravity."""
    radius = constants.EARTH_RADIUS
    root = ET.Element("planet", name="spherical Earth that does not turn")
    _quantity(root, "semimajor_axis", radius, "M")
    _quantity(root, "semiminor_axis", radius, "M")
    _quantity(root, "rotation_rate", 0.0, "RAD/SEC")
    _quantity(root, "GM", constants.STANDARD_GRAVITY * radius**2, "M3/SEC2")
    ET.SubElement(root, "J2").text = "0"
    ET.indent(root, "  ")
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _surfaces(model: AeroModel) -> tuple[str, ...]:
    return tuple(name for name in CONTROLS if name in model.surfaces)


def _header(root: ET.Element, model: AeroModel, full: AeroModel) -> None:
    head = ET.SubElement(root, "fileheader")
    ET.SubElement(head, "author").text = f"spaceplane {__version__}"
    ET.SubElement(head, "version").text = __version__
    ET.SubElement(head, "description").text = f"{model.name}: unpowered, without landing gear"
    lines = [
        f"Source: {model.source}",
        "Axes and positive senses:",
        *_items(statement.AXES),
        *_items(statement.deflection_lines(full)),
        "Units: coefficients without unit; angles in the tables rad; forces lbs and moments lbs ft by JSBSim",
        "Reference:",
        *_items(statement.reference_lines(full)),
        *([] if full.center_known else ["  - AERORP and CG are put at the origin of the structural axes"]),
        f"Valid inside these limits only. Outside them JSBSim holds the value at the edge without a word; {INSIDE} "
        "is 0 there and 1 inside:",
        *_items(statement.limit_lines(full)),
        *filter(None, [statement.cut_line(model, full)]),
        statement.unknown_line(full),
        *filter(None, [statement.lag_line(full)]),
    ]
    ET.SubElement(head, "note").text = "\n" + "\n".join(f"      {line}" for line in lines) + "\n    "


def _items(lines: Sequence[str]) -> list[str]:
    return [f"  - {line}" for line in lines]


def _metrics(root: ET.Element, model: AeroModel) -> None:
    metrics = ET.SubElement(root, "metrics")
    _quantity(metrics, "wingarea", model.reference.area, "M2")
    _quantity(metrics, "wingspan", model.reference.span, "M")
    _quantity(metrics, "chord", model.reference.chord, "M")
    for name in ("htailarea", "vtailarea"):
        _quantity(metrics, name, 0.0, "M2")
    for name in ("htailarm", "vtailarm"):
        _quantity(metrics, name, 0.0, "M")
    _location(metrics, "AERORP", model.reference.moment_center)
    _location(metrics, "EYEPOINT", (0.0, 0.0, 0.0))
    _location(metrics, "VRP", (0.0, 0.0, 0.0))


def _mass(root: ET.Element, mass: MassProperties, center: tuple[float, float, float]) -> None:
    balance = ET.SubElement(root, "mass_balance", negated_crossproduct_inertia="true")
    for name in ("Ixx", "Iyy", "Izz"):
        _quantity(balance, name.lower(), getattr(mass, name), "KG*M2")
    # Negated, also where JSBSim is too old for the attribute, they are elements of the tensor in structural axes; with
    # x aft and z up that of x and z is the one in body axes, minus the integral of x z dm.
    for name, value in (("ixy", 0.0), ("ixz", 0.0 - mass.Ixz), ("iyz", 0.0)):
        _quantity(balance, name, value, "KG*M2")
    _quantity(balance, "emptywt", mass.mass, "KG")
    _location(balance, "CG", center)


def _quantity(parent: ET.Element, name: str, value: float, unit: str) -> None:
    ET.SubElement(parent, name, unit=unit).text = _number(value)


def _location(parent: ET.Element, name: str, place: Sequence[float]) -> None:
    location = ET.SubElement(parent, "location", name=name, unit="M")
    for axis, value in zip("xyz", place, strict=True):
        ET.SubElement(location, axis).text = _number(value)


def _number(value: float) -> str:
    """Twelve digits: far below anything that counts, and short where the value is."""
    return f"{float(value):.12g}"


def _aerodynamics(root: ET.Element, model: AeroModel) -> None:
    aerodynamics = ET.SubElement(root, "aerodynamics")
    _inside(aerodynamics, model)
    for _, coefficient, _ in AXES:
        _coefficient(aerodynamics, coefficient, model)
    for axis, coefficient, lengths in AXES:
        place = ET.SubElement(aerodynamics, "axis", name=axis)
        function = ET.SubElement(place, "function", name=f"aero/{'moment' if lengths else 'force'}/{axis.lower()}")
        product = ET.SubElement(function, "product")
        for factor in ("aero/qbar-psf", "metrics/Sw-sqft", *lengths, f"aero/coefficient/{coefficient}"):
            ET.SubElement(product, "property").text = factor


def _inside(aerodynamics: ET.Element, model: AeroModel) -> None:
    """The property that is 1 inside every limit and 0 outside."""
    ranges = {MACH: model.mach[[0, -1]], ALPHA: model.alpha[[0, -1]], BETA: (-model.beta_limit, model.beta_limit)}
    ranges |= {deflection_property(name): model.surfaces[name].limits for name in _surfaces(model)}
    function = ET.SubElement(aerodynamics, "function", name=INSIDE)
    ET.SubElement(function, "description").text = "1 inside every limit of the tables, 0 outside"
    both = ET.SubElement(function, "and")
    for quantity, (lower, upper) in ranges.items():
        slack = 1e-9 * max(abs(lower), abs(upper))  # so that a value at the limit is inside in spite of round-off
        for comparison, limit in (("ge", lower - slack), ("le", upper + slack)):
            test = ET.SubElement(both, comparison)
            ET.SubElement(test, "property").text = quantity
            ET.SubElement(test, "value").text = _number(limit)


def _coefficient(aerodynamics: ET.Element, name: str, model: AeroModel) -> None:
    """`aero/coefficient/NAME`: base, increments of the surfaces, and slopes times what they multiply."""
    function = ET.SubElement(aerodynamics, "function", name=f"aero/coefficient/{name}")
    total = ET.SubElement(function, "sum")
    ET.SubElement(total, "value").text = "0"
    if name in model.base:
        _table(total, model, model.base[name])
    for surface in _surfaces(model):
        increments = model.surfaces[surface].increments
        if name in increments:
            _deflected_table(total, model, surface, increments[name])
    for slope, values in model.slopes.items():
        coefficient, quantity = slope.split("_")
        if coefficient == name:
            product = ET.SubElement(total, "product")
            for factor in MOTION[quantity]:
                ET.SubElement(product, "property").text = factor
            _table(product, model, values)


def _table(parent: ET.Element, model: AeroModel, values: np.ndarray) -> None:
    table = ET.SubElement(parent, "table")
    _variables(table, row=ALPHA, column=MACH)
    ET.SubElement(table, "tableData").text = _block(model, values)


def _deflected_table(parent: ET.Element, model: AeroModel, surface: str, values: np.ndarray) -> None:
    table = ET.SubElement(parent, "table")
    _variables(table, row=ALPHA, column=MACH, table=deflection_property(surface))
    for deflection, block in zip(model.surfaces[surface].deflection, values, strict=True):
        ET.SubElement(table, "tableData", breakPoint=_number(deflection)).text = _block(model, block)


def _variables(parent: ET.Element, **lookups: str) -> None:
    for lookup, name in lookups.items():
        ET.SubElement(parent, "independentVar", lookup=lookup).text = name


def _block(model: AeroModel, values: np.ndarray) -> str:
    """Rows of alpha, rad, columns of Mach numbers, in aligned columns."""
    rows = [["", *map(_number, model.mach)]]
    rows += [[_number(alpha), *map(_number, line)] for alpha, line in zip(model.alpha, values, strict=True)]
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]
    return "\n" + "\n".join(f"  {line}" for line in lines) + "\n"
