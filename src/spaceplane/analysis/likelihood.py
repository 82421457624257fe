"""How certain modes and verdicts at one flight point are, from the errors of derivatives that the user states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spaceplane.dynamics.given_errors import GivenError, half_widths
from spaceplane.dynamics.sensitivity import ModeSensitivity, of_model
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.probability import Assessed, Outlook, Uncertainty, mirror_correlation, outlooks
from spaceplane.qualities.scatter import Spread, eigenvalue_cloud, spreads

CLOUD = 400
"""Draws of which the eigenvalues are kept."""


@dataclass(frozen=True)
class Likelihood:
    """What moves the modes of a flight point, and how certain they and the verdicts are.

    Attributes:
        sensitivities: of the modes, in their order.
        uncertainty: of the derivatives; None where no error is stated, and then nothing of what follows.
        outlooks: the verdicts' probabilities.
        cloud: [draw, state] eigenvalues, 1/s.
        spreads: of the modes, in their order.
    """

    sensitivities: tuple[ModeSensitivity, ...]
    uncertainty: Uncertainty | None = None
    outlooks: tuple[Outlook, ...] = ()
    cloud: np.ndarray | None = None
    spreads: tuple[Spread, ...] = ()


def likelihood(
    airframe: Airframe,
    assessed: Assessed,
    errors: Mapping[str, GivenError],
    vehicle_class: str,
    category: str,
    form: str,
    samples: int,
    correlation: Mapping[tuple[str, str], float] | None = None,
) -> Likelihood:
    """Sensitivities and, with errors, probabilities and scatter about the nominal flight point.

    The trim is not sought anew: flight point and deflections are held.

    Args:
        airframe: vehicle at its flight point.
        assessed: what was found with its nominal derivatives.
        errors: as stated; empty for none.
        vehicle_class, category: of MIL-F-8785C.
        form: of the linear model.
        samples: number of draws.
        correlation: of the errors as stated; those of mirror images are one error in any case.

    Raises:
        InputError: an error of a derivative that the vehicle does not have, or a number of draws out of range.
    """
    a = airframe
    found = of_model(a.point, a.mass, a.reference, a.derivatives, assessed.system.A, assessed.modes, form)
    widths = half_widths(errors, a.point, a.derivatives)
    if not any(widths.values()):
        return Likelihood(found)
    stated = {pair: value for pair, value in (correlation or {}).items() if set(pair) <= set(widths)}
    uncertainty = Uncertainty(widths, stated | mirror_correlation(a.derivatives, widths))
    cloud = eigenvalue_cloud(a, uncertainty, min(samples, CLOUD), form=form)
    return Likelihood(
        found,
        uncertainty,
        outlooks(a, uncertainty, vehicle_class, category, samples=samples, form=form),
        cloud,
        spreads(cloud, assessed.modes),
    )
