"""The command `shipcosim export fmu`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.app import Debug, command
from shipcosim.cli.export import exporting


def fmu(
    ssp: Annotated[str, typer.Argument(metavar="SSP", help="A .ssp, a .ssd, or a folder with a SystemStructure.ssd.")],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder that gets NAME.fmu.")] = Path("."),
    step_size: Annotated[
        float | None, typer.Option("--step-size", help="[s] Of the exchange inside. Default: the system's.")
    ] = None,
    parameters: Annotated[
        list[Path] | None, typer.Option("--parameters", metavar="X.SSV", help="Parameter set; repeatable, last wins.")
    ] = None,
    connectors_only: Annotated[
        bool, typer.Option("--connectors-only", help="Show the system's own connectors, nothing of its components.")
    ] = False,
    unchecked: Annotated[
        bool, typer.Option("--unchecked", help="Do not run FMU and system side by side first.")
    ] = False,
    debug: Debug = False,
):
    """Make one FMU of a whole system, a block in anyone's tool. FMPy's container FMU does the work in it.

    FMU and system are run side by side for some steps first; where they differ, no FMU is written.
    """
    from shipcosim.cli.console import print_problems, shown_path
    from shipcosim.cli.project import build_stale, check_is_system, experiment_of, find_project
    from shipcosim.cosim import export_fmu
    from shipcosim.ssp import read_system

    check_is_system(ssp)
    project = find_project(Path(ssp.partition("#")[0]))
    system = read_system(ssp, parameters or (), fmus=[build_stale(project)] if project else ())
    step = experiment_of(system, system.experiment.stop_time or step_size or 1.0, step_size).step_size
    target = out / f"{system.name}.fmu"
    print_problems(export_fmu(system, target, step, connectors_only=connectors_only, check=not unchecked))
    typer.echo(shown_path(target))


command(fmu, exporting)
