"""Free streams that a body is put into all at once, and what is refused of them before a mesh is made."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from spaceplane.aero.conditions import in_air, product
from spaceplane.aero.increments.settings import Air, IncrementSettings, require_no_friction
from spaceplane.aero.integrate import Reference
from spaceplane.environment.atmosphere import Ambient
from spaceplane.errors import InputError
from spaceplane.flow.freestream import velocity
from spaceplane.flow.settings import check
from spaceplane.flow.solution import PERFECT, FlowConditions
from spaceplane.mesh.mesh import Mesh
from spaceplane.plain import degrees

FASTEST_POINT = 0.5
"""Speed by rotation, on the flight speed, that a point of the body may have: far beyond any vehicle's manoeuvre."""
ALONG = 1e-3
"""Share of the free stream's speed that may go through a plane of symmetry, flat to what its file rounds."""


@dataclass(frozen=True)
class FreeStreams:
    """Every combination of Mach number, angle of attack and sideslip, and what is the same in all of them.

    Attributes:
        machs: Mach numbers.
        alphas: angles of attack, rad.
        betas: sideslip angles, rad.
        rates: steady roll, pitch and yaw rate about the moment centre, rad/s on the speed of sound in m/s, 1/m.
        increments: viscous increments.
        ambient: undisturbed air, for skin friction and equilibrium air.
        gas: name in `flow.solution.GASES`.
    """

    machs: Sequence[float]
    alphas: Sequence[float] = (0.0,)
    betas: Sequence[float] = (0.0,)
    rates: tuple[float, float, float] = (0.0, 0.0, 0.0)
    increments: IncrementSettings = field(default_factory=IncrementSettings)
    ambient: Ambient | None = None
    gas: str = PERFECT

    def __len__(self) -> int:
        """Number of conditions."""
        return len(self.machs) * len(self.alphas) * len(self.betas)

    def conditions(self, reference: Reference, points: np.ndarray) -> FlowConditions:
        """For the solver, about a body with these points [point, xyz], m.

        Raises:
            InputError: a bad condition, rates that move some point of the body at more than half the flight speed, skin
                friction or equilibrium air without air, or both together.
        """
        found = product(list(self.machs), list(self.alphas), list(self.betas))
        if len(self.rates) != 3 or not np.isfinite(np.asarray(self.rates, float)).all():
            raise InputError(f"rates: {tuple(self.rates)}, three finite numbers are needed")
        arm = np.linalg.norm(points - np.asarray(reference.moment_center), axis=1).max()
        share = float(math.hypot(*self.rates) * arm / found.mach.min())
        if share > FASTEST_POINT:
            raise InputError(
                f"rates: a point of the body would move at {share:.2g} of the flight speed, at most {FASTEST_POINT:g}"
            )
        found = replace(found, rates=np.tile(self.rates, (len(found), 1)), center=reference.moment_center)
        if self.increments.friction != "off" and self.ambient is None:
            raise InputError(f"friction = {self.increments.friction!r}: needs the altitude")
        if self.gas == PERFECT:
            return found
        require_no_friction(self.gas, self.increments)
        if self.ambient is None:
            raise InputError(f"gas = {self.gas!r}: needs the altitude")
        # Refused here where the solver would refuse them after the mesh is made.
        return check(in_air(found, self.gas, [self.ambient] * len(found)))

    def air(self) -> Air | None:
        """The air of every condition, which friction needs."""
        return None if self.ambient is None else Air.of([self.ambient] * len(self))


def require_along_symmetry(mesh: Mesh, conditions: FlowConditions) -> None:
    """Refuse free streams that go through a plane of symmetry, or turn beside one.

    Raises:
        InputError: naming the first such condition, or the rates.
    """
    area = mesh.wall_area[~mesh.body_wall]
    if not len(area):
        return
    if np.any(conditions.rates):
        raise InputError("rates: not allowed on a mesh with planes of symmetry")
    normal = area / np.linalg.norm(area, axis=1)[:, None]
    wind = velocity(conditions.mach, conditions.alpha, conditions.beta) / np.asarray(conditions.mach)[:, None]
    through = np.abs(wind @ normal.T)
    bad = np.flatnonzero(through.max(axis=1) > ALONG)
    if len(bad):
        first, share = bad[0], through[bad[0]]
        x, y, z = normal[share.argmax()]
        raise InputError(
            f"alpha {degrees(conditions.alpha[first]):g} deg, beta {degrees(conditions.beta[first]):g} deg: this free "
            f"stream goes through {int((share > ALONG).sum())} of {len(area)} faces of symmetry (one has the normal "
            f"{x:.3g}, {y:.3g}, {z:.3g}); it must run along the plane of symmetry"
        )
