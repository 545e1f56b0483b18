"""The command `shipcosim init`."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.terminal import say


def init(
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", help="Folder of the project; made if needed.")
    ],
) -> None:
    """Lay out a project of your own that runs as it is: system, scenarios, parameter set, CI, notebook.

    Example: shipcosim init my-project
    """
    from shipcosim.cli.start.files import project_files, write_new

    for path in write_new(folder, project_files(folder.resolve().name)):
        say(path)
    inside = "" if folder.resolve() == Path.cwd() else f"cd {shlex.quote(str(folder))} && "
    say(f"\nGo on with: {inside}shipcosim run hold_position\nREADME.md says what is what.")
