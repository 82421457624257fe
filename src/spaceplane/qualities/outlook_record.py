"""Modes and verdicts with their uncertainty as plain JSON types, for `result.json` and `spaceplane modes`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from spaceplane.dynamics.modes import Mode
from spaceplane.dynamics.modes import to_record as mode_record
from spaceplane.dynamics.sensitivity import ModeSensitivity, drivers, eigenvalue_error
from spaceplane.qualities.probability import NORMAL_95, Outlook, Uncertainty
from spaceplane.qualities.verdict import AIRFRAME, Verdict
from spaceplane.qualities.verdict import to_record as verdict_record

MOST_DRIVERS = 6
LEAST_SHARE = 1e-3


def verdict_records(verdicts: Sequence[Verdict], outlooks: Sequence[Outlook]) -> tuple[list[dict], list[dict]]:
    """(verdicts on modes, verdicts on the airframe), each with its probabilities; null without uncertainty.

    Args:
        verdicts: at the nominal derivatives.
        outlooks: of these verdicts and of those that arise only in some draws; empty without uncertainty.
    """
    rows = (
        [verdict_record(one.verdict) | _outlook_record(one) for one in outlooks]
        if outlooks
        else [verdict_record(v) | _outlook_record(None) for v in verdicts]
    )
    return [row for row in rows if row["mode"] != AIRFRAME], [row for row in rows if row["mode"] == AIRFRAME]


def mode_records(
    modes: Sequence[Mode], found: Sequence[ModeSensitivity], uncertainty: Uncertainty | None
) -> list[dict]:
    """Modes with the error of their eigenvalue (95 % half widths, 1/s) and what drives them.

    Args:
        modes: of the linear model.
        found: their sensitivities, in the same order; empty where there are none.
        uncertainty: of the derivatives; None where unknown.
    """
    if not found:
        return [mode_record(mode) | {"eigenvalue_error": None, "drivers": []} for mode in modes]
    half_width = dict(uncertainty.half_width) if uncertainty else {}
    rows = []
    for mode, one in zip(modes, found, strict=True):
        error = None
        if uncertainty and half_width and np.all(np.isfinite(one.slopes)):
            error = [NORMAL_95 * sigma for sigma in eigenvalue_error(one, uncertainty.covariance(one.parameters))]
        rows.append(mode_record(mode) | {"eigenvalue_error": error, "drivers": _drivers(one, half_width)})
    return rows


def _drivers(one: ModeSensitivity, half_width: Mapping[str, float]) -> list[dict]:
    if not np.all(np.isfinite(one.slopes)):
        return []
    return [
        {
            "parameter": d.parameter,
            "slope": _pair(d.slope),
            "per_percent": _pair(d.per_percent),
            "error": None if d.error is None else _pair(d.error),
            "share": d.share,
        }
        for d in drivers(one, half_width)[:MOST_DRIVERS]
        if d.share >= LEAST_SHARE
    ]


def _pair(value: complex) -> list[float]:
    return [value.real, value.imag]


def _outlook_record(one: Outlook | None) -> dict:
    if one is None:
        return {"probabilities": None, "probability_error": None, "probability_text": "", "samples": None}
    return {
        "probabilities": dict(one.probabilities),
        "probability_error": one.error,
        "probability_text": one.text,
        "samples": one.samples,
    }
