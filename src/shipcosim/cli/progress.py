"""How far long work is: its steps, the share that is done, the time that is left."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING

from shipcosim.cli.terminal import make_console
from shipcosim.staging import WRITING as LAST_STEP

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress, ProgressColumn

LAST_TIME = 0.5
"""How long the last step typically takes. [s]"""
SHORT = 5.0
"""Work that is done within this time needs no lines on how far it is. [s]"""
CONFIDENCE = 0.1
"""How much of the work has to be done before its pace counts as much as the typical one."""


class Course:
    """How far work of several steps is.

    The share only grows, and is 1 at the end alone. The time that is left comes from the typical times of the steps,
    and more and more from how long the steps behind have taken.

    Parameters
    ----------
    steps : mapping of str to float
        Steps in order, with the time that each typically takes. [s]
    clock : callable
        Gives the time. [s]
    """

    def __init__(
        self, steps: Mapping[str, float], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._steps = dict(steps)
        self._clock = clock
        self._whole = sum(steps.values())
        self._start = self._at = clock()
        self.share = 0.0
        """Share of the work that is done, 0 to 1."""

    def reached(self, step: str, done: float | None = None, total: float | None = None) -> None:
        """Report the present step, and how many parts of it are done; unplanned steps have no share."""
        if step not in self._steps:
            return
        names = list(self._steps)
        before = sum(self._steps[name] for name in names[: names.index(step)])
        part = min(max((done or 0.0) / total, 0.0), 1.0) if total else 0.0
        share = (before + part * self._steps[step]) / self._whole
        if share > self.share:
            self.share, self._at = share, self._clock()

    def left(self) -> float:
        """Time until the end; 0 where it should have come already. [s]"""
        passed = self._at - self._start
        weight = CONFIDENCE * self._whole
        pace = (passed + weight) / (self.share * self._whole + weight)
        return max((1.0 - self.share) * self._whole * pace - (self._clock() - self._at), 0.0)


def tenths(
    console: Console, label: str, clock: Callable[[], float] = time.monotonic
) -> Callable[..., None]:
    """A function of (done, in all, pace) that prints a line each tenth of long work where there is no terminal.

    Parameters
    ----------
    console : Console
        On a terminal nothing is printed: there is a bar.
    label : str
        Of the work.
    clock : callable
        Gives the time. [s]
    """
    start = clock()
    last = 0

    def report(done: int, total: int, pace: str = "") -> None:
        nonlocal last
        tenth = 10 * done // total if total else 0
        passed = clock() - start
        is_long = last > 0 or passed * total > SHORT * done
        if not console.is_terminal and last < tenth < 10 and is_long:
            last = tenth
            speed = f", {pace}" if pace else ""
            console.print(f"{label}: {10 * tenth} % after {passed:.0f} s{speed}", highlight=False)

    return report


def bar_on(console: Console, *columns: ProgressColumn) -> Progress:
    """A progress bar that goes when the work is done; without a terminal there is none."""
    from rich.progress import Progress

    return Progress(*columns, console=console, transient=True, disable=not console.is_terminal)


@contextmanager
def shown_progress(steps: Mapping[str, float]) -> Iterator[Callable[..., None]]:
    """How far the work is, on stderr; yields a function of (step, parts of it done, of how many).

    On a terminal a bar with the share of the whole that is done and the time that is left; elsewhere a line for each
    step after the first, so that of input which cannot be used nothing but its error is said.

    Parameters
    ----------
    steps : mapping of str to float
        Steps in order except for the page, which is the last of all, with the time that each typically takes. [s]
    """
    from rich.progress import (
        BarColumn,
        SpinnerColumn,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
    )

    steps = {**steps, LAST_STEP: LAST_TIME}
    numbers = {
        step: f"{number} of {len(steps)}: {step}" for number, step in enumerate(steps, start=1)
    }
    console = make_console(stderr=True, highlight=True)
    course = Course(steps)
    announced = {next(iter(steps))}
    columns = [
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=24),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        _time_left(course),
    ]
    with bar_on(console, *columns) as bar:
        task = bar.add_task("", total=1.0)

        def show(step, done=None, total=None):
            course.reached(step, done, total)
            if not console.is_terminal and step not in announced:
                console.print(numbers.get(step, step), highlight=False)
            announced.add(step)
            bar.update(task, description=numbers.get(step, step), completed=course.share)

        yield show


def _time_left(course):
    """Column of the time that is left."""
    from rich.progress import ProgressColumn
    from rich.text import Text

    class TimeLeft(ProgressColumn):
        def render(self, task):
            minutes, seconds = divmod(round(course.left()), 60)
            return Text(f"{minutes}:{seconds:02d} left", style="progress.remaining")

    return TimeLeft()
