"""The published HORUS-2B tables as a model, table sets of users, and the model's file."""

import math
import shutil
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from tests.aero.model import linear

from spaceplane.aero.model import netcdf
from spaceplane.aero.model.derivatives import per_degree
from spaceplane.aero.model.model import OutsideTables
from spaceplane.aero.model.published import FOLDER, horus_2b_published
from spaceplane.aero.model.table_set import read_table, read_table_set
from spaceplane.errors import InputError

# Thesis Table 6.1, per degree and per unit Mach, Mach 2.5, alpha 16.6 deg.
BASE = {"CD_alpha": 0.019, "CL_alpha": 0.033, "Cm_alpha": 0.0004, "CD_M": -0.045, "CL_M": -0.105, "Cm_M": 0.015}
BODY_FLAP = {"CD_alpha": -0.0007, "CL_alpha": -0.0003, "Cm_alpha": 0.00011}
ELEVON_PAIR = {"CD_alpha": -0.0004, "CL_alpha": -0.0004, "Cm_alpha": 0.0002}
TAEM = (2.5, math.radians(16.6))


def slopes(deflections):
    found = horus_2b_published().derivatives(*TAEM, deflections)
    return per_degree({name: getattr(found, name) for name in BASE})


@pytest.mark.parametrize("name", [name for name in BASE if name.endswith("_alpha")])
def test_slopes_are_the_rows_of_table_6_1(name):
    flap, elevons = math.radians(-20.0), math.radians(-10.0)
    clean = slopes({})[name]
    assert clean == pytest.approx(BASE[name], abs=1e-6)
    assert slopes({"body_flap": flap})[name] - clean == pytest.approx(BODY_FLAP[name], abs=1e-6)
    both = {"elevon_left": elevons, "elevon_right": elevons}
    assert slopes(both)[name] - clean == pytest.approx(ELEVON_PAIR[name], abs=1e-6)


def test_mach_slopes_are_the_row_of_table_6_1():
    found = horus_2b_published().derivatives(2.5, math.radians(20.0))
    at_20 = {name: getattr(found, name) for name in BASE if name.endswith("_M")}
    found = horus_2b_published().derivatives(2.5, math.radians(15.0))
    at_15 = {name: getattr(found, name) for name in BASE if name.endswith("_M")}
    for name in ("CD_M", "CL_M", "Cm_M"):  # printed for 16.6 deg: the mean of both
        assert (at_15[name] + at_20[name]) / 2 == pytest.approx(BASE[name], abs=1e-6)


def test_lateral_point_is_constant_and_said_to_be():
    model = horus_2b_published()
    found = model.coefficients(10.0, 0.5, beta=math.radians(1.0))
    assert (found["CY"], found["Cl"], found["Cn"]) == pytest.approx((-0.01725, -0.00139, -0.00048), abs=1e-15)
    assert "Mach 2.5, alpha 16.6 deg only" in model.source
    assert "Cl, Cn of a single elevon unknown" in model.source
    assert {"Cl_elevon_left", "Cn_elevon_right", "Cm_q", "Cn_rudder_left"} <= set(model.unknown())


def test_values_are_the_printed_ones():
    model = horus_2b_published()
    both = {"elevon_left": math.radians(-40.0), "elevon_right": math.radians(-40.0)}
    found = model.coefficients(2.0, math.radians(10.0), deflections=both)
    assert found["CL"] == pytest.approx(0.26 - 2 * 0.034)
    assert found["Cm"] == pytest.approx(-0.016 + 2 * 0.0099)
    assert model.coefficients(1.5, math.radians(40.0))["CD"] == pytest.approx(1.32)
    with pytest.raises(OutsideTables, match=r"mach = 1\.2: outside the tables, which run from 1\.5 to 20"):
        model.coefficients(1.2, 0.2)
    with pytest.raises(InputError, match=r"rudder_left = .* has no table"):
        model.coefficients(2.0, 0.2, deflections={"rudder_left": 0.1})


