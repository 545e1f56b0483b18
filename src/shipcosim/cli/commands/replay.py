"""The command `shipcosim replay`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.options import Channels, Force, out_option, time_option
from shipcosim.cli.outcomes.exits import Conclusion


def replay(
    log: Annotated[
        Path, typer.Argument(metavar="LOG", help="Measured data: .csv, .csv.gz, .parquet or .nc.")
    ],
    system: Annotated[
        str | None,
        typer.Option(
            "--system",
            metavar="SSP",
            help="A system, or extended.ssp. [default: as of `shipcosim diagnose`]",
        ),
    ] = None,
    before: Annotated[
        str | None,
        typer.Option(
            "--before",
            metavar="SSP",
            help="The system to compare with. [default: the one that was extended]",
        ),
    ] = None,
    channels: Channels = None,
    parameters: Annotated[
        list[Path] | None,
        typer.Option(
            "--parameters",
            metavar="X.SSV",
            help="A set over the system's own, for 'after'; repeatable.",
        ),
    ] = None,
    horizon: Annotated[
        float | None,
        time_option(
            "--horizon",
            "Length of each prediction; in s, or with a unit: '2 min'. Default: fits craft and log.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        out_option("Folder of the results. [default: results/LOG-replay]"),
    ] = None,
    force: Force = False,
) -> Conclusion:
    """Draw a log and its simulation by a system, before and after a diagnosis: track, heading and speeds, errors.

    The system is started again and again from the measured state and driven by what the log says of its thrusters.
    Leaves report.html, errors.csv and replay.nc.

    Example: shipcosim replay log.csv --system results/log/extended.ssp
    """
    from shipcosim.calls.arguments import default_folder
    from shipcosim.calls.logs import replay as replay_log
    from shipcosim.cli.console import progress_of
    from shipcosim.cli.replaying import print_replay

    folder = out or default_folder(log, "-replay")
    with progress_of(f"replaying {log.name}") as progress:
        options = {"parameters": parameters or [], "horizon": horizon, "force": force}
        replayed = replay_log(
            log, system, before, channels, progress=progress, out=folder, **options
        )
    return Conclusion(log.name, replayed, lambda: print_replay(replayed, folder), folder)
