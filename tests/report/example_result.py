"""A made-up but plausible result folder: a lifting body in Newtonian flow with textbook modes."""

from __future__ import annotations

import functools
import json
import math
from pathlib import Path

import numpy as np

STATES = ["V", "gamma", "R", "p", "q", "r", "alpha", "beta", "sigma"]
CONTROLS = ["elevon_left", "elevon_right", "rudder_left", "rudder_right", "body_flap"]
DUTCH_ROLL = "lateral-directional oscillation (Dutch roll)"
PARTS = ("nose", "fuselage", "body_flap")


def lifting_body(stations: int = 60, around: int = 72) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(points, triangles, part) of a closed half-cone-like body 25 m long, x aft, z up."""
    s = np.linspace(0.0, 1.0, stations)
    phi = np.linspace(0, 2 * np.pi, around, endpoint=False)
    half_width = 0.8 * np.sqrt(np.minimum(s / 0.03, 1.0)) * (1 - s) + 6.0 * s**1.6
    height = (
        0.8 * np.sqrt(np.minimum(s / 0.03, 1.0)) * (1 - s) + 2.0 * np.sin(np.pi * np.minimum(s * 0.9 + 0.02, 1)) ** 0.7
    )
    y = half_width[:, None] * np.cos(phi)
    z = height[:, None] * np.where(np.sin(phi) > 0, np.sin(phi), 0.45 * np.sin(phi)) * np.abs(np.sin(phi)) ** 0.3
    x = np.broadcast_to(25.0 * s[:, None], y.shape)
    points = np.concatenate([np.stack([x, y, z], -1).reshape(-1, 3), [[0, 0, 0]], [[25.0, 0, 0]]])
    index = np.arange(stations * around).reshape(stations, around)
    nxt = np.roll(index, -1, axis=1)
    a, b, c, d = index[:-1].ravel(), nxt[:-1].ravel(), nxt[1:].ravel(), index[1:].ravel()
    sides = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
    tip, base = len(points) - 2, len(points) - 1
    nose = np.stack([np.full(around, tip), nxt[0], index[0]], -1)
    tail = np.stack([np.full(around, base), index[-1], nxt[-1]], -1)
    triangles = np.concatenate([sides, nose, tail])
    middle = points[triangles].mean(axis=1)
    part = np.where(middle[:, 0] < 3.0, 0, np.where(middle[:, 0] > 23.0, 2, 1))
    return points, triangles, part


def newtonian_cp(points: np.ndarray, triangles: np.ndarray, mach: float, alpha_deg: float) -> np.ndarray:
    """Modified Newtonian pressure with vacuum's half in the shadow."""
    c = points[triangles]
    normal = np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-30)[:, None]
    wind = np.array([math.cos(math.radians(alpha_deg)), 0.0, math.sin(math.radians(alpha_deg))])
    into = -normal @ wind
    return np.where(into > 0, 1.8 * into**2, 0.5 * -1.43 / mach**2 * np.minimum(1.0, -into * 3))


def write_surface(path: Path, flight_points: list[dict]) -> None:
    """surface.vtp with part and Cp of every flight point on the triangles."""
    import pyvista

    points, triangles, part = lifting_body()
    body = pyvista.PolyData(points, np.column_stack([np.full(len(triangles), 3), triangles]).ravel())
    body.cell_data["part"] = part.astype(np.int32)
    body.field_data["part_names"] = np.array(PARTS)
    for p in flight_points:
        body.cell_data[f"Cp_{p['name']}"] = newtonian_cp(points, triangles, p["mach"], p["alpha_deg"]).astype(
            np.float32
        )
    body.save(path)


def mode(name: str, real: float, imaginary: float, main: str, explanation: str) -> dict:
    size = math.hypot(real, imaginary)
    vector = {
        s: {"magnitude": 1.0 if s == main else 0.6 / (2 + k), "phase_deg": (57.0 * k) % 360 - 180}
        for k, s in enumerate(STATES)
    }
    return {
        "name": name,
        "eigenvalue": [real, imaginary],
        "period_s": 2 * math.pi / imaginary if imaginary else None,
        "half_time_s": math.log(2) / -real if real < 0 else None,
        "double_time_s": math.log(2) / real if real > 0 else None,
        "damping_ratio": -real / size if imaginary else None,
        "natural_frequency_rads": size if imaginary else None,
        "oscillatory": bool(imaginary),
        "eigenvector": vector,
        "participation": {s: 0.8 if s == main else 0.025 for s in STATES},
        "explanation": explanation,
    }


