"""`spaceplane modes`: flight dynamics and flying qualities from given derivatives, without flow."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spaceplane.commands import feedback, options
from spaceplane.commands.arguments import existing_file, writable_file, write_json

if TYPE_CHECKING:
    from spaceplane.analysis.feedback_settings import FeedbackSettings
    from spaceplane.dynamics.derivatives_file import ModesCase

EXAMPLE = "Example: spaceplane modes examples/horus_2b_taem.toml --json modes.json"


def modes(
    derivatives: Annotated[
        Path, typer.Argument(metavar="DERIVATIVES.toml", help="Flight point, vehicle and derivatives.")
    ],
    form: Annotated[
        str | None,
        typer.Option("--form", metavar="rigid-body|thesis", help="Form of the model, instead of the file's."),
    ] = None,
    vehicle_class: Annotated[
        str | None, typer.Option("--class", metavar="I..IV", help="Class of MIL-F-8785C, instead of the file's.")
    ] = None,
    category: Annotated[
        str | None, typer.Option("--category", metavar="A|B|C", help="Flight phase category, instead of the file's.")
    ] = None,
    control: feedback.Control = False,
    gust: feedback.Gust = None,
    offset: feedback.Offset = None,
    decay: feedback.Decay = None,
    json_file: options.JsonFile = None,
) -> int:
    """Eigenmodes and MIL-F-8785C levels from a table of derivatives; with --control what the controls can do."""
    existing_file(derivatives, "a TOML file of derivatives")
    asked = feedback.settings(control, gust, offset, decay)
    writable_file(json_file, "--json")
    from spaceplane.dynamics import derivatives_file
    from spaceplane.qualities.modes_record import analyse_modes

    given = {"form": form, "vehicle_class": vehicle_class, "category": category}
    case = replace(derivatives_file.read(derivatives), **{name: value for name, value in given.items() if value})
    record = analyse_modes(case)
    if asked is not None:
        record["control"] = _control(case, asked)
    write_json(record, json_file)
    if str(json_file) != "-":
        from spaceplane.report.summary import print_modes

        print_modes(record)
    return 0


def _control(case: ModesCase, asked: FeedbackSettings) -> dict | None:
    """The record of control; the trim is that of the file's `elevator_deg`, the other surfaces stand at 0."""
    from spaceplane.analysis.controllability import controllability
    from spaceplane.dynamics.linearise import linearise
    from spaceplane.qualities.airframe import Airframe
    from spaceplane.report.control_record import control_record

    model = (case.point, case.mass, case.reference, case.derivatives)
    system = linearise(*model, case.form, case.density_gradient, case.gyroscopic)
    airframe = Airframe(*model, **case.airframe)
    trim = dict.fromkeys(("elevon_left", "elevon_right"), airframe.elevator)
    return control_record(controllability(airframe, system, trim, asked, case.vehicle_class, case.category))