@pytest.fixture
def folder(tmp_path):
    return shutil.copytree(FOLDER, tmp_path / "set")


def test_a_users_table_set_with_rudders_and_slopes_on_the_grid(folder):
    grid = "delta_deg,alpha_deg,M1.5,M2,M3,M10,M20"
    alphas = range(0, 50, 5)
    rows = [f"{d},{a},{','.join([str(d * -0.001)] * 5)}" for d in (0, 40) for a in alphas]
    (folder / "dCn_one_rudder.csv").write_text("\n".join([grid, *rows]))
    lines = [f"{m},{a},{-0.001 * m},-0.3" for m in (1.5, 2, 3, 10, 20) for a in alphas if (m, a) != (20, 45)]
    (folder / "slopes.csv").write_text("\n".join(["mach,alpha_deg,Cn_beta_per_deg,Cl_p", *lines]))
    model = read_table_set(folder, linear.REFERENCE)
    right = model.coefficients(2.0, 0.2, deflections={"rudder_right": math.radians(20.0)})
    left = model.coefficients(2.0, 0.2, deflections={"rudder_left": math.radians(20.0)})
    assert (left["Cn"], right["Cn"]) == pytest.approx((-0.02, 0.02))
    assert model.coefficients(3.0, 0.2, beta=0.02)["Cn"] == pytest.approx(-0.003 * math.degrees(0.02))
    assert model.coefficients(3.0, 0.2, rates=(0.1, 0.0, 0.0))["Cl"] == pytest.approx(-0.03)
    with pytest.raises(OutsideTables, match="Cn_beta: the tables of set are empty"):
        model.coefficients(20.0, math.radians(45.0), beta=0.01)


def test_empty_cells_are_unknown(folder):
    text = (folder / "CD0.csv").read_text().replace("45,1.32,", "45,,")
    (folder / "CD0.csv").write_text(text)
    model = read_table_set(folder, linear.REFERENCE)
    with pytest.raises(OutsideTables, match=r"CD: the tables of set are empty at Mach 1.5, alpha 42 deg"):
        model.coefficients(1.5, math.radians(42.0))
    assert model.coefficients(2.0, math.radians(42.0))["CD"] > 1.0


@pytest.mark.parametrize(
    ("name", "old", "new", "message"),
    [
        ("CL0.csv", "0.16", "O.16", r"CL0.csv, row 3: M1.5 = 'O.16': must be a number"),
        ("CL0.csv", "M1.5", "Mach", "M.*must be a number"),
        ("CD0.csv", "45,1.32", "46,1.32", "alpha_deg differ"),
        ("dCm_bodyflap.csv", "-10,5,", "-10,0,", "row 13: delta_deg -10, alpha_deg 0 stands in row 12 already"),
        ("dCm_bodyflap.csv", "-10,5,", "-10,6,", "dCm_bodyflap.csv: no row for delta_deg -20, alpha_deg 6"),
        ("CD0.csv", "\n5,", "\n0,", "CD0.csv, row 3: alpha_deg 0 stands in row 2 already"),
        ("CD0.csv", "M2,M3", "M3,M2", "CD0.csv, row 1: M2 follows M3; Mach numbers must increase"),
        ("CD0.csv", "M2,M3", "M2,M2.0", "CD0.csv, row 1: M2.0 follows M2"),
        ("CL0.csv", "M1.5", "M-1.5", "CL0.csv, row 1: M-1.5: Mach numbers must not be negative"),
        ("CD0.csv", "M2,M3", "2,M3", "CD0.csv, row 1: column '2': must be M and a Mach number"),
        ("CD0.csv", "5,0.1,0.09", "5,0.1,-0.09", "CD0.csv, row of alpha_deg 5, column M2: CD = -0.09: must be above 0"),
        ("CD0.csv", "5,0.1,0.09", "5,0.1,0", "column M2: CD = 0: must be above 0"),
        ("slopes.csv", "CY_beta_per_deg,", "CY_beta_per_degree,", "did you mean 'CY_beta_per_deg'"),
        ("dCm_bodyflap.csv", "-10,0,0.0056", "-10,0,1,0.0056", "has 8 cells, needed are 7"),
        ("dCL_bodyflap.csv", "\n20,", "\n21,", "deflections differ"),
        ("slopes.csv", "Cn_beta", "Cn_betta", "did you mean 'Cn_beta_per_deg'"),
        ("dCm_bodyflap.csv", "0,5,0,0,0,0,0", "0,5,0,0.1,0,0,0", "dCm_bodyflap.csv, row 23: M2 = 0.1: must be 0"),
    ],
)
def test_damaged_table_sets_are_refused(folder, name, old, new, message):
    text = (folder / name).read_text()
    assert old in text
    (folder / name).write_text(text.replace(old, new, 1 if old != "\n20," else -1))
    with pytest.raises(InputError, match=message) as caught:
        read_table_set(folder, linear.REFERENCE)
    assert "\n" not in str(caught.value)


