"""An aerodynamic database, for people and machines: model.nc, database.json, CSV tables, pictures and one HTML page."""

from __future__ import annotations

import html
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any, Protocol

from spaceplane.aero.model.model import AeroModel
from spaceplane.analysis.tables.assemble import Remark
from spaceplane.analysis.tables.settings import EULER, TableSettings
from spaceplane.analysis.tables.solve import Block
from spaceplane.decks import folder as model_folder
from spaceplane.decks import statement
from spaceplane.decks.tables import write_model_csv
from spaceplane.files import renamed_when_done, told, write_text
from spaceplane.plain import degrees, plain
from spaceplane.report.model_figures import pictures
from spaceplane.report.plain_page import Table, document, picture_html, table_html
from spaceplane.vehicle.presets import Vehicle

PAGE = "database.html"
CSV_FOLDER = "csv"
_BELOW = {
    "coefficients": "Coefficients over the angle of attack",
    "increments": "Increments by control surfaces",
    "slopes": "Slopes with sideslip and rates",
}


class Found(Protocol):
    """What a computed database holds, see `study.database.Database`."""

    vehicle: Vehicle
    settings: TableSettings
    model: AeroModel
    blocks: tuple[Block, ...]
    results: tuple[dict | None, ...]
    remarks: tuple[Remark, ...]


def write(found: Found, out_dir: Path | str) -> dict[str, Path]:
    """Write model.nc, database.json, csv/, the pictures and database.html; return paths by name.

    Raises:
        InputError: the folder cannot be written.
    """
    target = Path(out_dir)
    drawn = pictures(found.model)
    paths = {"model": target / model_folder.MODEL_FILE, "json": target / model_folder.RECORD_FILE}
    paths |= {"csv": target / CSV_FOLDER, "html": target / PAGE}
    paths |= {name: target / f"{name}.png" for name in drawn}
    with told(target):
        model_folder.write(found.model, found.vehicle, _computed(found), target)
        write_model_csv(found.model, paths["csv"])
        for name, data in drawn.items():
            with renamed_when_done(paths[name]) as partial:
                partial.write_bytes(data)
        write_text(page(found, drawn), paths["html"])
    return paths


def record(found: Found) -> dict:
    """What database.json holds."""
    return model_folder.record_of(found.model, found.vehicle, _computed(found))


def _computed(found: Found) -> dict[str, Any]:
    """Settings, blocks and remarks as JSON values, angles in deg."""
    settings = found.settings
    used: dict[str, Any] = {
        "tier": settings.tier,
        "machs": list(settings.machs),
        "alphas_deg": [degrees(a) for a in settings.alphas],
        "deflections_deg": {name: [degrees(d) for d in values] for name, values in settings.deflections.items()},
        "beta_step_deg": degrees(settings.steps.beta),
        "rate_step": settings.steps.rate,
    }
    if settings.tier == EULER:
        used |= {name: plain(getattr(settings, name)) for name in ("altitude_m", "mesh", "flow", "increments")}
    else:
        used["method"] = settings.method
    return {
        "settings": used,
        "blocks": [
            {
                "label": block.label,
                **(
                    {name: result[name] for name in ("conditions", "cells", "wall_cell_m", "seconds")}
                    | {"not_converged": len(result["bad"])}
                    if result is not None
                    else {"failed": True}
                ),
            }
            for block, result in zip(found.blocks, found.results, strict=True)
        ],
        "not_converged": [asdict(remark) for remark in found.remarks],
    }


def page(found: Found, drawn: dict[str, bytes]) -> str:
    """The HTML page, with the pictures in it."""
    model = found.model
    title = f"{model.name}: aerodynamic database"
    lines = [
        f"Source: {model.source}.",
        *(
            f"{text[0].upper()}{text[1:]}."
            for text in (*statement.reference_lines(model), statement.unknown_line(model))
        ),
        f"Limits: {'; '.join(statement.limit_lines(model))}. Linear between nodes, nothing outside and in empty cells.",
    ]
    parts = [f"<h1>{html.escape(title)}</h1>", *(f"<p>{html.escape(text)}</p>" for text in lines)]
    parts += [f"<h2>{html.escape(_BELOW[name])}</h2>{picture_html(data, _BELOW[name])}" for name, data in drawn.items()]
    return document(title, parts + [table_html(table) for table in (_blocks(found), *_remarks(found))])


def _blocks(found: Found) -> Table:
    rows = []
    for block, result in zip(found.blocks, found.results, strict=True):
        if result is None:
            rows.append((block.label, *("-",) * 4))
            continue
        good = f"{result['conditions'] - len(result['bad'])} of {result['conditions']}"
        cells = "-" if result["cells"] is None else f"{result['cells']:,}".replace(",", " ")
        cell = "-" if result["wall_cell_m"] is None else f"{result['wall_cell_m']:.3g}"
        rows.append((block.label, good, cells, cell, f"{result['seconds']:.1f}"))
    columns = ("shape", "converged", "cells", "wall cell, m", "seconds")
    return Table("Computed", 2, "Each line is one shape on one mesh; stored as it is finished.", columns, tuple(rows))


def _remarks(found: Found) -> list[Table]:
    if not found.remarks:
        return []
    rows = [
        (
            one.shape if one.mach is None else one.shape.partition(", Mach")[0],
            one.condition or "-",
            "-" if one.mach is None else f"{one.mach:g}",
            "-" if one.alpha_deg is None or not math.isfinite(one.alpha_deg) else f"{one.alpha_deg:g}",
            one.verdict,
            one.reason,
        )
        for one in found.remarks
    ]
    note = (
        "Oscillating: the mean of the final window is in the tables. Failed: the cells are empty; nothing is filled in."
    )
    columns = ("shape", "condition", "Mach", "alpha, deg", "verdict", "reason")
    return [Table("Not converged", 2, note, columns, tuple(rows))]
