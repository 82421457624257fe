from dataclasses import dataclass

import numpy as np
import pytest
import xarray as xr

from spaceplane.aero.conditions import DerivativeSteps, plan
from spaceplane.aero.database import AeroDatabase, SolvedCases, assemble
from spaceplane.aero.derivatives import Move, by_symmetry, control_derivatives, differentiate
from spaceplane.aero.integrate import integrate
from spaceplane.errors import InputError


@dataclass(frozen=True)
class Point:
    mach: float
    alpha: float = 0.2
    beta: float = 0.0


def wavy(center, mach, alpha, beta):
    return np.sin(center @ [1.0, 2.0, 3.0] + mach) * (1.0 + alpha + beta)


@pytest.fixture
def database(make_solution, box, lengths) -> AeroDatabase:
    made = plan([Point(0.8), Point(2.5)], DerivativeSteps())
    c = made.conditions
    data = integrate(make_solution(box, wavy, c.mach, c.alpha, c.beta, spread=1e-3), lengths)
    base = data.isel(condition=[p.base for p in made.points])
    moved = integrate(make_solution(box, wavy, [0.8, 2.5], 0.21, 0.0), lengths)
    controls = control_derivatives(by_symmetry({"elevon_left": [Move(0.1, base, moved)]}))
    slopes = xr.merge([differentiate(data, made), controls])
    blocks = [
        SolvedCases(data, made.labels, made.point, {"body_flap": -0.35}),
        SolvedCases(moved, ["elevon_left+"] * 2, [0, 1], {"body_flap": -0.35, "elevon_left": 0.1}),
    ]
    return assemble(blocks, slopes, ["Mach 0.8", "Mach 2.5"], "0.1.0")


def test_round_trip_keeps_every_value_and_attribute(database, tmp_path):
    database.save(tmp_path / "aero.nc")
    again = AeroDatabase.load(tmp_path / "aero.nc")
    xr.testing.assert_identical(database.data, again.data)


def test_cases_are_found_by_flight_point_label_and_deflection(database):
    data = database.data
    assert data.sizes == {"case": 14, "part": 4, "point": 2}
    chosen = data.sel(case=(data.flight_point == "Mach 2.5") & (data.label == "alpha+"))
    assert float(chosen.alpha[0]) == pytest.approx(0.2 + DerivativeSteps().alpha)
    deflected = data.sel(case=data.elevon_left > 0.05)
    assert list(deflected.label.values) == ["elevon_left+"] * 2
    assert float(data.CL_alpha.sel(point="Mach 0.8", part="total")) != 0.0


def test_every_variable_carries_units(database):
    for name, variable in database.data.data_vars.items():
        if not name.endswith("_status"):
            assert "units" in variable.attrs, name


def test_bad_files_and_folders_are_named(database, tmp_path):
    with pytest.raises(InputError, match="nowhere"):
        database.save(tmp_path / "nowhere" / "aero.nc")
    (tmp_path / "text.nc").write_text("no data")
    with pytest.raises(InputError, match=r"text\.nc"):
        AeroDatabase.load(tmp_path / "text.nc")
    xr.Dataset().to_netcdf(tmp_path / "other.nc")
    with pytest.raises(InputError, match="schema"):
        AeroDatabase.load(tmp_path / "other.nc")
