"""The store keeps what is finished, whatever happens to processes, disk and file."""

import json
import multiprocessing
import os
import resource
import sqlite3
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from spaceplane.errors import InputError
from spaceplane.study.keys import _code_only, canonical, code_fingerprint, result_key
from spaceplane.study.store import ResultStore

KEY = "k" * 64


@pytest.fixture
def path(tmp_path):
    return tmp_path / "results.sqlite"


def test_key_ignores_order_and_number_type_but_nothing_else():
    first = {"shape": {"a": 1, "b": 2.0}, "mach": (0.8, 1.5)}
    same = {"mach": [0.8, 1.5], "shape": {"b": 2, "a": 1.0}}
    assert result_key(first, "c") == result_key(same, "c")
    assert result_key(first, "c") != result_key(first, "d")
    assert result_key(first, "c") != result_key(first | {"mach": (0.8, 1.6)}, "c")
    assert canonical(True) != canonical(1)
    assert canonical(-0.0) == canonical(0.0)
    with pytest.raises(InputError, match="finite"):
        canonical(float("nan"))


def test_code_fingerprint_sees_code_but_not_comments():
    assert len(code_fingerprint()) == 16
    assert _code_only('"""Doc."""\n\ndef f():\n    "doc"\n    return 1  # why\n') == _code_only(
        "def f():\n    return 1\n"
    )
    assert _code_only("def f():\n    return 1\n") != _code_only("def f():\n    return 2\n")


def test_what_is_put_comes_back_after_reopening(path):
    with ResultStore(path) as store:
        assert store.get(KEY) is None
        assert store.put(KEY, "one", {"x": 1}, {"CL": 0.5, "list": [1, None]}, 2.5)
        assert not store.put(KEY, "one", {"x": 1}, {"CL": 0.6}, 2.5)  # the first result stays
    with ResultStore(path) as store:
        assert store.get(KEY) == {"CL": 0.5, "list": [1, None]}
        assert store.finished([KEY, "other"]) == {KEY}
        assert store.seconds([KEY]) == [2.5]


def test_numbers_that_are_not_finite_are_refused(path):
    with ResultStore(path) as store, pytest.raises(InputError, match="null"):
        store.put(KEY, "one", {}, {"CL": float("nan")}, 1.0)


def test_a_claim_belongs_to_one_live_process(path):
    with ResultStore(path) as store:
        assert store.claim(KEY)
        with _another_process(path) as (claimed, _):
            assert claimed is False
        store.release(KEY)
        with _another_process(path) as (claimed, process):
            assert claimed is True
            assert not store.claim(KEY)  # the other process lives and holds it
            process.kill()
            process.join()
            assert store.claim(KEY)  # its process is gone


@contextmanager
def _another_process(path):
    """(whether it got the claim, a process that tried and then waits)."""
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_claim_and_wait, args=(path, there), daemon=True)
    process.start()
    there.close()
    try:
        assert here.poll(60.0)
        yield here.recv(), process
    finally:
        here.close()
        process.kill()
        process.join()


def test_a_claim_that_nobody_renews_runs_out(path):
    with ResultStore(path, lease_s=0.05) as store:
        assert store.claim(KEY)
        time.sleep(0.1)
        assert store.claim(KEY)
        store.release(KEY)
    with ResultStore(path, lease_s=0.4) as store:
        assert store.claim(KEY)
        with store.holding(KEY):
            time.sleep(0.8)
            assert _expiry(path) > time.time()  # renewed meanwhile
        assert _expiry(path) is None


