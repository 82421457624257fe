"""Exact responses of linear systems against closed forms and against an independent integration."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import identify
from spaceplane.dynamics.response import doublet, free, respond, step
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.errors import InputError

from . import horus


def lag(rate=-0.5, gain=2.0):
    return StateSpace(np.array([[rate]]), np.array([[gain]]), ("p",), ("aileron",))


def horus_system():
    return linearise(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(**horus.EXTRA))


def test_first_order_lag_is_exact():
    """p' = a p + b u: exp(a t) and b u (exp(a t) - 1) / a, whatever the times."""
    times = [0.0, 0.1, 0.17, 3.0, 20.0]
    t = np.array(times)
    assert free(lag(), {"p": 0.3}, times)["p"].values == pytest.approx(0.3 * np.exp(-0.5 * t), rel=1e-13)
    result = step(lag(), "aileron", 0.2, times, start=0.1)
    late = np.maximum(t - 0.1, 0.0)
    assert result["p"].values == pytest.approx(0.2 * 2.0 * (1 - np.exp(-0.5 * late)) / 0.5, abs=1e-14)
    assert result["aileron"].values.tolist() == [0.0, 0.2, 0.2, 0.2, 0.2]


def test_an_integrator_has_no_inverse_and_needs_none():
    system = StateSpace(np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]), ("sigma", "p"), ("moment_x",))
    result = step(system, "moment_x", 3.0, np.linspace(0, 4, 9))
    assert result["sigma"].values == pytest.approx(1.5 * np.linspace(0, 4, 9) ** 2, rel=1e-13)
    assert result["moment_x"].attrs["units"] == "N m" and result["p"].attrs["units"] == "rad/s"


def test_doublet_of_an_integrator_returns_the_rate_to_zero():
    system = StateSpace(np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]), ("sigma", "p"), ("aileron",))
    result = doublet(system, "aileron", 0.5, 2.0, [0.0, 1.5, 2.0, 2.5, 5.0], start=0.5)
    assert result["p"].values == pytest.approx([0.0, 0.5, 0.25, 0.0, 0.0], abs=1e-14)
    assert result["sigma"].values[-1] == pytest.approx(0.5)  # a displacement of amplitude (duration/2)^2
    assert result["aileron"].values.tolist() == [0.0, -0.5, -0.5, 0.0, 0.0]


def test_horus_against_an_integration():
    """Nine states, three inputs in pieces, an initial offset: the same as an integration at 1e-10."""
    system = horus_system()
    inputs = {"elevator": [(0.0, 0.02), (0.7, -0.02), (1.4, 0.0)], "rudder": [(0.5, 0.03)], "moment_y": [(1.0, 500.0)]}
    initial = {"alpha": 0.01, "beta": -0.02}
    times = np.linspace(0.0, 4.0, 41)
    result = respond(system, times, inputs, initial)

    def values(t):
        u = np.zeros(len(system.inputs))
        for name, rows in inputs.items():
            for start, value in rows:
                if t >= start:
                    u[system.inputs.index(name)] = value
        return u

    x = np.zeros(9)
    for name, value in initial.items():
        x[system.index(name)] = value
    edges, found = [0.0, 0.5, 0.7, 1.0, 1.4, 4.0], {0.0: x}
    for a, b in pairwise(edges):
        u = values(a)
        inside = np.unique(np.append(times[(times > a) & (times <= b)], b))

        def rates(t, x, u=u):
            return system.A @ x + system.B @ u

        run = solve_ivp(rates, (a, b), x, "DOP853", inside, rtol=1e-12, atol=1e-13)
        found |= {float(t): y for t, y in zip(run.t, run.y.T, strict=True)}
        x = run.y[:, -1]
    for k, name in enumerate(system.states):
        expected = np.array([found[float(t)][k] for t in times])
        assert result[name].values == pytest.approx(expected, abs=1e-8 * max(np.abs(expected).max(), 1e-3)), name


def test_a_mode_moves_along_its_eigenvector():
    """Started on the real part of an eigenvector, the whole response is the real part of the mode."""
    system = horus_system()
    times = np.linspace(0, 10, 23)
    for mode in identify(system):
        start = {name: float(z.real) for name, z in zip(system.states, mode.eigenvector, strict=True)}
        result = free(system, start, times)
        for k, name in enumerate(system.states):
            expected = (mode.eigenvector[k] * np.exp(mode.eigenvalue * times)).real
            scale = np.abs(np.exp(mode.eigenvalue * times)).max()
            assert result[name].values == pytest.approx(expected, abs=1e-8 * scale)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda s: respond(s, [0.0, 1.0], {"rudder": [(0.0, 1.0)]}), "unknown input 'rudder'"),
        (lambda s: free(s, {"q": 1.0}, [0.0, 1.0]), "unknown state 'q'"),
        (lambda s: free(s, {"p": math.inf}, [0.0, 1.0]), "p = inf"),
        (lambda s: free(s, {"p": 1.0}, [1.0, 0.0]), "times"),
        (lambda s: free(s, {"p": 1.0}, [-1.0, 0.0]), "times"),
        (lambda s: free(s, {"p": 1.0}, []), "times"),
        (lambda s: respond(s, [0.0, 1.0], {"aileron": [(1.0, 1.0), (0.5, 0.0)]}), "aileron: pieces"),
        (lambda s: doublet(s, "aileron", 1.0, 0.0, [0.0, 1.0]), "duration = 0"),
    ],
)
def test_refuses(call, message):
    with pytest.raises(InputError, match=message):
        call(lag())
