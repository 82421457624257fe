"""python-control gets the same system: poles, names, response."""

import sys

import numpy as np
import pytest
from scipy.linalg import expm

from dynamics import horus
from spaceplane.decks.control import to_control
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.statespace import from_matrix
from spaceplane.errors import InputError

control = pytest.importorskip("control", reason="python-control is not installed (extra: decks)")


@pytest.fixture(scope="module")
def system():
    return linearise(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(**horus.EXTRA))


def test_poles_and_names(system):
    exported = to_control(system)
    ours, theirs = (np.sort_complex(x) for x in (np.linalg.eigvals(system.A), exported.poles()))
    assert theirs == pytest.approx(ours, rel=1e-9, abs=1e-12)
    assert tuple(exported.state_labels) == system.states == tuple(exported.output_labels)
    assert tuple(exported.input_labels) == system.inputs and exported.name == system.form


def test_step_response_of_a_chosen_output(system):
    """alpha and q after a step of the body flap: integral of the exponential, from the exponential of the block
    matrix (Van Loan 1978)."""
    exported = to_control(system, outputs=("alpha", "q"), name="glider")
    assert exported.name == "glider"
    time = np.linspace(0.0, 4.0, 81)
    column = system.inputs.index("body_flap")
    response = control.step_response(exported, time, input=column)
    block = np.zeros((10, 10))
    block[:9, :9], block[:9, 9] = system.A, system.B[:, column]
    expected = np.array([expm(block * t)[[6, 4], 9] for t in time]).T
    assert np.abs(expected).max(axis=1).min() > 1e-4
    assert response.outputs.reshape(2, -1) == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_system_without_inputs():
    exported = to_control(from_matrix(np.diag([-1.0, -2.0]), ("u", "w")))
    assert exported.input_labels == ["none"] and not exported.B.any()
    assert np.sort(exported.poles().real) == pytest.approx([-2.0, -1.0])


@pytest.mark.parametrize("outputs", [(), ("alpha", "alpha"), ("alfa",)])
def test_bad_outputs_are_refused(system, outputs):
    with pytest.raises(InputError, match="output"):
        to_control(system, outputs=outputs)


def test_missing_package_is_told(system, monkeypatch):
    monkeypatch.setitem(sys.modules, "control", None)
    with pytest.raises(InputError, match=r"pip install 'spaceplane\[decks\]'"):
        to_control(system)
