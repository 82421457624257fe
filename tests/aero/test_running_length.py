import math

import numpy as np
import pytest

from spaceplane.aero.increments.friction_laws import LAMINAR, TURBULENT
from spaceplane.aero.increments.running_length import neighbours, running_length

from . import walls


def unit(vector):
    return vector / np.linalg.norm(vector, axis=1, keepdims=True)


def length_on(mesh, direction, exponent):
    return running_length(mesh, neighbours(mesh), direction, exponent)


def test_neighbours_share_a_cell_face_and_are_mutual():
    mesh = walls.plate(shape=(3, 2))
    found = {tuple(pair) for pair in neighbours(mesh)}
    assert found == {
        (0, 1),
        (1, 0),
        (2, 3),
        (3, 2),
        (4, 5),
        (5, 4),
        (0, 2),
        (2, 0),
        (2, 4),
        (4, 2),
        (1, 3),
        (3, 1),
        (3, 5),
        (5, 3),
    }


def test_parallel_flow_on_a_plate_is_exact():
    """But for the 2000th that streamlines of one length have forgotten at the end."""
    mesh = walls.plate(shape=(40, 4))
    x = mesh.wall_center[:, 0]
    found = length_on(mesh, np.tile([1.0, 0.0, 0.0], (160, 1)), 0.5)
    np.testing.assert_allclose(found, x, rtol=6e-4)


@pytest.mark.parametrize("turn_deg", [15.0, 30.0, 45.0])
def test_a_turned_grid_gives_the_same_length(turn_deg):
    """Ragged leading edge: half a face of error there, and what it does downstream, within a face."""
    mesh = walls.plate(shape=(40, 0), turn=math.radians(turn_deg))
    x = length_on(mesh, np.tile([1.0, 0.0, 0.0], (mesh.cells, 1)), 0.139)
    inner = (np.abs(mesh.wall_center[:, 1]) < 0.25) & (mesh.wall_center[:, 0] > 0.1)
    error = (x - mesh.wall_center[:, 0])[inner]
    assert np.abs(error).mean() < 1.5 / 40


@pytest.mark.parametrize(("law", "factor"), [(LAMINAR, 3.0), (TURBULENT, 1.0 + 1.0 / (1.0 - 0.139))])
def test_cone_rule(law, factor):
    """Mangler: a laminar boundary layer on a cone is that of a plate of a third of the length."""
    mesh = walls.cone(math.radians(15.0))
    slant = np.linalg.norm(mesh.wall_center, axis=1)
    x = length_on(mesh, unit(mesh.wall_center), law.exponent)
    far = slant > 0.2
    np.testing.assert_allclose(x[far], slant[far] / factor, rtol=0.03)


def test_the_length_converges_with_the_mesh_at_first_order():
    """Flow from a line x = 0 that fans out as u = (1, y): h = exp(s) along y = 0, so x is known in closed form."""
    errors = []
    for count in (20, 40, 80):
        mesh = walls.patch(lambda u, v: np.stack([u, 0.5 * (v - 0.5), 0.0 * u], axis=-1), (count, count // 2))
        x, y, _ = mesh.wall_center.T
        length = length_on(mesh, unit(np.stack([np.ones_like(x), y, 0.0 * x], axis=1)), 0.5)
        middle = np.abs(y) < 0.6 / count
        exact = 0.5 * (1.0 - np.exp(-2.0 * x[middle]))
        errors.append(np.abs(length[middle] - exact).mean())
    assert errors[0] / errors[1] > 1.6
    assert errors[1] / errors[2] > 1.6
    assert errors[2] < 0.01


def test_an_attachment_line_has_a_finite_length():
    """A swept attachment line: u = (1, 4 y). Along y = 0 div u = 4, so laminar x tends to 1 / (2 * 4), not to s."""
    mesh = walls.patch(lambda u, v: np.stack([4.0 * u, v - 0.5, 0.0 * u], axis=-1), (160, 81))
    x, y, _ = mesh.wall_center.T
    length = length_on(mesh, unit(np.stack([np.ones_like(x), 4.0 * y, 0.0 * x], axis=1)), 0.5)
    on = (np.abs(y) < 1e-9) & (x > 1.0)
    np.testing.assert_allclose(length[on], 0.125, rtol=0.03)


def test_converging_streamlines_and_closed_ones_stay_bounded():
    mesh = walls.patch(lambda u, v: np.stack([u, v - 0.5, 0.0 * u], axis=-1), (40, 40))
    x, y, _ = mesh.wall_center.T
    straight = length_on(mesh, np.tile([1.0, 0.0, 0.0], (1600, 1)), 0.5)
    converging = length_on(mesh, unit(np.stack([np.ones_like(x), -3.0 * y, 0.0 * x], axis=1)), 0.5)
    middle = (np.abs(y) < 0.03) & (x > 0.3)
    assert (converging[middle] > 1.2 * straight[middle]).all()
    assert (converging[middle] < 2.1 * straight[middle]).all()
    vortex = length_on(mesh, unit(np.stack([-y, x - 0.5, 0.0 * x], axis=1)), 0.5)
    assert np.isfinite(vortex).all() and (vortex > 0.0).all() and (vortex <= 2000.0).all()


def test_no_flow_leaves_every_face_its_own_half_size():
    mesh = walls.plate(shape=(8, 4))
    half = 0.5 * np.sqrt(np.linalg.norm(mesh.wall_area, axis=1))
    np.testing.assert_allclose(length_on(mesh, np.zeros((32, 3)), 0.5), half, rtol=1e-2)
