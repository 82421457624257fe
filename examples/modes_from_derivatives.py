"""Eigenmodes of HORUS-2B from a file of derivatives, in both forms of the model. No flow is solved."""

from dataclasses import replace
from pathlib import Path

from spaceplane.dynamics import derivatives_file
from spaceplane.qualities.modes_record import analyse_modes

case = derivatives_file.read(Path(__file__).with_name("horus_2b_taem.toml"))
for form in ("rigid-body", "thesis"):
    record = analyse_modes(replace(case, form=form))
    print(f"{form}:")
    for mode in record["modes"]:
        re, im = mode["eigenvalue"]
        print(f"  {re:+.4f} {im:+.4f}i 1/s  {mode['name']}")

fastest = max((mode for mode in record["modes"] if mode["oscillatory"]), key=lambda mode: mode["eigenvalue"][1])
print(f"fastest oscillation: {fastest['name']}, period {fastest['period_s']:.2f} s")
