"""Text from the command line to values, and files that can be read or written."""

from __future__ import annotations

import functools
import math
import os
import re
import sys
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

from spaceplane.errors import InputError
from spaceplane.files import json_text, writable_folder, write_text

ASSIGNING = ("--set", "--deflect")
OPTION_OF = {
    "accuracy": "--accuracy",
    "adapt": "--adapt",
    "altitude_m": "--altitude",
    "base": "--base",
    "boxes": "--refine-box",
    "category": "--category",
    "domain": "--domain",
    "emissivity": "--emissivity",
    "fine_parts": "--refine-parts",
    "form": "--form",
    "friction": "--friction",
    "gas": "--gas",
    "mach": "--mach",
    "max_cells": "--cells",
    "rates": "--rates",
    "sizing": "--refine-box",
    "target_cells": "--cells",
    "transition_reynolds": "--transition-reynolds",
    "vehicle_class": "--class",
    "wall_cell": "--cell",
    "wall_temperature_K": "--wall-temperature",
}
"""Options of `flow`, `analyse` and `database` by the settings that they become."""
VERIFIED_MACH = 25.0
"""Up to which the flow solver is compared with exact solutions (docs, validation)."""
PLACES = ("--out", "--json", "--vtu", "--vtp", "--store", "--mesh")


def spread_assignments(arguments: Sequence[str]) -> list[str]:
    """Let one --set or --deflect take several values: `--set a=1 b=2` becomes `--set a=1 --set b=2`."""
    spread: list[str] = []
    option = ""
    taken = False
    for argument in arguments:
        if argument in ASSIGNING:
            option, taken = argument, False
        elif option and not taken:
            taken = True
        elif option and "=" in argument and not argument.startswith("-"):
            spread.append(option)
        else:
            option = ""
        spread.append(argument)
    return spread


def require_places(arguments: Sequence[str]) -> None:
    """Refuse an empty name of a file or folder, which would mean the current folder.

    Raises:
        InputError: naming the option.
    """
    for option, value in pairwise(arguments):
        if option in PLACES and not value.strip():
            raise InputError(f"{option}: empty, a name is needed")


def naming_options(command: Callable[..., int]) -> Callable[..., int]:
    """A command whose errors name the option where a setting was refused, see `in_options`.

    Raises:
        InputError: as the command.
    """

    @functools.wraps(command)
    def run(*given: object, **named: object) -> int:
        try:
            return command(*given, **named)
        except InputError as error:
            raise InputError(in_options(str(error))) from error

    return run


def in_options(message: str) -> str:
    """The message with settings replaced by options: `--cells: 10, ...` for `target_cells: 10, ...`."""
    found = re.match(r"(\w+)(?: = (.+?))?: ", message)
    if found is None or found[1] not in OPTION_OF:
        return message
    start = f"{OPTION_OF[found[1]]}: " + (f"{found[2]}, " if found[2] else "")
    others = "|".join(name for name in OPTION_OF if "_" in name)
    return start + re.sub(rf"\b({others})\b", lambda name: OPTION_OF[name[0]], message[found.end() :])


def warn_beyond_verified(machs: Sequence[float], option: str = "--mach") -> None:
    """Say on stderr that nothing has been checked, where a Mach number lies beyond `VERIFIED_MACH`."""
    if max(machs, default=0.0) > VERIFIED_MACH:
        print(
            f"warning: {option}: {max(machs):g}, beyond Mach {VERIFIED_MACH:g} nothing has been checked",
            file=sys.stderr,
        )


def number(option: str, text: str, unit: str = "") -> float:
    """A finite number in the option's `unit`, which the message names.

    Raises:
        InputError: naming the option and the text.
    """
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{option}: {text.strip()!r} is not a number{f' ({unit})' if unit else ''}")
    return value


def numbers(option: str, text: str, unit: str = "", count: int | None = None) -> list[float]:
    """Numbers between commas, in the option's `unit`; blanks around them are fine.

    Raises:
        InputError: empty, not a number, or not `count` of them.
    """
    if not text.strip():
        raise InputError(f"{option}: empty; give {count or 'one or more'} numbers between commas{_of(unit)}")
    values = [number(option, piece, unit) for piece in text.split(",")]
    if count is not None and len(values) != count:
        raise InputError(f"{option}: {text.strip()!r} has {len(values)} numbers, {count} are needed{_of(unit)}")
    return values


def list_of_names(option: str, text: str | None) -> list[str] | None:
    """Names between commas, without the blanks around them; None for None.

    Raises:
        InputError: an empty name.
    """
    if text is None:
        return None
    names = [name.strip() for name in text.split(",")]
    if not all(names):
        raise InputError(f"{option}: {text.strip()!r} has an empty name; give names between commas")
    return names


