"""Low-Mach correction of the reconstructed normal velocities.

B. Thornber et al., J. Comput. Phys. 227 (2008) 4873-4894, eq. 34, applied to the normal component only.
"""

from __future__ import annotations

from spaceplane.flow.compiled import inlined


@inlined
def shrink_normal_jump(ul, vl, wl, ur, vr, wr, nx, ny, nz, mach):
    """Velocities on both sides with the jump of their normal component scaled by min(1, mach)."""
    real = type(ul)
    jump = (ur - ul) * nx + (vr - vl) * ny + (wr - wl) * nz
    half = real(0.5) * jump * (real(1) - min(real(1), mach))
    return ul + half * nx, vl + half * ny, wl + half * nz, ur - half * nx, vr - half * ny, wr - half * nz
