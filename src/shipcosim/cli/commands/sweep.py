"""The command `shipcosim sweep`."""

from typing import Annotated

import typer

from shipcosim.cli.options import AsJson, Force, Junit, Out, Quiet, Settings
from shipcosim.cli.outcomes.exits import Conclusion
from shipcosim.cli.start.completion import names_of, words_of

Number = Annotated[
    int | None,
    typer.Option(
        "--run",
        metavar="N",
        help="Simulate run N again, with its page in DIR/run-N, and nothing else.",
    ),
]
Serve = Annotated[
    bool,
    typer.Option(
        "--serve", help="Then show the page on this machine: a click on a row simulates it."
    ),
]
Port = Annotated[
    int | None,
    typer.Option(
        "--port", metavar="N", min=1, max=65535, help="Port of --serve. Default: a free one."
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler", metavar="ADDRESS", help="Run on a Dask cluster, such as tcp://10.0.0.5:8786."
    ),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", metavar="N", min=1, help="Processes here. Default: one a core."),
]
Engine = Annotated[
    str,
    typer.Option(
        "--engine",
        help="What runs the FMUs: native (models compiled) or fmpy.",
        autocompletion=words_of("native", "fmpy"),
    ),
]
AtMost = Annotated[
    int | None,
    typer.Option(
        "--runs-at-most",
        metavar="N",
        min=0,
        help="Do at most so many runs now; others another time.",
    ),
]


def sweep(
    study: Annotated[
        str,
        typer.Argument(
            metavar="STUDY", help="A study: a file or a name.", autocompletion=names_of("study")
        ),
    ],
    out: Out = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
    engine: Engine = "native",
    settings: Settings = None,
    at_most: AtMost = None,
    number: Number = None,
    serve: Serve = False,
    port: Port = None,
    as_json: AsJson = False,
    junit: Junit = None,
    quiet: Quiet = False,
    force: Force = False,
) -> Conclusion:
    """Run a study: a scenario many times, with other weather, events, parameters. Leaves runs.parquet, a row a run,
    runs.csv, summary.csv, study.json, verdict.json and report.html in results/STUDY.

    It goes on where it was interrupted: runs that are done are on disk. A run that fails is a row with its error. A
    study that has changed starts again; earlier results are kept in results/STUDY-1, -2, ... unless --force is given,
    which does all runs again.

    Exit code 1 says that some runs failed.

    Example: shipcosim sweep wind_limits --runs-at-most 8
    """
    from shipcosim.calls.studies import PlannedStudy
    from shipcosim.cli.requests import parsed_settings
    from shipcosim.cli.runs import print_run, run_with_progress
    from shipcosim.cli.studies.runs import serve as show
    from shipcosim.cli.studies.sweeping import print_study, sweep_with_progress

    planned = PlannedStudy(study, out=out, engine=engine, set=parsed_settings(settings))
    if number is not None:
        again = planned.run_again(
            number, lambda prepared, folder: run_with_progress(prepared, folder, force=True)
        )
        folder = planned.folder / f"run-{number}"
        return Conclusion(again.name, again, lambda: print_run(again, folder), folder)
    swept = sweep_with_progress(
        planned, scheduler=scheduler, workers=workers, at_most=at_most, force=force
    )
    if serve:
        print_study(swept)
        show(planned, swept, port or 0)
    name = planned.plan.study.name
    return Conclusion(name, swept, lambda: serve or print_study(swept), swept.folder)