def mach_numbers(text: str, option: str = "--mach") -> list[float]:
    """Mach numbers above 0, each once.

    Raises:
        InputError: as `numbers`, or one that is not above 0 or given twice.
    """
    values = numbers(option, text)
    for k, value in enumerate(values):
        if value <= 0:
            raise InputError(f"{option}: {value:g}, must be above 0")
        if value in values[:k]:
            raise InputError(f"{option}: {value:g} is given twice")
    return values


def angles(option: str, text: str, limit_deg: float = 90.0) -> list[float]:
    """Angles in degrees within +-`limit_deg`, each once, as radians.

    Raises:
        InputError: as `numbers`, or one out of range or given twice.
    """
    values = numbers(option, text, "degrees")
    for k, value in enumerate(values):
        if abs(value) > limit_deg:
            raise InputError(f"{option}: {value:g} deg, allowed -{limit_deg:g} to {limit_deg:g} deg")
        if value in values[:k]:
            raise InputError(f"{option}: {value:g} deg is given twice")
    return [math.radians(value) for value in values]


def positive(option: str, text: str, unit: str) -> float:
    """A number above 0 in the option's `unit`.

    Raises:
        InputError: not a number, or not above 0.
    """
    value = number(option, text, unit)
    if value <= 0:
        raise InputError(f"{option}: {value:g} {unit}, must be above 0")
    return value


def count(option: str, text: str, unit: str) -> int:
    """A whole number above 0, such as 300000, 300k or 1.5M.

    Raises:
        InputError: as `positive`.
    """
    scale = {"k": 1e3, "m": 1e6}.get(text.strip()[-1:].lower(), 1.0)
    digits = text.strip()[:-1] if scale > 1.0 else text
    return round(scale * positive(option, digits, unit))


def fraction(option: str, text: str) -> float:
    """A share above 0, such as 1% or 0.01.

    Raises:
        InputError: not a number, or not above 0.
    """
    stripped = text.strip()
    percent = stripped.endswith("%")
    try:
        value = float(stripped.removesuffix("%"))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{option}: {stripped!r} is not a share such as 1% or 0.01")
    if value <= 0:
        raise InputError(f"{option}: {stripped}, must be above 0")
    return value / 100.0 if percent else value


def assignments(option: str, texts: Sequence[str] | None) -> dict[str, float]:
    """`name=value` texts (also several between commas) as a dict of numbers, each in the unit that its name implies.

    Raises:
        InputError: no `=`, no name, a value that is not a number, or a name given twice.
    """
    found: dict[str, float] = {}
    for piece in (p for text in texts or () for p in text.split(",")):
        name, equals, value = piece.partition("=")
        name = name.strip().replace("-", "_")
        if not equals or not name:
            raise InputError(f"{option}: {piece.strip()!r} is not name=value")
        if name in found:
            raise InputError(f"{option}: {name} is given twice")
        found[name] = number(f"{option} {name}", value)
    return found


def existing_file(path: Path, what: str) -> Path:
    """`path`, when it is a file that can be read.

    Raises:
        InputError: it is missing, a folder or not readable.
    """
    if path.is_dir():
        raise InputError(f"{path}: is a folder, {what} is needed")
    if not path.exists():
        raise InputError(f"{path}: no such file ({what} is needed)")
    if not os.access(path, os.R_OK):
        raise InputError(f"{path}: cannot be read (permission denied)")
    return path


def writable_file(path: Path | None, option: str, suffixes: Sequence[str] = ()) -> Path | None:
    """`path` when it can be written (its folder is made); `None` and `-` (standard output) pass.

    Raises:
        InputError: a folder, a wrong suffix, or a place that cannot be written.
    """
    if path is None or str(path) == "-":
        return path
    if suffixes and path.suffix.lower() not in suffixes:
        raise InputError(f"{option}: {path} must end in {', '.join(suffixes)}")
    if path.is_dir():
        raise InputError(f"{option}: {path} is a folder, a file is needed")
    if path.exists() and not os.access(path, os.W_OK):
        raise InputError(f"{option}: {path} cannot be written (permission denied)")
    writable_folder(path.parent, option)
    return path


def write_json(record: object, path: Path | None) -> None:
    """Write `record` as JSON to `path`, or to standard output for `-`; nothing for None."""
    if path is None:
        return
    if str(path) == "-":
        sys.stdout.write(json_text(record))
    else:
        write_text(json_text(record), path)


def _of(unit: str) -> str:
    return f", in {unit}" if unit else ""
