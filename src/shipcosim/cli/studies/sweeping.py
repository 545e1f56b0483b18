"""A study from the command line: what will be done, how far it is, how it went."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import inf
from typing import TYPE_CHECKING, Any

import typer
from rich.console import Console
from rich.text import Text

from shipcosim.cli.console import say_page, shown_path
from shipcosim.cli.outcomes.exits import INTERRUPTED
from shipcosim.cli.terminal import make_console, say
from shipcosim.sweep import Plan, Swept
from shipcosim.sweep.summary import RANGE

if TYPE_CHECKING:
    from shipcosim.calls.studies import PlannedStudy
    from shipcosim.results.study import StudyResult

SHOWN = 20  # rows of the summary on the terminal
MOST_IMPORTANT = 10  # parameters of each quantity on the terminal


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
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    console = make_console(stderr=True)
    each = plan.duration / max(len(plan), 1)
    columns = [
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[pace]}"),
    ]
    columns.append(TimeRemainingColumn())
    console.print(f"{plan.study.name}: {len(plan):,} runs of {each:,.0f} s.")
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as bar:
        task = bar.add_task("", total=len(plan), pace="")
        first = []
        said = []

        def report(done: int, total: int) -> None:
            elapsed = bar.tasks[0].elapsed or 0.0
            if not first:
                first.append((done, elapsed))
            rate = (done - first[0][0]) / (elapsed - first[0][1]) if elapsed > first[0][1] else 0.0
            pace = f"{rate:.1f} runs/s, {rate * each:,.0f} ship-s/s" if rate else ""
            bar.update(task, completed=done, total=total, pace=pace)
            if rate and not said and elapsed - first[0][1] > 2.0 and done < total:
                said.append(done)
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
        # What is known of a value that not every case was run for takes its place.
        shown = swept.summary.copy()
        for name in [name for name in shown if str(name).endswith(RANGE)]:
            shown[str(name).removesuffix(RANGE)] = shown.pop(name)
        text = shown.to_string(index=False, na_rep="", float_format=_number)
        console.print(text, markup=False)
    if "indices" in swept.tables:
        _say_indices(console, swept)
    if "pareto" in swept.tables.get("trials", ()):  # not where no trial is done yet
        _say_trials(console, swept)
    for remark in swept.about.get("remarks", ()):
        console.print(remark, markup=False)
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
    console.print(
        f"{counts['done']:,} of {counts['planned']:,} runs are done{open_}.", markup=False
    )
    say_page(console, swept.folder / "report.html")


def _number(value: float) -> str:
    """A number of the summary; what no run reached is infinite."""
    return "never in the run" if value == inf else f"{value:.4g}"


def _say_indices(console: Console, swept: Swept) -> None:
    """Sobol indices of each quantity, those of the most important parameters."""
    indices = swept.tables["indices"]
    factors = [one.name for one in swept.plan.study.factor]
    for key, part in indices.groupby(["quantity", *factors], sort=False):
        quantity, *levels = key if isinstance(key, tuple) else (key,)
        of = ", ".join(
            [
                str(quantity),
                *(f"{name} {level}" for name, level in zip(factors, levels, strict=True)),
            ]
        )
        more = f", {MOST_IMPORTANT} of {len(part)} parameters" if len(part) > MOST_IMPORTANT else ""
        console.print(f"Sobol indices of {of}{more}:", markup=False)
        shown = part.head(MOST_IMPORTANT)
        columns = {"parameter": shown["parameter"].tolist()}
        for name in ("total", "first_order"):
            ends = zip(*(shown[f"{name}{end}"] for end in ("", "_low", "_high")), strict=True)
            columns[name] = [f"{value:.2f} ({low:.2f} to {high:.2f})" for value, low, high in ends]
        console.print(type(shown)(columns).to_string(index=False), markup=False)


def _say_trials(console: Console, swept: Swept) -> None:
    """Trials of a search that no other beats, and the one as shipped."""
    trials = swept.tables["trials"]
    tune = swept.plan.study.tune
    assert tune is not None
    names = [one.quantity for one in tune.objective]
    front = trials.loc[trials["pareto"]].sort_values(by=names[0])
    said = f"of {len(trials)} trials no other beats {len(front)}; trial 0 is as shipped."
    console.print(
        f"{', '.join(f'{one.quantity} {one.direction}d' for one in tune.objective)}: {said}",
        markup=False,
    )
    shown = front.iloc[:: max(-(-len(front) // SHOWN), 1)]
    ours = trials[trials["as_shipped"] & ~trials["trial"].isin(shown["trial"])]
    columns = (
        ["trial", *names, *(one.name for one in swept.plan.samples.columns)]
        if swept.plan.samples
        else []
    )
    text = type(trials)({name: [*shown[name], *ours[name]] for name in columns})
    console.print(
        text.to_string(index=False, float_format=lambda value: f"{value:.4g}"), markup=False
    )
