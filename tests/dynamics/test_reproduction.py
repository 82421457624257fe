"""The thesis's eigenvalues come out, and the page that says so is current."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from spaceplane.dynamics.modes import identify
from spaceplane.errors import InputError
from spaceplane.validation import thesis
from spaceplane.validation.records import passed

DOCS = Path(__file__).parents[2] / "docs"


def test_table_6_2_within_7_percent():
    system = thesis.reproduce("reference")
    for mode in thesis.FAST_MODES:
        published = complex(*thesis.printed()["table_6_2"][mode])
        assert abs(thesis.eigenvalue(system, published) - published) < 0.07 * abs(published)


def test_table_6_3_comes_from_unconverted_degrees():
    found = thesis.reproduce_table_6_3()
    for mode in thesis.FAST_MODES:
        published = complex(*thesis.printed()["table_6_3"][mode])
        assert abs(found[mode] - published) < 0.03 * abs(published)
    # slow modes hang on C_L and C_D, which the thesis does not print
    assert found["pitch/roll divergence"] == pytest.approx(0.034959, rel=0.05)
    assert found["periodic pitch/roll"] == pytest.approx(-0.022228 + 0.014393j, rel=0.1)


def test_eigenvectors_of_table_6_3():
    """Norm 1, SI units: the columns of Table 6.3 that the printed digits resolve."""
    mode = next(m for m in identify(thesis.reproduce("unconverted")) if m.kind == "pitch_aperiodic" and m.stable)
    component = dict(zip(mode.states, np.abs(mode.eigenvector), strict=True))
    for state, printed in {"V": 0.12142, "R": 0.99214, "q": 0.004615, "alpha": 0.02977}.items():
        assert component[state] == pytest.approx(printed, rel=0.02)


def test_factor_between_the_tables():
    """The fast modes of the two tables differ by sqrt(180/pi)."""
    converted, unconverted = thesis.reproduce("reference"), thesis.reproduce("unconverted")
    ratio = thesis.eigenvalue(converted, 1.4j).imag / thesis.eigenvalue(unconverted, 0.19j).imag
    assert ratio == pytest.approx(np.sqrt(180 / np.pi), rel=0.02)


def test_computed_table_of_the_notes():
    """Values that were computed independently of this program, to their printed digits."""
    converted, unconverted = thesis.reproduce("reference"), thesis.reproduce("unconverted 25 km")
    for system, values in (
        (converted, (-1.137, 1.010, 0.0391 + 1.397j, -0.0224 + 0.0121j, 0.0336)),
        (unconverted, (-0.181, 0.128, 0.0156 + 0.210j, -0.0231 + 0.0161j, 0.0451)),
    ):
        for value in values:
            assert abs(thesis.eigenvalue(system, value) - value) < 0.006 * abs(value)


def test_table_7_4_needs_two_slips():
    plain = thesis.chapter_7_system("original", 2.5)
    swapped = thesis.chapter_7_system("original", 2.5, swapped=True)
    assert thesis.eigenvalue(swapped, 0.62j) == pytest.approx(0.0003 + 0.630j, abs=5e-4)
    assert abs(thesis.eigenvalue(plain, 0.62j) - 0.62j) > 0.5
    assert np.abs(np.linalg.eigvals(plain.A).imag).max() < 0.05  # no lateral oscillation at all as printed
    optimised = thesis.chapter_7_system("optimised", 2.5, swapped=True)
    assert thesis.eigenvalue(optimised, 0.65j) == pytest.approx(-0.0007 + 0.6481j, rel=0.02)


def test_needed_pitch_stiffness_recovers_a_known_one():
    """On eigenvalues that were computed from a C_m_alpha, the cubic gives this C_m_alpha back."""
    entry = next(e for e in thesis.printed()["chapter_7"] if (e["shape"], e["mach"]) == ("optimised", 5.0))
    values = np.linalg.eigvals(thesis.chapter_7_system("optimised", 5.0).A)
    modes = identify(thesis.chapter_7_system("optimised", 5.0))
    pitch = [m.eigenvalue.real for m in modes if m.kind == "pitch_aperiodic"]
    assert len(pitch) == 2 and len(values) == 9
    slow = -sum(pitch)  # the third root of s^3 - a s + c, whose sum of roots is zero
    known = {**entry, "longitudinal": [[root, 0.0] for root in (*pitch, slow)]}
    assert thesis.needed_pitch_stiffness(known) == pytest.approx(0.0010, rel=0.02)


def test_unknown_reproduction():
    with pytest.raises(InputError, match="reproduction"):
        thesis.reproduce("guess")


def test_validation_case_passes():
    from spaceplane.validation import run

    records = run(("dynamics",))
    assert passed(records) and len(records) >= 15


@pytest.mark.parametrize("page", ["reproduction.md", "flight-dynamics.md"])
def test_page_is_current(page):
    sys.path.insert(0, str(DOCS))
    try:
        spec = importlib.util.spec_from_file_location("docs_generate", DOCS / "generate.py")
        assert spec and spec.loader
        generate = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(generate)
    finally:
        sys.path.remove(str(DOCS))
    text = (DOCS / page).read_text(encoding="utf-8")
    assert "| ---" in text or "|---" in text
    assert generate.rebuilt(text) == text, "run python docs/generate.py"
