"""Solve a Latin hypercube of free streams over random shapes with random deflections and report how each ended.

Example: python scripts/check_flow.py --shapes 20 --conditions 300 --json flow.json

Silently wrong is what counts as converged and is no finite number, is far from impact theory at a Mach number where
that holds, or, on the first shapes with --deep, is not where the flow goes in double precision when asked for five
decades; and what does not converge without a reason.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
from check_shapes import sample
from rich.progress import track
from scipy.stats import qmc

from spaceplane.aero.inclination.solve import local_inclination
from spaceplane.aero.integrate import COEFFICIENTS, integrate
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.presets import horus_2b
from spaceplane.vehicle.shape import ShapeParameters

MACH, ALPHA_DEG, BETA_DEG = (0.3, 25.0), (-10.0, 45.0), (-10.0, 10.0)
IMPACT_FROM, ALLOWED, SHARE = 3.0, 0.1, 0.3
"""From this Mach number on, CN and CA may differ from impact theory by ALLOWED + SHARE of its normal force."""

DEEP = FlowSettings(precision="double", iterations=400).falling(5.0)
DEEP_ALLOWED = 0.01
"""Greatest distance of a converged force from that of the deep run, a share of it."""


def hypercube(count: int, seed: int) -> np.ndarray:
    """[count, (Mach, alpha, beta)] Latin hypercube, uniform in log(Mach) and in the angles, rad."""
    unit = qmc.LatinHypercube(3, rng=np.random.default_rng(seed)).random(count)
    low = [math.log(MACH[0]), *np.radians([ALPHA_DEG[0], BETA_DEG[0]])]
    high = [math.log(MACH[1]), *np.radians([ALPHA_DEG[1], BETA_DEG[1]])]
    rows = qmc.scale(unit, low, high)
    rows[:, 0] = np.exp(rows[:, 0])
    return rows


def check(rows: np.ndarray, rng: np.random.Generator, cells: int, deep: bool) -> list[dict]:
    """One record per free stream, on one random shape; `deep`: solve again, with `DEEP`."""
    shape, deflections = sample(rng, corner=False)
    surface = build(ShapeParameters.create(shape), ControlDeflections.from_degrees(deflections))
    mesh = generate(surface, MeshSettings(target_cells=cells, wall_layers=1))
    conditions = FlowConditions(*np.ascontiguousarray(rows.T))
    reference = horus_2b().reference
    began = time.perf_counter()
    solution = solve(mesh, conditions)
    seconds = time.perf_counter() - began
    again = solve(mesh, conditions, DEEP).records if deep else [None] * len(rows)
    totals = integrate(solution, reference).sel(part="total")
    impact = local_inclination(surface, replace(conditions, mach=np.maximum(conditions.mach, IMPACT_FROM)), reference)
    impact = impact.sel(part="total")
    records = []
    for i, (mach, alpha, beta) in enumerate(rows):
        record = solution.records[i]
        values = {name: float(totals[name][i]) for name in COEFFICIENTS}
        known = record.verdict != "failed"
        finite = all(math.isfinite(v) for v in values.values()) and bool(np.isfinite(solution.state[:, :, i]).all())
        gap = max(abs(values[name] - float(impact[name][i])) for name in ("CN", "CA"))
        plausible = mach < IMPACT_FROM or gap < ALLOWED + SHARE * abs(float(impact.CN[i]))
        if (other := again[i]) is not None and other.good:
            size = float(np.linalg.norm(other.window_mean))
            away = float(np.linalg.norm(record.window_mean - other.window_mean)) / size
            plausible &= away < DEEP_ALLOWED
        records.append(
            {
                "mach": mach,
                "alpha_deg": math.degrees(alpha),
                "beta_deg": math.degrees(beta),
                "verdict": record.verdict,
                "residual_drop": record.residual_drop,
                "iterations": record.iterations,
                "reason": record.reason,
                "from_impact_theory": gap,
                **({} if other is None else {"deep_verdict": other.verdict, "deep_decades": other.residual_drop}),
                **({"from_deep": away} if other is not None and other.good else {}),
                "silently_wrong": not (finite and plausible) if record.good else not record.reason,
                "cells": mesh.cells,
                "ensemble_seconds": round(seconds, 1),
                **(values if known and finite else {}),
            }
        )
    return records


def main() -> int:
    """Run the sweep; exit code 1 when a condition is silently wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shapes", type=int, default=20)
    parser.add_argument("--conditions", type=int, default=300, help="free streams, over all shapes")
    parser.add_argument("--cells", type=int, default=40_000, help="about how many cells each mesh has")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--deep", type=int, default=0, help="shapes solved again in double precision, to five decades")
    parser.add_argument("--json", type=Path, help="write every record here")
    options = parser.parse_args()

    rng = np.random.default_rng(options.seed)
    rows = hypercube(options.conditions, options.seed)
    records = []
    for number, part in enumerate(track(np.array_split(rows, options.shapes), description="shapes")):
        found = check(part, rng, options.cells, number < options.deep)
        records += [{"shape": number, **record} for record in found]
        if not sys.stderr.isatty():
            print(f"shape {number + 1} of {options.shapes}: {dict(Counter(r['verdict'] for r in found))}", flush=True)
    verdicts = Counter(record["verdict"] for record in records)
    summary = {
        "conditions": len(records),
        **{name: verdicts.get(name, 0) for name in ("converged", "oscillating", "failed")},
        "silently_wrong": sum(record["silently_wrong"] for record in records),
    }
    if options.deep:
        away = [record["from_deep"] for record in records if record["verdict"] == "converged" and "from_deep" in record]
        summary["beside_deep"] = {
            "compared": len(away),
            "deep_verdicts": dict(Counter(record.get("deep_verdict", "not solved") for record in records)),
            **{f"percentile_{p}": float(np.percentile(away, p)) for p in (50, 90, 99, 100)},
        }
    if options.json:
        options.json.write_text(json.dumps({"summary": summary, "records": records}, indent=1))
    print(json.dumps(summary, indent=1))
    return 1 if summary["silently_wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
