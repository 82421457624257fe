"""Progress on stderr."""

from __future__ import annotations

import pytest

from spaceplane.commands import progress


def told(bodies: int, calls: list[tuple]) -> list[tuple[str, float]]:
    shown: list[tuple[str, float]] = []
    tell = progress._whole(lambda line, fraction: shown.append((line, fraction)), bodies)
    for call in calls:
        tell(*call)
    return shown


def test_fractions_only_grow_over_bodies_and_phases():
    calls = []
    for body in ("base", "elevon_left +5 deg", "body_flap +5 deg"):
        calls += [(f"{body}: geometry", 0, 1, ""), (f"{body}: compile mesh", 0, 1, ""), (f"{body}: mesh", 0, 1, "")]
        calls += [(f"{body}: start level 2, order 1", 30, 60, "x"), (f"{body}: start level 1, order 2", 1, 60, "x")]
        calls += [(f"{body}: fine", k, 120, "x") for k in range(0, 60, 10)]
    calls += [("flight dynamics", 0, 1, ""), ("report", 0, 1, "out")]
    fractions = [fraction for _, fraction in told(3, calls)]
    assert fractions == sorted(fractions)
    assert fractions[0] == 0.0
    assert fractions[5] < progress.BASE_SHARE * 0.3  # coarse levels are the beginning of a body
    assert fractions[-1] > 0.9
    assert max(fractions) <= 1.0


def test_plain_fractions_pass_through():
    assert told(1, [("cones: Mach 3", 0.25)]) == [("cones: Mach 3", 0.25)]


def test_log_says_at_once_when_kernels_are_compiled_and_nothing_for_short_work(capfd, monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: False, raising=False)
    with progress.progress_bar() as tell:
        tell("mesh", 0, 1, "")
        tell("compile", 0, 1, "compiling kernels (once, ~20 s)")
        tell("fine", 1, 100, "12 active")
    err = capfd.readouterr().err
    assert err.count("\n") == 1
    assert "compiling kernels" in err


def test_log_says_each_compilation_of_a_body(capfd, monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: False, raising=False)
    with progress.progress_bar(2) as tell:
        tell("base: mesh", 0, 1, "")
        tell("base: compile mesh", 0, 1, "compiling mesh kernels (once, ~15 s)")
        tell("base: compile", 0, 1, "compiling kernels (once, ~20 s)")
    assert [line.count("compiling") for line in capfd.readouterr().err.splitlines()] == [1, 1]


def test_log_repeats_a_stage_only_now_and_then(capfd, monkeypatch):
    clock = iter([0.0, 5.0, 6.0, 7.0, 16.0, 17.0])
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(clock))
    show = progress._log()
    for k in range(5):
        show(f"fine: {k} active", k / 5)
    lines = capfd.readouterr().err.splitlines()
    assert len(lines) == 2
    assert lines[0].endswith("fine: 0 active") and lines[1].endswith("fine: 3 active")


@pytest.mark.parametrize("bodies", [1, 2, 4])
def test_the_whole_is_reached_at_the_last_body(bodies):
    assert progress._fraction(bodies - 1, 1.0, bodies) == pytest.approx(1.0)
