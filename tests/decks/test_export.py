"""`spaceplane export` of aerodynamic models."""

import json
import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from spaceplane import cli
from spaceplane.aero.model import netcdf
from spaceplane.aero.model.published import FOLDER, horus_2b_published
from spaceplane.decks.source import PUBLISHED, read_source
from spaceplane.errors import InputError
from spaceplane.vehicle.properties import HORUS_MASS

from .horus import complete


def run(capfd, *arguments):
    code = cli.run([str(a) for a in arguments])
    out, err = capfd.readouterr()
    return code, out, err


def refused(capfd, *arguments, naming):
    code, out, err = run(capfd, *arguments)
    assert code == 2 and out == "" and err.count("\n") == 1 and naming in err, err


@pytest.fixture
def tables(tmp_path):
    """A user's folder of tables."""
    return shutil.copytree(FOLDER, tmp_path / "tables")


@pytest.mark.parametrize(
    ("form", "files"),
    [
        ("jsbsim", {"HORUS-2B-published-tables.xml", "planet.xml"}),
        ("tudat", {"force_0_CD.dat", "force_1_CS.dat", "elevon_left_moment_1_Cm.dat", "README.txt"}),
        ("csv", {"base.csv", "slopes.csv", "body_flap.csv", "limits.csv", "README.txt"}),
        ("netcdf", {"aero_model.nc"}),
    ],
)
def test_published_tables_in_every_format(capfd, tmp_path, form, files):
    code, out, _ = run(capfd, "export", form, PUBLISHED, "--out", tmp_path / "out", "--json", "-")
    assert code == 0
    written = json.loads(out)["files"]
    assert files <= {path.rsplit("/", 1)[-1] for path in written}
    assert sorted(written) == sorted(str(path) for path in (tmp_path / "out").rglob("*") if path.is_file())


def test_mass_and_centre_reach_the_jsbsim_deck(capfd, tables, tmp_path):
    vehicle = tmp_path / "heavy.yaml"
    vehicle.write_text("base: horus-2b\nmass: {mass_kg: 31000}\nreference: {area_m2: 120}\n")
    options = ["--vehicle", vehicle, "--name", "heavy", "--center-of-mass", "12.5,0,0.1"]
    assert run(capfd, "export", "jsbsim", tables, "--out", tmp_path, *options)[0] == 0
    root = ET.parse(tmp_path / "heavy" / "heavy.xml").getroot()
    assert float(root.find("mass_balance/emptywt").text) == 31000.0
    assert float(root.find("metrics/wingarea").text) == 120.0
    for place in ("mass_balance/location", "metrics/location"):
        assert [float(x.text) for x in root.find(place)] == [12.5, 0.0, 0.1]


def test_netcdf_model_is_a_source(capfd, tmp_path):
    netcdf.save(complete(), tmp_path / "model.nc")
    run(capfd, "export", "netcdf", tmp_path / "model.nc", "--out", tmp_path / "again")
    again = netcdf.load(tmp_path / "again" / "aero_model.nc")
    assert np.array_equal(again.slopes["Cl_p"], complete().slopes["Cl_p"])
    assert read_source(str(tmp_path / "model.nc")).mass is None
    assert read_source(str(tmp_path / "model.nc"), "horus-2b").mass == HORUS_MASS


@pytest.mark.parametrize(("form", "file"), [("jsbsim", "b.xml"), ("tudat", "README.txt"), ("csv", "README.txt")])
def test_a_derivatives_file_says_that_its_moment_centre_is_no_known_place(capfd, tmp_path, form, file):
    source = Path(__file__).parents[2] / "examples" / "boeing747_cruise.toml"
    name = ["--name", "b"] if form == "jsbsim" else []
    assert run(capfd, "export", form, source, *name, "--out", tmp_path)[0] == 0
    [path] = tmp_path.rglob(file)
    text = path.read_text()
    assert "moments about the centre of mass; where it lies in the vehicle is not known" in text
    assert "m behind the nose" not in text and "m, body axes, from the nose" not in text
    assert "on dalpha/dt c_ref/2V): CL_alphadot = -5.9, Cm_alphadot = -6.314" in text
    assert "mach 0.6 to 1" in text and "alpha -5 to 5 deg" in text  # as docs/decks.md says
    assert "5 deg and Mach 0.2 of its flight point" in (source.parents[1] / "docs" / "decks.md").read_text()


def test_sources(tables):
    published = read_source(PUBLISHED)
    assert published.mass == HORUS_MASS and published.model.name == horus_2b_published().name
    user = read_source(str(tables), "horus-2b").model
    assert np.array_equal(user.base["CL"], published.model.base["CL"])
    with pytest.raises(InputError, match="--vehicle: needed"):
        read_source(str(tables))


def test_refusals(capfd, tables, tmp_path):
    out = tmp_path / "out"
    netcdf.save(complete(), tmp_path / "model.nc")
    model = tmp_path / "model.nc"
    refused(capfd, "export", "jsbsim", model, "--out", out, naming="--vehicle: needed")
    refused(capfd, "export", "tudat", PUBLISHED, naming="--out: needed")
    refused(capfd, "export", "tudat", "horus-2b-publish", "--out", out, naming="'horus-2b-published'")
    refused(capfd, "export", "tudat", tmp_path / "none.nc", "--out", out, naming="none.nc")
    refused(capfd, "export", "tudat", tmp_path, "--out", out, naming="CL0.csv")
    refused(capfd, "export", "csv", tables, "--out", out, naming="--vehicle: needed")
    refused(capfd, "export", "csv", PUBLISHED, "--vehicle", "horus-2b", "--out", out, naming="--vehicle: has no effect")
    refused(capfd, "export", "csv", tmp_path, "--vehicle", "horus-2b", "--out", out, naming="--vehicle: an analysis")
    for option, value in (("--name", "x"), ("--center-of-mass", "13,0,0")):
        refused(capfd, "export", "tudat", PUBLISHED, option, value, "--out", out, naming=option)
    refused(capfd, "export", "jsbsim", PUBLISHED, "--name", "a/b", "--out", out, naming="a/b")
    refused(capfd, "export", "jsbsim", PUBLISHED, "--center-of-mass", "13,0", "--out", out, naming="--center-of-mass")
    refused(capfd, "export", "jsbsim", PUBLISHED, "--center-of-mass", "13,1,0", "--out", out, naming="y = 1 m")
    refused(capfd, "export", "jsbsim", PUBLISHED, "--vehicle", "horus", "--out", out, naming="horus-2b")
    (tmp_path / "bad.nc").write_text("no")
    refused(capfd, "export", "csv", tmp_path / "bad.nc", "--out", out, naming="bad.nc")
    assert not out.exists()
