"""The command `shipcosim new`: `new fmu`, `new parameters`, `new scenario`, `new system`."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from shipcosim.cli.start.completion import names_of
from shipcosim.cli.terminal import say, say_next

if TYPE_CHECKING:
    from shipcosim.cli.start.files import Files

Name = Annotated[str, typer.Argument(metavar="NAME", help="Its name.")]


def fmu(name: Name) -> None:
    """Make the source of an FMU in fmus/NAME: one Python file that can be built as it is.

    Example: shipcosim new fmu winch
    """
    from shipcosim.cli.start.files import fmu_files

    _write(
        fmu_files(name),
        {
            f"shipcosim simulate {name} --stop-time 10 --step-size 0.1 --set {name}.u=1": "runs it",
            f"shipcosim check {name}": "lists its variables",
            f'Its equations are in `step`. A system takes it as a component with source="resources/{name}.fmu".': "",
        },
    )


def parameters(
    name: Name,
    origin: Annotated[
        str,
        typer.Option(
            "--from",
            metavar="SSP",
            help="A system, or an FMU.",
            autocompletion=names_of("system"),
        ),
    ] = "gunnerus_dp",
) -> None:
    """Make NAME.ssv and NAME.ssm: every parameter of a system or an FMU with its value, to change.

    The mapping (SSM) is for sets that use other names.

    Example: shipcosim new parameters heavy --from gunnerus_dp
    """
    from shipcosim.cli.start.files import parameter_files

    _write(
        parameter_files(name, origin),
        {
            f"shipcosim check {name}.ssv": "checks it after each change",
            f"shipcosim simulate {origin} --parameters {name}.ssv": "runs it with these values",
        },
    )


def scenario(
    name: Name,
    system: Annotated[
        str | None,
        typer.Option(
            "--system",
            metavar="SSP",
            help="What runs. Default: the project's first system, else gunnerus_dp.",
            autocompletion=names_of("system"),
        ),
    ] = None,
) -> None:
    """Make a scenario in scenarios/NAME.toml: what happens in a run, and what must hold.

    Example: shipcosim new scenario squall --system gunnerus_dp
    """
    from shipcosim.cli.start.files import scenario_files

    _write(
        scenario_files(name, system),
        {
            f"shipcosim run {name}": "runs it and makes its page",
            f"shipcosim check {name}": "checks it after each change",
        },
    )


def system(
    name: Name,
    origin: Annotated[
        str,
        typer.Option(
            "--from", metavar="SSP", help="The system to copy.", autocompletion=names_of("system")
        ),
    ] = "gunnerus_dp",
) -> None:
    """Make a system in ssp/NAME: a copy of another one, with its numbers, to change.

    Example: shipcosim new system ferry_dp --from gunnerus_dp
    """
    from shipcosim.cli.start.files import system_files

    _write(
        system_files(name, origin),
        {
            f"shipcosim simulate {name}": "runs it",
            f"shipcosim check {name}": "checks it after each change",
            f"shipcosim new scenario NAME --system {name}": "has something happen to it",
        },
    )


def _write(files: "Files", steps: Mapping[str, str]) -> None:
    """Write files into the project around the working folder, else into that, and say how to go on."""
    from shipcosim import library
    from shipcosim.cli.console import shown_path
    from shipcosim.cli.start.files import write_new

    for path in write_new(library.project_of() or Path.cwd(), files):
        say(shown_path(path))
    say_next(steps)
