"""Tudat's coefficient files, read back by a reader made from the format's description alone."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spaceplane.aero.model.published import horus_2b_published
from spaceplane.decks.tudat import write

from .horus import complete

# Tudat: key of the force files and the axis of the aerodynamic frame, in the negative direction of which they count.
FORCE, MOMENT = {0: "CD", 1: "CS", 2: "CL"}, {0: "Cl", 1: "Cm", 2: "Cn"}


def read(path: Path) -> tuple[list[np.ndarray], np.ndarray]:
    """(values of each independent variable, [first, second(, third)] values).

    Lines split at blanks, tabs, semicolons or commas; empty lines and those that start with # do not count. The first
    has the number of variables, the next ones their values, the others hold the second variable along the line and
    the first down the lines, block after block for the third.
    """
    lines = [line.strip() for line in path.read_text().splitlines()]
    numbers = [[float(x) for x in re.split(r"[\t ;,]+", line)] for line in lines if line and line[0] != "#"]
    assert len(numbers[0]) == 1 and numbers[0][0] in (1, 2, 3)
    count = int(numbers[0][0])
    axes, block = [np.array(row) for row in numbers[1 : count + 1]], np.array(numbers[count + 1 :])
    rows, columns = len(axes[0]), len(axes[1])
    assert block.shape == (rows * (len(axes[2]) if count == 3 else 1), columns)
    if count == 2:
        return axes, block
    values = np.empty((rows, columns, len(axes[2])))
    for k in range(len(axes[2])):
        values[:, :, k] = block[k * rows : (k + 1) * rows]
    return axes, values


def linear(axes, values, point):
    """Multilinear interpolation."""
    for axis, x in zip(axes, point, strict=True):
        k = min(max(int(np.searchsorted(axis, x)) - 1, 0), len(axis) - 2)
        share = (x - axis[k]) / (axis[k + 1] - axis[k])
        values = (1 - share) * values[k] + share * values[k + 1]
    return float(values)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    model = complete()
    folder = tmp_path_factory.mktemp("tudat")
    write(model, folder)
    return model, folder


def total(folder, mach, alpha, beta, deflections):
    """Tudat's own sum: base coefficients and increments by surface, in its keys."""
    found = {}
    for kind, keys in (("force", FORCE), ("moment", MOMENT)):
        for key, name in keys.items():
            found[name] = linear(*read(folder / f"{kind}_{key}_{name}.dat"), (mach, alpha, beta))
            for surface, deflection in deflections.items():
                path = folder / f"{surface}_{kind}_{key}_{name}.dat"
                if path.exists():
                    found[name] += linear(*read(path), (mach, alpha, deflection))
    return found


def test_read_back_gives_our_coefficients(written):
    """With Tudat's senses: side force along -y, moments all on the chord."""
    model, folder = written
    random = np.random.default_rng(2)
    r = model.reference
    for _ in range(20):
        mach, alpha = random.uniform(*model.mach[[0, -1]]), random.uniform(*model.alpha[[0, -1]])
        beta = random.uniform(-model.beta_limit, model.beta_limit)
        deflections = {name: random.uniform(*s.limits) for name, s in model.surfaces.items()}
        ours = model.coefficients(mach, alpha, beta, deflections=deflections)
        theirs = total(folder, mach, alpha, beta, deflections)
        assert theirs["CL"] == pytest.approx(ours["CL"], abs=1e-10)
        assert theirs["CD"] == pytest.approx(ours["CD"], abs=1e-10)
        assert -theirs["CS"] == pytest.approx(ours["CY"], abs=1e-10)
        for name, length in (("Cl", r.span), ("Cm", r.chord), ("Cn", r.span)):
            assert theirs[name] * r.chord == pytest.approx(ours[name] * length, abs=1e-9)


def test_axes_are_mach_alpha_and_the_third_in_rad(written):
    model, folder = written
    axes, _ = read(folder / "force_1_CS.dat")
    assert np.allclose(axes[0], model.mach) and np.allclose(axes[1], model.alpha, atol=1e-12)
    assert np.allclose(axes[2], [-model.beta_limit, 0.0, model.beta_limit], atol=1e-12)
    axes, increments = read(folder / "body_flap_moment_1_Cm.dat")
    assert np.allclose(axes[2], np.radians([-20, -10, 0, 10, 20, 30]), atol=1e-12)
    # Published: Cm +0.0094 at flap -20 deg, alpha 0, Mach 1.5 and +0.0007 at -20 deg, 15 deg, Mach 20.
    assert increments[0, 0, 0] == 0.0094 and increments[4, 3, 0] == 0.0007 and not increments[:, :, 2].any()


def test_readme_states_axes_units_reference_and_limits(written):
    model, folder = written
    text = " ".join((folder / "README.txt").read_text().split())
    for needed in (
        model.source,
        "wind axes",
        "body axes (x forward, y right, z down)",
        "C_S = -CY",
        "positive along the negative axes",
        "rad",
        "reference_length 23 m, reference_area 110 m2",
        "moment_reference_point -13, 0, 0 m, body axes, from the nose",
        "mach 1.5 to 20",
        "beta -10 to 10 deg",
        "elevon_left -40 to 40 deg",
        "throw_exception_at_boundary",
        "Cm_q",
    ):
        assert needed in text, needed
    named = set(re.findall(r"[\w]+\.dat", text))
    assert named == {path.name for path in folder.glob("*.dat")}


def test_without_sideslip_two_variables(tmp_path):
    model = replace(horus_2b_published(), slopes={})
    files = {path.name for path in write(model, tmp_path)}
    assert {"force_0_CD.dat", "force_2_CL.dat", "moment_1_Cm.dat"} < files
    assert not {name for name in files if "CS" in name or "Cl" in name or "Cn" in name}
    axes, values = read(tmp_path / "force_2_CL.dat")
    assert len(axes) == 2 and values[2, 4] == 0.48  # Mach 3, alpha 20 deg


def test_empty_cells_never_reach_a_file(tmp_path):
    model = complete()
    table = model.base["Cm"].copy()
    table[0, 2] = np.nan
    write(replace(model, base={**model.base, "Cm": table}), tmp_path)
    assert all("nan" not in path.read_text() for path in tmp_path.glob("*.dat"))
    assert len(read(tmp_path / "moment_1_Cm.dat")[0][1]) == 9
    assert "left out" in (tmp_path / "README.txt").read_text()
