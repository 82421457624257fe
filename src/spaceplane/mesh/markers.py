"""What the named patches of a mesh's boundary are: walls, far field or planes of symmetry."""

from __future__ import annotations

import re
from collections.abc import Sequence

from spaceplane.errors import InputError, unknown_name

WALL, FAR, SYMMETRY = "wall", "far", "symmetry"
ROLES = (WALL, FAR, SYMMETRY)
USUAL = {
    FAR: (
        *("far", "farfield", "freestream", "inlet", "outlet", "inflow", "outflow", "entrance", "exit", "outer"),
        *("ambient", "external", "infinity"),
    ),
    SYMMETRY: ("sym", "symm", "symmetry", "symmetric", "symmetryplane", "symplane", "mirror"),
}
"""Role -> first words of names, small letters, by which it is guessed."""


def assign(names: Sequence[str], chosen: dict[str, Sequence[str] | None]) -> dict[str, str]:
    """Marker -> role, as chosen or, for roles that nothing was chosen for, guessed from the first word of its name.

    Markers that are neither are walls, unless walls were chosen.

    Args:
        names: all markers of the mesh.
        chosen: role (of `ROLES`) -> its markers; None or missing: guess.

    Raises:
        InputError: a marker that does not exist, is chosen twice or is left over, or no wall or no far field.
    """
    roles: dict[str, str] = {}
    for role in ROLES:
        for name in chosen.get(role) or ():
            if name not in names:
                raise InputError(f"--{role}: {unknown_name('marker', name, names)}")
            if name in roles:
                raise InputError(f"--{role}: marker '{name}' is given twice, once for --{roles[name]}")
            roles[name] = role
    for name in names:
        if name in roles:
            continue
        guess = guessed(name)
        if guess == WALL or chosen.get(guess) is not None:
            if chosen.get(WALL) is not None:
                raise InputError(f"--wall: marker '{name}' is left over; name it with --wall, --far or --symmetry")
            guess = WALL
        roles[name] = guess
    for role, what in ((WALL, "wall"), (FAR, "far field")):
        if role not in roles.values():
            raise InputError(
                f"--{role}: the mesh has no {what}; name one of its markers {', '.join(names) or '(none)'}"
            )
    return {name: roles[name] for name in names}


def guessed(name: str) -> str:
    """The role that a marker's name suggests; a wall where it suggests none."""
    words = re.findall(r"[a-z]+", name.lower())
    return next((role for role, usual in USUAL.items() if words and words[0] in usual), WALL)
