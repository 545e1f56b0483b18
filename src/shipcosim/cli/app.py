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
    init,
    list,
    new,
    new_ship,
    replay,
    report,
    run,
    sea_trials,
    simulate,
    sweep,
    train,
)
from shipcosim.cli.outcomes.exits import EXIT_CODES, guarded
from shipcosim.cli.terminal import say

app = typer.Typer(
    help="Co-simulation of ships: FMUs, system structures, scenarios.",
    epilog=EXIT_CODES,
    context_settings={"help_option_names": ["-h", "--help"]},  # commands have it from here
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
exporting = typer.Typer(
    help="Write a system in a form that other tools run.",
    rich_markup_mode=None,
    no_args_is_help=True,
)
making = typer.Typer(
    help="Make a new file that runs, in the project around.",
    rich_markup_mode=None,
    no_args_is_help=True,
)
training = typer.Typer(
    help="Train a learned component from scratch, with a fixed seed.",
    rich_markup_mode=None,
    no_args_is_help=True,
)
app.command("list", epilog=EXIT_CODES)(guarded(list.list_))
app.command(epilog=EXIT_CODES)(guarded(list.docs))
for _function in (
    init.init,
    build.build,
    run.run,
    export.live,
    simulate.simulate,
    sweep.sweep,
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
for _function in (export.fmu, export.osp, export.page):
    exporting.command(epilog=EXIT_CODES)(guarded(_function))
for _function in (new.fmu, new.parameters, new.scenario, new_ship.ship, new.system):
    making.command(epilog=EXIT_CODES)(guarded(_function))
for _function in (train.allocator, train.drift, train.dead_reckoning, train.docking):
    training.command(epilog=EXIT_CODES)(guarded(_function))
app.add_typer(exporting, name="export")
app.add_typer(making, name="new")
app.add_typer(training, name="train")


@app.callback(invoke_without_command=True)
def options(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False,
) -> None:
    """Co-simulation of ships: FMUs, system structures, scenarios."""
    if version:
        from shipcosim import __version__

        say(f"shipcosim {__version__}")
        raise typer.Exit()
    if context.invoked_subcommand is None:
        from shipcosim.cli.start.listing import overview

        say(f"{context.get_help()}\n{overview()}")
