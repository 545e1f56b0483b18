"""The command `shipcosim calibrate`."""

from pathlib import Path
from typing import Annotated, Any

import typer

from shipcosim.cli.options import (
    AsJson,
    Channels,
    Effects,
    Force,
    Junit,
    Learn,
    Length,
    Quiet,
    Ship,
    out_option,
)
from shipcosim.cli.outcomes.exits import Conclusion


def calibrate(
    logs: Annotated[
        list[Path],
        typer.Argument(
            metavar="LOG...", help="Logs of one ship that is well: .csv, .csv.gz, .parquet, .nc."
        ),
    ],
    channels: Channels = None,
    system: Ship = None,
    effects: Effects = None,
    learn: Learn = False,
    length: Length = None,
    out: Annotated[
        Path | None,
        out_option("Folder of the results. [default: results/calibrated-SYSTEM]"),
    ] = None,
    as_json: AsJson = False,
    junit: Junit = None,
    quiet: Quiet = False,
    force: Force = False,
) -> Conclusion:
    """Fit a ship's numbers to logs in which she is known to be well: her own parameter set, and a reference.

    Leaves calibrated.ssv, reference.json and report.html. `shipcosim diagnose LOG --reference DIR` then says what has
    changed since. Exit code 1 if these logs make no reference: only the page is left then, which says why.

    With --learn the logs teach a craft that has no system: calibrated.ssv has her numbers for craft_open.ssp. They make
    no reference.

    Example: shipcosim calibrate monday.csv tuesday.csv
    """
    from shipcosim.calls.arguments import SYSTEM_OF_LOGS
    from shipcosim.calls.logs import calibrate as calibrate_ship
    from shipcosim.calls.logs import ship_of
    from shipcosim.cli.console import print_found
    from shipcosim.cli.progress import shown_progress
    from shipcosim.diagnose.calibration_pipeline import steps_of
    from shipcosim.report.calibration.words import blocks, outcome

    read = None if learn else ship_of(system or SYSTEM_OF_LOGS)
    name = read.name if read else "craft"
    folder = out or Path("results") / f"calibrated-{name}"
    options: dict[str, Any] = {"out": folder, "force": force, "learn": learn, "length": length}
    with shown_progress(steps_of(logs)) as progress:
        calibration = calibrate_ship(logs, read or system, channels, effects, progress, **options)

    def show() -> None:
        print_found(outcome(calibration), blocks(calibration), folder / "report.html")

    return Conclusion(name, calibration, show, folder)
