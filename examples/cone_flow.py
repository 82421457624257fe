"""Flow past a 20 deg cone at Mach 3 on a coarse mesh, beside the exact solution of Taylor and Maccoll."""

import math

import numpy as np

from spaceplane.aero.exact.conical import taylor_maccoll
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies
from spaceplane.validation.cones import surface_cp

half_angle = math.radians(20.0)
mesh = generate(bodies.cone(half_angle), MeshSettings(wall_cell=0.04))
conditions = FlowConditions(mach=np.array([3.0]), alpha=np.zeros(1), beta=np.zeros(1))
solution = solve(mesh, conditions, FlowSettings())

exact = taylor_maccoll(3.0, half_angle)
computed = surface_cp(solution)[0]
print(f"{mesh.cells} cells, {solution.records[0].verdict} in {solution.records[0].iterations} iterations")
print(f"surface Cp {computed:.4f}, exact {exact.surface_cp:.4f}: {100 * (computed / exact.surface_cp - 1):+.1f} %")
