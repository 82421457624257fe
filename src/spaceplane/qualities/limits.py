"""The limits of MIL-F-8785C and of departure criteria, read from the data files beside this module."""

from __future__ import annotations

import tomllib
from functools import lru_cache
from importlib.resources import files

from spaceplane.errors import InputError

CLASSES = ("I", "II-L", "II-C", "III", "IV")
CATEGORIES = ("A", "B", "C")


@lru_cache(maxsize=1)
def specification() -> dict:
    """All limits as read from `mil_f_8785c.toml`."""
    return _read("mil_f_8785c.toml")


@lru_cache(maxsize=1)
def departure() -> dict:
    """Departure criteria as read from `departure.toml`, per degree."""
    return _read("departure.toml")


def _read(name: str) -> dict:
    return tomllib.loads(files("spaceplane.qualities").joinpath("data", name).read_text(encoding="utf-8"))


def check(vehicle_class: str, category: str) -> None:
    """Refuse a class or category that the specification does not know.

    Raises:
        InputError: naming the value and what is allowed.
    """
    if vehicle_class not in CLASSES:
        raise InputError(f"vehicle_class = {vehicle_class!r}: must be one of {', '.join(CLASSES)}")
    if category not in CATEGORIES:
        raise InputError(f"category = {category!r}: must be one of {', '.join(CATEGORIES)}")


def of(criterion: str, category: str, vehicle_class: str) -> object:
    """Entry of a criterion for a category and, where the specification distinguishes them, a class."""
    entry = specification()[criterion][category]
    if isinstance(entry, dict):
        if vehicle_class in entry:
            return entry[vehicle_class]
        if "all" in entry:
            return entry["all"]
    return entry
