"""What the commands say: progress and errors on stderr, results on stdout."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from rich.text import Text

from shipcosim.cli.tables import print_table
from shipcosim.cli.terminal import make_console
from shipcosim.errors import AnyPath, Problem, worth_showing

if TYPE_CHECKING:
    from rich.console import Console

    from shipcosim.report.theme.views import Block, Outcome
    from shipcosim.results.check import CheckedFiles
    from shipcosim.results.run import Run

WIDEST = 40  # columns that a cell makes its column; longer ones stand out of it
STYLES = {"error": "bold red", "remark": "yellow"}
VERDICTS = {
    "passed": "bold green",
    "consistent": "bold green",
    "form": "bold yellow",
    "named": "bold blue",
    "partial": "bold yellow",
}
LINES = {"Remarks": ("yellow", ""), "What to do next": ("", "- ")}
"""Style of the lines below a heading, and what stands before each."""


def print_problems(problems: Iterable[Problem]) -> None:
    """Errors as one readable block on stderr."""
    console = make_console(stderr=True, soft_wrap=True)
    for problem in worth_showing(problems):
        console.print(_block(problem))


def _block(problem: Problem) -> Text:
    block = Text(f"{problem.severity}: ", style=STYLES.get(problem.severity, ""))
    if problem.where:
        block.append(f"{_from_here(problem.where)}:\n", style="bold")
    return block.append(
        _from_here(f"{problem.found} {problem.remedy}").rstrip(), style="not bold default"
    )


def _from_here(text: str) -> str:
    """The text with the files in it named from the working folder."""
    here = str(Path.cwd()) + os.sep
    return text.replace(here, "") if len(here) > 1 else text


@contextmanager
def progress_of(label: str, duration: float | None = None) -> Iterator[Callable[[int, int], None]]:
    """Progress on stderr, a bar or lines; yields a function of (done, in all). `duration` adds its speed. [s]"""
    from rich.progress import (
        BarColumn,
        TaskProgressColumn,
        TextColumn,
        TimeRemainingColumn,
    )

    from shipcosim.cli.progress import bar_on, tenths

    columns = [
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[pace]}"),
        TimeRemainingColumn(),
    ]
    console = make_console(stderr=True, highlight=True)
    with bar_on(console, *columns) as bar:
        task = bar.add_task(str(label), total=None, pace="")
        say_tenth = tenths(console, str(label))

        def report(done: int, total: int) -> None:
            elapsed = bar.tasks[0].elapsed or 0.0
            pace = (
                f"{duration * done / total / elapsed:.0f} x real time"
                if duration and total and elapsed
                else ""
            )
            bar.update(task, completed=done, total=total, pace=pace)
            say_tenth(done, total, pace)

        yield report


def print_summary(result: Run, page: Path, *, to_stderr: bool = False) -> None:
    """How a run went: its expectations, what must not be overlooked, where the page is."""
    from shipcosim.cosim.profile import PHASES, rows_of
    from shipcosim.report.run.predictions import summarise, texts

    console = make_console(stderr=to_stderr, soft_wrap=True)
    outcome, remarks, judged = result.digest
    if judged:
        words = {True: Text("pass", style="green"), False: Text("FAIL", style="bold red")}
        rows = [(words[passed], *cells) for passed, *cells in judged]
        print_table(console, rows, ("", "expected", "during", "worst", "at"))
    if predicted := texts(summarise(result.predictions)):
        print_table(console, predicted, ("error of the forecast", "position", "heading", ""))
    if "profile" in result.table.attrs:
        spent = rows_of(str(result.table.attrs["profile"]))
        rows = [(name, *(f"{duration:.3f}" for duration in seconds)) for name, seconds in spent]
        print_table(console, rows, ("seconds", *PHASES))
    before = {str(remark) for remark in result.remarks}  # these were printed before the run
    for remark in remarks:
        if remark not in before:
            console.print(Text(remark, style="yellow"))
    print_problems(result.errors)
    if result.table.attrs.get("engine") == "native":
        others = result.table.attrs.get("stepped_by_python")
        console.print(f"The models ran as compiled code{f', except {others}' if others else ''}.")
    say_outcome(console, outcome)
    say_page(console, page)


def print_overview(outcome: Outcome, rows: Iterable[tuple[str, Outcome]], page: Path) -> None:
    """How several scenarios went: one line each, then all together, and where the page is."""
    console = make_console(soft_wrap=True)
    listed = [
        (Text(result.word, style=VERDICTS.get(result.kind, "bold")), name, result.sentence)
        for name, result in rows
    ]
    print_table(console, listed, ("", "scenario", ""))
    say_outcome(console, outcome)
    say_page(console, page)


def print_found(outcome: Outcome, blocks: Iterable[Block], page: Path) -> None:
    """Print a result in the blocks of its notebook card, and the path of its page."""
    console = make_console(soft_wrap=True)
    # Red is what failed or was not understood.
    style = VERDICTS.get(outcome.kind, "bold red")
    console.print(Text(outcome.word, style=style), Text(outcome.sentence))
    for block in filter(None, blocks):
        # A table that a notebook folds is left to the page.
        if block.folded and block.table.rows:
            continue
        console.print()
        console.print(Text(block.heading, style="bold"))
        style, mark = LINES.get(block.heading, ("", ""))
        for line in block.lines:
            console.print(Text(f"{mark}{line}", style=style))
        print_table(console, block.table.rows, block.table.head)
    console.print()
    say_page(console, page)


def say_outcome(console: Console, outcome: Outcome) -> None:
    """The verdict line."""
    style = VERDICTS.get(outcome.kind, "bold red" if outcome.kind == "failed" else "bold")
    console.print(Text(outcome.word, style=style), Text(outcome.sentence))


def say_page(console: Console, page: Path) -> None:
    """Print the path of the page."""
    console.print(f"Page: {shown_path(page)}")


def shown_path(path: AnyPath) -> Path:
    """A path relative to the working folder where it lies in it, else absolute."""
    here = Path.cwd()
    absolute = Path(path).absolute()
    return absolute.relative_to(here) if absolute.is_relative_to(here) else absolute


def print_variables(rows: Iterable[Sequence[str]]) -> None:
    """An FMU's variables, nothing cut off: a line each, or a block each where the terminal is too narrow for that."""
    lines = [("variable", "causality", "type", "unit", "start", "meaning"), *rows]
    widths = [max(min(len(line[i]), WIDEST) for line in lines) for i in range(5)]
    console = make_console(soft_wrap=True)
    narrow = console.is_terminal and sum(widths) + 2 * len(widths) > console.width
    for number, line in enumerate(lines):
        name, *facts = (cell.ljust(width) for cell, width in zip(line[:5], widths, strict=True))
        first, last = (f"{name}\n    ", "\n    ") if narrow else (f"{name}  ", "  ")
        text = f"{first}{'  '.join(facts)}{last}{line[5]}"
        console.print(Text(text.rstrip(), style="" if number else "bold"))


