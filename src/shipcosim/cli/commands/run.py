"""The command `shipcosim run`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.options import Debug, Engine, From, Isolate, Out, Settings, Store, Timeout, Until
from shipcosim.errors import ShipcosimError


def run(
    scenario: Annotated[str, typer.Argument(metavar="SCENARIO", help="A scenario file, or its name in scenarios/.")],
    out: Out = None,
    engine: Engine = "fmpy",
    settings: Settings = None,
    until: Until = None,
    store: Store = None,
    resume: From = None,
    isolate: Isolate = False,
    timeout: Timeout = None,
    debug: Debug = False,
) -> None:
    """Run a scenario and check what it expects. Leaves result.nc, result.csv and report.html in results/SCENARIO.

    A part of a run is checked for what is expected within it.
    """
    from shipcosim.cli.console import print_problems
    from shipcosim.cli.project import build_stale, find_scenario
    from shipcosim.cli.requests import isolation, parsed_settings
    from shipcosim.cli.runs import simulate_and_save
    from shipcosim.options import RunOptions
    from shipcosim.scenario import check_files, check_times, read_scenario
    from shipcosim.ssp import read_system, with_values

    happening = read_scenario(find_scenario(scenario))
    if missing := check_files(happening):
        raise ShipcosimError(missing)
    fmus = build_stale(happening.project)
    system = read_system(happening.system_path, happening.parameter_paths, fmus=[fmus])
    given = parsed_settings(settings or [])
    with_values(system, given, "--set")
    print_problems(check_times(happening))
    happening = happening.model_copy(update={"set": happening.set | given})
    options = RunOptions(engine=engine, until=until, resume=resume, **isolation(isolate, timeout))
    simulate_and_save(system, happening, out or Path("results") / happening.name, options, store)
