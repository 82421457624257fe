"""Every example runs as it stands."""

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"
SCRIPTS = sorted(EXAMPLES.glob("*.py"))

# What the last line must begin with: a script that stops half-way must not pass.
LAST_LINE = {
    "geometry_only.py": "wrote ",
    "cone_flow.py": "surface Cp 0.2",
    "modes_from_derivatives.py": "fastest oscillation",
}


def test_every_script_is_known():
    assert {script.name for script in SCRIPTS} == set(LAST_LINE)


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_example_runs(script, tmp_path):
    done = subprocess.run([sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip().splitlines()[-1].startswith(LAST_LINE[script.name])
