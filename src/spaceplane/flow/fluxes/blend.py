"""HLLC away from strong shocks, HLLE inside them: the cure of the carbuncle.

J. J. Quirk, Int. J. Numer. Meth. Fluids 18 (1994) 555-574, section 3 proposes the switch; here it is continuous.
"""

from __future__ import annotations

from spaceplane.flow.compiled import inlined
from spaceplane.flow.fluxes.hllc import hllc
from spaceplane.flow.fluxes.hlle import hlle


@inlined
def blend(rl, ul, vl, wl, pl, rr, ur, vr, wr, pr, nx, ny, nz, gl, gr, p0, theta):
    """theta HLLE + (1 - theta) HLLC, per unit area; theta 0 is HLLC, 1 is HLLE."""
    c0, c1, c2, c3, c4 = hllc(rl, ul, vl, wl, pl, rr, ur, vr, wr, pr, nx, ny, nz, gl, gr, p0)
    e0, e1, e2, e3, e4 = hlle(rl, ul, vl, wl, pl, rr, ur, vr, wr, pr, nx, ny, nz, gl, gr, p0)
    return (
        c0 + theta * (e0 - c0),
        c1 + theta * (e1 - c1),
        c2 + theta * (e2 - c2),
        c3 + theta * (e3 - c3),
        c4 + theta * (e4 - c4),
    )
