"""The books of a running study: which cases wait, run, are done or failed, and how long the rest will take."""

from __future__ import annotations

import contextlib
import threading
import time
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field

from spaceplane.errors import InputError
from spaceplane.study.records import Answer, Case, Failure, Progress, Report
from spaceplane.study.store import ResultStore

REPORT_SECONDS = 2.0
ATTEMPTS = 2  # a case that killed its worker this often is given up


@dataclass
class Ledger:
    """Which cases wait, run, are done or failed. Cases go by their key, see `keys.result_key`.

    Attributes:
        cases: key to case.
        store: where results are kept.
        progress: told on every change.
        workers: processes that compute at once.
        queue: keys that wait.
        running: key to the time (`time.monotonic`, s) at which it was begun.
        failures: key to what went wrong.
        attempts: key to how often a worker died at it.
        durations: s, of finished cases, those found in the store included.
        reused: cases found in the store at the beginning.
        computed: cases computed since.
        done: both together, and those that other processes finished meanwhile.
        began: time (`time.monotonic`, s) of the beginning.
    """

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
        """Tell `progress` how far the study is."""
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
        """Share of the running cases that is done, in cases, as the time of those before them tells."""
        if not self.durations:
            return 0.0
        mean = sum(self.durations) / len(self.durations)
        return sum(min((time.monotonic() - since) / max(mean, 1e-9), 0.95) for since in tuple(self.running.values()))

    def start(self, key: str) -> None:
        """The case is being computed."""
        self.running[key] = time.monotonic()
        self.report()

    def finish(self, key: str, seconds: float) -> None:
        """The case is stored; it took `seconds`."""
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
        """The case will have no result."""
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


def enter(ledger: Ledger, answer: Answer) -> bool:
    """Write an answer into the ledger; False when the case waits for another process.

    Raises:
        InputError: the worker cannot use the store.
    """
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


@contextlib.contextmanager
def reporting(ledger: Ledger) -> Iterator[None]:
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
