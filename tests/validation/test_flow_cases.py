"""The flow cases: coarse and quick in the suite, all of them on fine meshes when marked slow."""

import itertools
import math

import numpy as np
import pytest

from spaceplane import validation
from spaceplane.aero.exact.conical import taylor_maccoll
from spaceplane.aero.exact.inclined_cone import shock_tilt
from spaceplane.aero.integrate import integrate
from spaceplane.flow.solution import FlowConditions
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies, cones, hb2, horus
from spaceplane.validation.flowcase import part_of_wall, reference_of, solve_body
from spaceplane.vehicle import presets


@pytest.fixture(scope="module")
def cone():
    """A 20 deg cone at Mach 3 on a coarse mesh: straight, at 1 deg of alpha, at 1 deg of beta."""
    step = cones.STEP
    conditions = FlowConditions(np.full(3, 3.0), np.array([0.0, step, 0.0]), np.array([0.0, 0.0, step]))
    return solve_body(bodies.cone(math.radians(20.0)), MeshSettings(wall_cell=0.04, far_field=1.0), conditions)


def test_coarse_cone_is_near_the_exact_surface_pressure(cone):
    assert cones.surface_cp(cone)[0] == pytest.approx(0.28427, rel=0.04)


def test_coarse_cone_sideslip_mirrors_incidence(cone):
    """A cone knows no up: the side force in sideslip is the normal force at incidence with the sign turned."""
    reference = reference_of(math.pi * math.tan(math.radians(20.0)) ** 2, 1.0)
    zero, pitch, yaw = (integrate(cone, reference).sel(part="total").isel(condition=k) for k in range(3))
    normal, moment = float(pitch.CN - zero.CN), float(pitch.Cm - zero.Cm)
    side = float(yaw.CY - yaw.CA * math.sin(cones.STEP))
    assert side == pytest.approx(-normal, rel=0.02)
    assert float(yaw.Cn) == pytest.approx(-moment, rel=0.02)
    assert normal / cones.STEP == pytest.approx(1.6860, rel=0.08)


def test_wall_faces_of_a_part_are_its_own(cone):
    """The base of a cone lies at x = 1 and looks aft."""
    base = part_of_wall(cone.mesh, "base")
    assert base.any()
    assert cone.mesh.wall_center[base, 0] == pytest.approx(1.0, abs=1e-9)
    assert (cone.mesh.wall_area[base, 0] < 0.0).all()  # out of the fluid, into the body


def test_coarse_m6_has_nearly_the_published_lift():
    lift, drag = validation.run(["m6"], fine=False)
    assert lift.computed == pytest.approx(0.282, rel=0.03)
    assert 0.0118 < drag.computed < 0.02 and not drag.gate


@pytest.mark.parametrize("angle_deg", cones.HALF_ANGLES_DEG)
@pytest.mark.parametrize("mach", [3.0, 10.0])
def test_exact_shocks_of_cones_lie_in_cells_of_their_own(mach, angle_deg):
    """Fine: the shock and two cells on either side are in the finest ones, at Mach 3 at incidence too, where it moves
    most; walls have twice that."""
    angle = math.radians(angle_deg)
    plan = cones.mesh_plan(mach, angle, True)
    frustums = plan.settings.frustums
    cell = min(frustum.cell for frustum in frustums)
    assert 14.0 < cones.layer(mach, angle) / cell < 20.1
    x = np.linspace(2.0 * cell * plan.stretch, 1.0, 400)

    def at(x: np.ndarray, r: np.ndarray) -> np.ndarray:
        """Points in the plane y = 0 of the squeezed cone."""
        return np.stack([x / plan.stretch, np.zeros_like(x), r], axis=1)

    shock, turn = taylor_maccoll(mach, angle).shock_angle, shock_tilt(mach, angle) * cones.STEP
    for side, cells in itertools.product((-turn, 0.0, turn) if mach == 3.0 else (0.0,), (-2.0, 0.0, 1.9)):
        r = np.maximum(x * math.tan(shock + side) + cells * cell, 0.0)
        assert any_of(frustums, cell, at(x, r)).all()
    wall = at(x, x * math.tan(angle))
    assert any_of(frustums, 2.0 * cell, wall).all()
    assert not any_of(frustums, cell, wall).all()


def test_no_cell_at_the_rim_of_a_fine_cone_reaches_the_measured_metre():
    """The cell that holds the rim feels the base: on the tail cells are short enough to leave it there."""
    for mach, angle_deg in itertools.product((3.0, 10.0), cones.HALF_ANGLES_DEG):
        angle = math.radians(angle_deg)
        plan = cones.mesh_plan(mach, angle, True)
        rim = np.array([[1.0 + cones.TAIL, 0.0, (1.0 + cones.TAIL) * math.tan(angle)]]) / [plan.stretch, 1.0, 1.0]
        held = [frustum.cell for frustum in plan.settings.frustums if frustum.contains(rim)[0]]
        assert min([plan.settings.wall_cell, *held]) * plan.stretch < 0.7 * cones.TAIL


