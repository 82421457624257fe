"""The HTML report: one file that needs no network."""

from __future__ import annotations

import base64
import json
from pathlib import Path

from spaceplane.files import write_text
from spaceplane.report import sections
from spaceplane.report.numbers import fixed
from spaceplane.report.picture import COLOUR_STOPS, stills
from spaceplane.report.read import level_text, read_result
from spaceplane.report.surface_data import ColouredSurface, cp_range, pack, read_surface

NAVIGATION = (
    ("overview", "Overview"),
    ("flight", "Flight points"),
    ("coefficients", "Coefficients"),
    ("derivatives", "Derivatives"),
    ("modes", "Modes"),
    ("levels", "Levels"),
    ("control", "Control"),
    ("convergence", "Convergence"),
    ("vehicle", "Vehicle"),
)


def write_report(out_dir: Path) -> Path:
    """Write `report.html` from the `result.json` and `surface.vtp` in `out_dir` and return its path.

    Raises:
        InputError: result.json is missing, damaged or of another schema; surface.vtp is damaged.
        OSError: the file cannot be written.
    """
    out_dir = Path(out_dir)
    result = read_result(out_dir)
    surface_path = out_dir / "surface.vtp"
    surface = read_surface(surface_path) if surface_path.is_file() else None
    path = out_dir / "report.html"
    write_text(render(result, surface), path)
    return path


def render(result: dict, surface: ColouredSurface | None) -> str:
    """The report's HTML."""
    import jinja2
    from markupsafe import Markup

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("spaceplane.report"), autoescape=True, undefined=jinja2.StrictUndefined
    )
    environment.filters |= {"level_text": level_text, "level_css": sections.level_css, "words": sections.words}
    environment.filters["capitalize_first"] = lambda text: text[:1].upper() + text[1:]
    points = [sections.point(p) for p in result["flight_points"]]
    macros = environment.get_template("macros.html").make_module({"points": points})
    context = {
        **sections.whole(result),
        "points": points,
        "sections": NAVIGATION,
        "css": Markup(_template_text("style.css")),
        "page_script": Markup(_template_text("page.js")),
        "viewer_script": Markup(_template_text("viewer.js")),
        "stops": COLOUR_STOPS,
        **_surface_context(surface, [p["name"] for p in result["flight_points"]]),
        "ui_head": macros.head,
        "ui_measured": macros.measured,
        "ui_chip": macros.chip,
    }
    return environment.get_template("report.html").render(context)


def _surface_context(surface: ColouredSurface | None, names: list[str]) -> dict:
    from markupsafe import Markup

    if surface is None:
        return {"surface": None, "stills": [], "parts": []}
    packed = pack(surface) | {"stops": COLOUR_STOPS}
    drawn = stills(surface, {name: surface.cp[name] for name in names if name in surface.cp})
    pictures = []
    for name, png in drawn.items():
        low, high = (fixed(value, 2) for value in cp_range(surface.cp[name]))
        code = base64.b64encode(png).decode()
        pictures.append({"index": names.index(name), "name": name, "png": code, "low": low, "high": high})
    return {"surface": Markup(json.dumps(packed).replace("</", "<\\/")), "stills": pictures, "parts": packed["parts"]}


def _template_text(name: str) -> str:
    return (Path(__file__).parent / "templates" / name).read_text(encoding="utf-8")
