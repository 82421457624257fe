"""python-control (R. M. Murray et al., python-control.org): a linear model as its `StateSpace`, names kept.

python-control has no units: states and inputs are perturbations in the SI units and rad of the linear model (V m/s,
gamma rad, R m, p q r rad/s, alpha beta sigma rad; deflections rad, moments N m), with p, q, r and moments about body
axes x forward, y right, z down. They hold near the flight point of the linear model only.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.dynamics.statespace import StateSpace
from spaceplane.errors import InputError, unknown_name

if TYPE_CHECKING:
    import control

HINT = "python-control is not installed; install it with: pip install 'spaceplane[decks]'"


def to_control(system: StateSpace, outputs: Sequence[str] | None = None, name: str | None = None) -> control.StateSpace:
    """The system for python-control, with its names of states and inputs; the outputs are states.

    Args:
        system: A, B and their names.
        outputs: states to give out, in this order; all by default.
        name: of the system in python-control; the form of the linear model by default.

    Returns:
        D is zero. A system without inputs gets one that does nothing, "none", since python-control wants one.

    Raises:
        InputError: python-control is not installed, or an output is unknown, named twice or missing.
    """
    chosen = list(system.states if outputs is None else outputs)
    for output in chosen:
        if output not in system.states:
            raise InputError(unknown_name("output", output, system.states))
    if not chosen or len(set(chosen)) != len(chosen):
        raise InputError(f"outputs = {chosen}: name one or more states, each once")
    try:
        import control
    except ImportError as error:
        raise InputError(HINT) from error
    B, inputs = (system.B, list(system.inputs)) if system.inputs else (np.zeros((len(system.states), 1)), ["none"])
    C = np.array([[float(state == output) for state in system.states] for output in chosen])
    return control.ss(
        system.A,
        B,
        C,
        np.zeros((len(chosen), len(inputs))),
        states=list(system.states),
        inputs=inputs,
        outputs=chosen,
        name=system.form.replace(".", "_") if name is None else name,
    )
