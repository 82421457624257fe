"""Tables of a parsed TOML file, checked at the door: known keys, finite numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from spaceplane.errors import InputError, unknown_name


def table(content: Mapping[str, object], name: str) -> Mapping[str, object]:
    """The table of a name.

    Raises:
        InputError: it is missing or no table.
    """
    found = content.get(name)
    if found is None:
        raise InputError(f"[{name}]: the table is missing")
    if not isinstance(found, Mapping):
        raise InputError(f"{name} = {found!r}: must be a table [{name}]")
    return found


def numbers(
    content: Mapping[str, object],
    name: str,
    required: Sequence[str],
    optional: Sequence[str],
    ignore: Sequence[str] = (),
) -> dict[str, float]:
    """The finite numbers of a table, each in the unit of its name.

    Args:
        content: of the file.
        name: of the table.
        required, optional: keys of numbers.
        ignore: keys of anything else, left to others.

    Raises:
        InputError: an unknown or missing key, or a value that is no finite number.
    """
    found = table(content, name)
    known(name, found, (*required, *optional, *ignore))
    missing = [key for key in required if key not in found]
    if missing:
        raise InputError(f"[{name}] {', '.join(missing)}: missing")
    for key, value in found.items():
        if key not in ignore and not is_finite(value):
            raise InputError(f"[{name}] {key} = {value!r}: must be a finite number")
    return {key: float(value) for key, value in found.items() if key not in ignore}  # type: ignore[arg-type]


def is_finite(value: object) -> bool:
    """Whether a value is a finite number; true and false are none."""
    return not isinstance(value, bool) and isinstance(value, int | float) and math.isfinite(value)


def known(name: str, content: Mapping[str, object], allowed: Sequence[str]) -> None:
    """Refuse keys of a table, or, with an empty name, tables of the file, that do not exist.

    Raises:
        InputError: naming the nearest that does.
    """
    for key in content:
        if key not in allowed:
            message = unknown_name("key" if name else "table", key, allowed)
            raise InputError(f"[{name}] {message}" if name else message)
