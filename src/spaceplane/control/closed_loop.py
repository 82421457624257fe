"""Modes and flying qualities of the regulated vehicle.

The criteria are those of the open loop, held against the modes of the closed one: the specification is about the
vehicle as it flies, with its control system.
"""

from __future__ import annotations

from dataclasses import dataclass

from spaceplane.control.regulator import Regulator
from spaceplane.dynamics.modes import Mode, identify
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.qualities.assess import Verdict, assess


@dataclass(frozen=True)
class ClosedLoop:
    """The regulated vehicle.

    Attributes:
        system: its state space.
        modes: its modes.
        verdicts: MIL-F-8785C on them.
    """

    system: StateSpace
    modes: tuple[Mode, ...]
    verdicts: tuple[Verdict, ...]


def close(
    regulator: Regulator, vehicle_class: str = "III", category: str = "B", n_alpha: float | None = None
) -> ClosedLoop:
    """Modes and verdicts of the closed loop.

    Args:
        regulator: the feedback.
        vehicle_class: I, II-L, II-C, III or IV.
        category: flight phase category A, B or C.
        n_alpha: load factor per angle of attack, g/rad.

    Raises:
        InputError: unknown class or category.
    """
    system = regulator.closed()
    modes = tuple(identify(system))
    return ClosedLoop(system, modes, tuple(assess(modes, vehicle_class, category, n_alpha)))
