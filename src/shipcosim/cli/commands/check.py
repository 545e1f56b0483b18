"""The command `shipcosim check`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.exits import FAILED
from shipcosim.cli.options import Debug, ReportAsJson, Strict
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
            help="libcosim or ecos: what it would ignore or die of; repeatable.",
        ),
    ] = None,
    strict: Strict = False,
    as_json: ReportAsJson = False,
    debug: Debug = False,
) -> None:
    """Validate files: schema, then meaning. Loads no binary and runs nothing. Of an FMU it lists the variables,
    of a ship file what is estimated.

    A table whose columns are named by roles, or one with a channel file, is measured data: it is examined for faults.

    Example: shipcosim check build/fmus/vessel.fmu scenarios/four_corner.toml
    """
    from shipcosim.calls.systems import check as check_files
    from shipcosim.cli.console import print_estimates, print_report, print_variables

    checked = check_files(files, channels=channels, hosts=hosts or (), strict=strict)
    print_report(checked, as_json)
    if not as_json:
        for variables in checked.variables.values():
            print_variables(variables)
        for estimates in checked.estimates.values():
            print_estimates(estimates)
    if not checked.passed:
        raise typer.Exit(FAILED)