def verdict(mode_name: str, criterion: str, quantity: str, paragraph: str, value, level, limits: dict, note="") -> dict:
    return {
        "mode": mode_name, "criterion": criterion, "quantity": quantity, "paragraph": paragraph, "vehicle_class": "III",
        "category": "B", "value": value, "unit": "s" if "time" in quantity else "", "limits": limits, "level": level,
        "margin": 0.21 if level == 1 else None if level is None else -0.049, "applicable": level is not None,
        "note": note,
    }  # fmt: skip


def airframe_verdict(quantity: str, paragraph: str, value, limits: dict, level=None, met=None, chances=None) -> dict:
    """A verdict on the airframe with its probabilities."""
    applicable = level is not None or met is not None
    return verdict("airframe", quantity, quantity, paragraph, value, level, limits) | {
        "applicable": applicable, "met": met, "note": "" if applicable else "not applicable: no elevator is known",
        **certain(chances or {"not applicable": 1.0}),
    }  # fmt: skip


def certain(chances: dict) -> dict:
    """Probabilities with the text of the greatest."""
    first = max(chances, key=chances.get)
    name = f"level {first}" if first in "123" else first
    return {
        "probabilities": chances, "probability_error": 0.02, "samples": 1000,
        "probability_text": f"{name} with {100 * chances[first]:.0f} %",
    }  # fmt: skip


def convergence(label: str, mach: float, alpha: float, beta: float, verdict_name: str = "converged") -> dict:
    count = 60
    k = np.arange(count)
    force = np.stack([0.11 + 0.02 * np.exp(-k / 6), 0.0 * k + (0.01 if beta else 0), 0.42 * (1 - np.exp(-k / 8))], -1)
    return {
        "label": label, "mach": mach, "alpha_deg": alpha, "beta_deg": beta, "verdict": verdict_name,
        "residual_drop": 3.4,
        "iterations": count, "window_spread": {"CA": 1.2e-5, "CY": 1e-7, "CN": 4.1e-5},
        "residual_history": (-3.4 * (1 - np.exp(-k / 25)) + 0.1 * np.sin(k)).tolist(), "force_history": force.tolist(),
        "reason": "" if verdict_name == "converged" else "forces wander by 0.4 %",
    }  # fmt: skip


@functools.cache
def control_of() -> dict:
    """Control of HORUS-2B at the TAEM interface with every derivative at its usual size."""
    from tests.dynamics import horus

    from spaceplane.analysis.controllability import controllability
    from spaceplane.dynamics.linearise import linearise
    from spaceplane.qualities.airframe import Airframe
    from spaceplane.report.control_record import control_record

    model = (horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(**horus.EXTRA))
    return control_record(controllability(Airframe(*model), linearise(*model), {}))


