"""Build many random shapes with random deflections, and the corners of the limits, and report which are valid.

Example: python scripts/check_shapes.py --count 1000 --corners 60 --json shapes.json
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np
from rich.progress import track

from spaceplane.errors import InputError
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import CONTROL_LIMITS_DEG, ControlDeflections
from spaceplane.vehicle.shape import PARAMETERS, ShapeParameters


def sample(rng: np.random.Generator, corner: bool) -> tuple[dict[str, float], dict[str, float]]:
    """Random values within the limits (uniform), or a random corner of them, with deflections chosen alike."""

    def draw(lower: float, upper: float) -> float:
        return float(rng.choice([lower, upper]) if corner else rng.uniform(lower, upper))

    shape = {p.name: draw(p.lower, p.upper) for p in PARAMETERS}
    return shape, {name: draw(*limits) for name, limits in CONTROL_LIMITS_DEG.items()}


def check(shape: dict[str, float], deflections: dict[str, float]) -> tuple[str, float, int]:
    """Reason of failure (empty if valid), seconds and triangles of one case."""
    start = time.perf_counter()
    try:
        surface = build(ShapeParameters.create(shape), ControlDeflections.from_degrees(deflections))
    except InputError as err:
        return str(err), time.perf_counter() - start, 0
    return "", time.perf_counter() - start, len(surface.triangles)


def main() -> int:
    """Run the sweep; exit code 1 when a shape failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000, help="random shapes inside the limits")
    parser.add_argument("--corners", type=int, default=100, help="random corners of the limits")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", type=Path, help="write the summary here")
    options = parser.parse_args()

    rng = np.random.default_rng(options.seed)
    failures, seconds, triangles = [], [], []
    kinds = [False] * options.count + [True] * options.corners
    for index, corner in enumerate(track(kinds, description="shapes")):
        shape, deflections = sample(rng, corner)
        reason, spent, count = check(shape, deflections)
        seconds.append(spent)
        triangles.append(count)
        if not sys.stderr.isatty() and (index + 1) % 50 == 0:
            print(f"{index + 1} of {len(kinds)}, {len(failures)} failed", file=sys.stderr, flush=True)
        if reason:
            failures.append({"index": index, "corner": corner, "reason": reason, "shape": shape, "deg": deflections})
            print(f"{index} {'corner' if corner else 'random'}: {reason}", file=sys.stderr)
    summary = {
        "tried": len(kinds),
        "random": options.count,
        "corners": options.corners,
        "valid": len(kinds) - len(failures),
        "seed": options.seed,
        "seconds_mean": round(float(np.mean(seconds)), 3),
        "seconds_max": round(float(np.max(seconds)), 3),
        "triangles_min": int(min((t for t in triangles if t), default=0)),
        "triangles_max": int(max(triangles)),
        "failures": failures,
    }
    if options.json:
        options.json.write_text(json.dumps(summary, indent=1))
    print(json.dumps({k: v for k, v in summary.items() if k != "failures"}, indent=1))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
