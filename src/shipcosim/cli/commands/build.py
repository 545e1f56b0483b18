"""The command `shipcosim build`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.options import out_option
from shipcosim.cli.terminal import say
from shipcosim.errors import error_at


def build(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[NAME]...", help="FMUs and systems; all if none.")
    ] = None,
    out: Annotated[
        Path | None,
        out_option("Folder to build into. [default: build]"),
    ] = None,
    native: Annotated[
        bool,
        typer.Option(
            "--native", help="FMUs with their models in C, without Python; into build/native."
        ),
    ] = False,
    targets: Annotated[
        str,
        typer.Option(
            "--targets",
            metavar="LIST",
            help="With --native: linux, windows, macos, linux-arm, windows-arm, by commas. [default: this one]",
        ),
    ] = "",
) -> None:
    """Build the FMUs in fmus/ and pack each system in ssp/.

    Example: shipcosim build vessel
    """
    from shipcosim import library
    from shipcosim.cli.building import build_named, build_native
    from shipcosim.cli.console import print_problems, progress_of, shown_path

    project = library.project_of()
    if project is None:
        remedy = (
            "A project has a folder fmus/ or ssp/: go there, or make one with `shipcosim init DIR`."
        )
        raise error_at(str(Path.cwd()), "There is no project here.", remedy)
    if targets and not native:
        raise error_at(
            "--targets", "FMUs in Python run on Linux and Windows.", "Give --native too."
        )
    left = []
    with progress_of("Building") as progress:
        if native:
            built, left = build_native(
                project, names or [], out or project / "build" / "native", targets, progress
            )
        else:
            built = build_named(project, names or [], out or project / "build", progress)
    print_problems(left)
    for path in built:
        say(shown_path(path))
