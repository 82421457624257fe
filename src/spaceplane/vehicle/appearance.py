"""How a vehicle is shown: the colour of each part and the named views."""

from __future__ import annotations

VIEWS: dict[str, tuple[tuple[float, float, float], tuple[float, float, float]]] = {
    "perspective": ((-1.0, 0.8, 0.6), (0.0, 0.0, 1.0)),
    "front": ((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "side": ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    "top": ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
    "rear": ((1.0, 0.7, 0.5), (0.0, 0.0, 1.0)),
    "below": ((-0.6, 0.7, -0.8), (0.0, 0.0, 1.0)),
}
"""Direction from body to viewer and direction that points up, of each view."""

PART_COLOURS: dict[str, tuple[float, float, float]] = {
    "fuselage": (0.93, 0.92, 0.89),
    "nose": (0.20, 0.20, 0.22),
    "wing": (0.83, 0.84, 0.86),
    "winglet": (0.78, 0.80, 0.83),
    "elevon": (1.00, 0.50, 0.05),
    "rudder": (0.90, 0.12, 0.14),
    "body_flap": (0.10, 0.45, 0.95),
    "body": (0.85, 0.86, 0.88),
}
"""Red, green, blue of each part, sides left out; flaps are bright so that deflections show."""

_OTHER_COLOUR = (0.75, 0.75, 0.75)


def part_colour(part: str) -> tuple[float, float, float]:
    """Colour of a part by its name, left or right."""
    return PART_COLOURS.get(part.removesuffix("_left").removesuffix("_right"), _OTHER_COLOUR)
