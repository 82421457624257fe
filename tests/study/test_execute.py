"""Cases are computed once, whoever asks, and a dead worker costs one case."""

import itertools
import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import fake
import pytest

from spaceplane.errors import InputError
from spaceplane.study.execute import execute
from spaceplane.study.records import Case, Progress

HERE = Path(__file__).parent

_STUDY_PROCESS = """
import sys
sys.path.insert(0, {here!r})
import fake
from spaceplane.study.execute import execute
from spaceplane.study.records import Case
if __name__ == "__main__":
    inputs = {{"log": sys.argv[2]}}
    cases = [Case(f"case {{i}}", inputs | {{"label": f"case {{i}}", "number": i}}) for i in range(12)]
    outcome = execute(cases, fake.evaluate, sys.argv[1], workers=int(sys.argv[3]), code="test")
    print(outcome.computed, outcome.reused, len(outcome.failures))
"""


@pytest.fixture
def store(tmp_path):
    return tmp_path / "results.sqlite"


@pytest.fixture
def log(tmp_path):
    return tmp_path / "log.txt"


def cases_of(count: int, log: Path, **extra) -> list[Case]:
    return [Case(f"case {i}", {"label": f"case {i}", "number": i, "log": str(log), **extra}) for i in range(count)]


def computed(log: Path) -> Counter:
    return Counter(log.read_text().splitlines() if log.exists() else [])


@pytest.mark.parametrize("workers", [1, 3])
def test_everything_is_computed_once_and_found_again(store, log, workers):
    seen: list[Progress] = []
    cases = cases_of(5, log)
    first = execute(cases, fake.evaluate, store, seen.append, workers, code="a")
    assert (first.computed, first.reused, first.failures) == (5, 0, ())
    assert [result["vehicle"]["name"] for result in first.results] == ["fake"] * 5
    assert seen[0].done == 0 and seen[0].remaining_s is None
    assert seen[-1].done == 5 and seen[-1].remaining_s == 0.0 and seen[-1].running == ()
    assert seen[0].fraction == 0.0 and seen[-1].fraction == 1.0
    assert all(later.fraction >= 0.95 * one.fraction for one, later in itertools.pairwise(seen))
    again = execute(cases, fake.evaluate, store, None, workers, code="a")
    assert (again.computed, again.reused) == (0, 5) and again.results == first.results
    assert set(computed(log).values()) == {1}
    other_code = execute(cases[:1], fake.evaluate, store, None, 1, code="b")
    assert other_code.computed == 1


def test_equal_inputs_are_one_case(store, log):
    cases = [Case("one", {"label": "same", "log": str(log)}), Case("two", {"log": str(log), "label": "same"})]
    outcome = execute(cases, fake.evaluate, store, code="a")
    assert outcome.computed == 1 and outcome.results[0] == outcome.results[1] is not None


def test_time_left_follows_the_mean_of_what_is_done(store, log):
    seen: list[Progress] = []
    execute(cases_of(4, log, sleep_s=0.1), fake.evaluate, store, seen.append, code="a")
    halfway = next(p for p in seen if p.done == 2 and not p.running)
    assert halfway.remaining_s == pytest.approx(0.2, rel=0.5)


@pytest.mark.parametrize("workers", [1, 2])
def test_long_cases_count_down(store, log, monkeypatch, workers):
    monkeypatch.setattr("spaceplane.study.ledger.REPORT_SECONDS", 0.02)
    seen: list[Progress] = []
    execute(cases_of(3, log, sleep_s=0.3), fake.evaluate, store, seen.append, workers, code="a")
    during = [p for p in seen if p.done == workers and p.running]
    assert len({round(p.fraction, 3) for p in during}) > 3
    assert during[-1].remaining_s < during[0].remaining_s


@pytest.mark.parametrize("workers", [1, 2])
def test_a_broken_case_is_reported_and_the_rest_goes_on(store, log, workers):
    cases = [*cases_of(3, log), Case("bad", {"raise": "no lift today"})]
    outcome = execute(cases, fake.evaluate, store, None, workers, code="a")
    assert outcome.computed == 3 and outcome.results[3] is None
    (failure,) = outcome.failures
    assert failure.label == "bad" and "no lift today" in failure.reason and "Traceback" in failure.traceback


def test_a_killed_worker_costs_one_case(store, log, tmp_path):
    cases = cases_of(6, log)
    cases[2] = Case("deadly", cases[2].inputs | {"die_once": str(tmp_path / "died")})
    outcome = execute(cases, fake.evaluate, store, None, 2, code="a")
    assert outcome.computed == 6 and outcome.failures == ()
    counts = computed(log)
    assert counts.pop("case 2") == 2  # the one it was at, again
    assert set(counts.values()) == {1}


def test_a_study_killed_in_mid_run_resumes_without_repeating(store, log):
    process = _start(store, log, sleep_s=0.15, workers=1)
    _wait_for(log, 4)
    process.send_signal(signal.SIGKILL)
    process.wait()
    finished = _finished(store)
    assert 2 <= finished < 12
    again = _start(store, log, sleep_s=0.0, workers=1)
    output, errors = again.communicate(timeout=60)
    assert again.returncode == 0, errors
    assert output.split() == [str(12 - finished), str(finished), "0"]
    counts = computed(log)
    assert len(counts) == 12 and sum(counts.values()) <= 13  # at most the one it was at, twice


def test_ctrl_c_keeps_what_is_finished(store, log):
    process = _start(store, log, sleep_s=0.2, workers=2)
    _wait_for(log, 4)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode != 0 and "KeyboardInterrupt" in errors
    finished = _finished(store)
    assert finished >= 2
    outcome = execute(_same_cases(log), fake.evaluate, store, code="test")
    assert outcome.reused == finished and outcome.computed == 12 - finished


def test_two_processes_at_once_share_the_work(store, log):
    both = [_start(store, log, sleep_s=0.1, workers=1) for _ in range(2)]
    outputs = [process.communicate(timeout=60) for process in both]
    assert [process.returncode for process in both] == [0, 0], outputs
    counts = computed(log)
    assert len(counts) == 12 and set(counts.values()) == {1}
    assert sum(int(output.split()[0]) for output, _ in outputs) == 12


def test_no_workers_is_an_input_error(store):
    with pytest.raises(InputError, match="workers: 0"):
        execute([], fake.evaluate, store, workers=0)


def _same_cases(log: Path) -> list[Case]:
    inputs = {"log": str(log)}
    return [Case(f"case {i}", inputs | {"label": f"case {i}", "number": i}) for i in range(12)]


def _start(store: Path, log: Path, sleep_s: float, workers: int) -> subprocess.Popen:
    script = store.with_name("study.py")
    script.write_text(_STUDY_PROCESS.format(here=str(HERE)))
    command = [sys.executable, str(script), str(store), str(log), str(workers)]
    environment = os.environ | {"FAKE_SLEEP_S": str(sleep_s)}
    # A shell's background job ignores SIGINT and hands that down; the child must not inherit it.
    return subprocess.Popen(
        command,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def _wait_for(log: Path, count: int) -> None:
    deadline = time.monotonic() + 60
    while sum(computed(log).values()) < count:
        assert time.monotonic() < deadline, "the study did not get going"
        time.sleep(0.02)


def _finished(store: Path) -> int:
    db = sqlite3.connect(store)
    count = db.execute("SELECT count(*) FROM results").fetchone()[0]
    db.close()
    return count
