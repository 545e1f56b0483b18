"""The command `shipcosim diagnose`."""

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
from shipcosim.cli.start.completion import names_of


def diagnose(
    data: Annotated[
        list[Path],
        typer.Argument(
            metavar="DATA...",
            help="Measured data: .csv, .csv.gz, .parquet or .nc; several logs of one ship.",
            autocompletion=names_of("example"),
        ),
    ],
    channels: Channels = None,
    system: Ship = None,
    effects: Effects = None,
    reference: Annotated[
        Path | None,
        typer.Option(
            "--reference",
            metavar="DIR",
            help="What `shipcosim calibrate` left: say what has changed since.",
        ),
    ] = None,
    learn: Learn = False,
    length: Length = None,
    out: Annotated[
        Path | None,
        out_option("Folder of the results. [default: results/DATA]"),
    ] = None,
    as_json: AsJson = False,
    junit: Junit = None,
    quiet: Quiet = False,
    force: Force = False,
) -> Conclusion:
    """Say what a simulation gets wrong of a measured log, and why: causes by name, with size and probability.

    Leaves diagnosis.json and report.html; where a cause in the model was named extended.ssp and extended.ssv. Exit
    code 0 if simulation and log agree, 1 if something was found. Several logs are weighed together: the ship is common,
    the weather each log's own, and each is predicted by what the others say.

    With --learn the log teaches a craft that has no system: her numbers, what they gain on parts that were held out,
    and extended.ssp, which runs with them.

    Example: shipcosim diagnose log.csv --out results/log
    """
    from shipcosim.calls.arguments import default_folder
    from shipcosim.calls.logs import diagnose as diagnose_logs
    from shipcosim.cli.diagnosis import print_diagnosis
    from shipcosim.cli.progress import shown_progress
    from shipcosim.diagnose.joint_pipeline import steps_of
    from shipcosim.diagnose.pipeline import STEPS

    folder = out or default_folder(data[0])
    options: dict[str, Any] = {"channels": channels, "causes": effects, "reference": reference}
    options |= {"out": folder, "force": force, "learn": learn, "length": length}
    if len(data) > 1:
        with shown_progress(steps_of(data)) as progress:
            diagnosis = diagnose_logs(data, system, progress=progress, **options)
        name = f"{len(data)} logs"
    else:
        with shown_progress(STEPS) as progress:
            diagnosis = diagnose_logs(data[0], system, progress=progress, **options)
        name = data[0].name
    return Conclusion(name, diagnosis, lambda: print_diagnosis(diagnosis, folder), folder)
