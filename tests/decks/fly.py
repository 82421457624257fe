"""JSBSim without a window: load a deck, put it into a state, read it back in SI."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from scipy.constants import foot, lbf, slug

from spaceplane.decks.jsbsim import deflection_property

jsbsim = pytest.importorskip("jsbsim", reason="the Python package jsbsim is not installed (extra: decks)")

LATITUDE = 20.0  # deg; of no effect on the sphere that does not turn


def load(folder: Path, name: str):
    """The deck over its own planet, silent, nothing read but the aircraft."""
    fdm = jsbsim.FGFDMExec(str(folder))
    fdm.set_debug_level(0)
    fdm.set_aircraft_path(str(folder))
    assert fdm.load_planet(str(folder / name / "planet.xml"), False)
    assert fdm.load_model(name)
    fdm["simulation/gravity-model"] = 0  # inverse square
    return fdm


def place(
    fdm,
    altitude: float,
    velocity: Sequence[float],
    rates: Sequence[float] = (0.0, 0.0, 0.0),
    attitude: Sequence[float] = (0.0, 0.0, 0.0),
    deflections: Mapping[str, float] | None = None,
) -> None:
    """Altitude m, body components of the velocity m/s, p q r rad/s, bank pitch heading rad, deflections rad."""
    fdm["ic/lat-geod-deg"] = LATITUDE
    fdm["ic/h-sl-ft"] = altitude / foot
    for name, value in zip(("phi", "theta", "psi-true"), attitude, strict=True):
        fdm[f"ic/{name}-rad"] = value
    for name, value in zip("uvw", velocity, strict=True):
        fdm[f"ic/{name}-fps"] = value / foot
    for name, value in zip("pqr", rates, strict=True):
        fdm[f"ic/{name}-rad_sec"] = value
    for name, value in (deflections or {}).items():
        fdm[deflection_property(name)] = value
    assert fdm.run_ic()


def vector(fdm, names: Sequence[str], unit: float = 1.0) -> np.ndarray:
    """Some properties, times the SI value of their unit."""
    return np.array([fdm[name] for name in names]) * unit


def mass(fdm) -> float:
    """kg."""
    return fdm["inertia/mass-slugs"] * slug


def force(fdm) -> np.ndarray:
    """[3] aerodynamic, body axes, N."""
    return vector(fdm, [f"forces/fb{axis}-aero-lbs" for axis in "xyz"], lbf)


def acceleration(fdm) -> np.ndarray:
    """[3] rates of the body components of the velocity, m/s2."""
    return vector(fdm, [f"accelerations/{axis}dot-ft_sec2" for axis in "uvw"], foot)


def angular_acceleration(fdm) -> np.ndarray:
    """[3] rates of p, q, r, rad/s2."""
    return vector(fdm, [f"accelerations/{axis}dot-rad_sec2" for axis in "pqr"])
