"""What `fly` and `export` take as SOURCE: an aerodynamic model, or a flight point of an analysis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spaceplane.errors import InputError

if TYPE_CHECKING:
    from spaceplane.aero.model.model import AeroModel
    from spaceplane.decks.source import Source

Point = Annotated[
    str | None,
    typer.Option("--point", metavar="NAME", help="Flight point of an analysis, such as 2.5, where it has several."),
]


def is_analysis(source: str) -> bool:
    """Whether a source is a folder that `spaceplane analyse` wrote."""
    return (Path(source) / "result.json").is_file()


def read(source: str, vehicle: str | None, point: str | None) -> Source:
    """The model of a source, with the mass of its vehicle where it is known.

    Raises:
        InputError: as `decks.source.read_source` and `report.local_model.local_model`, or an option without effect.
    """
    if is_analysis(source):
        if vehicle is not None:
            raise InputError("--vehicle: an analysis has its own vehicle")
        from spaceplane.report.local_model import local_model
        from spaceplane.report.read import read_result

        return local_model(read_result(Path(source)), point)
    if point is not None:
        raise InputError(f"--point: {point}, goes with a folder of `spaceplane analyse` only")
    from spaceplane.decks.source import read_source

    return read_source(source, vehicle)


def check_center(model: AeroModel, center: Sequence[float] | None) -> None:
    """Refuse a centre of mass that no vehicle of these tables has, such as one in millimetres.

    Args:
        model: whose moment centre it is measured from.
        center: x, y, z in geometry axes, m; None is that of the model.

    Raises:
        InputError: farther from the moment centre than the larger of chord and span, or that centre is not known.
    """
    if center is None:
        return
    said = ",".join(f"{x:g}" for x in center)
    if not model.center_known:
        raise InputError(
            f"--center-of-mass: {said}, cannot be used: moments of {model.name} are about its centre of mass, whose "
            "place it does not give"
        )
    reference = model.reference
    away, reach = math.dist(center, reference.moment_center), max(reference.chord, reference.span)
    if away > reach:
        own = ",".join(f"{x:g}" for x in reference.moment_center)
        raise InputError(
            f"--center-of-mass: {said} m is {away:.4g} m from the moment centre {own} m; allowed are up to {reach:g} "
            "m, the larger of chord and span"
        )
