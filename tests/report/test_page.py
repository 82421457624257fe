"""The HTML report."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import pytest

from spaceplane.errors import InputError
from spaceplane.report import write_report

from .example_result import PARTS, convergence, example_result, write_example

VOID = {"meta", "br", "img", "link", "input", "hr"}


class Page(HTMLParser):
    """Checks that tags close in order; keeps what elements refer to and the visible text."""

    def __init__(self, html: str):
        super().__init__()
        self.open: list[str] = []
        self.references: list[str] = []
        self.text = ""
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        self.references += [v for k, v in attrs if k in ("src", "href", "data", "poster", "action") and v]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if not {"script", "style"} & set(self.open):
            self.text += data


@pytest.fixture(scope="module")
def html(out_dir: Path) -> str:
    return write_report(out_dir).read_text(encoding="utf-8")


def words(html: str) -> str:
    return " ".join(Page(html).text.split())


def test_it_needs_no_network(html):
    page = Page(html)
    assert page.open == []
    assert all(r.startswith(("#", "data:")) for r in page.references)
    assert not re.search(r"@import|url\((?!['\"]?(data:|#))|fetch\(|XMLHttpRequest|\bimport\(", html)


def test_it_stays_small(out_dir, html):
    assert (out_dir / "report.html").stat().st_size < 8_000_000


def test_every_flight_point_has_every_section(html):
    for index in range(3):
        assert html.count(f'data-for-point="{index}"') >= 6
    text = words(html)
    for word in (
        "Flight points",
        "Coefficients",
        "Derivatives",
        "Modes",
        "Flying-quality levels",
        "Convergence and mesh",
    ):
        assert word in text


def test_numbers_of_the_result_are_shown(html):
    text = words(html)
    result = example_result()
    assert "213 456" in text
    assert "1.405 ± 0.018" in text  # CL_alpha at Mach 2.5 with its error
    assert "−0.01230 ± 0.00015" in text  # Cm with what the wandering of the forces means for it
    assert "lateral oscillation" in text and "aperiodic pitch divergence" in text
    assert "paragraph 3.3.1.1" in text and "below 3" in text
    assert "not applicable: aperiodic" in text
    assert all(p["name"] in text for p in result["flight_points"])
    assert "x = 13.00" in text  # moment reference point
    assert all(part.replace("_", " ") in text for part in PARTS)


def test_units_and_axes_stand_beside_the_tables(html):
    text = words(html)
    for phrase in ("per rad", "per unit Mach", "wind axes", "body axes", "positive trailing edge down", "kPa", "rad/s"):
        assert phrase in text


def test_what_the_uncertainty_holds_is_said_in_a_sentence(html, tmp_path):
    assert "the error of the mesh is in neither" in words(html)
    found = {"sources": ["iteration", "mesh"], "level": 0.95, "ratio": 2.0, "cells": 24268}
    asked = {"target": 0.05, "reached": 0.062, "met": False}
    text = words(write_report(write_example(tmp_path, uncertainty=found, accuracy=asked)).read_text(encoding="utf-8"))
    assert "in neither" not in text
    assert "exact inviscid value in 95 % of all cases" in text
    assert "a coarser companion mesh (24 268 cells, at the wall 2.0 times as large)" in text.replace("\u202f", " ")
    assert "the same quotient on the companion mesh" in text
    assert "accuracy 6.2 %, 5 % asked" in text


def test_unconverged_conditions_are_warned_about_at_the_top(tmp_path):
    result = example_result()
    result["flight_points"][1]["convergence"][0] = convergence("base", 1.5, 12.0, 0.0, "oscillating")
    folder = write_example(
        tmp_path, flight_points=result["flight_points"], warnings=["wing: wall thinner than two cells"]
    )
    text = words(write_report(folder).read_text(encoding="utf-8"))
    top = text[: text.index("Flight points Ambient")]
    assert "2 warnings" in top
    assert top.index("condition base: oscillating") < top.index("wall thinner")  # the worse news first
    assert "wall thinner than two cells" in top
    assert "Mach 1.5, condition base: oscillating: forces wander by 0.4 %" in top
    assert "1 of 18 conditions not converged" in top
    assert "all 18 conditions converged" not in top


def test_a_failed_flight_point_shows_dashes_not_numbers(tmp_path):
    result = example_result()
    point = result["flight_points"][0]
    point["coefficients"] = dict.fromkeys(point["coefficients"])
    point["derivatives"] = {k: {"value": None, "error": None, "unit": "1/rad"} for k in point["derivatives"]}
    point.update(modes=[], verdicts=[], coefficients_by_part={}, equilibrium=None, states=None)
    folder = write_example(tmp_path, flight_points=result["flight_points"])
    text = words(write_report(folder).read_text(encoding="utf-8"))
    assert "No modes: there is no linear model" in text
    assert "nan" not in text.lower().split()


def test_names_from_the_result_are_escaped(tmp_path):
    vehicle = example_result()["vehicle"] | {"name": "<script>alert(1)</script>"}
    folder = write_example(tmp_path, vehicle=vehicle, warnings=["a < b & </script>"])
    html = write_report(folder).read_text(encoding="utf-8")
    assert "<script>alert(1)" not in html
    assert Page(html).open == []


def test_without_a_surface_it_says_so(tmp_path):
    folder = write_example(tmp_path)
    (folder / "surface.vtp").unlink()
    html = write_report(folder).read_text(encoding="utf-8")
    assert "No surface.vtp" in words(html)
    assert 'id="surface-data"' not in html


def test_a_damaged_result_leaves_the_old_report(tmp_path):
    (tmp_path / "report.html").write_text("old")
    (tmp_path / "result.json").write_text("{")
    with pytest.raises(InputError, match="result"):
        write_report(tmp_path)
    assert (tmp_path / "report.html").read_text() == "old"


BROWSER = next((b for b in ("chromium", "chromium-browser", "google-chrome") if shutil.which(b)), None)
PROBE = """
<script>
addEventListener("load", () => setTimeout(() => {
  const found = { live: document.getElementById("viewer").className, errors: window.mistakes };
  const view = window.spaceplaneView;
  if (view) {
    const canvas = document.querySelector("canvas"), box = canvas.getBoundingClientRect();
    const at = (type, x, y) => canvas.dispatchEvent(new PointerEvent(type,
      { pointerId: 1, clientX: box.left + x, clientY: box.top + y, buttons: 1, bubbles: true }));
    found.before = view.state.azimuth;
    at("pointerdown", 300, 200); at("pointermove", 400, 200); at("pointerup", 400, 200);
    found.after = view.state.azimuth;
    view.view("top");
    view.draw();
    found.middle = view.under(box.left + box.width / 2, box.top + box.height / 2);
    found.corner = view.under(box.left + 3, box.top + box.height / 2);
    document.querySelectorAll("[data-point]")[2].click();
    found.field = view.state.field;
    document.querySelector("[data-colour=parts]").click();
    found.mode = view.state.mode;
  }
  found.visible = [...document.querySelectorAll("#modes [data-for-point]")].map((e) => getComputedStyle(e).display);
  document.documentElement.innerHTML = "<pre id=found></pre>";
  document.getElementById("found").textContent = JSON.stringify(found);
}, 1500));
</script></body>"""


def in_browser(html: str, folder: Path, *flags: str) -> dict:
    """Open the page in headless Chromium, drag the view, press buttons, and report what happened."""
    start = "<head><script>window.mistakes = []; addEventListener('error', (e) => mistakes.push(e.message));</script>"
    page = folder / "probe.html"
    page.write_text(html.replace("<head>", start, 1).replace("</body>", PROBE), encoding="utf-8")
    command = [
        BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--window-size=1400,1200",
        "--virtual-time-budget=15000",
        "--disable-background-networking", "--disable-component-update", "--disable-sync",
        f"--user-data-dir={folder / 'user'}",
        *flags, "--dump-dom", page.as_uri(),
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    text = re.search(r"<pre id=\"found\">(.*)</pre>", done.stdout, re.S)
    assert text, done.stdout[-500:]
    return json.loads(text.group(1).replace("&amp;", "&").replace("&lt;", "<").replace("&gt;", ">"))


@pytest.mark.skipif(BROWSER is None, reason="no Chromium here")
def test_the_view_turns_with_the_mouse(html, tmp_path):
    found = in_browser(html, tmp_path, "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
    assert found["errors"] == []
    assert "live" in found["live"]
    assert found["after"] - found["before"] == pytest.approx(-40.0)
    assert found["middle"]["part"] == "fuselage"
    assert found["corner"] is None
    assert found["field"] == 2
    assert found["mode"] == 1
    assert found["visible"] == ["none", "none", "block"]


@pytest.mark.skipif(BROWSER is None, reason="no Chromium here")
def test_without_webgl_a_picture_stands_in(html, tmp_path):
    found = in_browser(html, tmp_path, "--disable-3d-apis")
    assert found["errors"] == []
    assert "still" in found["live"]


def test_cards_show_what_is_known_and_what_is_not(tmp_path):
    """A derivative smaller than its error stands there with the error and without a certain sign."""
    result = example_result()
    first, second = result["flight_points"][:2]
    first["derivatives"]["Cn_beta"] |= {"value": 0.0602, "error": 0.11}
    second["derivatives"]["Cn_beta"] |= {"value": 0.0602, "error": 0.011}
    text = words(write_report(write_example(tmp_path, flight_points=[first, second])).read_text(encoding="utf-8"))
    cards = text[: text.index("Flight points Ambient")]
    assert "0.06 ± 0.11 sign not certain" in cards and cards.count("sign not certain") == 1
    assert "0.060 ± 0.011" in cards
    assert cards.count("0.3600 ± 0.0004") == 2  # C_L and its error
