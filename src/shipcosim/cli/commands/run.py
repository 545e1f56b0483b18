"""The command `shipcosim run`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim import library
from shipcosim.cli.options import (
    AsJson,
    Components,
    Engine,
    Every,
    Fmus,
    Force,
    From,
    Isolate,
    Junit,
    Order,
    Out,
    Parameters,
    Profiled,
    Quiet,
    Realtime,
    Record,
    ScenariosStepSize,
    ScenariosStopTime,
    Settings,
    Store,
    Strict,
    Timeout,
    Until,
)
from shipcosim.cli.outcomes.exits import Conclusion
from shipcosim.cli.start.completion import names_of
from shipcosim.errors import error_at


def run(
    scenario: Annotated[
        str,
        typer.Argument(
            metavar="SCENARIO",
            help="A scenario: a file or a name; or a folder, for all scenarios in it.",
            autocompletion=names_of("scenario"),
        ),
    ],
    out: Out = None,
    engine: Engine = "auto",
    order: Order = None,
    parameters: Parameters = None,
    settings: Settings = None,
    components: Components = None,
    fmus: Fmus = None,
    stop_time: ScenariosStopTime = None,
    step_size: ScenariosStepSize = None,
    until: Until = None,
    record: Record = None,
    every: Every = None,
    store: Store = None,
    resume: From = None,
    isolate: Isolate = False,
    timeout: Timeout = None,
    realtime: Realtime = None,
    profile: Profiled = False,
    strict: Strict = False,
    as_json: AsJson = False,
    junit: Junit = None,
    quiet: Quiet = False,
    force: Force = False,
) -> Conclusion:
    """Run a scenario and check what it expects. Leaves result.nc, result.csv, report.html, verdict.json and, where
    something predicts, predictions.csv in results/SCENARIO.

    A part of a run is checked for what is expected within it. The scenarios of a folder are run one after another;
    report.html in results/FOLDER is a table of all of them, and the results of each are in a folder beside it. Of a
    project's folder all scenarios are run; one that cannot be read is named, with exit code 2. Earlier
    results are kept in results/SCENARIO-1, -2, ... without --force.

    --parameters takes sets that were made for another system too, as extended.ssv of a diagnosis: what the scenario's
    system has is taken, over what the scenario says, and what it has not is said.

    Example: shipcosim run four_corner --set environment.wind_speed='10 kn' --until 300
    """
    from shipcosim.calls.runs import prepare_run
    from shipcosim.cli.requests import isolation, parsed_components, parsed_settings
    from shipcosim.cli.runs import concluded, prepare_folder, run_folder

    options = {
        "parameters": parameters or [],
        "fmus": fmus or [],
        "record": record or (),
        "set": parsed_settings(settings),
        "components": parsed_components(components),
    }
    options |= {"strict": strict, "engine": engine, "order": order, "resume": resume}
    options |= {"stop_time": stop_time, "step_size": step_size, "until": until}
    options["output_interval"] = every
    options |= {"realtime": realtime, "profile": profile, **isolation(isolate, timeout)}
    if files := library.scenarios(scenario):
        if store or resume:
            message = "This is a folder of scenarios, which has no one state to keep."
            raise error_at(scenario, message, "Name one scenario, or leave out --store and --from.")
        prepared, refused = prepare_folder(files, options)
        return run_folder(prepared, refused, Path(scenario).resolve().name, out, force)
    prepared = prepare_run(scenario, store=store, **options)
    return concluded(prepared, out or Path("results") / prepared.scenario.name, force)
