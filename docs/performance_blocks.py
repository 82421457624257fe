"""The generated blocks of the pages on speed and on convergence.

From docs/data/benchmark.json (benchmarks/run.py --json) and docs/data/stopping*.json (scripts/check_stopping.py).
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable

from blocks import DATA, table

KERNELS = ("gradients", "fluxes", "diagonals", "sweeps", "update")


def figures(part: str) -> tuple[str, dict[str, float]]:
    """(machine and size, figures) of one part of the benchmark."""
    stored = json.loads((DATA / "benchmark.json").read_text(encoding="utf-8"))["figures"]
    name = next(name for name in stored if name.startswith(part + ":"))
    return name.partition(": ")[2], stored[name]


def stages() -> str:
    """Seconds by stage."""
    size, f = figures("stages")
    rows = [
        (name, f"{f[key]:.1f} s")
        for name, key in (("geometry", "geometry_s"), ("mesh", "mesh_s"), ("flow", "solver_s"))
    ]
    rows += [
        ("all", f"{f['total_s']:.1f} s"),
        ("peak memory", f"{f['peak_memory_gb']:.2f} GB"),
        ("conditions converged", f"{f['converged']:.0f} of {f['conditions']:.0f}"),
        ("least fall of a residual", f"{f['least_decades']:.1f} decades"),
        ("iterations on the fine mesh, mean", f"{f['fine_iterations_mean']:.0f}"),
    ]
    return f"{size}; {f['cells']:.0f} cells came out.\n\n" + table(("", ""), rows)


def roofline() -> str:
    """Bytes, operations and shares of the machine by kernel."""
    size, f = figures("roofline")
    head = ("kernel", "ns", "bytes", "operations", "operations/byte", "of the bandwidth", "of the speed", "limited by")
    rows = []
    for kernel in KERNELS:
        ns, moved, done = (f[f"{kernel} {key}"] for key in ("ns", "bytes", "flops"))
        band, speed = f[f"{kernel} of_bandwidth"], f[f"{kernel} of_speed"]
        counted = done > 0
        rows.append(
            (
                kernel,
                f"{ns:.1f}",
                f"{moved:.0f}",
                f"{done:.0f}" if counted else "-",
                f"{done / moved:.1f}" if counted else "-",
                f"{100 * band:.0f} %",
                f"{100 * speed:.0f} %" if counted else "-",
                "memory" if band > speed else "arithmetic",
            )
        )
    text = (
        f"{size}; {f['cells']:.0f} cells; per cell, condition and iteration. The machine: "
        f"{f['bandwidth_gb_per_s']:.1f} GB/s, {f['speed_gflop_per_s']:.0f} GFlop/s in single precision, both measured. "
        f"The residual (gradients and fluxes) reaches {100 * f['residual of_bandwidth']:.0f} % of the bandwidth and "
        f"{100 * f['residual of_speed']:.0f} % of the speed."
    )
    return text + "\n\n" + table(head, rows)


def compilation() -> str:
    """Seconds of the first and of a later start."""
    size, f = figures("compile")
    return (
        f"{size}: {f['first_cpu_s']:.0f} s of processor time in both processes for the first start ever, "
        f"{f['later_cpu_s']:.1f} s for a later one; {f['first_s']:.0f} and {f['later_s']:.1f} s by the clock."
    )


def scaling() -> str:
    """Growth of time and memory with cells and with conditions."""
    size, f = figures("scaling")
    sizes = [name.removesuffix(" cells") for name in f if name.endswith(" cells")]
    rows = [
        (
            f"{f[f'{s} cells']:.0f}",
            f"{f[f'{s} mesh_cpu_s']:.1f}",
            f"{f[f'{s} iteration_cpu_s']:.2f}",
            f"{f[f'{s} cpu_ns']:.0f}",
            f"{f[f'{s} bytes']:.0f}",
            f"{f[f'{s} peak_memory_gb']:.2f}",
        )
        for s in sizes
    ]
    head = (
        "cells",
        "mesh, s",
        "one iteration of eight, s",
        "ns per cell and condition",
        "bytes per cell and condition",
        "GB",
    )
    small, large = sizes[0], sizes[-1]
    power = math.log(f[f"{large} iteration_cpu_s"] / f[f"{small} iteration_cpu_s"])
    power /= math.log(f[f"{large} cells"] / f[f"{small} cells"])
    counts = [name.partition(" ")[0] for name in f if name.endswith("conditions solver_cpu_s")]
    one = f[f"{counts[0]} conditions solver_cpu_s"]
    more = [
        (n, f"{f[f'{n} conditions solver_cpu_s']:.1f}", f"{f[f'{n} conditions solver_cpu_s'] / one:.1f}")
        for n in counts
    ]
    return (
        f"{size}; sixteen conditions; seconds of processor time over all cores. The time of an iteration grows as "
        f"cells^{power:.2f}.\n\n{table(head, rows)}\n\n"
        f"From the free stream to convergence by conditions, on a mesh of about 20 000 cells:\n\n"
        f"{table(('conditions', 's', 'on one condition'), more)}"
    )


def stopping(name: str = "stopping.json") -> str:
    """The stopping rule against long runs."""
    stored = json.loads((DATA / name).read_text(encoding="utf-8"))
    head = ("Mach", "alpha, deg", "beta, deg", "verdict", "iterations", "decades", "spread of the force")
    head += ("long run: iterations", "best decades", "force differs by")
    rows = [
        (
            f"{r['mach']:.3g}",
            f"{r['alpha_deg']:.0f}",
            f"{r['beta_deg']:.0f}",
            r["verdict"],
            r["iterations"],
            f"{r['decades']:.1f}",
            f"{r['spread_percent']:.3f} %",
            r["long_iterations"],
            f"{r['long_decades']:.1f}",
            f"{r['force_percent']:.3f} %",
        )
        for r in stored["rows"]
    ]
    return f"HORUS-2B, {stored['cells']} cells.\n\n" + table(head, rows)


BLOCKS: dict[str, Callable[[], str]] = {
    "bench stages": stages,
    "bench roofline": roofline,
    "bench compilation": compilation,
    "bench scaling": scaling,
    "stopping rule": stopping,
    "stopping rule in double precision": lambda: stopping("stopping_double.json"),
    "five decades": lambda: stopping("five_decades.json"),
}
