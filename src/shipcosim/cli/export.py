"""The command `shipcosim export`, whose sub-commands write systems in the forms of other tools."""

import typer

from shipcosim.cli.app import app

exporting = typer.Typer(
    help="Write a system in a form that other tools run.", rich_markup_mode=None, no_args_is_help=True
)
app.add_typer(exporting, name="export")
