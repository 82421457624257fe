"""Options that say what a stabilising feedback is put to."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import typer

from spaceplane.commands.arguments import number
from spaceplane.errors import InputError

if TYPE_CHECKING:
    from spaceplane.analysis.feedback_settings import FeedbackSettings

Control = Annotated[
    bool, typer.Option("--control/--no-control", help="What the controls can do, and the least stabilising feedback.")
]
Gust = Annotated[
    str | None, typer.Option("--gust", metavar="M/S", help="Sharp gust that the feedback meets; 9 by default.")
]
Offset = Annotated[
    str | None, typer.Option("--offset", metavar="DEG", help="Offset in alpha and beta that it meets; 1 by default.")
]
Decay = Annotated[
    str | None, typer.Option("--decay", metavar="1/S", help="Everything shall decay so fast; 0 only stabilises.")
]


def settings(control: bool, gust: str | None, offset: str | None, decay: str | None) -> FeedbackSettings | None:
    """The settings that the options make; None without `--control`.

    Raises:
        InputError: not a number, out of range, or given without `--control`.
    """
    from spaceplane.analysis.feedback_settings import FeedbackSettings

    texts = {"gust": (gust, "m/s"), "offset": (offset, "deg"), "decay": (decay, "1/s")}
    given = {name: number(f"--{name}", text, unit) for name, (text, unit) in texts.items() if text is not None}
    if not control:
        if given:
            raise InputError(f"--{next(iter(given))}: has no effect without --control")
        return None
    if "offset" in given:
        given["offset"] = math.radians(given["offset"])
    return FeedbackSettings(**given)
