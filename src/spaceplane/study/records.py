"""What a study asks of one case and what comes back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


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
    """A case without a result.

    Attributes:
        label: of the case.
        reason: one line on why.
        traceback: where the program is to blame; else empty.
    """

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


@dataclass(frozen=True)
class Answer:
    """What a worker reports of one case.

    Attributes:
        key: of the case.
        verdict: "done", "found" (another process was first), "busy" (another one is at it), "failed" or "store" (the
            store cannot be used).
        seconds: it took, s.
        reason: why it failed.
        traceback: where the program is to blame.
    """

    key: str
    verdict: str
    seconds: float = 0.0
    reason: str = ""
    traceback: str = ""


Evaluate = Callable[[dict], dict]
Report = Callable[[Progress], None]
