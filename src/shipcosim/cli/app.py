"""The command `shipcosim`: its sub-commands and its global options."""

from typing import Annotated

import typer

from shipcosim.cli.commands import (
    build,
    calibrate,
    capability,
    channels,
    check,
    compare,
    diagnose,
    export,
    new_ship,
    replay,
    report,
    run,
    sea_trials,
    simulate,
)
from shipcosim.cli.exits import EXIT_CODES, guarded

app = typer.Typer(
    help="Co-simulation of ships: FMUs, system structures, scenarios.",
    epilog=EXIT_CODES,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
)
exporting = typer.Typer(
    help="Write a system in a form that other tools run.", rich_markup_mode=None, no_args_is_help=True
)
making = typer.Typer(
    help="Make a new file that runs, in the project around.", rich_markup_mode=None, no_args_is_help=True
)
for _function in (
    build.build,
    run.run,
    simulate.simulate,
    compare.compare,
    check.check,
    channels.channels,
    diagnose.diagnose,
    replay.replay,
    report.report,
    sea_trials.sea_trials,
    calibrate.calibrate,
    capability.capability,
):
    app.command(epilog=EXIT_CODES)(guarded(_function))
for _function in (export.fmu, export.osp):
    exporting.command(epilog=EXIT_CODES)(guarded(_function))
for _function in (new_ship.ship,):
    making.command(epilog=EXIT_CODES)(guarded(_function))
app.add_typer(exporting, name="export")
app.add_typer(making, name="new")


@app.callback(invoke_without_command=True)
def options(
    version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False,
) -> None:
    """Co-simulation of ships: FMUs, system structures, scenarios."""
    if version:
        from shipcosim import __version__

        typer.echo(f"shipcosim {__version__}")
        raise typer.Exit()
