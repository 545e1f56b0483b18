"""The command `shipcosim diagnose`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.exits import FAILED
from shipcosim.cli.options import Debug


def diagnose(
    data: Annotated[Path, typer.Argument(metavar="DATA", help="Measured data: .csv, .csv.gz, .parquet or .nc.")],
    channels: Annotated[
        Path | None, typer.Option("--channels", metavar="X.TOML", help="Which column is what, in which unit.")
    ] = None,
    system: Annotated[
        str | None,
        typer.Option("--system", metavar="SSP", help="The ship: a path, or its name in ssp/. [default: gunnerus_open]"),
    ] = None,
    effects: Annotated[
        Path | None, typer.Option("--effects", metavar="FOLDER", help="Causes of your own, one .toml each.")
    ] = None,
    reference: Annotated[
        Path | None,
        typer.Option("--reference", metavar="DIR", help="What `shipcosim calibrate` left: say what has changed since."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder of the results. [default: results/DATA]")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print diagnosis.json instead of a summary.")] = False,
    debug: Debug = False,
) -> None:
    """Say what a simulation gets wrong of a measured log, and why: causes by name, with size and probability.

    Leaves diagnosis.json and report.html; where a cause in the model was named extended.ssp and extended.ssv. Exit
    code 0 if simulation and log agree, 1 if something was found.
    """
    from shipcosim.cli.diagnosis import default_folder, diagnose_log, print_diagnosis
    from shipcosim.cli.results import check_targets

    folder = out or default_folder(data)
    check_targets(folder)
    diagnosis = diagnose_log(data, folder, system=system, channels=channels, effects=effects, reference=reference)
    print_diagnosis(diagnosis, folder, as_json)
    if diagnosis.verdict != "consistent":
        raise typer.Exit(FAILED)
