"""How far long work is: the share never jumps back or above the whole, the time left follows the pace of the work."""

import itertools

import pytest
from rich.console import Console

from shipcosim.calls.runs import prepare_run
from shipcosim.cli import progress, runs
from shipcosim.cli.progress import LAST_STEP, Course, shown_progress

STEPS = {"reading": 1.0, "searching": 6.0, "predicting": 3.0}


class Clock:
    """A clock that is set by hand. [s]"""

    now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


def test_the_share_is_that_of_the_typical_time_of_what_is_done(clock):
    course, shares = Course(STEPS, clock), []
    for step, *parts in [
        ("reading",),
        ("searching",),
        ("searching", 1, 4),
        ("searching", 4, 4),
        ("predicting", 1, 2),
    ]:
        course.reached(step, *parts)
        shares.append(round(course.share, 3))
    assert shares == [0.0, 0.1, 0.25, 0.7, 0.85]


def test_the_share_never_jumps_back_or_above_the_whole(clock):
    told = [
        ("searching", 3, 4),
        ("searching", 0, 8),
        ("reading",),
        ("unheard of", 1, 1),
        ("searching", 9, 8),
    ]
    told += [("predicting", 2, 2), ("predicting", 1, 2), ("searching",)]
    course, shares = Course(STEPS, clock), []
    for step in told:
        course.reached(*step)
        shares.append(course.share)
    assert (
        all(before <= after for before, after in itertools.pairwise(shares)) and shares[-1] == 1.0
    )


def test_time_left_is_the_typical_one_at_first_and_then_by_the_pace(clock):
    course = Course(STEPS, clock)
    assert course.left() == pytest.approx(10.0)
    clock.now += 7.0  # seven times the typical second
    course.reached("searching")
    assert 9.0 * 3.5 < course.left() < 9.0 * 7.0
    before = course.left()
    clock.now += 2.0
    assert course.left() == pytest.approx(
        before - 2.0
    )  # counts down where no step is done meanwhile
    clock.now += 1000.0
    assert course.left() == 0.0


def test_a_machine_of_half_the_pace_is_given_twice_the_time(clock):
    course = Course(STEPS, clock)
    clock.now += 14.0
    course.reached("predicting")
    assert course.left() == pytest.approx(6.0, rel=0.1)


def test_steps_are_lines_where_no_terminal_is_but_the_first(capsys):
    with shown_progress(STEPS) as show:
        show("reading")
        show("reading", 1, 2)
        for done in range(3):
            show("predicting", done, 3)
        show(LAST_STEP)
    assert capsys.readouterr().err.splitlines() == ["3 of 4: predicting", f"4 of 4: {LAST_STEP}"]


def test_a_terminal_shows_share_and_time_left_of_the_whole(monkeypatch):
    console = Console(force_terminal=True, width=120, record=True, color_system=None)
    monkeypatch.setattr("rich.console.Console", lambda **given: console)
    with shown_progress(STEPS) as show:
        show("searching", 1, 2)
    said = console.export_text()
    assert "0:10 left" in said and "2 of 4: searching" in said and "38%" in said  # 4.0 of 10.5 s


@pytest.mark.parametrize("steps", [{"one": progress.LAST_TIME}])
def test_the_page_is_a_step_of_the_whole(steps, monkeypatch):
    console = Console(force_terminal=True, width=120, record=True, color_system=None)
    monkeypatch.setattr("rich.console.Console", lambda **given: console)
    with shown_progress(steps) as show:
        show(LAST_STEP)
    assert "50%" in console.export_text()


def test_long_work_is_a_line_each_tenth_where_no_terminal_is(clock, capsys):
    say = progress.tenths(Console(stderr=True, soft_wrap=True), "gust", clock)
    for done in range(1, 101):
        clock.now += 0.5
        say(done, 100, "12 x real time")
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "gust: 10 % after 5 s, 12 x real time" and len(lines) == 9


def test_short_work_needs_no_lines(clock, capsys):
    say = progress.tenths(Console(stderr=True), "gust", clock)
    for done in range(1, 101):
        clock.now += 0.01
        say(done, 100)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("slow", "compiler", "engine", "hints"),
    [
        (0.0, False, "auto", True),
        (0.0, True, "auto", False),
        (0.0, False, "fmpy", False),
        (60.0, False, "auto", False),
    ],
)
def test_a_slow_run_without_a_compiler_says_what_is_faster(
    slow, compiler, engine, hints, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(runs, "SLOW", slow)
    monkeypatch.setattr(runs, "is_installed", lambda: compiler)
    runs.run_with_progress(prepare_run("stationkeeping", until=1.0, engine=engine), tmp_path)
    assert (runs.FASTER in capsys.readouterr().err) == hints
