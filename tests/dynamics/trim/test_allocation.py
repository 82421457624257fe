"""Deflections that give wanted moments: exact, within limits, mirrored, and the reasons where there are none."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from tests.aero.model import linear

from spaceplane.aero.model.model import OutsideTables, SurfaceTable
from spaceplane.aero.model.published import horus_2b_published
from spaceplane.dynamics.trim.allocation import MOMENTS, allocate
from spaceplane.dynamics.trim.longitudinal import trim_elevator
from spaceplane.errors import InputError

MACH, ALPHA = 2.2, math.radians(13.0)
MIRROR = {"elevon_left": "elevon_right", "elevon_right": "elevon_left", "rudder_left": "rudder_right"}
MIRROR |= {"rudder_right": "rudder_left", "body_flap": "body_flap"}
LIMITS = {name: surface.limits for name, surface in linear.model().surfaces.items()}


def left_over(found, model=None, **flight):
    """Moments of the model itself at the deflections found."""
    model = model or linear.model()
    total = model.coefficients(MACH, ALPHA, beta=found.beta, deflections=found.deflections, **flight)
    return max(abs(total[name]) for name in MOMENTS)


@pytest.mark.parametrize("beta_deg", [-9.0, -2.0, 0.0, 1.0, 9.0])
def test_moments_vanish_within_limits(beta_deg):
    found = allocate(linear.model(), MACH, ALPHA, beta=math.radians(beta_deg))
    assert found.found and found.reason == "" and left_over(found) < 1e-15
    for name, value in found.deflections.items():
        assert LIMITS[name][0] <= value <= LIMITS[name][1]


def test_sideslip_by_hand():
    """With one rudder, the elevons' difference and mean: three equations with three unknowns."""
    beta = math.radians(9.0)
    found = allocate(linear.model(), MACH, ALPHA, beta=beta, held={"body_flap": 0.0, "rudder_right": 0.0})
    e, r = linear.ELEVON, linear.RUDDER
    matrix = [[e["Cl"], -e["Cl"], r["Cl"]], [e["Cm"], e["Cm"], r["Cm"]], [e["Cn"], -e["Cn"], r["Cn"]]]
    clean = [linear.SLOPE["Cl_beta"] * beta, linear.static("Cm", ALPHA, MACH), linear.SLOPE["Cn_beta"] * beta]
    expected = np.linalg.solve(matrix, np.negative(clean))
    names = ("elevon_left", "elevon_right", "rudder_left")
    assert [found.deflections[name] for name in names] == pytest.approx(expected, abs=1e-13)


def test_rudders_move_outboard_only_and_the_right_one():
    """Wind from the right turns the nose right; the left rudder, outboard, turns it back."""
    for sign in (1.0, -1.0):
        found = allocate(linear.model(), MACH, ALPHA, beta=sign * math.radians(5.0))
        used, idle = ("rudder_left", "rudder_right")[:: int(sign)]
        assert found.deflections[used] > math.radians(5.0)
        assert found.deflections[idle] == pytest.approx(0.0, abs=1e-9)


def test_mirrored_flight_takes_mirrored_deflections():
    wanted = {"Cl": 0.002, "Cm": 0.001, "Cn": -0.003}
    there = allocate(linear.model(), MACH, ALPHA, wanted, 0.04, (0.01, 0.005, -0.02))
    wanted = {name: linear.MIRROR[name] * value for name, value in wanted.items()}
    back = allocate(linear.model(), MACH, ALPHA, wanted, -0.04, (-0.01, 0.005, 0.02))
    assert there.found and back.found
    for name, value in there.deflections.items():
        assert back.deflections[MIRROR[name]] == pytest.approx(value, abs=1e-7)


def test_symmetric_flight_takes_symmetric_deflections():
    found = allocate(horus_2b_published(), 2.5, math.radians(16.6), held={"body_flap": math.radians(-20.0)})
    assert found.deflections["elevon_left"] == pytest.approx(found.deflections["elevon_right"], abs=1e-12)
    pitch = trim_elevator(horus_2b_published(), 2.5, math.radians(16.6), math.radians(-20.0)).best
    assert found.deflections["elevon_left"] == pytest.approx(pitch.elevator, abs=1e-9)


def test_the_most_used_surface_is_used_least():
    """No other combination of a fine grid that trims leaves more of the limits."""
    model, beta = linear.model(rudders=False), 0.0
    held = {"elevon_left": math.radians(4.0)}
    free = allocate(model, MACH, ALPHA, {"Cm": 0.0}, beta, held=held)
    use = max(abs(free.deflections[n]) / max(map(abs, LIMITS[n])) for n in ("elevon_right",))
    flap_use = abs(free.deflections["body_flap"]) / math.radians(20.0 if free.deflections["body_flap"] < 0 else 30.0)
    rest = linear.static("Cm", ALPHA, MACH) + linear.ELEVON["Cm"] * math.radians(4.0)
    for flap in np.radians(np.linspace(-20.0, 30.0, 2001)):
        right = -(rest + linear.FLAP["Cm"] * flap) / linear.ELEVON["Cm"]
        other = max(abs(right) / math.radians(40.0), abs(flap) / math.radians(20.0 if flap < 0 else 30.0))
        assert max(use, flap_use) <= other + 1e-9


