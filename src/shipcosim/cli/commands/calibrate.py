"""The command `shipcosim calibrate`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.exits import FAILED
from shipcosim.cli.options import Channels, Debug, Effects, Force, Ship


def calibrate(
    logs: Annotated[
        list[Path],
        typer.Argument(metavar="LOG...", help="Logs of one ship that is well: .csv, .csv.gz, .parquet, .nc."),
    ],
    channels: Channels = None,
    system: Ship = None,
    effects: Effects = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Folder of the results. [default: results/calibrated-SYSTEM]"),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print reference.json instead of a summary.")] = False,
    force: Force = False,
    debug: Debug = False,
) -> None:
    """Fit a ship's numbers to logs in which she is known to be well: her own parameter set, and a reference.

    Leaves calibrated.ssv, reference.json and report.html. `shipcosim diagnose LOG --reference DIR` then says what has
    changed since. Exit code 1 if these logs make no reference: only the page is left then, which says why.

    Example: shipcosim calibrate monday.csv tuesday.csv
    """
    from shipcosim.cli.calibration import calibrate_ship, print_calibration
    from shipcosim.cli.diagnosis import logs_of

    ship, folder = calibrate_ship(logs_of(logs), out, system=system, channels=channels, effects=effects)
    print_calibration(ship, folder, as_json)
    if ship.refusals:
        raise typer.Exit(FAILED)
