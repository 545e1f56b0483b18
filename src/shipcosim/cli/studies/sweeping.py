"""A study from the command line: what will be done, how far it is, how it went."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, cast

import typer
from rich.console import Console
from rich.text import Text

from shipcosim.cli.console import say_page, shown_path
from shipcosim.cli.outcomes.exits import INTERRUPTED
from shipcosim.cli.progress import bar_on, tenths
from shipcosim.cli.tables import print_table
from shipcosim.cli.terminal import make_console, say
from shipcosim.sweep import Plan, Swept

if TYPE_CHECKING:
    import pandas

    from shipcosim.calls.studies import PlannedStudy
    from shipcosim.results.study import StudyResult

SHOWN = 20  # rows of the summary on the terminal
MOST_IMPORTANT = 10  # parameters of each quantity on the terminal
ENDS = ("", "_low", "_high")  # of an index and its interval


def sweep_with_progress(study: PlannedStudy, **options: Any) -> StudyResult:
    """Run what is not done of a study, with a progress bar.

    Parameters
    ----------
    study : PlannedStudy
    **options
        As of `shipcosim.sweep.run_study`.

    Raises
    ------
    typer.Exit
        If it was interrupted.
    """
    with _progress(study.plan) as progress:
        try:
            return study.run(progress=progress, **options)
        except KeyboardInterrupt:
            kept = shown_path(study.folder)
            say(f"Interrupted. What is done is kept in {kept}; the same command goes on.", err=True)
            raise typer.Exit(INTERRUPTED) from None


@contextmanager
def _progress(plan: Plan) -> Iterator[Callable[[int, int], None]]:
    """Progress bar with runs and simulated seconds a second, and the time that is left.

    Where there is no terminal, a line at the start, when the first runs show how long all will take, and each tenth.
    """
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        TextColumn,
        TimeRemainingColumn,
    )

    console = make_console(stderr=True)
    each = plan.duration / max(len(plan), 1)
    columns = [
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[pace]}"),
        TimeRemainingColumn(),
    ]
    console.print(f"{plan.study.name}: {len(plan):,} runs of {each:,.0f} s.")
    with bar_on(console, *columns) as bar:
        task = bar.add_task("", total=len(plan), pace="")
        first = []
        announced = []
        say_tenth = tenths(console, plan.study.name)

        def report(done: int, total: int) -> None:
            elapsed = bar.tasks[0].elapsed or 0.0
            if not first:
                first.append((done, elapsed))
            rate = (done - first[0][0]) / (elapsed - first[0][1]) if elapsed > first[0][1] else 0.0
            pace = f"{rate:.1f} runs/s, {rate * each:,.0f} ship-s/s" if rate else ""
            bar.update(task, completed=done, total=total, pace=pace)
            say_tenth(done, total, pace)
            if rate and not announced and elapsed - first[0][1] > 2.0 and done < total:
                announced.append(done)
                left = total - done
                console.print(
                    f"{pace}: about {_time(left / rate)} for the {left:,} runs that are left."
                )

        yield report


def _time(seconds: float) -> str:
    for unit, length in (("h", 3600.0), ("min", 60.0)):
        if seconds > 1.5 * length:
            return f"{seconds / length:.1f} {unit}"
    return f"{seconds:.0f} s"


def print_study(swept: Swept) -> None:
    """The summary, errors, and where the page is."""
    console = make_console(soft_wrap=True)
    if 0 < len(swept.summary) <= SHOWN:
        _print_frame(console, swept, swept.summary)
    if "indices" in swept.tables:
        _say_indices(console, swept)
    if "pareto" in swept.tables.get("trials", ()):  # not where no trial is done yet
        _say_trials(console, swept)
    for remark in swept.about.get("remarks", ()):
        console.print(remark)
    counts = swept.about["runs"]
    errors = swept.runs.loc[swept.runs["error"] != "", "error"]
    if len(errors):
        console.print(
            Text(
                f"{counts['failed']} runs failed, the first with: {errors.iloc[0]}",
                style="bold red",
            )
        )
    left = counts["planned"] - counts["done"]
    open_ = f"; {left:,} are left, which the same command does" if left else ""
    console.print(f"{counts['done']:,} of {counts['planned']:,} runs are done{open_}.")
    say_page(console, swept.folder / "report.html")


def _print_frame(console: Console, swept: Swept, frame: pandas.DataFrame) -> None:
    """A table as the page has it: in units to read, with intervals in the cells of their values."""
    from shipcosim.report.study import columns_of, summary_table

    table = summary_table(columns_of(frame, swept.about["columns"]))
    print_table(console, table.rows, table.head)


def _say_indices(console: Console, swept: Swept) -> None:
    """Sobol indices of each quantity, those of the most important parameters."""
    indices = swept.tables["indices"]
    factors = [factor.name for factor in swept.plan.study.factor]
    for key, part in indices.groupby(["quantity", *factors], sort=False):
        quantity, *levels = key if isinstance(key, tuple) else (key,)
        of = ", ".join(
            [
                str(quantity),
                *(f"{name} {level}" for name, level in zip(factors, levels, strict=True)),
            ]
        )
        more = f", {MOST_IMPORTANT} of {len(part)} parameters" if len(part) > MOST_IMPORTANT else ""
        console.print(f"Sobol indices of {of}{more}:")
        names = [f"{name}{end}" for name in ("total", "first_order") for end in ENDS]
        shown = part.head(MOST_IMPORTANT)[["parameter", *names]].round(2)
        _print_frame(console, swept, cast("pandas.DataFrame", shown))


def _say_trials(console: Console, swept: Swept) -> None:
    """Pareto-optimal trials of a search, and the trial with the shipped gains."""
    trials = swept.tables["trials"]
    tune = swept.plan.study.tune
    assert tune is not None
    names = [objective.quantity for objective in tune.objective]
    front = trials.loc[trials["pareto"]].sort_values(by=names[0])
    message = (
        f"{len(front)} of {len(trials)} trials are Pareto-optimal; trial 0 has the shipped gains."
    )
    console.print(
        f"{', '.join(f'{objective.quantity} {objective.direction}d' for objective in tune.objective)}: {message}",
    )
    shown = front.iloc[:: max(-(-len(front) // SHOWN), 1)]
    ours = trials[trials["as_shipped"] & ~trials["trial"].isin(shown["trial"])]
    columns = (
        ["trial", *names, *(column.name for column in swept.plan.samples.columns)]
        if swept.plan.samples
        else []
    )
    _print_frame(
        console, swept, type(trials)({name: [*shown[name], *ours[name]] for name in columns})
    )