def test_one_failed_surface():
    stuck = math.radians(20.0)
    found = allocate(linear.model(), MACH, ALPHA, held={"rudder_right": stuck})
    assert found.found and found.deflections["rudder_right"] == stuck and left_over(found) < 1e-15
    assert found.deflections["rudder_left"] == pytest.approx(stuck)  # elevons cannot hold both roll and yaw
    loose = allocate(linear.model(), MACH, ALPHA, held={"elevon_left": math.radians(2.0)})
    assert loose.found and left_over(loose) < 1e-15 and loose.deflections["elevon_left"] == math.radians(2.0)


def test_free_sideslip_takes_the_side_force_away():
    model = linear.model(slopes=linear.SLOPE | {"Cl_beta": -0.02, "Cn_beta": 0.01})
    held = {"rudder_right": math.radians(10.0), "rudder_left": 0.0}
    found = allocate(model, MACH, ALPHA, {"CY": 0.0, "Cm": 0.0, "Cn": 0.0}, None, held=held)
    assert found.found and found.beta != 0.0
    total = model.coefficients(MACH, ALPHA, found.beta, deflections=found.deflections)
    assert max(abs(total[name]) for name in ("CY", "Cm", "Cn")) < 1e-15
    fixed = allocate(model, MACH, ALPHA, {"CY": 0.0, "Cm": 0.0, "Cn": 0.0}, 0.0, held=held)
    assert not fixed.found and set(fixed.lacking) <= {"CY", "Cn"}


def test_what_is_lacking_and_where_the_limit_is():
    weak = {"rudder_left": (0.0, math.radians(5.0))}
    beta = math.radians(9.0)
    only = {"elevon_left": 0.0, "elevon_right": 0.0, "body_flap": 0.0, "rudder_right": 0.0}
    found = allocate(linear.model(), MACH, ALPHA, {"Cn": 0.0}, beta, limits=weak, held=only)
    needed, possible = -linear.SLOPE["Cn_beta"] * beta, linear.RUDDER["Cn"] * math.radians(5.0)
    assert found.lacking["Cn"] == pytest.approx(needed - possible, rel=1e-6)
    assert found.saturated == ("rudder_left",) and found.margin == pytest.approx(0.0, abs=1e-9)
    expected = f"needs Cn {needed:.4g} from the surfaces, {possible:.4g} within limits; at the limit: rudder_left"
    assert found.reason == expected


def test_an_infeasible_task_is_infeasible_on_a_grid_too():
    """Elevons that bend: the program's verdict against trying every combination."""
    axis = np.radians([-40.0, -10.0, 0.0, 20.0, 40.0])
    bend = np.array([0.03, 0.02, 0.0, -0.01, 0.015])[:, None, None] * np.ones((5, 4, 3))
    roll = np.array([-0.02, -0.015, 0.0, 0.01, 0.012])[:, None, None] * np.ones((5, 4, 3))
    left, right = SurfaceTable(axis, {"Cm": bend, "Cl": roll}), SurfaceTable(axis, {"Cm": bend, "Cl": -roll})
    model = replace(linear.model(Cm=(0.0, 0.0, 0.0)), surfaces={"elevon_left": left, "elevon_right": right})
    grid = np.radians(np.linspace(-40.0, 40.0, 321))
    pitch, rolling = np.interp(grid, axis, bend[:, 0, 0]), np.interp(grid, axis, roll[:, 0, 0])
    reached = 0
    for Cl, Cm in product(np.linspace(-0.03, 0.03, 5), np.linspace(-0.02, 0.06, 5)):
        found = allocate(model, MACH, ALPHA, {"Cl": Cl, "Cm": Cm})
        gap = np.maximum(abs(pitch[:, None] + pitch - Cm), abs(rolling[:, None] - rolling - Cl))
        assert found.found == (gap.min() < 4e-4), (Cl, Cm, gap.min())
        reached += found.found
    assert 3 <= reached <= 22


def test_an_unknown_rolling_moment_is_not_invented():
    model, alpha, flap = horus_2b_published(), math.radians(16.6), {"body_flap": math.radians(-20.0)}
    found = allocate(model, 2.5, alpha, beta=math.radians(2.0), held=flap)
    assert (
        "needs Cl 0.00278 from the surfaces, none gives any (Cl_elevon_left, Cl_elevon_right unknown)" in found.reason
    )
    stuck = allocate(model, 2.5, alpha, held=flap | {"elevon_left": math.radians(5.0)})
    assert stuck.deflections["elevon_right"] == pytest.approx(math.radians(5.0))
    assert not stuck.found and "Cm" in stuck.lacking
    both = flap | {"elevon_left": math.radians(-10.0), "elevon_right": math.radians(4.0)}
    apart = allocate(model, 2.5, alpha, {"Cl": 0.0}, held=both)
    assert apart.reason == "Cl of elevon_left and elevon_right unknown where they differ"
    assert not apart.found and math.isnan(apart.lacking["Cl"])


def test_bad_tasks_are_refused():
    model = linear.model()
    with pytest.raises(InputError, match="did you mean 'rudder_left'"):
        allocate(model, MACH, ALPHA, held={"ruder_left": 0.0})
    with pytest.raises(InputError, match="unknown coefficient 'CM'"):
        allocate(model, MACH, ALPHA, {"CM": 0.0})
    with pytest.raises(InputError, match="Cm = nan"):
        allocate(model, MACH, ALPHA, {"Cm": math.nan})
    with pytest.raises(OutsideTables, match="rudder_left"):
        allocate(model, MACH, ALPHA, held={"rudder_left": -0.1})
    with pytest.raises(OutsideTables, match="beta"):
        allocate(model, MACH, ALPHA, beta=0.3)
