"""Run many cases in this process or in several local ones, each result stored as soon as it is finished.

The parent hands out one case at a time over a pipe and the worker itself stores the result, so a worker that dies
loses the case it was at and nothing else.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path

from spaceplane.errors import InputError
from spaceplane.study.keys import code_fingerprint, result_key
from spaceplane.study.store import ResultStore

POLL_SECONDS = 0.5
REPORT_SECONDS = 2.0
ATTEMPTS = 2  # a case that killed its worker this often is given up


@dataclass(frozen=True)
class Case:
    """One computation of a study.

    Attributes:
        label: what a person calls it.
        inputs: everything that determines the result, resolved, as JSON values.
    """

    label: str
    inputs: dict


@dataclass(frozen=True)
class Progress:
    """How far a study is.

    Attributes:
        done: cases finished, those found in the store included.
        total: cases in all.
        reused: cases found in the store when the study began.
        running: labels of the cases now being computed.
        elapsed_s: seconds since the study began.
        remaining_s: estimated seconds left; None before the first case has been timed.
        fraction: of the work done, 0 to 1, the running cases' estimated share included.
    """

    done: int
    total: int
    reused: int
    running: tuple[str, ...]
    elapsed_s: float
    remaining_s: float | None
    fraction: float


@dataclass(frozen=True)
class Failure:
    """A case without a result: its label, one line on why, and the traceback where the program is to blame."""

    label: str
    reason: str
    traceback: str = ""


@dataclass(frozen=True)
class Outcome:
    """What came of a list of cases.

    Attributes:
        results: [case] the result, or None where it failed.
        failures: one for each case without a result.
        computed: cases computed now, by this study.
        reused: cases found in the store when the study began.
        seconds: wall-clock time, s.
    """

    results: tuple[dict | None, ...]
    failures: tuple[Failure, ...]
    computed: int
    reused: int
    seconds: float


Evaluate = Callable[[dict], dict]
Report = Callable[[Progress], None]


def execute(
    cases: Sequence[Case],
    evaluate: Evaluate,
    store_path: Path | str,
    progress: Report | None = None,
    workers: int = 1,
    code: str | None = None,
) -> Outcome:
    """Return the result of every case, computing only those that the store lacks.

    Args:
        cases: what to compute; two of them may share their inputs.
        evaluate: from a case's inputs to its result (JSON values, all finite); with several workers, a function that
            can be imported by name.
        store_path: the store's file, see `store.ResultStore`.
        progress: called on every change and every few seconds, possibly from another thread.
        workers: processes that compute at once; 1 computes in this process.
        code: fingerprint of what `evaluate` runs; the numerical packages' by default.

    Raises:
        InputError: workers below 1, or the store is damaged or cannot be written.
        KeyboardInterrupt: passed on after the workers were ended and their claims given up; finished results stay.
    """
    if workers < 1:
        raise InputError(f"workers: {workers}; allowed: 1 or more")
    code = code or code_fingerprint()
    keys = [result_key(case.inputs, code) for case in cases]
    with ResultStore(store_path) as store:
        ledger = _Ledger(dict(zip(keys, cases, strict=True)), store, progress, workers)
        if ledger.queue:
            run = _run_here if workers == 1 else _run_in_workers
            with _reporting(ledger):
                run(ledger, evaluate)
        results = tuple(store.get(key) for key in keys)
    failures = tuple(ledger.failures.values())
    return Outcome(results, failures, ledger.computed, ledger.reused, time.monotonic() - ledger.began)


@dataclass
class _Ledger:
    """Which cases wait, run, are done or failed."""

    cases: dict[str, Case]
    store: ResultStore
    progress: Report | None
    workers: int
    queue: deque[str] = field(default_factory=deque)
    running: dict[str, float] = field(default_factory=dict)
    failures: dict[str, Failure] = field(default_factory=dict)
    attempts: dict[str, int] = field(default_factory=dict)
    durations: list[float] = field(default_factory=list)
    reused: int = 0
    computed: int = 0
    done: int = 0
    began: float = 0.0

    def __post_init__(self) -> None:
        self.began = time.monotonic()
        finished = self.store.finished(self.cases)
        self.queue.extend(key for key in self.cases if key not in finished)
        self.reused = self.done = len(finished)
        self.durations = self.store.seconds(finished)
        self.report()

    def report(self) -> None:
        if self.progress is None:
            return
        labels = tuple(self.cases[key].label for key in tuple(self.running))
        total, ended = len(self.cases), self.done + len(self.failures)
        left = total - ended - self.begun()
        mean = sum(self.durations) / len(self.durations) if self.durations else None
        remaining = None if mean is None else left * mean / min(self.workers, max(total - ended, 1))
        elapsed = time.monotonic() - self.began
        fraction = 1.0 - left / total if total else 1.0
        self.progress(
            Progress(self.done, total, self.reused, labels, elapsed, 0.0 if left == 0 else remaining, fraction)
        )

    def begun(self) -> float:
        """How much of the running cases is done, in cases, as the time of those before them tells."""
        if not self.durations:
            return 0.0
        mean = sum(self.durations) / len(self.durations)
        return sum(min((time.monotonic() - since) / max(mean, 1e-9), 0.95) for since in tuple(self.running.values()))

    def start(self, key: str) -> None:
        self.running[key] = time.monotonic()
        self.report()

    def finish(self, key: str, seconds: float) -> None:
        self.running.pop(key, None)
        self.durations.append(seconds)
        self.computed += 1
        self.done += 1
        self.report()

    def found(self, key: str) -> None:
        """Another process finished the case."""
        self.running.pop(key, None)
        self.done += 1
        self.report()

    def fail(self, key: str, reason: str, trace: str = "") -> None:
        self.running.pop(key, None)
        self.failures[key] = Failure(self.cases[key].label, reason, trace)
        self.report()

    def lose(self, key: str) -> None:
        """A worker died at the case: try it again, or give it up."""
        self.running.pop(key, None)
        self.attempts[key] = self.attempts.get(key, 0) + 1
        if self.attempts[key] < ATTEMPTS:
            self.queue.append(key)
        else:
            self.fail(key, f"its process ended without an answer {ATTEMPTS} times (out of memory?)")

    def postpone(self, key: str) -> None:
        """Another process computes the case: look again later."""
        self.running.pop(key, None)
        self.queue.append(key)


@dataclass(frozen=True)
class _Answer:
    """What a worker reports of one case: "done", "found", "busy", "failed" or "store" (the store cannot be used)."""

    key: str
    verdict: str
    seconds: float = 0.0
    reason: str = ""
    traceback: str = ""


def _compute(store: ResultStore, key: str, case: Case, evaluate: Evaluate) -> _Answer:
    """Claim, compute and store one case."""
    if not store.claim(key):
        return _Answer(key, "found" if store.finished([key]) else "busy")
    with store.holding(key):
        began = time.monotonic()
        try:
            result = evaluate(case.inputs)
        except InputError as error:
            return _Answer(key, "failed", reason=str(error))
        except Exception as error:  # one broken case must not end the study; it is reported with its traceback
            return _Answer(key, "failed", reason=f"{type(error).__name__}: {error}", traceback=traceback.format_exc())
        seconds = time.monotonic() - began
        store.put(key, case.label, case.inputs, result, seconds)
        return _Answer(key, "done", seconds)


def _enter(ledger: _Ledger, answer: _Answer) -> bool:
    """Write an answer into the ledger; False when the case waits for another process."""
    if answer.verdict == "store":
        raise InputError(answer.reason)
    if answer.verdict == "done":
        ledger.finish(answer.key, answer.seconds)
    elif answer.verdict == "found":
        ledger.found(answer.key)
    elif answer.verdict == "failed":
        ledger.fail(answer.key, answer.reason, answer.traceback)
    else:
        ledger.postpone(answer.key)
        return False
    return True


def _run_here(ledger: _Ledger, evaluate: Evaluate) -> None:
    waited = 0
    while ledger.queue:
        key = ledger.queue.popleft()
        ledger.start(key)
        if _enter(ledger, _compute(ledger.store, key, ledger.cases[key], evaluate)):
            waited = 0
        else:
            waited += 1
            if waited >= len(ledger.queue):
                time.sleep(POLL_SECONDS)


def _run_in_workers(ledger: _Ledger, evaluate: Evaluate) -> None:
    crew = _Crew(ledger.store.path, evaluate, min(ledger.workers, len(ledger.queue)))
    try:
        not_before = dict.fromkeys(ledger.queue, 0.0)
        while ledger.queue or ledger.running:
            for connection in crew.idle():
                key = _next_due(ledger.queue, not_before)
                if key is None:
                    break
                ledger.start(key)
                if not crew.send(connection, key, ledger.cases[key]):
                    ledger.postpone(key)
            for key, answer in crew.answers(POLL_SECONDS):
                if answer is None:
                    ledger.lose(key)
                elif not _enter(ledger, answer):
                    not_before[key] = time.monotonic() + POLL_SECONDS
    finally:
        crew.end()


def _next_due(queue: deque[str], not_before: dict[str, float]) -> str | None:
    for key in queue:
        if not_before[key] <= time.monotonic():
            queue.remove(key)
            return key
    return None


class _Crew:
    """The worker processes, each with the case it is at."""

    def __init__(self, store_path: Path, evaluate: Evaluate, size: int) -> None:
        self._store_path, self._evaluate, self._size = store_path, evaluate, size
        self._context = multiprocessing.get_context("spawn")
        self._workers: dict[Connection, tuple[BaseProcess, str | None]] = {}
        for _ in range(size):
            self._hire()

    def _hire(self) -> None:
        here, there = self._context.Pipe()
        process = self._context.Process(target=_serve, args=(there, self._store_path, self._evaluate), daemon=True)
        with _threads_shared_by(self._size):
            process.start()
        there.close()
        self._workers[here] = (process, None)

    def idle(self) -> list[Connection]:
        return [connection for connection, (_, key) in self._workers.items() if key is None]

    def send(self, connection: Connection, key: str, case: Case) -> bool:
        """Hand a case to a worker; False, and a new worker in its place, where it is gone."""
        process, _ = self._workers[connection]
        try:
            connection.send((key, case))
        except OSError:
            self._replace(connection)
            return False
        self._workers[connection] = (process, key)
        return True

    def answers(self, timeout_s: float) -> Iterator[tuple[str, _Answer | None]]:
        """Yield (key, answer), with None for the answer of a worker that died."""
        busy = [connection for connection, (_, key) in self._workers.items() if key is not None]
        if not busy:
            time.sleep(timeout_s)
        for connection in wait(busy, timeout_s) if busy else ():
            process, key = self._workers[connection]
            try:
                answer = connection.recv()
            except (EOFError, OSError):
                self._replace(connection)
                yield key, None
            else:
                self._workers[connection] = (process, None)
                yield key, answer

    def _replace(self, connection: Connection) -> None:
        process, _ = self._workers.pop(connection)
        connection.close()
        process.join(timeout=10.0)
        self._hire()

    def end(self) -> None:
        """End idle workers by closing their pipes, busy ones by force (their claims lapse with their processes)."""
        for connection, (process, key) in self._workers.items():
            connection.close()
            if key is not None:
                process.terminate()
        for process, _ in self._workers.values():
            process.join(timeout=10.0)


def _serve(connection: Connection, store_path: Path, evaluate: Evaluate) -> None:
    """What a worker process does: cases in, answers out, until the pipe closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the parent decides
    try:
        with ResultStore(store_path) as store:
            while True:
                key, case = connection.recv()
                try:
                    answer = _compute(store, key, case, evaluate)
                except InputError as error:
                    answer = _Answer(key, "store", reason=str(error))
                connection.send(answer)
    except (EOFError, OSError):
        return  # the parent has closed the pipe, or is gone


@contextlib.contextmanager
def _reporting(ledger: _Ledger) -> Iterator[None]:
    """Report every few seconds while the body runs, so that the time left counts down within a long case."""
    stop = threading.Event()

    def repeat() -> None:
        while not stop.wait(REPORT_SECONDS):
            ledger.report()

    thread = threading.Thread(target=repeat, daemon=True)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


@contextlib.contextmanager
def _threads_shared_by(workers: int) -> Iterator[None]:
    """Let each process started in the body use its share of the processors; one the user set stays."""
    name = "NUMBA_NUM_THREADS"
    if name in os.environ:
        yield
        return
    os.environ[name] = str(max(1, (os.cpu_count() or 1) // workers))
    try:
        yield
    finally:
        del os.environ[name]
