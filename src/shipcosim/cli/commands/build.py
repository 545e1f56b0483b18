"""The command `shipcosim build`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.options import Debug
from shipcosim.errors import Problem, ShipcosimError


def build(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[NAME]...", help="FMUs and systems; all if none.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder to build into. [default: build]")
    ] = None,
    debug: Debug = False,
) -> None:
    """Build the FMUs in fmus/ and pack each system in ssp/.

    Example: shipcosim build vessel
    """
    from shipcosim import library
    from shipcosim.cli.building import build_named
    from shipcosim.cli.console import progress_of, shown_path

    project = library.project_of()
    if project is None:
        remedy = "A project has a folder fmus/ or ssp/: go there, or make one with `shipcosim init DIR`."
        raise ShipcosimError(Problem(str(Path.cwd()), "There is no project here.", remedy))
    with progress_of("Building") as progress:
        built = build_named(project, names or [], out or project / "build", progress)
    for path in built:
        typer.echo(shown_path(path))
