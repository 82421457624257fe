"""The command line: help, exit codes, and one-line errors for everything a user can get wrong."""

from __future__ import annotations

import functools
import json
import math
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

from spaceplane import __version__, cli
from spaceplane.commands.arguments import fraction, spread_assignments
from spaceplane.errors import InputError

COMMANDS = (
    *("analyse", "database", "geometry", "flow", "fly", "modes", "compare", "report", "validate", "export"),
    "study sensitivity",
)
TAEM = Path(__file__).parents[1] / "examples" / "horus_2b_taem.toml"
FLOW = ["--area", "1", "--length", "1", "--span", "1", "--moment-center", "0,0,0"]
PUBLISHED = "horus-2b-published"
BOEING = Path(__file__).parents[1] / "examples" / "boeing747_cruise.toml"
HEAD = "alpha_deg,M2,M3\n"


def run(capfd: pytest.CaptureFixture, *arguments: object) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of one command."""
    code = cli.run([str(a) for a in arguments])
    out, err = capfd.readouterr()
    return code, out, err


def refused(capfd: pytest.CaptureFixture, *arguments: object, naming: str) -> str:
    """Assert a one-line error that names `naming`, exit code 2 and nothing on standard output; return the line."""
    code, out, err = run(capfd, *arguments)
    assert code == 2, err
    assert out == ""
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert naming in err
    assert "Traceback" not in err
    return err


def tetrahedron(path: Path, faces: int = 4, scale: float = 1.0) -> Path:
    """ASCII STL of a tetrahedron, or of some of its faces."""
    points = [(0, 0, 0), (scale, 0, 0), (0, scale, 0), (0, 0, scale)]
    text = "solid t\n"
    for a, b, c in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))[:faces]:
        text += "facet normal 0 0 0\nouter loop\n"
        text += "".join("vertex {} {} {}\n".format(*points[k]) for k in (a, b, c))
        text += "endloop\nendfacet\n"
    path.write_text(text + "endsolid t\n")
    return path


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example(capfd, command):
    code, out, _ = run(capfd, *command.split(), "--help")
    assert code == 0
    assert f"Example: spaceplane {command}" in " ".join(out.split())


def test_version(capfd):
    assert run(capfd, "--version")[:2] == (0, f"spaceplane {__version__}\n")


def test_the_package_runs_as_a_module():
    done = subprocess.run(
        [sys.executable, "-m", "spaceplane", "--version"], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (0, f"spaceplane {__version__}\n")


def test_help_starts_quickly_and_loads_nothing_heavy():
    code = (
        "import sys; from spaceplane import cli; cli.run(['--help']); "
        "heavy = {'numba', 'vtk', 'pyvista', 'scipy', 'xarray', 'matplotlib', 'numpy'} & set(sys.modules); "
        "sys.exit(str(heavy) if heavy else 0)"
    )
    best = 9.0  # s of processor time, which other work on the machine does not stretch as it does wall time
    for _ in range(3):
        before = os.times()
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
        after = os.times()
        spent = (after.children_user - before.children_user) + (after.children_system - before.children_system)
        best = min(best, spent)
        assert done.returncode == 0, done.stderr
    assert best < 0.5


def test_one_option_takes_several_assignments():
    given = ["analyse", "horus-2b", "--set", "a=1", "b=2", "--deflect", "c=-3", "--out", "d=e"]
    assert spread_assignments(given) == [
        "analyse", "horus-2b", "--set", "a=1", "--set", "b=2", "--deflect", "c=-3", "--out", "d=e",
    ]  # fmt: skip


def test_vehicle_after_the_assignments_stays_the_vehicle():
    assert spread_assignments(["geometry", "--set", "a=1", "horus-2b"]) == ["geometry", "--set", "a=1", "horus-2b"]


# What `analyse` and `geometry` refuse.


def test_unknown_vehicle_names_the_nearest_preset(capfd, tmp_path):
    assert "horus-2b" in refused(capfd, "analyse", "horus2b", "--out", tmp_path / "o", naming="horus2b")
    assert not (tmp_path / "o").exists()


def test_unknown_parameter_names_the_nearest(capfd, tmp_path):
    line = refused(
        capfd, "analyse", "horus-2b", "--set", "wing_widht_m=3", "--out", tmp_path / "o", naming="wing_widht_m"
    )
    assert "wing_width_m" in line


@pytest.mark.parametrize(
    ("text", "naming"),
    [
        ("wing_width_m=9", "9"),
        ("wing_width_m=wide", "wide"),
        ("wing_width_m", "name=value"),
        ("wing_width_m=nan", "nan"),
    ],
)
def test_bad_parameter_values(capfd, tmp_path, text, naming):
    line = refused(capfd, "geometry", "horus-2b", "--set", text, "--out", tmp_path / "b.stl", naming="wing_width_m")
    assert naming in line
    assert list(tmp_path.iterdir()) == []


def test_value_out_of_limits_says_the_limits(capfd, tmp_path):
    line = refused(capfd, "analyse", "horus-2b", "--set", "wing_width_m=9", "--out", tmp_path, naming="wing_width_m")
    assert "2.8" in line and "3.9" in line


def test_a_parameter_given_twice(capfd, tmp_path):
    both = ["--set", "wing_width_m=3", "wing_width_m=3.2"]
    refused(capfd, "geometry", "horus-2b", *both, "--out", tmp_path / "b.stl", naming="wing_width_m")


@pytest.mark.parametrize("text", ["elevon_left=-50", "elevon_lef=3", "elevon_left=up", "rudder_left=-5", "elevon_left"])
def test_bad_deflections(capfd, tmp_path, text):
    refused(capfd, "geometry", "horus-2b", "--deflect", text, "--out", tmp_path / "b.stl", naming=text.split("=")[0])


@pytest.mark.parametrize("text", ["", " ", "0", "-1", "abc", "nan", "inf", "0.8,,2", "0.8,1,", "0.8,0.8"])
def test_bad_mach_numbers(capfd, tmp_path, text):
    refused(capfd, "analyse", "horus-2b", "--mach", text, "--out", tmp_path / "o", naming="--mach")
    assert not (tmp_path / "o").exists()


@pytest.mark.parametrize("text", ["abc", "", "1,2", "nan"])
def test_bad_angles_of_attack(capfd, tmp_path, text):
    refused(capfd, "analyse", "horus-2b", "--alpha", text, "--out", tmp_path / "o", naming="--alpha")


def test_cells_and_cell_exclude_each_other(capfd, tmp_path):
    refused(capfd, "analyse", "horus-2b", "--cell", "0.1", "--cells", "9999", "--out", tmp_path, naming="--cells")


@pytest.mark.parametrize("option", ["--cell", "--cells"])
@pytest.mark.parametrize("text", ["0", "-1", "fine", "nan", ""])
def test_bad_cell_sizes(capfd, tmp_path, option, text):
    refused(capfd, "analyse", "horus-2b", option, text, "--out", tmp_path / "o", naming=option)


def test_unknown_precision(capfd, tmp_path):
    refused(capfd, "analyse", "horus-2b", "--precision", "fp16", "--out", tmp_path, naming="--precision")


@pytest.mark.parametrize(
    "options",
    [["--form", "x"], ["--class", "V"], ["--category", "D"], ["--friction", "on"], ["--base", "vacuum"]],
)
def test_unknown_choices(capfd, tmp_path, options):
    refused(capfd, "analyse", "horus-2b", *options, "--out", tmp_path, naming=options[1])


@pytest.mark.parametrize(
    ("options", "naming"),
    [
        (["--friction", "laminar", "--wall-temperature", "0"], "--wall-temperature"),
        (["--friction", "laminar", "--wall-temperature", "warm"], "--wall-temperature"),
        (["--friction", "off", "--emissivity", "0.8"], "--emissivity: 0.8, needs friction"),
        (["--friction", "laminar", "--emissivity", "2"], "--emissivity: 2"),
        (["--friction", "laminar", "--emissivity", "dark"], "--emissivity"),
        (["--friction", "laminar", "--emissivity", "0.8", "--wall-temperature", "300"], "not both"),
        (["--friction", "off", "--wall-temperature", "300"], "--wall-temperature: 300, needs friction"),
        (["--friction", "turbulent", "--transition-reynolds", "-1"], "--transition-reynolds: -1"),
        (["--friction", "turbulent", "--transition-reynolds", "x"], "--transition-reynolds"),
        (["--friction", "laminar", "--transition-reynolds", "1e6"], "needs friction turbulent"),
    ],
)
def test_bad_increments(capfd, tmp_path, options, naming):
    assert naming in refused(capfd, "analyse", "horus-2b", *options, "--out", tmp_path / "o", naming=naming[:20])
    body = tetrahedron(tmp_path / "t.stl")
    altitude = [] if "off" in options else ["--altitude", "20000"]
    refused(capfd, "flow", body, "--mach", 2, *FLOW, *options, *altitude, naming=naming)


@pytest.mark.parametrize(
    ("options", "naming"),
    [
        (["--friction", "laminar"], "--altitude: missing"),
        (["--altitude", "20000"], "--altitude: 20000"),
        (["--friction", "laminar", "--altitude", "high"], "--altitude"),
        (["--friction", "laminar", "--altitude", "200000"], "--altitude: 200000"),
    ],
)
def test_friction_of_a_flow_goes_with_its_altitude(capfd, tmp_path, options, naming):
    refused(capfd, "flow", tetrahedron(tmp_path / "t.stl"), "--mach", 2, *FLOW, *options, naming=naming)


@pytest.mark.parametrize(
    ("options", "naming"),
    [
        (["--gas", "equilibrium"], "--altitude: missing"),
        (["--gas", "equilibirum", "--altitude", "50000"], "did you mean 'equilibrium'"),
        (["--gas", "equilibrium", "--altitude", "50000", "--friction", "laminar"], "--friction: 'laminar'"),
        (["--gas", "equilibrium", "--altitude", "50000", "--mach", "40"], "ionises"),
        (["--gas", "equilibrium", "--altitude", "50000", "--method", "newtonian"], "--gas"),
    ],
)
def test_equilibrium_air_of_a_flow(capfd, tmp_path, options, naming):
    body = tetrahedron(tmp_path / "t.stl")
    mach = [] if "--mach" in options else ["--mach", 10]
    refused(capfd, "flow", body, *mach, *FLOW, *options, naming=naming)


def test_equilibrium_air_of_an_analysis_has_no_friction(capfd, tmp_path):
    refused(capfd, "analyse", "horus-2b", "--gas", "equilibrium", "--out", tmp_path / "o", naming="friction")


@pytest.mark.parametrize(
    ("text", "naming"),
    [
        ("shape: [1, 2", "vehicle.yaml"),
        ("- a\n", "vehicle.yaml"),
        ("shape:\n  wing_widht_m: 3\n", "wing_width_m"),
        ("\0", "yaml"),
    ],
)
def test_malformed_vehicle_file(capfd, tmp_path, text, naming):
    path = tmp_path / "vehicle.yaml"
    path.write_text(text)
    refused(capfd, "geometry", path, "--out", tmp_path / "b.stl", naming=naming)


def test_folder_as_vehicle_file(capfd, tmp_path):
    (tmp_path / "v.yaml").mkdir()
    refused(capfd, "geometry", tmp_path / "v.yaml", "--out", tmp_path / "b.stl", naming="v.yaml")


def test_missing_vehicle_file(capfd, tmp_path):
    refused(capfd, "geometry", tmp_path / "v.yaml", "--out", tmp_path / "b.stl", naming="v.yaml")


# Places that cannot be written.


@pytest.fixture
def blocked(tmp_path: Path) -> Path:
    """A path below a file, where not even root can make a folder."""
    (tmp_path / "file").write_text("kept")
    return tmp_path / "file" / "below"


@pytest.mark.parametrize(
    "arguments",
    [
        ["analyse", "horus-2b", "--out"],
        ["study", "sensitivity", "--out"],
        ["validate", "cones", "--out"],
        ["compare", "--out"],
    ],
)
def test_unwritable_folder_is_refused_before_anything_is_computed(capfd, blocked, arguments):
    began = time.perf_counter()
    refused(capfd, *arguments, blocked, naming="--out")
    assert time.perf_counter() - began < 10
    assert blocked.parent.read_text() == "kept"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_folder_without_permission(capfd, tmp_path):
    tmp_path.chmod(0o500)
    refused(capfd, "analyse", "horus-2b", "--out", tmp_path / "o", naming="--out")


def test_file_as_output_folder(capfd, tmp_path):
    (tmp_path / "o").write_text("kept")
    refused(capfd, "analyse", "horus-2b", "--out", tmp_path / "o", naming="--out")
    assert (tmp_path / "o").read_text() == "kept"


@pytest.mark.parametrize(("command", "option"), [("analyse", "--out"), ("geometry", "--out"), ("analyse", "--json")])
def test_empty_names_of_places(capfd, command, option):
    refused(capfd, command, "horus-2b", option, "", naming=option)


@pytest.mark.parametrize("name", ["b.obj", "b", "b.stl.txt"])
def test_unknown_geometry_format(capfd, tmp_path, name):
    refused(capfd, "geometry", "horus-2b", "--out", tmp_path / name, naming=".stl")


def test_folder_as_geometry_file(capfd, tmp_path):
    (tmp_path / "b.stl").mkdir()
    refused(capfd, "geometry", "horus-2b", "--out", tmp_path / "b.stl", naming="b.stl")


@pytest.mark.parametrize(("option", "name"), [("--json", "x/y.json"), ("--vtu", "x/y.vtu"), ("--vtp", "x/y.vtp")])
def test_unwritable_flow_output(capfd, tmp_path, option, name):
    (tmp_path / "x").write_text("kept")
    body = tetrahedron(tmp_path / "t.stl")
    refused(capfd, "flow", body, "--mach", 2, *FLOW, option, tmp_path / name, naming=option)


# What `flow` refuses.


@pytest.mark.parametrize(
    ("option", "text"),
    [
        ("--mach", ""), ("--mach", "0"), ("--mach", "-2"), ("--mach", "two"), ("--mach", "nan"), ("--mach", "1,,2"),
        ("--alpha", "abc"), ("--alpha", ""), ("--alpha", "95"), ("--alpha", "5,5"), ("--beta", "x"), ("--area", "0"),
        ("--area", "-1"), ("--area", "big"), ("--length", "0"), ("--span", "inf"), ("--moment-center", "0,0"),
        ("--moment-center", "a,b,c"), ("--rates", "0,0"), ("--altitude", "up"), ("--cell", "0"), ("--cells", "-5"),
        ("--precision", "half"), ("--vtu", "field.txt"), ("--uncertainty", "grid"), ("--uncertainty", ""),
        ("--accuracy", ""), ("--accuracy", "fine"), ("--accuracy", "%"), ("--accuracy", "0"), ("--accuracy", "-1%"),
        ("--accuracy", "0.001%"), ("--accuracy", "90%"), ("--accuracy", "1"), ("--accuracy", "nan"),
        ("--adapt", "4"), ("--adapt", "0.5"), ("--edges", "6"), ("--edges", "-1"), ("--edges", "1.5"), ("--edges", "a"),
        ("--edges", ""), ("--edges", "2,4,4"), ("--edges", "2,0"), ("--edges", "2,99"), ("--edges", "1,4"),
        ("--decades", "1"), ("--decades", "11"), ("--decades", "deep"),
        ("--refine-box", "0,0,0,1,1,1"), ("--refine-box", "0,0,0,1,1,1,0"), ("--refine-box", "0,0,0,1,-1,1,0.1"),
        ("--refine-box", "a,0,0,1,1,1,1"), ("--refine-box", "0,0,0,1,1,1,nan"), ("--refine-box", "9e3,0,0,1e4,1,1,1"),
        ("--refine-box", "0,0,0,1,1,1,1e-9"), ("--refine-parts", "wing"), ("--refine-parts", ","),
    ],
)  # fmt: skip
def test_bad_flow_options(capfd, tmp_path, option, text):
    body = tetrahedron(tmp_path / "t.stl")
    options = {"--mach": "2", "--alpha": "0", **dict(zip(FLOW[::2], FLOW[1::2], strict=True))} | {option: text}
    refused(capfd, "flow", body, *(x for pair in options.items() for x in pair), naming=option)


@pytest.mark.parametrize("text", ["1%", "0.01", " 1 % ", "1e0%"])
def test_a_share_may_be_per_cent(text):
    assert fraction("--accuracy", text) == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("options", "naming"),
    [
        (("--accuracy", "1%", "--cell", "0.1"), "not allowed with --cell"),
        (("--accuracy", "1%", "--uncertainty", "iteration"), "not allowed with --uncertainty iteration"),
        (("--accuracy", "1%", "--cells", "5k"), "--cells: 5k, at least 12000"),
    ],
)
@pytest.mark.parametrize("command", ["flow", "analyse"])
def test_what_an_accuracy_does_not_go_with(capfd, tmp_path, command, options, naming):
    if command == "flow":
        start = ["flow", tetrahedron(tmp_path / "t.stl"), "--mach", 2, *FLOW]
    else:
        start = ["analyse", "horus-2b", "--out", tmp_path / "o"]
    refused(capfd, *start, *options, naming=naming)


@pytest.mark.parametrize(
    ("options", "naming"),
    [
        (("--adapt", "1"), "--adapt: 1, goes with --cells"),
        (("--adapt", "4", "--cells", "40k"), "--adapt: 4"),
        (("--adapt", "1", "--cells", "40k", "--accuracy", "5%"), "--adapt: 1, not allowed with accuracy"),
        (("--adapt", "1", "--cells", "40k", "--edges", "2"), "--edges: 2, not allowed with --adapt 1"),
        (
            ("--adapt", "1", "--cells", "40k", "--refine-parts", "wing"),
            "--refine-parts: wing, not allowed with --adapt 1",
        ),
    ],
)
def test_what_an_adapted_analysis_does_not_go_with(capfd, tmp_path, options, naming):
    refused(capfd, "analyse", "horus-2b", "--out", tmp_path / "o", *options, naming=naming)


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (("--cells", "10"), "--cells: 10, allowed 1000 to"),
        (("--cell", "1e-9"), "--cell: 1e-09 m gives more than"),
        (
            ("--friction", "laminar", "--altitude", "2e4", "--emissivity", "3"),
            "--emissivity: 3.0, above 0 and at most 1",
        ),
        (("--wall-temperature", "300"), "--wall-temperature: 300, needs friction laminar or turbulent"),
        (
            ("--friction", "laminar", "--altitude", "2e4", "--emissivity", "0.8", "--wall-temperature", "300"),
            "--emissivity: 0.8, give it or --wall-temperature, not both",
        ),
        (("--rates", "nan,0,0"), "--rates: 'nan' is not a number"),
        (("--rates", "0,1e200,0"), "--rates: a point of the body would move"),
        (("--cell", "1000"), "--cell: 1000 m too coarse for this body"),
        (("--cells", "1000"), "--cells: 1000 gives wall cells of"),
    ],
)
def test_errors_name_the_option_and_not_the_setting(capfd, tmp_path, options, line):
    from spaceplane.mesh.generate import compile_kernels

    compile_kernels()
    body = tetrahedron(tmp_path / "t.stl")
    assert refused(capfd, "flow", body, "--mach", 2, *FLOW, *options, naming="--").startswith(f"error: {line}")


def test_a_mesh_too_coarse_for_the_vehicle_is_refused_with_a_cell_that_would_do(capfd, tmp_path):
    from spaceplane.mesh.generate import compile_kernels

    compile_kernels()
    sparse = ("--no-controls", "--uncertainty", "iteration", "--mach", "2.5", "--out", tmp_path / "o")
    code, _, err = run(capfd, "analyse", "horus-2b", "--cell", 30, "--edges", 0, *sparse)
    assert code == 2 and re.search(r"error: --cell: 30 m too coarse .*; [\d.]+ m \(\d+ cells\) would do$", err.strip())


def test_beyond_what_was_checked_is_a_warning(capfd):
    from spaceplane.commands.arguments import warn_beyond_verified

    warn_beyond_verified([2.0, 25.0])
    assert capfd.readouterr() == ("", "")
    warn_beyond_verified([2.0, 30.0])
    assert capfd.readouterr() == ("", "warning: --mach: 30, beyond Mach 25 nothing has been checked\n")


def test_rates_and_altitudes_that_no_flight_has(capfd, tmp_path):
    body = tetrahedron(tmp_path / "t.stl")
    refused(capfd, "flow", body, "--mach", 2, *FLOW, "--rates", "0,5000,0", naming="rates")
    refused(capfd, "flow", body, "--mach", 2, *FLOW, "--altitude", "1e6", naming="altitude")


def test_missing_flow_option(capfd, tmp_path):
    refused(capfd, "flow", tetrahedron(tmp_path / "t.stl"), "--mach", 2, naming="--area")


def test_blanks_in_lists_are_fine():
    from spaceplane.commands.arguments import mach_numbers, numbers

    assert mach_numbers(" 0.8, 1.5 ,2.5") == [0.8, 1.5, 2.5]
    assert numbers("--moment-center", "1, 2, 3", count=3) == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("text", "value"), [("300000", 300_000), ("300k", 300_000), ("1.5M", 1_500_000), (" 40K ", 40_000)]
)
def test_counts_of_cells_may_have_a_suffix(text, value):
    from spaceplane.commands.arguments import count

    assert count("--cells", text, "cells") == value


@pytest.mark.parametrize("text", ["k", "-3k", "30q", "", "0M"])
def test_bad_counts_name_the_option(text):
    from spaceplane.commands.arguments import count

    with pytest.raises(InputError, match="--cells"):
        count("--cells", text, "cells")


def test_missing_body(capfd, tmp_path):
    refused(capfd, "flow", tmp_path / "no.stl", "--mach", 2, *FLOW, naming="no.stl")


def test_folder_as_body(capfd, tmp_path):
    refused(capfd, "flow", tmp_path, "--mach", 2, *FLOW, naming=str(tmp_path))


def test_empty_body(capfd, tmp_path):
    (tmp_path / "empty.stl").write_bytes(b"")
    refused(capfd, "flow", tmp_path / "empty.stl", "--mach", 2, *FLOW, naming="empty.stl")


def test_body_without_triangles(capfd, tmp_path):
    (tmp_path / "none.stl").write_text("solid none\nendsolid none\n")
    refused(capfd, "flow", tmp_path / "none.stl", "--mach", 2, *FLOW, naming="none.stl")


def test_garbage_as_body(capfd, tmp_path):
    (tmp_path / "noise.stl").write_bytes(bytes(range(256)) * 5)
    refused(capfd, "flow", tmp_path / "noise.stl", "--mach", 2, *FLOW, naming="noise.stl")


def test_open_body(capfd, tmp_path):
    body = tetrahedron(tmp_path / "open.stl", faces=3)
    assert "watertight" in refused(capfd, "flow", body, "--mach", 2, *FLOW, naming="open.stl")


def test_failed_run_leaves_earlier_output_alone(capfd, tmp_path):
    kept = tmp_path / "kept.json"
    kept.write_text("[]")
    refused(capfd, "flow", tetrahedron(tmp_path / "o.stl", 3), "--mach", 2, *FLOW, "--json", kept, naming="o.stl")
    assert kept.read_text() == "[]"


# What `modes`, `report`, `compare`, `export`, `validate` and `study` refuse.


@pytest.mark.parametrize("text", ["[flight\nmach=2", "", "[flight]\nmach = 2.5\n", "\x00"])
def test_malformed_derivatives(capfd, tmp_path, text):
    path = tmp_path / "d.toml"
    path.write_text(text)
    refused(capfd, "modes", path, naming="d.toml" if not text.startswith("[flight]") else "altitude")


def test_missing_derivatives(capfd, tmp_path):
    refused(capfd, "modes", tmp_path / "d.toml", naming="d.toml")
    refused(capfd, "modes", tmp_path, naming=str(tmp_path))


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", "{}", '{"schema": "other"}', '{"schema": "spaceplane.result", "schema_version": 99}', "\x00"],
)
def test_damaged_result(capfd, tmp_path, text):
    (tmp_path / "result.json").write_text(text)
    refused(capfd, "report", tmp_path, naming="result.json")
    refused(capfd, "export", "csv", tmp_path, naming="result.json")
    refused(capfd, "compare", tmp_path / "result.json", tmp_path / "result.json", naming="result.json")
    assert (tmp_path / "result.json").read_text() == text
    assert not (tmp_path / "report.html").exists()


def test_missing_result(capfd, tmp_path):
    refused(capfd, "report", tmp_path / "none", naming="none")
    refused(capfd, "report", tmp_path, naming="result.json")


def test_unknown_export_format(capfd, tmp_path):
    refused(capfd, "export", "xlsx", tmp_path, naming="xlsx")
    refused(capfd, "export", "jsbsm", PUBLISHED, "--out", tmp_path / "o", naming="jsbsim")
    assert not (tmp_path / "o").exists()


# What `fly` and `export` refuse of an aerodynamic model.


def table_set(folder: Path, **texts: str) -> Path:
    """The smallest folder of tables, with some files as given."""
    folder.mkdir()
    files = {f"{c}0": HEAD + f"0,{v},{v}\n20,{2 * v},{2 * v}\n" for c, v in (("CL", 0.2), ("CD", 0.1), ("Cm", 0.01))}
    for name, text in (files | texts).items():
        (folder / f"{name}.csv").write_text(text)
    return folder


@pytest.mark.parametrize(
    ("options", "naming"),
    [
        (["--mach", "3,2"], "mach = 3, 2"),
        (["--mach", "2,2"], "--mach: 2 is given twice"),
        (["--mach", ""], "--mach"),
        (["--mach", "nan"], "--mach"),
        (["--mach", "-2"], "--mach"),
        (["--mach", "0.5"], "mach = 0.5"),
        (["--mach", "2,30"], "mach = 30"),
        (["--form", "x"], "form = 'x'"),
        (["--class", "V"], "vehicle_class = 'V'"),
        (["--category", "D"], "category = 'D'"),
        (["--gamma", "nan"], "--gamma"),
        (["--gamma", "95"], "gamma_deg = 95"),
        (["--bank", "down"], "--bank"),
        (["--bank", "200"], "bank_deg = 200"),
        (["--body-flap", "inf"], "--body-flap"),
        (["--vehicle", "nope"], "unknown vehicle preset 'nope'"),
        (["--vehicle", "none.yaml"], "none.yaml"),
        (["--alpha", "5,6"], "alpha_deg: 2 values for 12 Mach numbers"),
        (["--alpha", "x"], "--alpha"),
        (["--gamma", ""], "--gamma"),
        (["--bank", "200"], "bank"),
        (["--altitude", "1e9"], "altitude"),
        (["--mach", "2", "--altitude", "20000"], "gamma_deg: is needed with a single altitude"),
        (["--samples", "10"], "--samples: goes with --uncertainty"),
        (["--samples", "0", "--uncertainty", "all=10%"], "--samples"),
        (["--samples", "2M", "--uncertainty", "all=10%"], "samples = 2000000"),
        (["--uncertainty", ""], "--uncertainty"),
        (["--uncertainty", "Cm_alpha"], "--uncertainty"),
        (["--uncertainty", "Cm_alpa=10%"], "did you mean 'Cm_alpha'"),
        (["--uncertainty", "Cm_alpha=nan"], "Cm_alpha = 'nan'"),
        (["--uncertainty", "Cm_alpha=-5%"], "Cm_alpha = '-5%'"),
        (["--uncertainty", "all=0.1"], "must be a share"),
    ],
)
def test_bad_descents(capfd, tmp_path, options, naming):
    refused(capfd, "fly", PUBLISHED, *options, "--out", tmp_path / "o", naming=naming)
    assert not (tmp_path / "o").exists()


@pytest.mark.parametrize(
    ("options", "naming"),
    [
        (["--body-flap", "90"], "body_flap = 90 deg"),
        (["--uncertainty", "Cl_p=10%"], "Cl_p"),
        (["--uncertainty", "Cm_elevator=10%"], "Cm_elevator"),
    ],
)
def test_descents_that_the_tables_refuse(capfd, tmp_path, options, naming):
    refused(capfd, "fly", PUBLISHED, "--mach", "2", *options, "--out", tmp_path / "o", naming=naming)


@pytest.mark.parametrize("command", [["fly"], ["export", "tudat"], ["export", "jsbsim"]], ids=" ".join)
def test_sources_that_are_none(capfd, tmp_path, command):
    out = tmp_path / "o"
    refused(capfd, *command, "horus-2b-publish", "--out", out, naming="did you mean 'horus-2b-published'")
    refused(capfd, *command, tmp_path, "--out", out, naming=str(tmp_path))
    refused(capfd, *command, tmp_path / "none.nc", "--out", out, naming="none.nc")
    refused(capfd, *command, tmp_path / "none.toml", "--out", out, naming="none.toml")
    (tmp_path / "bad.nc").write_text("no")
    refused(capfd, *command, tmp_path / "bad.nc", "--out", out, naming="bad.nc")
    refused(capfd, *command, table_set(tmp_path / "t"), "--out", out, naming="--vehicle: needed")
    assert not out.exists()


@pytest.mark.parametrize(
    ("file", "text", "naming"),
    [
        ("CL0", HEAD + "0,nan,1\n20,1,1\n", "CL0.csv, row 2: M2 = nan: must be finite"),
        ("CD0", HEAD + "0,much,1\n20,1,1\n", "CD0.csv, row 2: M2 = 'much'"),
        ("Cm0", HEAD + "0,1\n20,1,1\n", "Cm0.csv, row 2"),
        ("Cm0", "alpha,M2\n0,1\n", "Cm0.csv: columns"),
        ("CL0", "alpha_deg,M3,M2\n0,1,1\n20,1,1\n", "CL0.csv, row 1: M2 follows M3"),
        ("dCm_one_elevn", HEAD, "dCm_one_elevon"),
    ],
)
@pytest.mark.parametrize("command", [["fly"], ["export", "csv"]], ids=" ".join)
def test_damaged_tables(capfd, tmp_path, command, file, text, naming):
    tables = table_set(tmp_path / "tables", **{file: text})
    refused(capfd, *command, tables, "--vehicle", "horus-2b", "--out", tmp_path / "o", naming=naming)


@pytest.mark.parametrize(
    "command", [["fly"], ["export", "tudat"], ["export", "jsbsim"], ["export", "csv"]], ids=" ".join
)
def test_models_are_not_written_where_nothing_can_be(capfd, blocked, command):
    refused(capfd, *command, PUBLISHED, "--out", blocked, naming="--out")
    refused(capfd, *command, PUBLISHED, "--out", "", naming="--out")
    good = blocked.parent.with_name("o")
    refused(capfd, *command, PUBLISHED, "--out", good, "--json", blocked / "r.json", naming="--json")
    assert blocked.parent.read_text() == "kept"


@pytest.mark.parametrize("text", ["nan,0,0", "1,2", "a,b,c", ""])
def test_bad_centres_of_mass(capfd, tmp_path, text):
    options = ["--center-of-mass", text, "--out", tmp_path / "o"]
    refused(capfd, "export", "jsbsim", PUBLISHED, *options, naming="--center-of-mass")
    assert not (tmp_path / "o").exists()


@pytest.mark.parametrize("lag", [("-5.9", "-6.314"), ("30", "-200")])
def test_fly_finds_the_modes_of_a_derivatives_file(capfd, tmp_path, lag):
    """Derivatives with dalpha/dt among them; `fly` takes its own air, so that of the file is left out."""
    kept = [
        x for x in BOEING.read_text().splitlines() if not x.startswith(("pressure_Pa", "temperature_K", "density_g"))
    ]
    text = "\n".join(kept).replace("Cl_p =", "Cm_elevator = -1.3\nCl_p =")
    path = tmp_path / "b747.toml"
    path.write_text(text.replace("CL_alphadot = -5.9", f"CL_alphadot = {lag[0]}").replace("-6.314", lag[1]))
    assert run(capfd, "modes", path, "--json", tmp_path / "modes.json")[0] == 0
    flown = run(capfd, "fly", path, "--no-control", "--json", tmp_path / "fly.json", "--out", tmp_path / "o")
    assert flown[0] == 0, flown
    modes = json.loads((tmp_path / "modes.json").read_text())["modes"]
    [point] = json.loads((tmp_path / "fly.json").read_text())["points"]
    assert len(modes) == len(point["modes"]) >= 5
    for one, other in zip(modes, point["modes"], strict=True):
        assert other["eigenvalue"] == pytest.approx(one["eigenvalue"], rel=1e-6, abs=1e-9), one["name"]


@pytest.mark.parametrize("command", [["fly"], ["export", "jsbsim"]], ids=" ".join)
def test_a_centre_of_mass_is_near_the_moment_centre(capfd, tmp_path, command):
    out = ["--out", tmp_path / "o"]
    naming = "--center-of-mass: 500,0,0 m is 487 m from the moment centre 13,0,0 m; allowed are up to 23 m"
    refused(capfd, *command, PUBLISHED, "--center-of-mass", "500,0,0", *out, naming=naming)
    refused(capfd, *command, BOEING, "--center-of-mass", "0.1,0,0", *out, naming="whose place it does not give")
    assert not (tmp_path / "o").exists()


def test_a_descent_says_how_likely_its_levels_are(capfd, tmp_path):
    """The command from end to end: files, terminal, exit code 0; without any trim exit code 1 and the reason."""
    options = ["--mach", "2,2.5", "--uncertainty", "all=20%", "--samples", "60", "--out", tmp_path / "o"]
    code, out, _ = run(capfd, "fly", PUBLISHED, *options)
    assert code == 0
    assert "2 of 2 flight points trimmed" in out and " with " in out and "descent.html" in out
    assert "worst level" in out and re.search(r"2\.5 +25\.0 +16\.6 +-9\.6 +60\.3 +-2\.8 +-20\.0", out)
    record = json.loads((tmp_path / "o" / "descent.json").read_text())
    assert record["uncertainty"] == {"all": {"share": 0.2}}
    assert all(v["samples"] == 60 for p in record["points"] for v in p["verdicts"])
    code, out, err = run(capfd, "fly", PUBLISHED, "--mach", "1.2", "--out", tmp_path / "none")
    assert code == 1
    assert "0 of 1 flight points trimmed" in out and "Mach 1.2: no trim" in err


def test_compare_needs_two(capfd, tmp_path):
    refused(capfd, "compare", tmp_path / "a.json", naming="two")


def test_unknown_validation_case(capfd):
    assert "cones" in refused(capfd, "validate", "cone", naming="cone")


@pytest.mark.parametrize("text", ["parameters: [", "parametres: {}\n", "mach: [0]\n", "mach: abc\n", "- 1\n"])
def test_malformed_study(capfd, tmp_path, text):
    (tmp_path / "s.yaml").write_text(text)
    refused(capfd, "study", "sensitivity", tmp_path / "s.yaml", "--out", tmp_path / "o", naming="s.yaml")


def test_damaged_store_is_named_and_kept(capfd, tmp_path):
    store = tmp_path / "store.sqlite"
    store.write_bytes(b"this is no database" * 300)
    before = store.read_bytes()
    line = refused(capfd, "study", "sensitivity", "--out", tmp_path / "o", "--store", store, naming="store.sqlite")
    assert "damaged" in line or "not a" in line
    assert store.read_bytes() == before


@pytest.mark.parametrize("text", ["0", "-1", "many"])
def test_bad_number_of_workers(capfd, tmp_path, text):
    refused(capfd, "study", "sensitivity", "--workers", text, "--out", tmp_path, naming="--workers")


def test_unknown_command_and_option(capfd):
    refused(capfd, "analyze", "horus-2b", naming="analyze")
    refused(capfd, "report", "--nonsense", naming="--nonsense")


# What happens inside.


def test_interrupt_is_one_line_and_130(capfd, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("spaceplane.report.read.read_result", interrupted)
    code, _, err = run(capfd, "report", "x")
    assert (code, err) == (130, "error: interrupted\n")


def test_full_disk_is_one_line_and_2(capfd, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device", "result.json")

    monkeypatch.setattr("spaceplane.report.read.read_result", full)
    code, _, err = run(capfd, "report", "x")
    assert (code, err) == (2, "error: result.json: No space left on device\n")


def test_error_messages_stay_on_one_line(capfd, monkeypatch):
    def broken(*_):
        raise InputError("first\nsecond")

    monkeypatch.setattr("spaceplane.report.read.read_result", broken)
    assert refused(capfd, "report", "x", naming="first second")


def test_modes_writes_json(capfd, tmp_path):
    path = tmp_path / "d.toml"
    path.write_text(
        "[flight]\nmach = 2.5\naltitude_m = 26700\nalpha_deg = 16.6\ngamma_deg = -8.4\nbank_deg = 55\nCL = 0.36\n"
        "CD = 0.2\n"
        "[vehicle]\nmass_kg = 26000.0\nIxx_kgm2 = 119000.0\nIyy_kgm2 = 769000.0\nIzz_kgm2 = 806000.0\narea_m2 = 110.0\n"
        "c_ref_m = 23.0\nb_ref_m = 13.0\n"
        '[derivatives]\nunit = "per_degree"\nCD_alpha = 0.0179\nCL_alpha = 0.0323\nCm_alpha = 0.00071\n'
        "CY_beta = -0.01725\nCl_beta = -0.00139\nCn_beta = -0.00048\nCD_M = -0.0415\nCL_M = -0.0965\nCm_M = 0.01195\n"
    )
    code, out, err = run(capfd, "modes", path, "--json", tmp_path / "m.json")
    assert (code, err) == (0, "")
    assert "MIL-F-8785C" in out
    record = json.loads((tmp_path / "m.json").read_text())
    assert len(record["eigenvalues"]) == 9
    code, out, _ = run(capfd, "modes", path, "--json", "-")
    assert json.loads(out)["modes"] == record["modes"]


# What `flow` does with a body that it can solve.


def wedge(path: Path) -> Path:
    """ASCII STL of a slender double wedge, 2 m long, 1 m wide and 0.2 m thick."""
    top, bottom = [(0, -0.5, 0), (1, -0.5, 0.1), (2, -0.5, 0)], (1, -0.5, -0.1)
    left = [*top, bottom]
    right = [(x, 0.5, z) for x, _, z in left]
    points = left + right
    quads = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    faces += [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7)]
    text = "solid w\n"
    for face in faces:
        text += "facet normal 0 0 0\nouter loop\n"
        text += "".join("vertex {} {} {}\n".format(*points[k]) for k in face) + "endloop\nendfacet\n"
    path.write_text(text + "endsolid w\n")
    return path


def test_body_larger_than_the_domain(capfd, tmp_path):
    body = wedge(tmp_path / "w.stl")
    line = refused(capfd, "flow", body, "--mach", 2, *FLOW, "--cell", 0.2, "--domain", "0,0,0,1,1,1", naming="domain")
    assert "larger than the domain" in line


def test_bad_domain(capfd, tmp_path):
    body = wedge(tmp_path / "w.stl")
    for text in ("1,2,3", "a,b,c,d,e,f", "1,1,1,0,0,0"):
        refused(capfd, "flow", body, "--mach", 2, *FLOW, "--domain", text, naming="domain")


def test_a_wall_thinner_than_two_cells_is_a_warning_with_the_place(capfd, tmp_path):
    body, record = wedge(tmp_path / "w.stl"), tmp_path / "w.json"
    files = ["--json", record, "--vtp", tmp_path / "w.vtp", "--vtu", tmp_path / "w.vtu"]
    code, out, err = run(capfd, "flow", body, "--mach", "2, 3", "--alpha", "0,4", *FLOW, "--cell", 0.2, *files)
    assert code == 0, err
    warning = next(line for line in err.splitlines() if line.startswith("warning: "))
    assert "thinner than two cells" in warning
    assert "x=" in warning and "y=" in warning and "z=" in warning
    rows = json.loads(record.read_text())
    assert [(r["mach"], r["alpha_deg"]) for r in rows] == [(2, 0), (2, 4), (3, 0), (3, 4)]
    keys = "mach alpha_deg beta_deg CL CD CY Cl Cm Cn CA CN converged residual_drop iterations seconds cells"
    assert set(keys.split()) | {"CA_forebody", "CA_base", "Cp_max", "Cp_min"} <= set(rows[0])
    assert rows[1]["CL"] > 0.05 > abs(rows[0]["CL"])
    assert all(r["converged"] for r in rows) and out.count("converged") == 4
    assert all(r["coefficient_errors"]["CL"] > 0.0 for r in rows) and out.count("±") == 8 * len(rows)
    import pyvista

    assert pyvista.read(tmp_path / "w.vtp").n_cells > 0
    assert pyvista.read(tmp_path / "w.vtu").n_cells == rows[0]["cells"]


def test_residuals_fall_as_far_as_asked(capfd, tmp_path):
    body, record = wedge(tmp_path / "w.stl"), tmp_path / "w.json"
    deep = ("--cell", 0.2, "--decades", 6, "--precision", "fp64", "--json", record)
    code, _, err = run(capfd, "flow", body, "--mach", "2,3", "--alpha", 4, *FLOW, *deep)
    assert code == 0, err
    assert all(r["converged"] and r["residual_drop"] >= 6 for r in json.loads(record.read_text()))
    single = ("--cell", 0.2, "--decades", 8, "--uncertainty", "iteration", "--json", record)
    code, _, err = run(capfd, "flow", body, "--mach", 2, "--alpha", 4, *FLOW, *single)
    assert code == 1 and "decades: 8 NOT reached by 1 of 1" in err and "--precision fp64" in err
    assert json.loads(record.read_text())[0]["converged"]


def test_local_inclination_from_the_command_line(capfd, tmp_path):
    """The records of the Euler solver, without a mesh; a wedge of 5.7 deg at Mach 3 in the plane."""
    from spaceplane.aero.exact.oblique import weak_shock_cp

    body, record = wedge(tmp_path / "w.stl"), tmp_path / "w.json"
    grid = ("--mach", "3,8", "--alpha", "0,4", *FLOW)
    code, out, err = run(capfd, "flow", body, *grid, "--method", "tangent-wedge", "--json", record)
    # Nothing but the first compilation has anything to say.
    assert code == 0 and all("compil" in line for line in err.splitlines()) and out.count("inclination") == 4
    rows = json.loads(record.read_text())
    assert [(r["mach"], r["alpha_deg"]) for r in rows] == [(3, 0), (3, 4), (8, 0), (8, 4)]
    assert all(r["converged"] and r["cells"] == 0 for r in rows)
    assert rows[0]["Cp_max"] == pytest.approx(float(weak_shock_cp(3.0, math.atan(0.1))), rel=1e-4)
    assert rows[1]["CL"] > 0.05 > abs(rows[0]["CL"])
    code, out, _ = run(capfd, "flow", body, *grid, "--method", "newtonian", "--json", "-")
    assert code == 0 and json.loads(out)[0].keys() == rows[0].keys()
    assert json.loads(out)[0]["Cp_min"] == 0.0


@pytest.mark.parametrize(
    ("options", "naming"),
    [
        (("--method", "newtonain"), "did you mean 'newtonian'"),
        (("--method", "newtonian", "--mach", "1.5,3"), "--mach: 1.5"),
        (("--method", "newtonian", "--cell", "0.1"), "--cell: 0.1"),
        (("--method", "tangent", "--cells", "1000"), "--cells: 1000"),
        (("--method", "tangent", "--adapt", "1"), "--adapt: 1"),
        (("--method", "tangent", "--edges", "1"), "--edges: 1"),
        (("--method", "tangent", "--refine-box", "0,0,0,1,1,1,0.1"), "--refine-box: 0,0,0,1,1,1,0.1, allowed with"),
        (("--method", "tangent", "--refine-parts", "w"), "--refine-parts: w, allowed with --method euler only"),
        (("--cells", "40k", "--refine-parts", "w", "--adapt", "1"), "--refine-parts: w, not allowed with --adapt 1"),
        (("--cells", "40k", "--refine-box", "0,0,0,1,1,1,1", "--adapt", "1"), "--refine-box: 0,0,0,1,1,1,1, not"),
        (("--cells", "40k", "--edges", "1", "--adapt", "1"), "--edges: 1, not allowed with --adapt 1"),
        (("--cell", "0.1", "--adapt", "1"), "--adapt: 1, goes with --cells"),
        (("--method", "tangent", "--domain", "0,0,0,1,1,1"), "--domain"),
        (("--method", "tangent", "--vtu", "a.vtu"), "--vtu"),
        (("--method", "tangent", "--vtp", "a.vtp"), "--vtp"),
        (("--method", "tangent", "--precision", "fp64"), "--precision"),
        (("--method", "tangent", "--decades", "4"), "--decades: 4, allowed with --method euler only"),
        (("--method", "tangent", "--accuracy", "1%"), "--accuracy: 1%, allowed with --method euler only"),
        (("--method", "tangent", "--uncertainty", "mesh"), "--uncertainty: mesh, allowed with --method euler only"),
    ],
)
def test_what_local_inclination_refuses(capfd, tmp_path, monkeypatch, options, naming):
    monkeypatch.chdir(tmp_path)
    mach = () if "--mach" in options else ("--mach", 3)
    refused(capfd, "flow", wedge(tmp_path / "w.stl"), *mach, *FLOW, *options, naming=naming)


# What `flow --mesh` does.


def cone_mesh(path: Path) -> Path:
    """Quarter of a 20 deg cone between two planes of symmetry."""
    import numpy as np

    from mesh import body_fitted

    elements, _ = body_fitted.cone(8, 10, 6, *np.radians([20.0, 38.0]))
    return (body_fitted.write_su2 if path.suffix == ".su2" else body_fitted.write_msh)(elements, path)


@pytest.mark.parametrize("ending", [".su2", ".msh"])
def test_flow_on_a_mesh(capfd, tmp_path, ending):
    mesh, record = cone_mesh(tmp_path / f"cone{ending}"), tmp_path / "cone.json"
    files = ["--json", record, "--vtp", tmp_path / "c.vtp", "--vtu", tmp_path / "c.vtu"]
    reference = ["--area", "0.10404", "--length", "1", "--span", "1", "--moment-center", "0,0,0"]
    code, out, err = run(capfd, "flow", "--mesh", mesh, "--mach", "3", *reference, *files)
    assert code == 0, err
    assert err.splitlines()[0] == "mesh: 480 cells; wall: cone; far field: farfield; symmetry: sym_z, sym_y"
    (row,) = json.loads(record.read_text())
    assert row["cells"] == 480 and row["converged"] and out.count("converged") == 1
    assert row["CA"] == pytest.approx(0.284, rel=0.06)  # Taylor-Maccoll, on a coarse mesh
    import pyvista

    wall, air = pyvista.read(tmp_path / "c.vtp"), pyvista.read(tmp_path / "c.vtu")
    assert air.n_cells == 480 and set(air.celltypes) == {12}
    assert air.volume == pytest.approx(0.1249, rel=0.01)
    assert wall.n_cells == 2 * 8 * 6 - 6
    slope = wall["Cp_M3_a0_b0"][wall.cell_centers().points[:, 0] > 0.5]
    assert slope.mean() == pytest.approx(0.284, rel=0.06)


@pytest.mark.parametrize(
    ("options", "naming"),
    [
        (["--far", "farfeld"], "did you mean 'farfield'"),
        (["--wall", "cone"], None),
        (["--wall", "cone,sym_y", "--symmetry", ","], "--symmetry"),
        (["--wall", "cone", "--symmetry", "sym_y"], "'sym_z' is left over"),
        (["--far", "farfield,cone"], "--wall: the mesh has no wall"),
        (["--cell", "0.1"], "--cell: 0.1, not allowed with --mesh"),
        (["--cells", "1000"], "--cells: 1000, not allowed with --mesh"),
        (["--adapt", "1"], "--adapt: 1, not allowed with --mesh"),
        (["--edges", "1"], "--edges: 1, not allowed with --mesh"),
        (["--refine-box", "0,0,0,1,1,1,1"], "--refine-box: 0,0,0,1,1,1,1, not allowed with --mesh"),
        (["--refine-parts", "w"], "--refine-parts: w, not allowed with --mesh"),
        (["--domain", "0,0,0,1,1,1"], "--domain"),
        (["--accuracy", "1%"], "--accuracy: 1%, not allowed with --mesh"),
        (["--uncertainty", "mesh"], "--uncertainty: mesh, not allowed with --mesh"),
        (["body.stl"], "BODY.stl: body.stl, not allowed with --mesh"),
        (["--alpha", "5"], "goes through 80 of 160 faces of symmetry"),
    ],
)
def test_bad_options_of_a_mesh(capfd, tmp_path, monkeypatch, options, naming):
    from spaceplane.aero import flow_case

    monkeypatch.setattr(flow_case, "solve", lambda *arguments: 1 / 0)
    mesh = cone_mesh(tmp_path / "cone.su2")
    if naming is None:
        with pytest.raises(ZeroDivisionError):
            run(capfd, "flow", "--mesh", mesh, "--mach", 2, *FLOW, *options)
        return
    code, out, err = run(capfd, "flow", "--mesh", mesh, "--mach", 2, *FLOW, *options)
    assert code == 2 and out == ""
    assert err.splitlines()[-1].startswith("error: ") and naming in err.splitlines()[-1]


def test_markers_without_a_mesh_and_nothing_at_all(capfd, tmp_path):
    body = tetrahedron(tmp_path / "t.stl")
    for option in ("--wall", "--far", "--symmetry"):
        refused(capfd, "flow", body, "--mach", 2, *FLOW, option, "x", naming=f"{option}: x, only allowed with --mesh")
    refused(capfd, "flow", "--mach", 2, *FLOW, naming="BODY.stl")
    refused(capfd, "flow", "--mesh", "", "--mach", 2, *FLOW, naming="--mesh")
    refused(capfd, "flow", "--mesh", tmp_path / "no.su2", "--mach", 2, *FLOW, naming="no.su2")
    refused(capfd, "flow", "--mesh", body, "--mach", 2, *FLOW, naming=".su2 or .msh")


def test_an_unconverged_condition_is_exit_code_1(capfd, tmp_path, monkeypatch):
    from spaceplane.aero import flow_case

    solved = flow_case.run_flow

    def spoilt(*arguments, **options):
        case = solved(*arguments, **options)
        case.records[0].update(converged=False, verdict="oscillating", reason="forces wander")
        return case

    monkeypatch.setattr(flow_case, "run_flow", spoilt)
    code, _, err = run(capfd, "flow", wedge(tmp_path / "w.stl"), "--mach", 2, *FLOW, "--cell", 0.25)
    assert code == 1
    assert "not good: Mach 2, alpha 0 deg, beta 0 deg: oscillating: forces wander" in err


def test_adapted_flow_from_the_command_line(capfd, tmp_path):
    body, options = wedge(tmp_path / "w.stl"), ("--cells", "6k", "--adapt", 1, "--json", "-")
    code, out, err = run(capfd, "flow", body, "--mach", 2, *FLOW, *options)
    assert code == 0, err
    assert json.loads(out)[0]["cells"] == pytest.approx(6000, rel=0.15)
    code, out, err = run(capfd, "flow", body, "--mach", 2, *FLOW, *options, "--uncertainty", "mesh")
    assert code == 0, err
    again = json.loads(out)[0]
    assert again["cells"] == pytest.approx(6000, rel=0.15)
    assert 0.0 < again["coefficient_errors_by_source"]["mesh"]["CD"] < 0.5 * again["CD"]
    options = ("--cells", "40k", "--adapt", 1, "--accuracy", "5%")
    refused(capfd, "flow", body, "--mach", 2, *FLOW, *options, naming="--accuracy: 5%, not allowed")


def test_edges_are_finer_by_default_and_as_asked(capfd, tmp_path):
    """Cells grow in number from no finer edges over one halving, the default, to two."""
    body = wedge(tmp_path / "w.stl")

    def cells(*options):
        code, out, err = run(capfd, "flow", body, "--mach", 2, *FLOW, "--cell", 0.25, "--json", "-", *options)
        assert code == 0, err
        return json.loads(out)[0]["cells"]

    assert cells("--edges", "0") < cells() == cells("--edges", "1") < cells("--edges", "2")


def test_parts_and_boxes_are_refined_as_asked(capfd, tmp_path, monkeypatch):
    """Wall cells of one solid come out half as large, and cells in the boxes no larger than asked."""
    import numpy as np

    from spaceplane.aero import flow_case

    class MeshedError(Exception):
        pass

    meshes = []

    def kept(mesh, *_):
        meshes.append(mesh)
        raise MeshedError

    monkeypatch.setattr(flow_case, "solve", kept)
    text = wedge(tmp_path / "w.stl").read_text()
    facets = text.split("facet normal")[1:]
    body = tmp_path / "two.stl"
    fore, aft = ("".join("facet normal" + f for f in half) for half in (facets[:2], facets[2:]))
    body.write_text(f"solid fore\n{fore}endsolid fore\nsolid aft\n" + aft.replace("endsolid w", "endsolid aft"))
    boxes = ((1.5, -1.0, 1.0, 3.0, 1.0, 2.0, 0.2), (-1.0, -1.0, -2.0, 0.0, 1.0, -1.0, 0.1))
    given = [x for box in boxes for x in ("--refine-box", ",".join(map(str, box)))]
    plain = ["flow", body, "--mach", 2, *FLOW, "--cell", 0.2, "--edges", 0]
    for options in ((), (*given, "--refine-parts", "fore")):
        with pytest.raises(MeshedError):
            run(capfd, *plain, *options)
    before, after = meshes
    assert before.part_names == ("body",) and after.part_names == ("fore", "aft")
    sizes = after.cell_size[after.wall_cell[after.piece_wall]]
    assert np.allclose(sizes[after.piece_part == 0], 0.1) and np.isclose(sizes[after.piece_part == 1], 0.2).any()
    assert np.allclose(before.cell_size[before.wall_cell], 0.2)
    for box in boxes:
        largest = []
        for mesh in meshes:
            inside = ((mesh.cell_cube_center > box[:3]) & (mesh.cell_cube_center < box[3:6])).all(axis=1)
            largest.append(mesh.cell_size[inside].max())
        assert largest[1] <= box[6] + 1e-9 < largest[0]
    line = refused(capfd, *plain, "--refine-parts", "wing", naming="--refine-parts: unknown part 'wing'")
    assert "the body has fore, aft" in line


def test_an_analysis_refines_parts_and_boxes(monkeypatch, capfd, tmp_path):
    from spaceplane import pipeline

    seen = []

    def seen_only(subject, settings, *_):
        seen.append(settings)
        raise InputError("seen")

    monkeypatch.setattr(pipeline, "run", seen_only)
    options = (
        "--refine-box",
        "18,-2,-1,26,2,3,0.15",
        "--refine-parts",
        "body_flap, elevon",
        "--refine-parts",
        "rudder",
    )
    refused(capfd, "analyse", "horus-2b", "--out", tmp_path / "o", *options, naming="seen")
    (box,) = seen[0].mesh.boxes
    assert (box.lower, box.upper, box.cell) == ((18, -2, -1), (26, 2, 3), 0.15)
    assert seen[0].mesh.fine_parts == ("body_flap", "elevon", "rudder") and seen[0].mesh.wall_cell == 0.3


def test_interrupt_from_outside_is_one_line_and_130(tmp_path):
    import signal

    body = wedge(tmp_path / "w.stl")
    arguments = ["flow", str(body), "--mach", "1.5,2,2.5,3", *FLOW, "--cell", "0.03"]
    command = [sys.executable, "-m", "spaceplane.cli", *arguments]
    # A shell's background job ignores SIGINT and hands that down; the child must not inherit it.
    restore = functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    with subprocess.Popen(
        command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, preexec_fn=restore
    ) as process:
        first = process.stderr.readline()  # the first line of progress: now it computes
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=200)
    assert first.startswith("["), first
    assert process.returncode == 130
    assert err.splitlines()[-1] == "error: interrupted"
    assert "Traceback" not in err
    assert out == ""


# The whole chain, small.


@pytest.fixture(scope="module")
def analysed(tmp_path_factory) -> tuple[int, str, str, Path]:
    """Exit code, output and folder of a coarse analysis of one flight point."""
    folder = tmp_path_factory.mktemp("analysed") / "out"
    arguments = ["analyse", "horus-2b", "--mach", "2.5", "--cells", "12000", "--no-controls", "--out", str(folder)]
    command = [sys.executable, "-m", "spaceplane.cli", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=400, check=False)
    return done.returncode, done.stdout, done.stderr, folder


def test_analyse_writes_everything_and_says_what_it_found(analysed):
    code, out, err, folder = analysed
    result = json.loads((folder / "result.json").read_text())
    verdicts = {r["verdict"] for p in result["flight_points"] for r in p["convergence"]}
    assert code == (0 if verdicts == {"converged"} else 1), err
    written = {path.name for path in folder.iterdir()}
    assert written == {"result.json", "aero.nc", "geometry.stl", "surface.vtp", "report.html"}
    assert "Cm_alpha" in out and "MIL-F-8785C" in out and "report.html" in out
    assert "Traceback" not in err


def test_report_export_and_compare_read_what_analyse_wrote(capfd, analysed, tmp_path):
    folder = analysed[-1]
    (folder / "report.html").unlink()
    assert run(capfd, "report", folder)[0] == analysed[0]
    assert (folder / "report.html").stat().st_size > 100_000
    code, out, _ = run(capfd, "export", "csv", folder, "--out", tmp_path, "--json", "-")
    assert code == 0
    assert {Path(p).name for p in json.loads(out)["files"]} == {
        "coefficients.csv", "derivatives.csv", "modes.csv", "verdicts.csv", "linear_models.csv",
    }  # fmt: skip
    assert run(capfd, "export", "netcdf", folder, "--out", tmp_path)[0] == 0
    result = folder / "result.json"
    code, out, _ = run(capfd, "compare", result, result, "--json", tmp_path / "c.json")
    assert code == analysed[0]
    point = json.loads((tmp_path / "c.json").read_text())["flight_points"][0]
    assert all(row["difference"] == 0 for row in point["derivatives"])


def test_geometry_writes_what_it_says(capfd, tmp_path):
    file = tmp_path / "sub" / "b.stl"
    deflect = ["--deflect", "elevon_left=-10", "body_flap=15"]
    code, out, _ = run(
        capfd, "geometry", "horus-2b", "--set", "wing_width_m=3.5", *deflect, "--out", file, "--json", "-"
    )
    assert code == 0
    record = json.loads(out)
    assert record["deflections_deg"]["elevon_left"] == pytest.approx(-10)
    assert file.stat().st_size == 84 + 50 * record["triangles"]
    assert record["span_m"] > 13.2
    assert [p.name for p in file.parent.iterdir()] == ["b.stl"]


def test_unconverged_results_are_written_but_exit_with_1(capfd, analysed, tmp_path):
    result = json.loads((analysed[-1] / "result.json").read_text())
    result["flight_points"][0]["convergence"][0].update(verdict="oscillating", reason="forces wander")
    (tmp_path / "result.json").write_text(json.dumps(result))
    code, out, err = run(capfd, "report", tmp_path)
    assert code == 1
    assert "NOT converged" in out
    assert "not good: Mach 2.5, condition base: oscillating" in err
    assert "not converged" in (tmp_path / "report.html").read_text()
    code, _, err = run(capfd, "compare", tmp_path / "result.json", tmp_path / "result.json")
    assert code == 1
    assert "not good: Mach 2.5: flow oscillating" in err


@pytest.mark.parametrize(
    ("options", "naming"),
    [
        (["--gust", "strong"], "--gust: 'strong' is not a number (m/s)"),
        (["--gust", "0"], "gust = 0 m/s: above 0 and at most 100 m/s"),
        (["--offset", "25"], "offset = 25 deg: above 0 and at most 20 deg"),
        (["--offset", "nan"], "--offset"),
        (["--decay", "-1"], "decay = -1 1/s: 0 or above and at most 10 1/s"),
        (["--no-control", "--gust", "9"], "--gust: has no effect without --control"),
    ],
)
def test_a_feedback_is_asked_with_sense(capfd, tmp_path, options, naming):
    refused(capfd, "fly", "horus-2b-published", "--mach", "2.5", "--out", tmp_path, *options, naming=naming)
    if "--no-control" not in options:
        refused(capfd, "modes", TAEM, "--control", *options, naming=naming)
        refused(capfd, "modes", TAEM, *options, naming=options[0])


def test_modes_say_what_the_controls_can_do(capfd):
    """Without known surfaces thrusters do it: the moment goes with the offset, and comes with --control alone."""
    found = {}
    for offset in ("1", "2"):
        code, out, _ = run(capfd, "modes", TAEM, "--control", "--offset", offset, "--json", "-")
        assert code == 0
        efforts = json.loads(out)["control"]["disturbances"][0]["efforts"]
        found[offset] = next(-one["least"] for one in efforts if one["name"] == "moment_y")
    assert found["2"] == pytest.approx(2.0 * found["1"], rel=1e-9)
    assert found["1"] == pytest.approx(27385.0, rel=1e-3)
    assert "control" not in json.loads(run(capfd, "modes", TAEM, "--json", "-")[1])
    text = run(capfd, "modes", TAEM, "--control")[1]
    assert "no pitching moment of the elevator is known" in " ".join(text.split())
