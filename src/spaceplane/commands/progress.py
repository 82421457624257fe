"""What a command says while it works: a bar on a terminal, a line now and then in a log; always on stderr."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

LOG_SECONDS = 10.0
Tell = Callable[..., None]


@contextmanager
def progress_bar() -> Iterator[Tell]:
    """A function that stages call to say how far they are; the bar goes away at the end.

    It takes (what runs, fraction done) or (phase, steps done, steps in all, text).
    """
    if sys.stderr.isatty():
        with _bar() as show:
            yield _either(show)
    else:
        yield _either(_log())


def _either(show: Callable[[str, float], None]) -> Tell:
    def tell(line: str, *rest) -> None:
        if len(rest) == 1:
            show(line, rest[0])
            return
        done, total, text = rest
        show(f"{line}: {text}" if text else line, done / max(total, 1))

    return tell


@contextmanager
def _bar() -> Iterator[Callable[[str, float], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(bar_width=32),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=1.0)

        def tell(line: str, fraction: float) -> None:
            bar.update(task, description=line, completed=min(max(fraction, 0.0), 1.0))

        yield tell


def _log() -> Callable[[str, float], None]:
    started = time.monotonic()
    last = {"line": "", "at": started}

    def tell(line: str, fraction: float) -> None:
        now = time.monotonic()
        new_line = line.split(":")[0] != last["line"].split(":")[0]
        if now - started > 2.0 and (new_line or now - last["at"] > LOG_SECONDS):
            print(f"[{now - started:5.0f} s] {100 * fraction:3.0f} % {line}", file=sys.stderr, flush=True)
            last["line"], last["at"] = line, now

    return tell
