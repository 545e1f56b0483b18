"""The command `shipcosim export osp`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.app import Debug, OspEvents, command
from shipcosim.cli.export import exporting


def osp(
    what: Annotated[str, typer.Argument(metavar="SSP_OR_SCENARIO", help="A scenario, as for run, or a system.")],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for the files; made if needed.")],
    stop_time: Annotated[float | None, typer.Option("--stop-time", help="[s] Default: the scenario's.")] = None,
    step_size: Annotated[float | None, typer.Option("--step-size", help="[s] Default: the scenario's.")] = None,
    parameters: Annotated[
        list[Path] | None, typer.Option("--parameters", metavar="X.SSV", help="Parameter set; repeatable, last wins.")
    ] = None,
    events: OspEvents = None,
    debug: Debug = False,
):
    """Write OspSystemStructure.xml, the FMUs and scenario.json, which libcosim runs as they are.

    What OSP cannot express is refused; what gets lost on the way is said.
    """
    from shipcosim.cli.comparison import matter_of
    from shipcosim.cli.console import print_problems, shown_path
    from shipcosim.cosim.export.osp import write_osp

    system, happening = matter_of(what, parameters or (), stop_time, step_size, events)
    print_problems(write_osp(system, happening, out))
    for path in sorted(out.glob("*")):
        typer.echo(shown_path(path))


command(osp, exporting)