@pytest.mark.parametrize("damage", ["text", "truncated", "scrambled"])
def test_a_damaged_file_is_named_and_left_alone(path, damage):
    with ResultStore(path) as store:
        for number in range(50):
            store.put(f"{number:064d}", "one", {}, {"text": "x" * 2000}, 1.0)
    content = path.read_bytes()
    broken = {
        "text": b"once upon a time" * 10,
        "truncated": content[: len(content) // 2 + 100],
        "scrambled": content[:4096] + bytes(range(256)) * 64 + content[4096 + 256 * 64 :],
    }[damage]
    path.write_bytes(broken)
    with pytest.raises(InputError) as caught:
        ResultStore(path)
    message = str(caught.value)
    assert str(path) in message and "damaged" in message and "move it away" in message and "\n" not in message
    assert path.read_bytes() == broken


def test_a_changed_result_is_noticed(path):
    with ResultStore(path) as store:
        store.put(KEY, "one", {}, {"CL": 0.5}, 1.0)
    with sqlite3.connect(path) as db:
        db.execute("UPDATE results SET result = ?", (json.dumps({"CL": 0.7}),))
    db.close()
    with ResultStore(path) as store, pytest.raises(InputError, match="checksum"):
        store.get(KEY)


def test_files_of_other_programs_and_versions_are_refused(path, tmp_path):
    with sqlite3.connect(path) as db:
        db.execute("CREATE TABLE songs (title TEXT)")
    db.close()
    with pytest.raises(InputError, match="another program"):
        ResultStore(path)
    other = tmp_path / "newer.sqlite"
    ResultStore(other).close()
    with sqlite3.connect(other) as db:
        db.execute("PRAGMA user_version = 99")
    db.close()
    with pytest.raises(InputError, match="version 99"):
        ResultStore(other)


def test_places_that_cannot_hold_a_store(tmp_path):
    with pytest.raises(InputError, match="folder"):
        ResultStore(tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot make its folder"):
        ResultStore(tmp_path / "file" / "results.sqlite")


def test_a_full_store_says_so_and_loses_nothing(path):
    with ResultStore(path) as store:
        store.put(KEY, "one", {}, {"CL": 0.5}, 1.0)
        pages = store._db.execute("PRAGMA page_count").fetchone()[0]
        store._db.execute(f"PRAGMA max_page_count = {pages}")
        with pytest.raises(InputError, match="disk is full; nothing stored is lost"):
            store.put("z" * 64, "two", {}, {"text": "x" * 100_000}, 1.0)
        assert store.get(KEY) == {"CL": 0.5}
    with ResultStore(path) as store:
        assert store.get(KEY) == {"CL": 0.5}
        assert store.put("z" * 64, "two", {}, {"text": "x" * 100_000}, 1.0)


_WRITE_UNDER_A_LIMIT = """
import resource, sys
from spaceplane.errors import InputError
from spaceplane.study.store import ResultStore
with ResultStore(sys.argv[1]) as store:
    store.put("a" * 64, "one", {}, {"CL": 0.5}, 1.0)
    resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, resource.RLIM_INFINITY))
    try:
        store.put("b" * 64, "two", {}, {"text": "x" * 1_000_000}, 1.0)
    except InputError as error:
        print(error)
        sys.exit(2)
"""


def test_a_disk_that_refuses_to_write(path):
    assert resource.RLIMIT_FSIZE is not None
    done = subprocess.run([sys.executable, "-c", _WRITE_UNDER_A_LIMIT, str(path)], capture_output=True, text=True)
    assert done.returncode == 2, done.stderr
    assert str(path) in done.stdout and "nothing stored is lost" in done.stdout and done.stdout.count("\n") == 1
    with ResultStore(path) as store:
        assert store.get("a" * 64) == {"CL": 0.5}
        assert store.get("b" * 64) is None


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_read_only_file_is_refused(path):
    ResultStore(path).close()
    path.chmod(0o400)
    with pytest.raises(InputError, match="not writable"):
        ResultStore(path)


def _claim_and_wait(path, pipe):
    with ResultStore(path) as store:
        pipe.send(store.claim(KEY))
        pipe.poll(None)


def _expiry(path: Path) -> float | None:
    db = sqlite3.connect(path)
    row = db.execute("SELECT expires FROM claims WHERE key = ?", (KEY,)).fetchone()
    db.close()
    return row[0] if row else None
