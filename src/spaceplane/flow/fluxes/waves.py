"""Signal speeds of the Riemann problem between two states.

B. Einfeldt, "On Godunov-type methods for gas dynamics", SIAM J. Numer. Anal. 25 (1988) 294-318, eqs. 4.5, 5.1, with the
Roe average of P. L. Roe, J. Comput. Phys. 43 (1981) 357-372.
"""

from __future__ import annotations

import math

from spaceplane.flow.compiled import inlined


@inlined
def wave_speeds(rl, unl, al, rr, unr, ar):
    """Slowest and fastest signal: min(un_L - a_L, u^ - a^), max(un_R + a_R, u^ + a^).

    The averaged sound speed uses Einfeldt's eta: a^2 = (sqrt(rl) al^2 + sqrt(rr) ar^2)/(sqrt(rl) + sqrt(rr))
    + sqrt(rl rr)/(2 (sqrt(rl) + sqrt(rr))^2) (unr - unl)^2 (eq. 5.6).
    """
    real = type(rl)
    ratio = real(1) / (real(1) + math.sqrt(rr / rl))
    other = real(1) - ratio
    jump = unr - unl
    mean = ratio * unl + other * unr
    sound = math.sqrt(ratio * al * al + other * ar * ar + real(0.5) * ratio * other * jump * jump)
    return min(unl - al, mean - sound), max(unr + ar, mean + sound)
