"""Command of the trial: `python tests/bench/trial run ...`, `sail` and `table`; `--help` says more."""

import argparse
import os
import sys
from contextlib import contextmanager
from pathlib import Path

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # truth, trial

from trial import comparison, manoeuvres, runs, scoring, tables

ROOT = Path(__file__).resolve().parents[3]
PAGE = ROOT / "docs" / "generated" / "diagnosis-trial.md"
FIRST_SEED = 5000  # of the trial; below 1000 is for developing


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__)
    commands = parser.add_subparsers(required=True)
    running = commands.add_parser("run", help="draw and diagnose what is not in the results yet")
    running.add_argument("--kinds", nargs="+", choices=runs.KINDS, default=runs.KINDS)
    running.add_argument("--sets", nargs="+", choices=runs.SETS, default=["one", "healthy"])
    running.add_argument(
        "--seeds", type=_range, default=range(FIRST_SEED, FIRST_SEED + 200), help="FROM:TO"
    )
    running.add_argument("--into", type=Path, default=ROOT / "results" / "trial.jsonl")
    running.add_argument("--jobs", type=int, default=1)
    running.add_argument("--minutes", type=float, help="begin no new batch after this long")
    running.add_argument("--tool", help="module:function that diagnoses a path")
    running.set_defaults(call=_run)
    sailing = commands.add_parser(
        "sail", help="sail what ambiguous answers prescribe, and diagnose the longer logs"
    )
    sailing.add_argument("--kinds", nargs="+", choices=runs.KINDS, default=runs.KINDS)
    sailing.add_argument("--sets", nargs="+", choices=runs.SETS, default=["one"])
    sailing.add_argument(
        "--into", type=Path, default=ROOT / "results" / "trial.jsonl", help="where the answers are"
    )
    sailing.add_argument("--jobs", type=int, default=1)
    sailing.add_argument("--minutes", type=float, help="begin no new log after this long")
    sailing.add_argument("--tool", default=runs.TOOL, help="module:function that diagnoses a path")
    sailing.set_defaults(call=_sail)
    showing = commands.add_parser("table", help="print the table of results")
    showing.add_argument(
        "results", type=Path, nargs="*", default=[ROOT / "results" / "trial.jsonl"]
    )
    showing.add_argument(
        "--write", action="store_true", help="into docs/generated/diagnosis-trial.md too"
    )
    showing.set_defaults(call=_table)
    beside = commands.add_parser("rivals", help="print the rates of several tools on the same logs")
    beside.add_argument("results", type=Path, nargs="+")
    beside.add_argument(
        "--write", action="store_true", help="into docs/generated/diagnosis-trial.md too"
    )
    beside.set_defaults(call=_rivals)
    options = parser.parse_args(arguments)
    options.call(options)


def _run(options):
    if options.jobs > 1:
        os.environ.setdefault("OMP_NUM_THREADS", "1")
    with shown() as show:
        runs.run(
            options.kinds,
            options.sets,
            options.seeds,
            options.into,
            tool=options.tool,
            jobs=options.jobs,
            minutes=options.minutes,
            progress=show,
        )


def _sail(options):
    if options.jobs > 1:
        os.environ.setdefault("OMP_NUM_THREADS", "1")
    with shown() as show:
        manoeuvres.sail(
            options.kinds,
            options.sets,
            options.into,
            tool=options.tool,
            jobs=options.jobs,
            minutes=options.minutes,
            progress=show,
        )


@contextmanager
def shown():
    """A line for each result, and on a terminal below them a bar: share of the plan, time left; yields a function."""
    columns = [BarColumn(), MofNCompleteColumn(), TaskProgressColumn(), TimeElapsedColumn()]
    columns += [TextColumn("left:"), TimeRemainingColumn()]
    hour = 3600.0  # s of results that tell the pace
    with Progress(
        *columns, speed_estimate_period=hour, transient=True, disable=not sys.stdout.isatty()
    ) as bar:
        task = bar.add_task("", total=None)

        def show(result, total):
            bar.console.print(_line(result), markup=False, highlight=False, soft_wrap=True)
            sys.stdout.flush()
            bar.update(task, advance=1, total=total)

        yield show


def _line(result):
    judged = scoring.score(result["answer"], result["diagnosis"] or tables.UNJUDGED, result["span"])
    mark = "right" if judged.right else "MISS "
    names = f"{tables.hidden_name(result)} -> {tables.answered_name(result)}"
    return f"{mark} {result['kind']} {result['set']} {result['seed']}: {names}, {result['seconds']:.0f} s"


def _table(options):
    results = _found(options.results)
    _tell(tables.leading(results), "leading", options.write)
    _tell(tables.table(results), "table", options.write)


def _rivals(options):
    _tell(comparison.comparison(_found(options.results)), "rivals", options.write)


def _found(paths):
    found = [result for path in paths for result in runs.read_results(path)]
    if not found:
        sys.exit(f"no results in {', '.join(map(str, paths))}")
    return found


def _tell(text, name, write):
    print(text)
    if write:
        begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
        page = PAGE.read_text(encoding="utf-8")
        before, after = page.split(begin)[0], page.split(end)[1]
        PAGE.write_text(f"{before}{begin}\n{text}\n{end}{after}", encoding="utf-8")


def _range(text):
    start, _, end = text.partition(":")
    return range(int(start), int(end) if end else int(start) + 1)


if __name__ == "__main__":
    main()
