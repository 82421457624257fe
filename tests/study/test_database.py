"""The database as a study: what is stored is not computed again, what is cut short goes on, and its folder is whole."""

import json
import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from spaceplane import cli
from spaceplane.aero.model import netcdf
from spaceplane.analysis.tables import solve
from spaceplane.analysis.tables.settings import default_settings
from spaceplane.decks.source import read_source
from spaceplane.errors import InputError
from spaceplane.mesh.settings import MeshSettings
from spaceplane.study.database import run, with_one_wall_cell
from spaceplane.vehicle.presets import horus_2b, load

VEHICLE = horus_2b()
SMALL = ["--tier", "fast", "--mach", "4,8", "--alpha", "10,24", "--elevon", "-15,15", "--rudder", "none"]


def radians(*degrees):
    return tuple(math.radians(d) for d in degrees)


@pytest.fixture
def settings():
    moved = {"elevon_left": radians(-15.0, 15.0), "body_flap": radians(20.0)}
    return default_settings("fast", machs=(4.0, 8.0), alphas=radians(10.0, 25.0), deflections=moved)


class Counting:
    """Computes blocks, remembers which, and stops at the one after `most`."""

    def __init__(self, most=99):
        self.seen, self.most = [], most

    def __call__(self, inputs):
        if len(self.seen) == self.most:
            raise KeyboardInterrupt
        self.seen.append((inputs["surface"], inputs["deflection_deg"]))
        return solve.evaluate(inputs)


def test_a_killed_run_keeps_what_it_had_and_a_second_computes_nothing(settings, tmp_path):
    store = tmp_path / "store.sqlite"
    first, second, third = Counting(2), Counting(), Counting()
    with pytest.raises(KeyboardInterrupt):
        run(VEHICLE, settings, store, evaluate=first)
    assert first.seen == [("", 0.0), ("elevon_left", -15.0)]
    found = run(VEHICLE, settings, store, evaluate=second)
    assert second.seen == [("elevon_left", 15.0), ("body_flap", 20.0)] and (found.computed, found.reused) == (2, 2)
    again = run(VEHICLE, settings, store, evaluate=third)
    assert third.seen == [] and (again.computed, again.reused) == (0, 4)
    for name, table in found.model.base.items():
        np.testing.assert_array_equal(table, again.model.base[name])
    assert found.remarks == () and found.conditions == 4 * 6 + 3 * 4


def test_one_more_deflection_costs_one_more_block_and_another_shape_all(settings, tmp_path):
    store = tmp_path / "store.sqlite"
    run(VEHICLE, settings, store)
    wider = replace(settings, deflections={**settings.deflections, "rudder_left": radians(20.0)})
    found = run(VEHICLE, wider, store)
    assert (found.computed, found.reused) == (1, 4)
    other = run(load("horus-2b", {"wing_width_m": 3.9}), replace(settings, deflections={}), store)
    assert (other.computed, other.reused) == (1, 0)


def test_a_block_that_cannot_be_computed_leaves_its_cells_empty(settings, tmp_path):
    def broken(inputs):
        if inputs["surface"] == "body_flap":
            raise InputError("no mesh about this")
        return solve.evaluate(inputs)

    found = run(VEHICLE, settings, tmp_path / "store.sqlite", evaluate=broken)
    assert [r.reason for r in found.remarks] == ["no mesh about this"]
    assert np.isnan(found.model.surfaces["body_flap"].increments["CL"][1]).all()

    def nothing(inputs):
        raise InputError("no mesh at all")

    with pytest.raises(InputError, match=r"undeflected vehicle has no result.*no mesh at all"):
        run(VEHICLE, settings, tmp_path / "none.sqlite", evaluate=nothing)


