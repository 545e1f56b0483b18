"""The command `shipcosim compare`."""

from typing import Annotated

import typer

from shipcosim.cli.exits import FAILED
from shipcosim.cli.options import (
    Components,
    Debug,
    Fmus,
    OspEvents,
    Parameters,
    ReportAsJson,
    ScenariosStepSize,
    ScenariosStopTime,
    Strict,
    SystemOrScenario,
)


def compare(
    what: SystemOrScenario,
    stop_time: ScenariosStopTime = None,
    step_size: ScenariosStepSize = None,
    parameters: Parameters = None,
    components: Components = None,
    fmus: Fmus = None,
    events: OspEvents = None,
    tolerance: Annotated[
        float, typer.Option("--tolerance", min=0.0, help="Largest difference between engines, of a signal's range.")
    ] = 1e-9,
    as_read: Annotated[
        bool, typer.Option("--as-read", help="libcosim and ecos read the file themselves, as their users run it.")
    ] = False,
    strict: Strict = False,
    as_json: ReportAsJson = False,
    debug: Debug = False,
) -> None:
    """Run on every engine that is installed, and on ours with half the step; show by how much each signal differs.

    Example: shipcosim compare four_corner --stop-time 60
    """
    from contextlib import nullcontext

    from shipcosim.cli.comparison import not_compared, print_comparison, reading
    from shipcosim.cli.console import progress_of
    from shipcosim.cli.requests import system_and_scenario
    from shipcosim.cosim.compare import compare as compare_engines
    from shipcosim.options import RunOptions

    system, scenario = system_and_scenario(what, parameters, stop_time, step_size, events, strict, components, fmus)
    for said in not_compared():
        typer.echo(said, err=True)
    how = reading(what, system, scenario, parameters) if as_read else nullcontext({})
    with how as tools, progress_of("Comparing") as progress:
        comparison = compare_engines(system, scenario, RunOptions(progress=progress), tolerance=tolerance, **tools)
    print_comparison(comparison, as_json)
    if not comparison.agree:
        raise typer.Exit(FAILED)
