"""The command `shipcosim sweep`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim import library
from shipcosim.cli.options import Debug, Force, Out, Settings
from shipcosim.cli.start.completion import names_of, words_of


def sweep(
    study: Annotated[
        str,
        typer.Argument(metavar="STUDY", help="A study: a file or a name.", autocompletion=names_of("study")),
    ],
    out: Out = None,
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="Run on a Dask cluster, such as tcp://10.0.0.5:8786."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option("--workers", metavar="N", min=1, help="Processes here. Default: one a core.")
    ] = None,
    engine: Annotated[
        str,
        typer.Option(
            "--engine",
            help="What runs the FMUs: native (models compiled) or fmpy.",
            autocompletion=words_of("native", "fmpy"),
        ),
    ] = "native",
    settings: Settings = None,
    at_most: Annotated[
        int | None,
        typer.Option("--runs-at-most", metavar="N", min=0, help="Do at most so many runs now; others another time."),
    ] = None,
    force: Force = False,
    debug: Debug = False,
) -> None:
    """Run a study: a scenario many times, with other weather, events, parameters. Leaves runs.parquet, a row a run,
    runs.csv, summary.csv, study.json and report.html in results/STUDY.

    It goes on where it was interrupted: runs that are done are on disk. A run that fails is a row with its error. A
    study that has changed starts anew; earlier results are kept in results/STUDY-1, -2, ... unless --force is given,
    which does all runs again.

    Exit code 1 says that some runs failed.

    Example: shipcosim sweep wind_limits --runs-at-most 8
    """
    from shipcosim.cli.requests import parsed_settings
    from shipcosim.cli.sweeping import sweep_and_save
    from shipcosim.sweep import plan_of, read_study

    plan = plan_of(read_study(library.find("study", study)), parsed_settings(settings or []))
    sweep_and_save(
        plan,
        out or Path("results") / plan.study.name,
        engine=engine,
        scheduler=scheduler,
        workers=workers,
        at_most=at_most,
        again=force,
    )
