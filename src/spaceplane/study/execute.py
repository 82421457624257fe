"""Run many cases in this process or in several local ones, each result stored as soon as it is finished."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Sequence
from pathlib import Path

from spaceplane.errors import InputError
from spaceplane.study.keys import code_fingerprint, result_key
from spaceplane.study.ledger import Ledger, enter, reporting
from spaceplane.study.records import Case, Evaluate, Outcome, Report
from spaceplane.study.store import ResultStore
from spaceplane.study.workers import Crew, compute

POLL_SECONDS = 0.5


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
        ledger = Ledger(dict(zip(keys, cases, strict=True)), store, progress, workers)
        if ledger.queue:
            run = _run_here if workers == 1 else _run_in_workers
            with reporting(ledger):
                run(ledger, evaluate)
        results = tuple(store.get(key) for key in keys)
    failures = tuple(ledger.failures.values())
    return Outcome(results, failures, ledger.computed, ledger.reused, time.monotonic() - ledger.began)


def _run_here(ledger: Ledger, evaluate: Evaluate) -> None:
    waited = 0
    while ledger.queue:
        key = ledger.queue.popleft()
        ledger.start(key)
        if enter(ledger, compute(ledger.store, key, ledger.cases[key], evaluate)):
            waited = 0
        else:
            waited += 1
            if waited >= len(ledger.queue):
                time.sleep(POLL_SECONDS)


def _run_in_workers(ledger: Ledger, evaluate: Evaluate) -> None:
    crew = Crew(ledger.store.path, evaluate, min(ledger.workers, len(ledger.queue)))
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
                elif not enter(ledger, answer):
                    not_before[key] = time.monotonic() + POLL_SECONDS
    finally:
        crew.end()


def _next_due(queue: deque[str], not_before: dict[str, float]) -> str | None:
    for key in queue:
        if not_before[key] <= time.monotonic():
            queue.remove(key)
            return key
    return None