def test_cells_of_cones_are_long_where_the_air_is_thin():
    """At Mach 10 the more, the more slender the cone, and never so long that fewer than 40 lie along it."""
    plans = [cones.mesh_plan(10.0, math.radians(angle), True) for angle in cones.HALF_ANGLES_DEG]
    assert [plan.stretch for plan in plans] == [4, 2, 1]
    assert all(2.0 * plan.stretch * plan.settings.frustums[0].cell <= 1.0 / 40 for plan in plans)


def any_of(frustums, cell, points):
    """[point] whether one of the frustums that ask for cells of at most `cell` holds the point."""
    return np.any([one.contains(points) for one in frustums if one.cell <= cell], axis=0)


def test_quick_cones_take_cells_by_distance_from_the_wall():
    """Where the shock is far off the fine ones too; walls are finer where it is close, else the same at all speeds."""
    angle = math.radians(10.0)
    near, far, slow = (
        cones.mesh_plan(*what) for what in ((10.0, angle, False), (3.0, angle, False), (1.5, angle, True))
    )
    assert not any(plan.settings.frustums or plan.stretch != 1.0 for plan in (near, far, slow))
    assert near.settings.wall_cell < far.settings.wall_cell == 2.0 / 30
    assert slow.settings.wall_cell == 2.0 / 80
    assert far == cones.mesh_plan(1.5, angle, False) and far.settings.wall_layers > near.settings.wall_layers


def test_no_cell_of_the_hb2_mesh_holds_flare_and_base():
    mesh = generate(bodies.hb2(), hb2.mesh_settings(1.0 / 12))
    base = mesh.piece_part == mesh.part_names.index("base")
    shared = np.intersect1d(mesh.wall_cell[mesh.piece_wall[base]], mesh.wall_cell[mesh.piece_wall[~base]])
    lost = np.isin(mesh.wall_cell[mesh.piece_wall], shared) & ~base
    size = np.linalg.norm(mesh.piece_area, axis=1)
    assert size[lost].sum() < 1e-5 * size.sum()


class TestMomentCenterFit:
    """The fit recovers a moment centre that was moved on purpose."""

    REFERENCE = reference_of(110.0, 23.0, (13.0, 0.0, 0.2))
    NORMAL, AXIAL = np.linspace(0.0, 0.7, 15), 0.1 + 0.02 * np.random.default_rng(1).random(15)
    GAP = (NORMAL * 1.5 - AXIAL * 0.4) / 23.0

    def test_recovers_the_shift(self):
        fit = horus.fit_moment_center(self.NORMAL, self.AXIAL, self.GAP, self.REFERENCE)
        assert (fit.x, fit.z) == (pytest.approx(14.5), pytest.approx(0.6))
        assert fit.after < 1e-12 < fit.before

    def test_one_coordinate_only_and_a_missing_row(self):
        gap = np.where(np.arange(15) == 3, np.nan, self.GAP)
        fit = horus.fit_moment_center(self.NORMAL, self.AXIAL, gap, self.REFERENCE, "x")
        assert fit.z == 0.2 and 0.0 < fit.after < fit.before


def test_impact_theory_agrees_with_the_hypersonic_tables():
    """C_L and C_D of the built shape at Mach 20, without any mesh or flow, within 10 % of the published ones."""
    records = horus.impact_records(presets.horus_2b())
    assert len(records) == 12
    assert max(abs(record.deviation) for record in records) < 0.1


def test_finner_on_the_coarse_mesh_has_the_measured_derivatives():
    """All inside their bands; the pitch damping, which rests on steady rotation, pinned to what it is."""
    records = validation.run(["finner"], fine=False)
    assert len(records) == 6 and all(record.within for record in records)
    damping = [record.computed for record in records if record.quantity.startswith("C_m_q")]
    assert damping == pytest.approx([-366.9, -252.0], rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("case", validation.CASES)
def test_every_judged_row_on_fine_meshes(case):
    """Cones: surface Cp within 1 %; sphere: stagnation Cp within 3 %, C_D below 0.02 at Mach 0.5; and so on."""
    outside = [record for record in validation.run([case]) if record.gate and not record.within]
    assert not outside, "\n".join(
        f"{r.quantity}, {r.condition}: {r.computed} instead of {r.published}, band {r.band}" for r in outside
    )
