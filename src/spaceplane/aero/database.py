"""The aerodynamic database: every case that was solved and every derivative made from them, in one NetCDF file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.errors import InputError
from spaceplane.vehicle.controls import CONTROLS

if TYPE_CHECKING:
    import xarray as xr

SCHEMA = "spaceplane.aero"
SCHEMA_VERSION = 1


@dataclass(frozen=True)
class SolvedCases:
    """Coefficients of one body in one ensemble and what they are for.

    Attributes:
        coefficients: what `integrate` gave, dims (condition, part).
        labels: [condition] such as base, alpha+, elevon_left+.
        point: [condition] index of the flight point.
        deflections: control surface to deflection, rad.
    """

    coefficients: xr.Dataset
    labels: Sequence[str]
    point: Sequence[int]
    deflections: dict[str, float]


@dataclass(frozen=True)
class AeroDatabase:
    """Coefficients of all cases and derivatives at all flight points.

    Attributes:
        data: Dataset. Along `case` (with the coordinates label, flight_point, mach, alpha, beta, the five deflections
            and verdict) the coefficients by part and their `<name>_spread`; along `point` the derivatives by
            part with `_error`, `_step` and `_status`. Every value has units, axes, positive and reference.
    """

    data: xr.Dataset

    def save(self, path: Path | str) -> None:
        """Write NetCDF 4.

        Raises:
            InputError: the file cannot be written.
        """
        try:
            self.data.to_netcdf(path, engine="netcdf4")
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror or error})") from error

    @classmethod
    def load(cls, path: Path | str) -> AeroDatabase:
        """Read what `save` wrote.

        Raises:
            InputError: not there, not NetCDF, or of another schema.
        """
        try:
            import xarray as xr

            with xr.open_dataset(path, engine="netcdf4") as file:
                data = file.load()
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: not a readable NetCDF file ({error})") from error
        found = (data.attrs.get("schema"), data.attrs.get("schema_version"))
        if found != (SCHEMA, SCHEMA_VERSION):
            raise InputError(f"{path}: schema {found[0]} version {found[1]}, not {SCHEMA} version {SCHEMA_VERSION}")
        return cls(data)


def assemble(
    cases: Sequence[SolvedCases], derivatives: xr.Dataset, points: Sequence[str], version: str = ""
) -> AeroDatabase:
    """Join all cases and derivatives into one AeroDatabase.

    Args:
        cases: the ensembles, all on the same parts and reference lengths.
        derivatives: dims (point, part), one entry of `point` per name in `points`.
        points: names of the flight points.
        version: of the program, kept as an attribute.
    """
    pieces = []
    for block in cases:
        count = block.coefficients.sizes["condition"]
        coordinates = {
            "label": ("case", list(block.labels)),
            "flight_point": ("case", [points[i] for i in block.point]),
        }
        for name in CONTROLS:
            value = np.full(count, float(block.deflections.get(name, 0.0)))
            coordinates[name] = ("case", value, {"units": "rad", "long_name": f"deflection of {name}"})
        pieces.append(block.coefficients.rename(condition="case").assign_coords(coordinates))
    import xarray as xr

    joined = xr.concat(pieces, dim="case", combine_attrs="override", join="exact")
    data = xr.merge([joined, derivatives.assign_coords(point=list(points))], join="exact", combine_attrs="override")
    data.attrs |= {"schema": SCHEMA, "schema_version": SCHEMA_VERSION, "spaceplane_version": version}
    return AeroDatabase(data)
