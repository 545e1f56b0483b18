"""The command `shipcosim channels`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.options import Channels, Ship, out_option


def channels(
    log: Annotated[
        Path, typer.Argument(metavar="LOG", help="Measured data: text, .xlsx, .nc or .parquet.")
    ],
    system: Ship = None,
    form: Channels = None,
    isolability: Annotated[
        bool,
        typer.Option(
            "--isolability",
            help="Say for each cause whether this log would show it, and which others look alike in it.",
        ),
    ] = False,
    out: Annotated[
        Path | None,
        out_option("Write the proposed channel file here.", metavar="X.TOML"),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write it over a file that is there.")
    ] = False,
) -> None:
    """Say what each column of a log is, and propose a channel file with a guess for each and its reason.

    Columns with one meaning are used without a channel file, too; what is a guess is used only where a channel file
    says it: look at the proposal, correct it, and give it to `shipcosim diagnose --channels`. --channels says the form
    of the file where it can be read in two ways, for example file = {dates = "dmy"}.

    Example: shipcosim channels monday.csv --out channels.toml
    """
    from shipcosim.calls.arguments import path_of_log
    from shipcosim.cli.channel_files import (
        print_channels,
        print_isolability,
        proposed,
        write_channels,
    )

    proposal = proposed(path_of_log(log), system, form)
    print_channels(proposal)
    if isolability:
        print_isolability(log, system, form)
    if out is not None:
        write_channels(proposal, out, force)
