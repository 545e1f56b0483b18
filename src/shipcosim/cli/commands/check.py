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
        Path | None, typer.Option("--channels", metavar="X.toml", help="Channel file of measured data.")
    ] = None,
    hosts: Annotated[
        list[str] | None,
        typer.Option("--for", metavar="TOOL", help="libcosim or ecos: what it would ignore or die of; repeatable."),
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
    from shipcosim import library
    from shipcosim.checks import VARIABLE_KEYS, check_any, estimates_in, variables_in
    from shipcosim.cli.console import print_estimates, print_report, print_variables
    from shipcosim.errors import held_strictly
    from shipcosim.ssp.portability.check import check_host

    for host in hosts or ():
        check_host(host)
    paths = [library.find_any(file) for file in files]
    reports = {file: check_any(path, channels, hosts or ()) for file, path in zip(files, paths, strict=True)}
    if strict:
        reports = {file: held_strictly(problems) for file, problems in reports.items()}
    rows = {file: found for file, path in zip(files, paths, strict=True) if (found := variables_in(path))}
    keyed = {file: [dict(zip(VARIABLE_KEYS, row, strict=True)) for row in found] for file, found in rows.items()}
    print_report(reports, as_json, keyed)
    for variables in () if as_json else rows.values():
        print_variables(variables)
    for estimates in () if as_json else filter(None, map(estimates_in, paths)):
        print_estimates(estimates)
    if any(problem.severity == "error" for problems in reports.values() for problem in problems):
        raise typer.Exit(FAILED)
