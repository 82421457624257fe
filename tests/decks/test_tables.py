"""CSV and NetCDF of models."""

import csv
from dataclasses import replace

import numpy as np
import pytest

from dynamics import horus
from spaceplane.aero.model.published import horus_2b_published
from spaceplane.decks.tables import linear_dataset, write_linear_csv, write_linear_netcdf, write_model_csv
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.statespace import from_matrix
from spaceplane.errors import InputError

from .horus import complete


def rows(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def systems():
    full = linearise(horus.point(), horus.MASS, horus.REFERENCE, horus.derivatives(**horus.EXTRA))
    bare = linearise(horus.point(mach=2.0), horus.MASS, horus.REFERENCE, horus.derivatives())
    return {"TAEM": full, "Mach 2": bare}


def test_model_csv_holds_every_value(tmp_path):
    model = complete()
    hole = model.base["CD"].copy()
    hole[3, 2] = np.nan
    model = replace(model, base={**model.base, "CD": hole})
    files = {path.name for path in write_model_csv(model, tmp_path)}
    assert files == {"base.csv", "slopes.csv", "limits.csv", "README.txt", *(f"{name}.csv" for name in model.surfaces)}
    base = rows(tmp_path / "base.csv")
    assert len(base) == 50 and [r["alpha_deg"] for r in base if r["CD"] == ""] == ["15.0"]
    for row in base + rows(tmp_path / "slopes.csv"):
        i = int(np.argmin(np.abs(np.degrees(model.alpha) - float(row["alpha_deg"]))))
        j = list(model.mach).index(float(row["mach"]))
        for name, table in (model.base if "CL" in row else model.slopes).items():
            assert row[name] == "" if np.isnan(table[i, j]) else float(row[name]) == table[i, j]
    for row in rows(tmp_path / "body_flap.csv"):
        k, i = (
            int(np.argmin(np.abs(np.degrees(axis) - float(row[name]))))
            for axis, name in ((model.surfaces["body_flap"].deflection, "deflection_deg"), (model.alpha, "alpha_deg"))
        )
        value = model.surfaces["body_flap"].increments["CL"][k, i, list(model.mach).index(float(row["mach"]))]
        assert float(row["CL"]) == value
    limits = {
        row["quantity"]: (float(row["lower"]), float(row["upper"]), row["unit"])
        for row in rows(tmp_path / "limits.csv")
    }
    assert limits["mach"] == (1.5, 20.0, "1") and limits["body_flap"] == (-20.0, 30.0, "deg")
    text = (tmp_path / "README.txt").read_text()
    assert model.source in text and "wind axes" in text and "13 m behind the nose" in text and "CL_rudder_left" in text


def test_unknown_surfaces_are_named_whole(tmp_path):
    write_model_csv(horus_2b_published(), tmp_path)
    line = (tmp_path / "README.txt").read_text().splitlines()[-1]
    assert line.startswith("unknown and counted as zero: CL_q, Cm_q, ")
    assert line.endswith("Cn_elevon_right, all of rudder_left, all of rudder_right") and "CL_rudder" not in line


def test_linear_csv_rebuilds_the_matrices(systems, tmp_path):
    (path,) = write_linear_csv(systems, tmp_path)
    found = rows(path)
    for label, system in systems.items():
        for matrix, values, columns in (("A", system.A, system.states), ("B", system.B, system.inputs)):
            own = {(r["of"], r["with"]): r for r in found if r["flight_point"] == label and r["matrix"] == matrix}
            assert len(own) == values.size
            for i, state in enumerate(system.states):
                for j, column in enumerate(columns):
                    assert float(own[state, column]["value"]) == values[i, j]
    units = {(r["of"], r["with"]): r["unit"] for r in found}
    assert units["V", "alpha"] == "(m/s)/s per rad" and units["q", "moment_y"] == "(rad/s)/s per N m"


def test_linear_netcdf_keeps_names_and_units(systems, tmp_path):
    import xarray as xr

    (path,) = write_linear_netcdf(systems, tmp_path)
    with xr.open_dataset(path) as data:
        for label, system in systems.items():
            point = data.sel(flight_point=label)
            assert np.array_equal(point["A"].sel(state=list(system.states), with_state=list(system.states)), system.A)
            assert np.array_equal(point["B"].sel(input=list(system.inputs)), system.B)
            assert float(point["reference_state"].sel(state="V")) == system.reference["V"]
            assert str(point["form"].values) == system.form
        assert np.isnan(data["B"].sel(flight_point="Mach 2", input="elevator")).all()
        assert str(data["state_unit"].sel(state="R").values) == "m"
        assert str(data["input_unit"].sel(input="moment_x").values) == "N m"
        assert str(data["input_positive"].sel(input="body_flap").values) == "trailing edge down"
        assert "body axes" in data.attrs["axes"] and data["A"].attrs["units"]


def test_what_cannot_be_written_is_refused(systems):
    with pytest.raises(InputError, match="there are none"):
        linear_dataset({})
    other = from_matrix(np.eye(2), ("q", "alpha"))
    with pytest.raises(InputError, match="their states differ"):
        linear_dataset({**systems, "short": other})
    with pytest.raises(InputError, match="h: not a state or input"):
        linear_dataset({"point": from_matrix(np.eye(1), ("h",))})
