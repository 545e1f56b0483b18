"""The command `shipcosim sea-trials`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.options import AsJson, Channels, Effects, Force, Junit, Quiet, Ship, out_option
from shipcosim.cli.outcomes.exits import Conclusion


def sea_trials(
    data: Annotated[
        Path, typer.Argument(metavar="DATA", help="Measured data: .csv, .csv.gz, .parquet or .nc.")
    ],
    channels: Channels = None,
    system: Ship = None,
    effects: Effects = None,
    orders: Annotated[
        bool,
        typer.Option(
            "--orders", help="Thruster channels are orders, which the units follow, not feedback."
        ),
    ] = False,
    out: Annotated[
        Path | None,
        out_option("Folder of the results. Default: results/DATA-sea-trials."),
    ] = None,
    as_json: AsJson = False,
    junit: Junit = None,
    quiet: Quiet = False,
    force: Force = False,
) -> Conclusion:
    """Say what a simulation gets wrong of a ship's manoeuvring trials: straight runs, turning circles, zig-zags.

    By features that need no clock: steady speed, rate and drift, time and speed over heading. Causes are fitted on
    circles to one side and judged on those to the other. Leaves sea_trials.json, and where causes were found
    extended.ssp and extended.ssv. Exit code 0 if simulation and trials agree, 1 if something was found.

    Example: shipcosim sea-trials trials.csv --channels channels.toml
    """
    from shipcosim.calls.arguments import default_folder
    from shipcosim.calls.logs import sea_trials as study_trials
    from shipcosim.cli.progress import shown_progress
    from shipcosim.cli.sea_trials import print_study
    from shipcosim.diagnose.sea_trials.study import STEPS

    folder = out or default_folder(data, "-sea-trials")
    with shown_progress(STEPS) as progress:
        study = study_trials(
            data, system, channels, effects, progress, orders=orders, out=folder, force=force
        )
    return Conclusion(data.name, study, lambda: print_study(study, folder), folder)
