"""The command `shipcosim check`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.options import AsJson, Junit, Quiet, Strict
from shipcosim.cli.outcomes.exits import Conclusion
from shipcosim.cli.start.completion import names_of


def check(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...",
            help="A name, or .ssp .ssd .ssv .ssm .ssb .fmu .xml .toml .json .yaml .csv .nc",
            autocompletion=names_of("scenario", "system", "fmu", "ship", "example"),
        ),
    ],
    channels: Annotated[
        Path | None,
        typer.Option("--channels", metavar="X.toml", help="Channel file of measured data."),
    ] = None,
    hosts: Annotated[
        list[str] | None,
        typer.Option(
            "--for",
            metavar="TOOL",
            help="libcosim or ecos: what it would ignore, or crash on; repeatable.",
        ),
    ] = None,
    strict: Strict = False,
    as_json: AsJson = False,
    junit: Junit = None,
    quiet: Quiet = False,
) -> Conclusion:
    """Validate files: schema, then meaning. Loads no binary and runs nothing. Of an FMU it lists the variables,
    of a ship file what is estimated; of a project, all that is in it.

    A table whose columns are named by roles, or one with a channel file, is measured data: it is examined for faults.

    Example: shipcosim check build/fmus/vessel.fmu scenarios/four_corner.toml
    """
    from shipcosim.calls.systems import check as check_files
    from shipcosim.cli.console import print_report

    checked = check_files(files, channels=channels, hosts=hosts or (), strict=strict)
    return Conclusion("check", checked, lambda: print_report(checked))
