"""A study file is checked before anything is computed."""

from pathlib import Path

import pytest

from spaceplane.errors import InputError
from spaceplane.study.cases import BASE_PARAMETERS, load_study
from spaceplane.study.sensitivity import plan
from spaceplane.vehicle.shape import PARAMETERS, THESIS_PARAMETERS


def written(tmp_path, text):
    path = tmp_path / "study.yaml"
    path.write_text(text)
    return path


def test_default_study_is_the_thesis_s():
    study = load_study()
    assert study.mach == (0.8, 1.5, 2.5)
    assert tuple(study.parameters) == BASE_PARAMETERS == THESIS_PARAMETERS[:15]
    variations = plan(study)
    assert len(variations) == 30
    limits = {info.name: (info.lower, info.upper) for info in PARAMETERS}
    for one in variations:
        assert one.value == limits[one.parameter][one.side == "high"]


def test_file_and_changes_are_taken(tmp_path):
    path = written(
        tmp_path,
        "study: sensitivity\nvehicle: horus-2b\nset: {fuselage_height_m: 1.2}\nmach: [2.5]\nworkers: 2\n"
        "parameters:\n  wing_width_m: [3.0, 3.5, 3.9]\n  winglet_length_m:\nsettings: {mesh: {target_cells: 9000}}\n",
    )
    study = load_study(path, workers=3, vehicle=None)
    assert study.workers == 3 and study.mach == (2.5,) and study.settings == {"mesh": {"target_cells": 9000}}
    labels = [one.label for one in plan(study)]
    assert labels[:3] == ["wing_width_m = 3 (low)", "wing_width_m = 3.5 (high)", "wing_width_m = 3.9 (high)"]
    assert labels[3:] == ["winglet_length_m = 2.5 (low)", "winglet_length_m = 4.5 (high)"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("machs: [2]", "unknown field 'machs': did you mean 'mach'?"),
        ("mach: [0]", "above 0"),
        ("mach: [fast]", "valid number"),
        ("mach: [2, 2]", "each Mach number once"),
        ("workers: 0", "greater than or equal to 1"),
        ("study: tarot", "allowed: sensitivity"),
        ("parameters: []", "at least one"),
        ("- 1\n- 2", "must hold keys"),
        ("mach: [1,", "not YAML at line"),
    ],
)
def test_bad_files_are_refused_in_one_line(tmp_path, text, message):
    with pytest.raises(InputError) as caught:
        load_study(written(tmp_path, text))
    assert message in str(caught.value) and "\n" not in str(caught.value)


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        load_study(tmp_path / "none.yaml")


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"wing_widht_m": ()}, "did you mean 'wing_width_m'"),
        ({"wing_width_m": (9.0,)}, "wing_width_m: 9; allowed: 2.8 to 3.9 m"),
        ({"wing_width_m": (3.1,)}, "is the default"),
    ],
)
def test_bad_parameters_are_refused(parameters, message):
    with pytest.raises(InputError, match=message):
        plan(load_study(parameters=parameters))


def test_values_beyond_the_limits_when_asked():
    study = load_study(parameters={"wing_width_m": (5.0,)}, allow_outside_limits=True)
    assert [one.value for one in plan(study)] == [5.0]


def test_the_example_is_a_study():
    study = load_study(Path(__file__).parents[2] / "examples" / "sensitivity.yaml")
    assert len(plan(study)) == 6


def test_the_companion_mesh_is_off_in_a_study_unless_asked_for():
    from spaceplane.study.shapes import case_inputs

    assert case_inputs("horus-2b", {}, (2.5,), {})["settings"]["uncertainty"] == "iteration"
    asked = case_inputs("horus-2b", {}, (2.5,), {"uncertainty": "mesh"})
    assert asked["settings"]["uncertainty"] == "mesh"
