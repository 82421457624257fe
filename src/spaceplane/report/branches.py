"""Followed modes as plain JSON types, and back for their picture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spaceplane.analysis.tracked import Tracked
from spaceplane.dynamics.tracking import Branches, Event


def record(tracked: Tracked, names: Sequence[str]) -> dict:
    """Eigenvalues along the Mach number, what each branch is called and what happens to it.

    Args:
        tracked: modes along the Mach number.
        names: of all flight points.
    """
    found = {"parameter": "mach", "flight_points": [names[k] for k in tracked.used], "reasons": list(tracked.reasons)}
    if tracked.branches is None:
        return found | {"branches": [], "mach": [], "given": [], "eigenvalues": [], "events": []}
    data = tracked.branches.dataset
    values = tracked.branches.eigenvalues()
    return found | {
        "branches": [str(label) for label in data["branch"].values],
        "mach": data["mach"].values.tolist(),
        "given": data["given"].values.tolist(),
        "eigenvalues": [[[z.real, z.imag] for z in row] for row in values],
        "events": [event_record(event) for event in tracked.branches.events],
    }


def event_record(event: Event) -> dict:
    """Something that happens to branches, at a Mach number."""
    value = event.eigenvalue
    return {
        "kind": event.kind,
        "mach": event.parameter,
        "branches": list(event.branches),
        "before": list(event.before),
        "after": list(event.after),
        "eigenvalue": [value.real, value.imag] if np.isfinite(value) else None,
    }


def from_record(found: dict) -> Branches:
    """What `record` wrote, as far as pictures need it: eigenvalues, labels and events."""
    import xarray as xr

    pairs = np.array(found["eigenvalues"], dtype=float)
    dims = ("mach", "branch")
    dataset = xr.Dataset(
        {"real": (dims, pairs[..., 0], {"units": "1/s"}), "imag": (dims, pairs[..., 1], {"units": "1/s"})},
        coords={
            "mach": ("mach", np.array(found["mach"], dtype=float), {"units": ""}),
            "given": ("mach", np.array(found["given"], dtype=bool)),
            "branch": list(found["branches"]),
        },
    )
    events = tuple(
        Event(
            e["kind"],
            e["mach"],
            tuple(e["branches"]),
            complex(np.nan) if e["eigenvalue"] is None else complex(*e["eigenvalue"]),
            tuple(e["before"]),
            tuple(e["after"]),
        )
        for e in found["events"]
    )
    return Branches(dataset, events)


def event_rows(found: dict) -> list[tuple[str, str, str]]:
    """(Mach number, what happens, to which modes) in words; of a pair once, renamings left out."""
    words = {"merge": "two roots become a pair", "split": "a pair splits", "unresolved": "pairing in doubt"}
    rows = []
    for event in found["events"]:
        if event["kind"] == "name":
            continue
        names = " and ".join(dict.fromkeys(event["before"] or event["branches"]))
        later = " and ".join(dict.fromkeys(event["after"]))
        rows.append((f"{event['mach']:.2f}", words.get(event["kind"], "stability changes"), _became(names, later)))
    return rows


def _became(before: str, after: str) -> str:
    return before if after in ("", before) else f"{before} → {after}"
