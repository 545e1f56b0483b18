"""The command `shipcosim compare`."""

from typing import Annotated

import typer

from shipcosim.cli.options import (
    AsJson,
    Components,
    Fmus,
    Junit,
    OspEvents,
    Parameters,
    Quiet,
    ScenariosStepSize,
    ScenariosStopTime,
    Strict,
    SystemOrScenario,
)
from shipcosim.cli.outcomes.exits import Conclusion
from shipcosim.cli.terminal import say


def compare(
    what: SystemOrScenario,
    stop_time: ScenariosStopTime = None,
    step_size: ScenariosStepSize = None,
    parameters: Parameters = None,
    components: Components = None,
    fmus: Fmus = None,
    events: OspEvents = None,
    tolerance: Annotated[
        float,
        typer.Option(
            "--tolerance", min=0.0, help="Largest difference between engines, of a signal's range."
        ),
    ] = 1e-9,
    as_read: Annotated[
        bool,
        typer.Option(
            "--as-read", help="libcosim and ecos read the file themselves, as their users run it."
        ),
    ] = False,
    strict: Strict = False,
    as_json: AsJson = False,
    junit: Junit = None,
    quiet: Quiet = False,
) -> Conclusion:
    """Run on every engine that is installed, and on ours with half the step; show by how much each signal differs.

    Example: shipcosim compare four_corner --stop-time 60
    """
    from shipcosim.calls.systems import compare as compare_engines
    from shipcosim.cli.comparison import not_compared, print_comparison
    from shipcosim.cli.console import print_problems, progress_of
    from shipcosim.cli.requests import parsed_components

    for line in not_compared():
        say(line, err=True)
    with progress_of("Comparing") as progress:
        comparison = compare_engines(
            what,
            stop_time=stop_time,
            step_size=step_size,
            parameters=parameters or [],
            components=parsed_components(components),
            fmus=fmus or [],
            events=events,
            tolerance=tolerance,
            as_read=as_read,
            strict=strict,
            progress=progress,
        )
    print_problems(comparison.flaws)
    return Conclusion(comparison.name, comparison, lambda: print_comparison(comparison))
