"""What a command says while it works: a bar on a terminal, a line now and then in a log; always on stderr."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

LOG_SECONDS = 10.0
QUIET_SECONDS = 2.0  # shorter work says nothing

Tell = Callable[..., None]
Show = Callable[[str, float], None]

# Where each phase of one body's computation begins and ends, as a fraction of it; by whole name or first word.
PHASES = {
    "geometry": (0.00, 0.02),
    "mesh": (0.02, 0.10),
    "compile mesh": (0.00, 0.00),
    "compile": (0.10, 0.10),
    "start": (0.10, 0.25),
    "fine": (0.25, 0.97),
    "retry": (0.97, 0.97),
}
BASE_SHARE = 0.55  # of an analysis with control derivatives: the base body has most conditions


@contextmanager
def progress_bar(bodies: int = 1) -> Iterator[Tell]:
    """A function that stages call to say how far they are; the bar goes away at the end.

    It takes (what runs, fraction done) or (phase, steps done, steps in all, text), where the phase may begin with the
    name of one of several `bodies` and a colon.
    """
    if sys.stderr.isatty():
        with _bar() as show:
            yield _whole(show, bodies)
    else:
        yield _whole(_log(), bodies)


def _whole(show: Show, bodies: int) -> Tell:
    """Turn the stages' counts into one fraction that only grows."""
    begun: list[str] = []
    reached = 0.0

    def tell(line: str, *rest) -> None:
        """Show what a stage says, with the fraction of the whole."""
        nonlocal reached
        if len(rest) == 1:
            show(line, rest[0])
            return
        done, total, text = rest
        body, _, phase = line.rpartition(": ")
        low, high = PHASES.get(phase) or PHASES.get(phase.split(" ")[0], (None, None))
        if low is not None:
            if body not in begun:
                begun.append(body)
            share = min(done / max(total, 1), 1.0)
            reached = max(reached, _fraction(begun.index(body), low + share * (high - low), bodies))
        elif begun:
            reached = max(reached, 0.97 if len(begun) >= bodies else reached)
        show(f"{line}: {text}" if text else line, reached)

    return tell


def _fraction(index: int, within: float, bodies: int) -> float:
    """Fraction of the whole when body number `index` of `bodies` is `within` done."""
    if bodies <= 1:
        return within
    if index == 0:
        return BASE_SHARE * within
    share = (1.0 - BASE_SHARE) / (bodies - 1)
    return min(BASE_SHARE + share * (index - 1 + within), 1.0)


@contextmanager
def _bar() -> Iterator[Show]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(bar_width=32),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(elapsed_when_finished=False),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=1.0)

        def show(line: str, fraction: float) -> None:
            """Move the bar."""
            bar.update(task, description=line, completed=min(max(fraction, 0.0), 1.0))

        yield show


def _log() -> Show:
    started = time.monotonic()
    last = {"stage": "", "at": started}

    def show(line: str, fraction: float) -> None:
        """Print a line when a new stage begins, or after a while."""
        now = time.monotonic()
        stage = line.rpartition(": ")[0] or line
        compiling = "compil" in line  # always said: the first run takes longer, and a reader wonders why
        due = now - started > QUIET_SECONDS and (stage != last["stage"] or now - last["at"] > LOG_SECONDS)
        if (compiling and stage != last["stage"]) or due:
            print(f"[{now - started:5.0f} s] {100 * fraction:3.0f} % {line}", file=sys.stderr, flush=True)
            last["stage"], last["at"] = stage, now

    return show