def flight_point(name: str, mach: float, altitude: float, alpha: float) -> dict:
    def derivative(value: float, unit: str = "1/rad", step: float = 0.0175, step_unit: str = "rad") -> dict:
        shares = {"nose": 0.2, "fuselage": 0.9, "body_flap": -0.1}
        return {
            "value": value, "error": abs(value) * 0.013 + 1e-5, "unit": unit, "step": step, "step_unit": step_unit,
            "by_part": {part: value * share for part, share in shares.items()},
        }  # fmt: skip

    names = {"CL_alpha": 1.85, "CD_alpha": 0.9, "Cm_alpha": 0.05, "CY_beta": -0.9, "Cl_beta": -0.08, "Cn_beta": -0.0002}
    derivatives = {k: derivative(v / mach**0.3) for k, v in names.items()}
    for k, v in {"CD_M": -0.04, "CL_M": -0.1, "Cm_M": 0.012}.items():
        derivatives[k] = derivative(v, "1", 0.05, "Mach")
    for k, control in enumerate(CONTROLS):
        derivatives[f"CL_{control}"] = derivative(0.1 - 0.02 * k)
        derivatives[f"Cm_{control}"] = derivative(-0.05 + 0.01 * k)
    by_part = {
        p: {c: 0.1 * (i + 1) - 0.03 * j for j, c in enumerate(("CL", "CD", "CY", "Cl", "Cm", "Cn"))}
        for i, p in enumerate(PARTS)
    }
    labels = [("base", mach, alpha, 0), ("alpha+", mach, alpha + 1, 0), ("alpha-", mach, alpha - 1, 0)]
    labels += [("mach+", mach + 0.05, alpha, 0), ("mach-", mach - 0.05, alpha, 0), ("beta", mach, alpha, 2)]
    return {
        "name": name, "mach": mach, "altitude_m": altitude, "alpha_deg": alpha, "beta_deg": 0.0, "gamma_deg": -8.4,
        "bank_deg": 55.0, "velocity_ms": 295 * mach, "dynamic_pressure_Pa": 8.6e3, "pressure_Pa": 1967.5,
        "temperature_K": 223.24, "density_kgm3": 0.0307, "alpha_source": "schedule of the TAEM descent",
        "knudsen": 3.1e-7,
        "compressibility_factor": 0.99998, "validity": {"continuum": True, "ideal_gas": mach < 5, "notes": []},
        "coefficients": {
            "CL": 0.36, "CD": 0.2, "CY": 1e-6, "Cl": -2e-7, "Cm": -0.0123, "Cn": 3e-7, "CA": 0.09, "CN": 0.41,
            "CA_forebody": 0.06, "CA_base": 0.03, "L_over_D": 1.8, "Cp_max": 1.79, "Cp_min": -0.23,
        },
        "coefficient_errors": {
            "CL": 4e-4, "CD": 2e-4, "CY": 1e-7, "Cl": 3e-5, "Cm": 1.5e-4, "Cn": 2e-6, "CA": 1e-4, "CN": 5e-4,
        },
        "coefficients_by_part": by_part, "derivatives": derivatives,
        "equilibrium": {"p_rads": 0.0021, "q_rads": 0.012, "r_rads": 0.0084},
        "A": np.diag(np.arange(1.0, 10.0)).tolist(), "B": np.ones((9, 5)).tolist(), "states": STATES,
        "inputs": CONTROLS,
        "form": "rigid-body",
        "modes": [
            mode("lateral oscillation", -0.0163 * mach, 1.31, "beta", "yaw and roll against sideslip"),
            mode("aperiodic pitch divergence", 1.01 / mach, 0.0, "alpha", "the unstable half of a split short period"),
            mode("aperiodic pitch subsidence", -1.14, 0.0, "q", "the stable half of a split short period"),
            mode("periodic pitch/roll", -0.0224, 0.0121, "gamma", "speed and flight-path angle exchange energy"),
            mode("spiral", 0.00042, 0.0, "sigma", "slow growth of the bank angle"),
            mode("altitude", -1.2e-14, 0.0, "R", "neutral: zero to round-off"),
        ],
        "verdicts": [
            verdict("lateral oscillation", DUTCH_ROLL, "damping ratio", "3.3.1.1", 0.031, 2,
                    {"1": ">= 0.08", "2": ">= 0.02", "3": ">= 0"}),
            verdict("lateral oscillation", DUTCH_ROLL, "natural frequency", "3.3.1.1", 1.31, 1,
                    {"1": ">= 0.4", "2": ">= 0.4", "3": ">= 0.4"}),
            verdict("roll mode", "roll mode", "time constant", "3.3.1.2", 1.1, 1,
                    {"1": "<= 1.4", "2": "<= 3", "3": "<= 10"}),
            verdict("spiral", "spiral stability", "time to double", "3.3.1.3", 3.1, "below 3",
                    {"1": ">= 20", "2": ">= 8", "3": ">= 4"}),
            verdict("short period", "short period damping", "damping ratio", "3.2.2.1.2", None, None, {},
                    "not applicable: aperiodic. Instead aperiodic pitch divergence: doubles in 0.69 s."),
        ],
        "airframe_verdicts": [
            airframe_verdict("time to bank by 30 deg", "3.3.4", 2.6, {"1": "<= 2", "2": "<= 3.3", "3": "<= 5"}, 2),
            airframe_verdict("C_n_beta,dyn", "Moul and Paulson", 0.0022, {"met": "> 0"}, met=True),
            airframe_verdict("nose-up elevator per load factor", "3.2.2.2", None, {}),
        ],
        "convergence": [convergence(*row) for row in labels],
        "control": control_of(),
    }  # fmt: skip


