"""Records as plain values, as JSON and YAML hold them, and plain values written over records."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, fields, is_dataclass, replace
from typing import Any

import numpy as np

from spaceplane.errors import InputError, unknown_name

Readers = Mapping[str, Callable[[str, Any], Any]]
"""Full name of a field to a function (name, plain value) -> value, for fields that are not numbers or words."""


def plain(value: Any) -> Any:
    """Anything as JSON values: arrays as lists, records as dicts, numbers that are not finite as None.

    Raises:
        TypeError: a value without JSON form.
    """
    if is_dataclass(value) and not isinstance(value, type):
        return plain(asdict(value))
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, bool | np.bool_):
        return bool(value)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return finite(value)
    if value is None or isinstance(value, str):
        return value
    raise TypeError(f"no JSON form for {type(value).__name__}")


def finite(value: float | None) -> float | None:
    """The number, in its own unit; None where there is none or it is not finite."""
    return None if value is None or not math.isfinite(value) else float(value)


def degrees(angle: float) -> float:
    """Degrees from rad, without the round-off of the turn."""
    return round(math.degrees(angle), 10)


def override(record: Any, values: Mapping, readers: Readers, where: str = "") -> Any:
    """A copy of a record with plain values written over its fields; nested records take mappings.

    A field kept in rad may be given in degrees with `_deg` at the end of its name.

    Args:
        record: dataclass; its values say of what kind a field is.
        values: field name to plain value.
        readers: for fields that need one of their own.
        where: name of the record with a dot after it, to find readers and to word errors.

    Raises:
        InputError: unknown name (with the nearest valid one) or a value of the wrong kind.
    """
    types = {f.name: str(f.type) for f in fields(record)}
    changes = {}
    for key, value in values.items():
        name, angle = str(key), False
        if name not in types and name.endswith("_deg"):
            name, angle = name.removesuffix("_deg"), True
        if name not in types:
            raise InputError(unknown_name("setting", f"{where}{key}", [f"{where}{n}" for n in types]))
        old = getattr(record, name)
        if is_dataclass(old):
            if not isinstance(value, Mapping):
                raise InputError(f"{where}{name} = {value!r}: fields by name are needed")
            changes[name] = override(old, value, readers, f"{where}{name}.")
        elif value is None and "None" in types[name]:
            changes[name] = None
        else:
            value = readers.get(f"{where}{name}", _of_kind(old))(f"{where}{key}", value)
            changes[name] = math.radians(value) if angle else value
    return replace(record, **changes)


def _of_kind(default: Any) -> Callable[[str, Any], Any]:
    """A reader of values of the kind that the default has."""

    def read(name: str, value: Any) -> Any:
        """The value when it is of the default's kind; an InputError naming it otherwise."""
        if isinstance(value, list | tuple):
            bad = [v for v in value if isinstance(v, bool) or not isinstance(v, int | float)]
            if bad:
                raise InputError(f"{name}: {bad[0]!r} is not a number")
            return tuple(value)
        if isinstance(default, bool | str):
            fits = isinstance(value, type(default))
        elif default is None:
            fits = isinstance(value, int | float)
        else:
            fits = isinstance(value, int | float) and not isinstance(value, bool) and not isinstance(default, tuple)
        if not fits:
            raise InputError(f"{name} = {value!r}: not allowed; the default is {default!r}")
        return value

    return read