def test_the_shapes_of_one_database_have_one_wall_cell():
    asked = default_settings("euler", mesh=MeshSettings(target_cells=8000, growth_layers=1))
    found = with_one_wall_cell(VEHICLE, asked)
    assert found.mesh.target_cells is None and 0.5 < found.mesh.wall_cell < 2.0
    assert with_one_wall_cell(VEHICLE, found) is found


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Made by the command, in a heavier vehicle with another moment centre."""
    place = tmp_path_factory.mktemp("database")
    vehicle = place / "heavy.yaml"
    vehicle.write_text(
        "base: horus-2b\nmass: {mass_kg: 31000, Ixz_kgm2: -6.0e4}\nreference: {moment_center_station_m: 14.8}\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "spaceplane.cli", "database", vehicle, *SMALL, "--out", place / "out"],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert "8 blocks, 0 from the store" in done.stdout and "database.html" in done.stdout
    return place / "out"


def test_the_folder_holds_model_tables_vehicle_and_page(folder):
    names = {path.name for path in folder.iterdir()}
    assert {"model.nc", "database.json", "database.html", "csv", "coefficients.png", "slopes.png"} <= names
    assert {"base.csv", "slopes.csv", "elevon_left.csv", "README.txt"} <= {p.name for p in (folder / "csv").iterdir()}
    record = json.loads((folder / "database.json").read_text())
    assert record["settings"]["machs"] == [4.0, 8.0] and record["not_converged"] == []
    assert record["settings"]["deflections_deg"]["elevon_left"] == [-15.0, 0.0, 15.0]
    page = (folder / "database.html").read_text()
    assert page.count("<img") == 3 and "All of rudder_left" not in page and "all of rudder_left" in page


def test_its_vehicle_goes_with_it(folder):
    source = read_source(str(folder))
    assert (source.mass.mass, source.mass.Ixz) == (31000.0, -6.0e4)
    assert source.model.reference.moment_center == (14.8, 0.0, 0.0)
    assert read_source(str(folder), "horus-2b").mass.mass == 26000.0
    loaded = netcdf.load(folder / "model.nc")
    np.testing.assert_array_equal(loaded.base["Cm"], source.model.base["Cm"])


def run_cli(capfd, *arguments):
    code = cli.run([str(a) for a in arguments])
    out, err = capfd.readouterr()
    return code, out, err


def test_it_flies_and_exports_without_a_vehicle(capfd, folder, tmp_path):
    code, _, err = run_cli(capfd, "fly", folder, "--mach", "4,5,8", "--out", tmp_path / "fly")
    assert code == 0, err
    record = json.loads((tmp_path / "fly" / "descent.json").read_text())
    assert [bool(point["trim"]) for point in record["points"]] == [True, True, False]
    assert "outside the tables" in record["points"][2]["reason"]
    for form in ("jsbsim", "tudat", "csv", "netcdf"):
        assert run_cli(capfd, "export", form, folder, "--out", tmp_path / form)[0] == 0


def test_the_centre_of_mass_of_a_flight_may_be_another(capfd, folder, tmp_path):
    """The pitching moment about it is zero at the trim, and the trim is not that of another centre."""
    model, alpha, found = read_source(str(folder)).model, math.radians(24.0), {}
    for station in (14.8, 14.6):
        options = ["--mach", "5", "--center-of-mass", f"{station},0,0.1", "--out", tmp_path]
        assert run_cli(capfd, "fly", folder, *options)[0] == 0
        trim = json.loads((tmp_path / "descent.json").read_text())["points"][0]["trim"]
        elevator, flap = (math.radians(trim[name]) for name in ("elevator_deg", "body_flap_deg"))
        deflections = {"elevon_left": elevator, "elevon_right": elevator, "body_flap": flap}
        C = model.coefficients(5.0, alpha, deflections=deflections)
        normal = C["CL"] * math.cos(alpha) + C["CD"] * math.sin(alpha)
        axial = C["CD"] * math.cos(alpha) - C["CL"] * math.sin(alpha)
        assert C["Cm"] + (normal * (station - 14.8) - axial * 0.1) / 23.0 == pytest.approx(0.0, abs=1e-9)
        found[station] = elevator + flap
    # Further forward the nose is heavier: trailing edges go up.
    assert found[14.6] < found[14.8] - 0.01
    code, _, err = run_cli(capfd, "fly", folder, "--center-of-mass", "14.8", "--out", tmp_path)
    assert code == 2 and "--center-of-mass: '14.8' has 1 numbers, 3 are needed" in err


def test_the_same_command_again_computes_nothing_and_tells_the_record(capfd, folder):
    options = [folder.parent / "heavy.yaml", *SMALL, "--out", folder]
    code, out, _ = run_cli(capfd, "database", *options, "--json", "-")
    assert code == 0 and json.loads(out) == json.loads((folder / "database.json").read_text())
    code, out, _ = run_cli(capfd, "database", *options)
    assert code == 0 and "8 blocks, 8 from the store" in out


@pytest.mark.parametrize(
    ("options", "naming"),
    [
        (["--tier", "slow"], "--tier: unknown tier 'slow'"),
        (["--mach", "2,1.5"], "--mach: 2, 1.5, must increase"),
        (["--mach", ""], "--mach: empty"),
        (["--mach", "two"], "--mach: 'two' is not a number"),
        (["--alpha", "0,120"], "alpha = 120 deg: allowed -90 to 90 deg"),
        (["--alpha", "10"], "alpha = 10: two or more"),
        (["--elevon", "60"], "elevon_left = 60 deg"),
        (["--rudder", "-10"], "rudder_left = -10 deg"),
        (["--body-flap", ""], "--body-flap: empty"),
        (["--workers", "0"], "--workers: 0"),
        (["--method", "tangent"], "--method: tangent, goes with --tier fast only"),
        (["--tier", "fast", "--cell", "0.3"], "--cell: 0.3, goes with --tier euler only"),
        (["--tier", "fast", "--friction", "off"], "--friction: off, goes with --tier euler only"),
        (["--tier", "fast", "--mach", "1.5,3"], "--mach: 1.5"),
        (["--cell", "-1"], "--cell: -1"),
        (["--mach", "0.3,2"], "--mach: 0.3, the altitude table"),
        (["--altitude", "high"], "--altitude"),
    ],
)
def test_bad_input_is_one_line(capfd, tmp_path, options, naming):
    code, out, err = run_cli(capfd, "database", "horus-2b", *options, "--out", tmp_path / "out")
    assert code == 2 and out == "" and err.count("\n") == 1 and naming in err, err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("source", ["horus-2b", "mine.yaml"])
def test_a_vehicle_is_told_to_make_its_database_first(capfd, tmp_path, source):
    for command in (["fly", source], ["export", "jsbsim", source], ["export", "csv", source]):
        code, _, err = run_cli(capfd, *command, "--out", tmp_path)
        assert code == 2 and f"run `spaceplane database {source} --out DIR` first" in err, err


@pytest.mark.parametrize(
    ("text", "naming"),
    [
        ("{", "cannot be read"),
        ("[]", "schema None"),
        ('{"schema": "spaceplane.database", "schema_version": 2}', "version 2, not"),
        ('{"schema": "spaceplane.database", "schema_version": 1}', "'vehicle' is missing"),
    ],
)
def test_a_damaged_record_is_refused(folder, tmp_path, text, naming):
    import shutil

    damaged = shutil.copytree(folder, tmp_path / "damaged")
    (damaged / "database.json").write_text(text)
    with pytest.raises(InputError, match=naming):
        read_source(str(damaged))