def test_a_table_needs_two_angles_two_mach_numbers_and_no_deflection(folder):
    for name, text, message in (
        ("CL0.csv", "alpha_deg,M2\n0,0.1\n5,0.2\n", "CL0.csv, row 1: M2 is the only Mach number; at least two"),
        ("CL0.csv", "alpha_deg,M2,M3\n5,0.1,0.1\n", "CL0.csv: alpha_deg 5 is the only one; at least two"),
        ("dCm_bodyflap.csv", "delta_deg,alpha_deg,M2,M3\n5,0,0,0\n5,5,0,0\n", "bodyflap.csv: no row of delta_deg 0"),
    ):
        with pytest.raises(InputError, match=message):
            (folder / name).write_text(text)
            read_table(folder / name)


def test_missing_and_misspelt_files(folder, tmp_path):
    with pytest.raises(InputError, match="is not a folder"):
        read_table_set(tmp_path / "nowhere", linear.REFERENCE)
    (folder / "dCL_bodyflap.csv").rename(folder / "dCL_body_flap.csv")
    with pytest.raises(InputError, match=r"did you mean 'dCL_bodyflap.csv'"):
        read_table_set(folder, linear.REFERENCE)
    (folder / "dCL_body_flap.csv").unlink()
    (folder / "Cm0.csv").unlink()
    with pytest.raises(InputError, match=r"Cm0.csv: cannot be read"):
        read_table_set(folder, linear.REFERENCE)


def of_a_derivatives_file():
    return replace(linear.model(), lag=(0.6, -0.7), center_known=False)


@pytest.mark.parametrize("make", [horus_2b_published, linear.model, of_a_derivatives_file])
def test_file_gives_the_model_back(make, tmp_path):
    model = make()
    netcdf.save(model, tmp_path / "model.nc")
    back = netcdf.load(tmp_path / "model.nc")
    assert (back.name, back.source, back.reference) == (model.name, model.source, model.reference)
    assert (back.lag, back.center_known) == (model.lag, model.center_known)
    assert back.beta_limit == model.beta_limit and back.unknown() == model.unknown()
    for one, other in ((model.base, back.base), (model.slopes, back.slopes)):
        assert set(one) == set(other) and all(np.array_equal(one[n], other[n]) for n in one)
    for name, surface in model.surfaces.items():
        assert np.array_equal(surface.deflection, back.surfaces[name].deflection)
        assert all(np.array_equal(t, back.surfaces[name].increments[c]) for c, t in surface.increments.items())
    with xr.open_dataset(tmp_path / "model.nc") as data:
        for name, variable in data.data_vars.items():
            assert {"units", "axes", "positive", "reference", "long_name"} <= set(variable.attrs), name
        assert all("units" in data[c].attrs for c in data.coords)


