"""The analytic linear model equals the complex-step derivative of the nonlinear equations, term by term, to 1e-8."""

from dataclasses import asdict, replace

import numpy as np
import pytest

from spaceplane.aero.model.derivatives import COEFFICIENTS, CONTROLS, DAMPING
from spaceplane.dynamics.equations import flight_model, state_rates
from spaceplane.dynamics.linearise import analytic, numerical
from spaceplane.dynamics.statespace import MOMENT_INPUTS

from . import horus

RELATIVE = 1e-8


def model(rng, mass=horus.MASS, **changes):
    """A random flight point, climbing or descending, banked to either side, with random derivatives of usual sizes."""
    point = horus.point(
        mach=rng.uniform(0.5, 20.0), altitude_m=rng.uniform(1e3, 7e4), alpha_deg=rng.uniform(-5, 45),
        gamma_deg=rng.uniform(-60, 60), bank_deg=rng.uniform(-170, 170), CL=rng.uniform(-0.2, 1.2),
        CD=rng.uniform(0.02, 1),
    )  # fmt: skip
    static = {
        name: value * rng.uniform(-2, 2) for name, value in asdict(horus.derivatives()).items() if name != "controls"
    }
    return flight_model(point, mass, horus.REFERENCE, horus.derivatives(**{**static, **changes}))


def agree(system, measured):
    """Entry by entry to 1e-8 of it; an entry in which large terms cancel, to round-off of its row's largest."""
    for ours, theirs in ((system.A, measured.A), (system.B, measured.B)):
        floor = 1e-14 * np.abs(theirs).max(axis=1, keepdims=True)
        assert (np.abs(ours - theirs) <= RELATIVE * np.abs(theirs) + floor).all()


@pytest.mark.parametrize("tilted", [False, True], ids=["symmetric", "Ixz"])
@pytest.mark.parametrize("seed", range(40))
def test_random_flight_points(seed, tilted):
    rng = np.random.default_rng(seed)
    mass = replace(horus.MASS, Ixz=np.random.default_rng(seed).uniform(-160e3, 160e3)) if tilted else horus.MASS
    extra = {name: value * rng.uniform(-2, 2) for name, value in horus.EXTRA.items()}
    one = model(rng, mass, **extra)
    system, measured = analytic(one), numerical(one)
    agree(system, measured)
    assert np.abs(system.A).max(axis=0).min() > 0  # every state acts
    # all inputs at once, in a random mixture
    mixture = rng.normal(size=len(one.inputs)) * np.where([n in MOMENT_INPUTS for n in one.inputs], 1e4, 0.1)
    found = state_rates(one.reference_state(), 1e-30j * mixture, one).imag / 1e-30
    assert np.allclose(system.B @ mixture, found, rtol=RELATIVE, atol=1e-14 * np.abs(system.B @ mixture).max())


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("seed", [1, 2])
def test_each_control_alone(control, seed):
    rng = np.random.default_rng(seed)
    given = {f"{coefficient}_{control}": rng.uniform(-0.2, 0.2) for coefficient in COEFFICIENTS}
    one = model(rng, **given)
    system = analytic(one)
    agree(system, numerical(one))
    assert system.inputs == (control, *MOMENT_INPUTS)
    column = system.B[:, 0]
    force = one.point.dynamic_pressure * horus.REFERENCE.area
    inertia, length = horus.MASS, horus.REFERENCE
    assert column[3] == pytest.approx(given[f"Cl_{control}"] * force * length.span / inertia.Ixx, rel=RELATIVE)
    assert column[5] == pytest.approx(given[f"Cn_{control}"] * force * length.span / inertia.Izz, rel=RELATIVE)
    assert column[0] == pytest.approx(-given[f"CD_{control}"] * force / inertia.mass, rel=RELATIVE)
    side = given[f"CY_{control}"] * force / (inertia.mass * one.point.velocity)
    assert column[7] == pytest.approx(side, rel=RELATIVE)
    assert column[2] == 0.0
    assert np.count_nonzero(column) == 8


@pytest.mark.parametrize("name", DAMPING)
@pytest.mark.parametrize("seed", [3, 4])
def test_each_damping_derivative_alone(name, seed):
    rng = np.random.default_rng(seed)
    value = horus.EXTRA[name]
    with_it, without = model(rng, **{name: value}), model(np.random.default_rng(seed), **{name: 0.0})
    agree(analytic(with_it), numerical(with_it))
    assert np.abs(analytic(with_it).A - analytic(without).A).max() > 0


def test_thruster_moments():
    system = analytic(model(np.random.default_rng(5)))
    B = np.zeros((9, 3))
    B[[3, 4, 5], [0, 1, 2]] = 1 / 119_000.0, 1 / 769_000.0, 1 / 806_000.0
    assert system.inputs == MOMENT_INPUTS
    assert np.allclose(system.B, B, rtol=1e-15, atol=0)


def test_thruster_moments_with_a_product_of_inertia():
    """The inverse of the tensor: a moment about x yaws, one about z rolls."""
    system = analytic(model(np.random.default_rng(5), horus.TILTED))
    mass = horus.TILTED
    tensor = np.array([[mass.Ixx, 0.0, -mass.Ixz], [0.0, mass.Iyy, 0.0], [-mass.Ixz, 0.0, mass.Izz]])
    assert np.allclose(system.B[3:6], np.linalg.inv(tensor), rtol=1e-13, atol=0)
    assert np.count_nonzero(system.B) == 5
