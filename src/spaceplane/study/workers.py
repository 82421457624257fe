"""Local worker processes: each takes a case over a pipe, computes it and stores the result itself.

A worker that dies loses the case it was at and nothing else.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import time
import traceback
from collections.abc import Iterator
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path

from spaceplane.errors import InputError
from spaceplane.study.records import Answer, Case, Evaluate
from spaceplane.study.store import ResultStore


def compute(store: ResultStore, key: str, case: Case, evaluate: Evaluate) -> Answer:
    """Claim, compute and store one case.

    Args:
        store: where the result goes.
        key: name of the result.
        case: what to compute.
        evaluate: from the case's inputs to the result.
    """
    if not store.claim(key):
        return Answer(key, "found" if store.finished([key]) else "busy")
    with store.holding(key):
        began = time.monotonic()
        try:
            result = evaluate(case.inputs)
        except InputError as error:
            return Answer(key, "failed", reason=str(error))
        except Exception as error:  # one broken case must not end the study; it is reported with its traceback
            return Answer(key, "failed", reason=f"{type(error).__name__}: {error}", traceback=traceback.format_exc())
        seconds = time.monotonic() - began
        store.put(key, case.label, case.inputs, result, seconds)
        return Answer(key, "done", seconds)


class Crew:
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
        """Return the connections of workers without a case."""
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

    def answers(self, timeout_s: float) -> Iterator[tuple[str, Answer | None]]:
        """Yield (key, answer), with None for the answer of a worker that died.

        Args:
            timeout_s: how long to wait for the first of them, s.
        """
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
                    answer = compute(store, key, case, evaluate)
                except InputError as error:
                    answer = Answer(key, "store", reason=str(error))
                connection.send(answer)
    except (EOFError, OSError):
        return  # the parent has closed the pipe, or is gone


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
