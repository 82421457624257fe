"""Every benchmark of the project: a table, a JSON file, ratios to the stored baseline of the same machine.

    python benchmarks/run.py                      all but the largest meshes
    python benchmarks/run.py --only stages        some of: stages roofline scaling compile su2
    python benchmarks/run.py --cells 30000        stages on a small mesh, something quick
    python benchmarks/run.py --largest 2400000    scaling up to meshes that need 20 GB
    python benchmarks/run.py --store              keep the results as this machine's baseline
    python benchmarks/run.py --json FILE          where the figures go; those of other parts that it holds stay

stages: geometry, mesh, solver of 16 conditions on 300 000 cells; roofline: bytes, operations and the share of the
machine that each kernel reaches; scaling: time and memory by cells and conditions; compile: the first start ever and a
later one; su2: beside SU2 on the same mesh, where there is an `SU2_CFD` on the PATH.

The baseline holds one entry per machine and size; a machine without one is told so and compared with nothing.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

import compile_time
import roofline
import scaling
import stages
import su2
from common import machine

BASELINE = Path(__file__).with_name("baseline.json")
PARTS = ("stages", "roofline", "scaling", "compile", "su2")


def measure(part: str, options: argparse.Namespace) -> tuple[str, dict[str, float]]:
    """(what the figures depend on, figures) of one part."""
    if part == "stages":
        size = f"{options.cells} cells, {options.conditions} conditions"
        return size, stages.measure(options.cells, options.conditions)
    if part == "roofline":
        return "100000 cells", roofline.measure(100_000)
    if part == "scaling":
        return f"to {options.largest} cells", scaling.measure(options.largest)
    if part == "compile":
        return "all kernels", compile_time.measure()
    return "ramp", su2.measure()


def kept(path: Path, parts: Sequence[str]) -> dict[str, dict[str, float]]:
    """Figures in the file `path`, which this run writes again, of the parts other than these."""
    old = json.loads(path.read_text(encoding="utf-8"))["figures"] if path.exists() else {}
    return {name: figures for name, figures in old.items() if name.partition(":")[0] not in parts}


def is_cost(figure: str) -> bool:
    """Whether a figure is one of which a ratio to the baseline says something."""
    return figure.endswith(("_s", " s", "ns", "_iteration", "_gb", " bytes", "of_bandwidth"))


def table(name: str, figures: dict[str, float], old: dict[str, float]) -> str:
    """Figures now and then, with their ratios."""
    lines = [name, f"{'figure':44s} {'now':>12s} {'baseline':>12s} {'ratio':>7s}"]
    for key, value in figures.items():
        before = old.get(key)
        ratio = f"{value / before:7.2f}" if before and is_cost(key) else ""
        lines.append(f"{key:44s} {value:12.4g} {'-' if before is None else format(before, '12.4g'):>12s} {ratio:>7s}")
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS, metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--cells", type=int, default=300_000, help="cells of the stages' mesh")
    parser.add_argument("--conditions", type=int, default=16, help="free streams of the stages' ensemble")
    parser.add_argument("--largest", type=int, default=1_200_000, help="most cells of the scaling")
    parser.add_argument("--json", type=Path, default=Path("out/benchmark.json"), help="where the figures go")
    parser.add_argument("--plot", type=Path, help="draw the scaling there")
    parser.add_argument("--store", action="store_true", help="make these the baseline of this machine")
    options = parser.parse_args()

    stored = json.loads(BASELINE.read_text(encoding="utf-8")) if BASELINE.exists() else {}
    results, known = kept(options.json, options.only), False
    for part in options.only:
        size, figures = measure(part, options)
        if not figures:
            print("su2: skipped, no SU2_CFD on the PATH\n")
            continue
        name = f"{part}: {machine()}, {size}"
        results[name] = figures
        known |= name in stored
        print(table(name, figures, stored.get(name, {})), end="\n\n", flush=True)
        if part == "scaling" and options.plot:
            scaling.plot(figures, options.plot)
        options.json.parent.mkdir(parents=True, exist_ok=True)
        options.json.write_text(json.dumps({"figures": results, "baseline": stored}, indent=1) + "\n")
    if not known:
        print("no baseline for this machine; --store keeps one")
    if options.store:
        BASELINE.write_text(json.dumps(stored | results, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