def print_estimates(rows: Iterable[Sequence[str]]) -> None:
    """Table of what is estimated of a ship."""
    console = make_console(soft_wrap=True)
    print_table(console, rows, ("estimated", "value", "tolerance", "source"))


def print_report(checked: CheckedFiles) -> None:
    """Findings on files, variables of FMUs, estimates of ships."""
    console = make_console(soft_wrap=True)
    for file, problems in checked.files.items():
        # What must be mended stands first, what is only to be known takes a line.
        shown = sorted(worth_showing(problems), key=lambda each: not each.is_error)
        for _, equal in groupby(shown, key=lambda each: (each.severity, each.found, each.remedy)):
            # What several places have in common stands once, below all of them.
            *others, problem = equal
            for other in others:
                console.print(_block(replace(other, found="", remedy="")), end="")
            block = _block(problem)
            console.print(block if problem.is_error else Text(" ").join(block.split("\n")))
        errors = sum(problem.is_error for problem in problems)
        remarks = len(problems) - errors
        if errors:
            message = f"{errors} error{'s' * (errors > 1)}"
        elif remarks:
            message = f"no error, {remarks} remark{'s' * (remarks > 1)}"
        else:
            is_fmu = file.lower().endswith(".fmu")
            message = "nothing wrong" + is_fmu * " in its description; its binaries were not loaded"
        console.print(Text(f"{file}: {message}"))
    for variables in checked.variables.values():
        print_variables(variables)
    for estimates in checked.estimates.values():
        print_estimates(estimates)
