"""Pictures of flight dynamics: they are drawn, and what they say is where it should be."""

import numpy as np
import pytest

from spaceplane.dynamics.modes import identify
from spaceplane.dynamics.response import step
from spaceplane.dynamics.statespace import StateSpace, from_matrix
from spaceplane.dynamics.tracking import follow
from spaceplane.errors import InputError
from spaceplane.report import figures_dynamics as figures

PNG = b"\x89PNG"


def oscillator(z):
    return StateSpace(np.array([[0.0, 1.0], [-1.0, -2.0 * z]]), np.array([[0.0], [1.0]]), ("alpha", "q"), ("elevator",))


def test_paths_fill_in_the_square_root():
    """Between the points of a coarse grid the path through a branch point is that of the exact roots."""
    branches = follow(oscillator, [0.5, 0.9, 1.2, 1.6], "damping")
    for k, sign in ((0, 1.0), (1, -1.0)):
        z, values = figures._path(branches, k)
        exact = -z + sign * np.sqrt(z.astype(complex) ** 2 - 1)
        assert len(z) > len(branches.dataset["damping"])
        near = np.abs(z - 1.0) < 0.06
        assert near.sum() > 10
        assert np.abs(values - exact)[near].max() < 0.02


def test_pictures_are_drawn():
    branches = follow(oscillator, [-0.2, 0.5, 1.2, 1.6], "damping")
    modes = [*identify(oscillator(0.3)), *identify(oscillator(1.5))]
    history = step(oscillator(0.3), "elevator", 0.1, np.linspace(0, 5, 20))
    for data in (
        figures.root_locus(branches),
        figures.root_locus(branches, [(-1.0, 1.0, 1.2), (-0.3, 0.3, 0.2)], "z"),
        figures.over_parameter(branches, window=(-1.0, 1.0)),
        figures.phasors(modes, 700.0),
        figures.responses({"a": history, "b": history}, ["alpha", "elevator", "q"], {"elevator": (-0.2, 0.2)}),
    ):
        assert data.startswith(PNG) and len(data) > 5000


def test_components_are_comparable():
    """A rate over its eigenvalue is the angle swept: alpha and q of an oscillation have the same length."""
    mode = identify(from_matrix(np.array([[0.0, 1.0], [-9.0, 0.0]]), ("alpha", "q")))[0]
    components = figures._components(mode, 700.0)
    assert abs(components["alpha"]) == pytest.approx(abs(components["q"]), rel=1e-9)
    assert abs(np.angle(components["q"] / components["alpha"])) == pytest.approx(np.pi / 2)


def test_refuses():
    with pytest.raises(InputError, match="modes: none"):
        figures.phasors([], 700.0)
    history = step(oscillator(0.3), "elevator", 0.1, [0.0, 1.0])
    with pytest.raises(InputError, match="unknown variable 'beta'"):
        figures.responses({"a": history}, ["beta"])