def test_files_that_are_no_models(tmp_path):
    with pytest.raises(InputError, match="not a readable NetCDF file"):
        netcdf.load(tmp_path / "none.nc")
    xr.Dataset(attrs={"schema": "other"}).to_netcdf(tmp_path / "other.nc")
    with pytest.raises(InputError, match="schema other"):
        netcdf.load(tmp_path / "other.nc")
    netcdf.to_dataset(linear.model()).drop_vars("CD").to_netcdf(tmp_path / "part.nc")
    with pytest.raises(InputError, match="CD"):
        netcdf.load(tmp_path / "part.nc")


def in_degrees(name):
    return lambda data: data.assign_coords({name: (name, np.degrees(data[name].values), {"units": "deg"})})


def without_units(name):
    def change(data):
        del data[name].attrs["units"]
        return data

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (in_degrees("alpha"), "alpha: units are 'deg'; needed are 'rad'"),
        (in_degrees("deflection_body_flap"), "deflection_body_flap: units are 'deg'; needed are 'rad'"),
        (without_units("alpha"), "alpha: has no units; needed is 'rad'"),
        (without_units("Cn_beta"), "Cn_beta: has no units; needed is '1/rad'"),
        (lambda d: d.assign(Cl_beta=d.Cl_beta.assign_attrs(units="1/deg")), "Cl_beta: units are '1/deg'"),
        (lambda d: d.assign(mach=d.mach.assign_attrs(units="days")), "mach: units are 'days'; needed are '1'"),
        (lambda d: d.rename(Cn_beta="Cnbeta"), "unknown variable 'Cnbeta': did you mean 'Cn_beta'"),
        (lambda d: d.rename(dCm_body_flap="dCm_bodyflap"), "did you mean 'dCm_body_flap'"),
        (lambda d: d.rename(deflection_body_flap="deflection_bodyflap"), "did you mean 'deflection_body_flap'"),
        (lambda d: d.assign(CD=d.CD.isel(alpha=0, drop=True)), "CD: its dimensions are mach; needed are alpha, mach"),
        (lambda d: d.assign(CD=d.CD.astype(str)), "CD: holds .*; numbers are needed"),
        (lambda d: d.drop_vars("alpha"), "alpha is missing"),
        (lambda d: d.drop_vars("deflection_body_flap"), "deflection_body_flap is missing"),
        (lambda d: d.drop_attrs(deep=False).assign_attrs(schema="spaceplane.aero_model", schema_version=1), "name is"),
        (lambda d: d.assign_attrs(b_ref_m="thirteen"), "b_ref_m = 'thirteen': must be a finite number"),
        (lambda d: d.assign_attrs(c_ref_m=math.nan), "c_ref_m = .*nan.*: must be a finite number"),
        (lambda d: d.assign_attrs(reference_area_m2=-110.0), "reference_area_m2 = -110: must be above 0"),
        (lambda d: d.assign_attrs(beta_limit_rad="ten"), "beta_limit_rad = 'ten'"),
        (lambda d: d.assign_attrs(moment_center_m=[13.0, 0.0]), "moment_center_m = .*: must be three finite numbers"),
        (lambda d: d.assign_attrs(moment_center_m="13 0 0"), "moment_center_m = '13 0 0': must be three"),
    ],
)
def test_files_of_other_units_names_and_sizes_are_refused(change, message, tmp_path):
    path = tmp_path / "model.nc"
    change(netcdf.to_dataset(linear.model())).to_netcdf(path)
    with pytest.raises(InputError, match=message) as caught:
        netcdf.load(path)
    assert str(caught.value).startswith(f"{path}: ") and "\n" not in str(caught.value)


def test_what_has_no_dimension_needs_no_units(tmp_path):
    data = netcdf.to_dataset(linear.model())
    for name in ("mach", "CL", "Cl_p", "dCm_body_flap"):
        del data[name].attrs["units"]
    data.to_netcdf(tmp_path / "model.nc")
    assert np.array_equal(netcdf.load(tmp_path / "model.nc").base["CL"], linear.model().base["CL"])
