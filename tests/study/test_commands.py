"""Bad input to the study commands: one line that names the thing, exit code 2, nothing lost."""

import subprocess
import sys

import fake
import pytest

from spaceplane.study.store import ResultStore


def spaceplane(*arguments) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "spaceplane.cli", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


def refused(done: subprocess.CompletedProcess, *words: str) -> None:
    assert done.returncode == 2, done.stderr
    message = done.stderr.strip()
    assert "\n" not in message and "Traceback" not in message
    for word in words:
        assert word in message


@pytest.mark.parametrize("command", [("study", "sensitivity"), ("compare",)])
def test_a_damaged_store(tmp_path, command):
    store = tmp_path / "store.sqlite"
    store.write_bytes(b"SQLite format 3\0" + b"not really" * 1000)
    before = store.read_bytes()
    refused(spaceplane(*command, "--out", tmp_path), str(store), "damaged", "move it away")
    assert store.read_bytes() == before


def test_a_bad_study_file(tmp_path):
    path = tmp_path / "study.yaml"
    path.write_text("parameters: [wing_widht_m]\n")
    refused(spaceplane("study", "sensitivity", path, "--out", tmp_path), "wing_widht_m", "wing_width_m")


def test_an_output_folder_that_is_a_file(tmp_path):
    (tmp_path / "out").touch()
    refused(spaceplane("study", "sensitivity", "--out", tmp_path / "out"), "out")


def test_two_results_are_compared(tmp_path):
    import json

    paths = []
    for name, shape in (("one", {}), ("two", {"wing_width_m": 3.9})):
        paths.append(tmp_path / f"{name}.json")
        paths[-1].write_text(json.dumps(fake.evaluate({"shape": shape})))
    done = spaceplane("compare", *paths, "--out", tmp_path / "out", "--json", tmp_path / "both.json")
    assert done.returncode == 0, done.stderr
    assert "wing_width_m" in done.stdout and "Dutch roll" in done.stdout
    record = json.loads((tmp_path / "both.json").read_text())
    assert record == json.loads((tmp_path / "out" / "compare.json").read_text())
    refused(spaceplane("compare", paths[0]), "two result.json")
    refused(spaceplane("compare", paths[0], tmp_path / "none.json"), "none.json")


def test_a_finished_store_is_left_as_it_was_by_bad_input(tmp_path):
    store = tmp_path / "store.sqlite"
    with ResultStore(store) as open_store:
        open_store.put("k" * 64, "one", {}, {"CL": 0.5}, 1.0)
    refused(spaceplane("study", "sensitivity", tmp_path / "none.yaml", "--out", tmp_path), "none.yaml")
    with ResultStore(store) as open_store:
        assert open_store.get("k" * 64) == {"CL": 0.5}
