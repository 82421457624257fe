"""Modified Newtonian theory against its closed forms."""

import math

import pytest

from spaceplane.aero.exact.stagnation import stagnation_cp
from spaceplane.validation import bodies
from spaceplane.validation.flowcase import reference_of
from spaceplane.validation.impact import newtonian

def test_sphere_drag_is_half_the_stagnation_pressure():
    forces = newtonian(bodies.sphere(segments=96), 5.0, 0.2, reference_of(math.pi, 2.0, (1.0, 0.0, 0.0)))
    assert pytest.approx(0.5 * stagnation_cp(5.0), rel=1e-3) == forces.CD
    assert pytest.approx(0.0, abs=1e-4) == forces.CL
    assert forces.Cm == pytest.approx(0.0, abs=1e-4)

def test_cone_at_small_incidence():
    """C_A = Cp_max sin^2 theta, C_N_alpha = Cp_max cos^2 theta on the base area, acting at 2 / (3 cos^2 theta)."""
    theta, alpha = math.radians(20.0), math.radians(0.5)
    forces = newtonian(bodies.cone(theta), 10.0, alpha, reference_of(math.pi * math.tan(theta) ** 2, 1.0))
    cp = stagnation_cp(10.0)
    assert pytest.approx(cp * math.sin(theta) ** 2, rel=2e-3) == forces.CA
    assert forces.CN / alpha == pytest.approx(cp * math.cos(theta) ** 2, rel=2e-3)
    assert -forces.Cm / forces.CN == pytest.approx(2.0 / (3.0 * math.cos(theta) ** 2), rel=2e-3)
