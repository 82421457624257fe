"""A stand-in for the pipeline: results in the published form, computed in no time from smooth made-up laws."""

from __future__ import annotations

import math
import os
import signal
import time
from pathlib import Path

from spaceplane.study.cases import BASE_PARAMETERS
from spaceplane.study.thesis import DERIVATIVES, derivatives
from spaceplane.vehicle.shape import ShapeParameters

DEFAULTS = ShapeParameters().as_dict()


def evaluate(inputs: dict) -> dict:
    """A result whose derivatives vary linearly with each parameter, with modes that follow from them."""
    if "log" in inputs:
        with Path(inputs["log"]).open("a", encoding="utf-8") as file:
            file.write(f"{inputs['label']}\n")
    time.sleep(inputs.get("sleep_s", float(os.environ.get("FAKE_SLEEP_S", "0"))))
    if "die_once" in inputs and not Path(inputs["die_once"]).exists():
        Path(inputs["die_once"]).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if "raise" in inputs:
        raise RuntimeError(inputs["raise"])
    shape = DEFAULTS | inputs.get("shape", {})
    offset = sum(inputs.get("settings", {}).get("mesh", {}).get("offset", (0.6, 0.0)))
    verdict = inputs.get("verdict", "converged")
    points = [_point(mach, shape, verdict, 0.02 * (offset - 0.6)) for mach in inputs.get("mach", (0.8, 1.5, 2.5))]
    return {
        "schema": "spaceplane.result",
        "schema_version": 1,
        "vehicle": {
            "name": "fake",
            "shape": {name: {"value": value} for name, value in shape.items()},
            "deflections_deg": {},
            "mass": {"mass_kg": 26000.0, "Ixx_kgm2": 119000.0, "Iyy_kgm2": 769000.0, "Izz_kgm2": 806000.0},
            "reference": {"area_m2": 110.0, "c_ref_m": 23.0, "b_ref_m": 13.0, "moment_center_m": [13.0, 0.0, 0.0]},
        },
        "settings": {"mesh": {"wall_cell": 0.3}},
        "mesh": {"cells": 12345},
        "flight_points": points,
    }


def _point(mach: float, shape: dict, verdict: str, noise: float) -> dict:
    base = derivatives("original")[mach if mach in (0.8, 1.5) else 2.5]
    relative = [(shape[name] - DEFAULTS[name]) / DEFAULTS[name] for name in BASE_PARAMETERS]
    values = {
        name: base[name] * (1 + noise + sum(math.sin(3 * i + 7 * j) * x for j, x in enumerate(relative)))
        for i, name in enumerate(DERIVATIVES)
    }
    speed = 300.0 * mach
    return {
        "name": f"Mach {mach:g}",
        "mach": mach,
        "altitude_m": 20000.0,
        "alpha_deg": 10.0,
        "gamma_deg": 0.0,
        "bank_deg": 0.0,
        "velocity_ms": speed,
        "coefficients": {"CL": 0.4, "CD": 0.2 + 0.01 * relative[0], "Cm": 0.0, "L_over_D": 2.0},
        "coefficient_errors": {},
        "derivatives": {name: {"value": value, "error": 0.01 * abs(value)} for name, value in values.items()},
        "modes": _modes(values),
        "verdicts": [
            {
                "mode": "Dutch roll",
                "criterion": "lateral-directional oscillation (Dutch roll)",
                "quantity": "damping ratio",
                "paragraph": "3.3.1.1",
                "level": 3,
                "value": 0.01,
                "unit": "-",
            }
        ],
        "convergence": [{"label": "base", "verdict": verdict, "residual_history": [0.0, -1.0]}],
    }


def _modes(values: dict) -> list[dict]:
    omega = 0.8 * math.sqrt(abs(values["Cl_beta"]) / 0.2)
    pitch = 0.5 * math.sqrt(abs(values["CL_alpha"]))
    return [
        mode("Dutch roll", complex(0.02 * values["CY_beta"], omega), {"beta": 0.4, "p": 1.0, "r": 0.2, "sigma": 0.7}),
        mode("pitch divergence", complex(pitch, 0.0), {"alpha": 1.0, "q": 0.6}),
        mode("pitch subsidence", complex(-1.1 * pitch, 0.0), {"alpha": 1.0, "q": -0.6}),
        mode("phugoid", complex(-0.01, 0.03), {"V": 40.0, "gamma": 0.1}),
        mode("spiral", complex(-1e-4, 0.0), {"sigma": 1.0}),
    ]


def mode(name: str, eigenvalue: complex, vector: dict[str, float]) -> dict:
    """A mode as result.json has it; negative entries of `vector` are in opposite phase."""
    size = abs(eigenvalue)
    scaled = {state: value / (240.0 if state == "V" else 1.0) for state, value in vector.items()}
    total = sum(value**2 for value in scaled.values())
    return {
        "name": name,
        "kind": name.lower().replace(" ", "_"),
        "eigenvalue": [eigenvalue.real, eigenvalue.imag],
        "oscillatory": eigenvalue.imag != 0,
        "damping_ratio": -eigenvalue.real / size if eigenvalue.imag else None,
        "natural_frequency_rads": size,
        "period_s": 2 * math.pi / eigenvalue.imag if eigenvalue.imag else None,
        "half_time_s": math.log(2) / -eigenvalue.real if eigenvalue.real < 0 else None,
        "double_time_s": math.log(2) / eigenvalue.real if eigenvalue.real > 0 else None,
        "eigenvector": {
            state: {"magnitude": abs(value), "phase_deg": 0.0 if value >= 0 else 180.0}
            for state, value in vector.items()
        },
        "participation": {state: value**2 / total for state, value in scaled.items()},
        "explanation": "",
    }
