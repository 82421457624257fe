"""The errors a user can cause. The command line prints them on one line and exits with code 2."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Bad input: the message names the field, the value and what is allowed."""


def unknown_name(kind: str, name: object, valid: Iterable[str]) -> str:
    """The message for a name that does not exist, with the nearest that does, or all of them where none is near."""
    names = list(valid)
    near = difflib.get_close_matches(str(name), names, n=1, cutoff=0.4)
    return f"unknown {kind} '{name}'" + (f": did you mean '{near[0]}'?" if near else f": valid are {', '.join(names)}")