def with_uncertainty(point: dict) -> dict:
    """The flight point with what stated errors of derivatives add: errors and drivers of modes, probabilities."""
    driver = {"slope": [0.1, 0.4], "per_percent": [1e-4, 4e-4], "error": [0.004, 0.02], "share": 0.9}
    lateral = point["modes"][0] | {
        "eigenvalue_error": [0.006, 0.021],
        "drivers": [driver | {"parameter": "Cl_beta"}, driver | {"parameter": "Cn_beta", "share": 0.1}],
    }
    first, *others = point["verdicts"]
    likely = certain({"1": 0.11, "2": 0.87, "not applicable": 0.02})
    return point | {
        "modes": [lateral, *point["modes"][1:]],
        "verdicts": [first | likely, *(v | certain({str(v["level"]): 1.0}) for v in others)],
        "airframe_verdicts": [
            airframe_verdict("C_n_beta,dyn", "Moul and Paulson", 0.0022, {"met": "> 0"}, met=True,
                             chances={"met": 0.8, "not met": 0.2}),
        ],
    }  # fmt: skip


def example_result() -> dict:
    """The whole record of three flight points."""
    shape = {
        "fuselage_width_m": {"value": 2.5, "unit": "m", "default": 2.5, "lower": 2.0, "upper": 4.5},
        "wing_width_m": {"value": 3.9, "unit": "m", "default": 3.1, "lower": 2.8, "upper": 3.9},
        "winglet_angle_deg": {"value": 12.0, "unit": "deg", "default": 12.0, "lower": 5.0, "upper": 25.0},
    }
    return {
        "schema": "spaceplane.result", "schema_version": 1, "created": "2030-01-02T03:04:05Z", "version": "0.1.0",
        "vehicle": {
            "name": "example body", "shape": shape,
            "deflections_deg": dict.fromkeys(CONTROLS, 0.0) | {"body_flap": -20.0},
            "mass": {"mass_kg": 26000, "Ixx_kgm2": 119000, "Iyy_kgm2": 769000, "Izz_kgm2": 806000},
            "reference": {"area_m2": 110.0, "c_ref_m": 23.0, "b_ref_m": 13.0, "moment_center_m": [13.0, 0.0, 0.0]},
            "geometry": {"length_m": 25.0, "span_m": 13.0, "height_m": 4.5, "wetted_area_m2": 401.0,
                         "volume_m3": 250.0, "triangles": 8784},
        },
        "settings": {"mach": [0.8, 1.5, 2.5], "cells": 200000},
        "mesh": {"cells": 213456, "wall_cell_m": 0.1, "split_cells": 812, "merged_cells": 9211, "area_error": 1.5e-13,
                 "volume_error": 2e-14, "seconds": 2.9, "warnings": []},
        "solver": {"seconds": 41.2, "seconds_by_phase": {"coarse": 6.1, "fine": 35.1}, "precision": "single",
                   "conditions": 18},
        "flight_points": [flight_point("Mach 0.8", 0.8, 13000, 9.0), flight_point("Mach 1.5", 1.5, 20000, 12.0),
                          flight_point("Mach 2.5", 2.5, 26700, 16.6)],
        "warnings": [],
    }  # fmt: skip


def write_example(out_dir: Path, **changes) -> Path:
    """Write result.json (with top-level `changes`) and surface.vtp into `out_dir`."""
    result = example_result() | changes
    out_dir.mkdir(parents=True, exist_ok=True)
    (out_dir / "result.json").write_text(json.dumps(result, allow_nan=False))
    write_surface(out_dir / "surface.vtp", result["flight_points"])
    return out_dir
