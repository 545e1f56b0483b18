"""The command `shipcosim simulate`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.options import (
    AsJson,
    Components,
    Engine,
    Every,
    Force,
    From,
    Isolate,
    Junit,
    Order,
    OspEvents,
    Out,
    Parameters,
    Profiled,
    Quiet,
    Realtime,
    Record,
    Settings,
    Store,
    Strict,
    SystemsStepSize,
    SystemsStopTime,
    Timeout,
    Until,
    time_option,
)
from shipcosim.cli.outcomes.exits import Conclusion
from shipcosim.cli.start.completion import names_of

System = Annotated[
    str,
    typer.Argument(
        metavar="SSP",
        help="A name, a .ssp, a .ssd, an OspSystemStructure.xml, a folder with one; or one .fmu.",
        autocompletion=names_of("system", "fmu"),
    ),
]
Inputs = Annotated[
    Path | None,
    typer.Option("--inputs", metavar="TABLE", help="CSV or NetCDF that feeds the system's inputs."),
]
Interpolate = Annotated[
    list[str] | None,
    typer.Option(
        "--interpolate",
        metavar="INPUT",
        help="Linear between rows, not held; '*' for all; repeatable.",
    ),
]
MaxGap = Annotated[
    float | None,
    time_option(
        "--max-gap",
        "Longest time without a row; in s, or with a unit: '1 min'. Default: 5 x an even spacing.",
    ),
]
StartTime = Annotated[
    float | None,
    time_option(
        "--start-time",
        "On the clock of the table; in s, or with a unit: '1 h'. Default: the system's.",
    ),
]


def simulate(
    ssp: System,
    stop_time: SystemsStopTime = None,
    step_size: SystemsStepSize = None,
    out: Out = None,
    engine: Engine = "auto",
    order: Order = None,
    parameters: Parameters = None,
    inputs: Inputs = None,
    interpolate: Interpolate = None,
    max_gap: MaxGap = None,
    start_time: StartTime = None,
    settings: Settings = None,
    components: Components = None,
    events: OspEvents = None,
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
    """Run a system, anybody's FMUs. Leaves result.nc, result.csv, report.html and verdict.json in results/SSP, and
    predictions.csv where something predicts.

    Running an FMU runs its author's code: run only what you trust. `shipcosim check` runs nothing.

    Example: shipcosim simulate ferry.ssp --stop-time 60 --step-size 0.1
    """
    from shipcosim.calls.runs import prepare_simulation
    from shipcosim.cli.requests import isolation, parsed_components, parsed_settings
    from shipcosim.cli.runs import concluded
    from shipcosim.series import read_table

    table = None if inputs is None else read_table(inputs)
    feeding = {"inputs": table, "interpolate": interpolate or (), "max_gap": max_gap}
    carried_out = {"start_time": start_time, "engine": engine, "order": order, "until": until}
    carried_out |= {"store": store, "resume": resume}
    carried_out |= {"realtime": realtime, "profile": profile, **isolation(isolate, timeout)}
    prepared = prepare_simulation(
        ssp,
        events,
        stop_time=stop_time,
        step_size=step_size,
        record=record or (),
        output_interval=every,
        set=parsed_settings(settings),
        parameters=parameters or [],
        components=parsed_components(components),
        strict=strict,
        **feeding,
        **carried_out,
    )
    default = Path("results") / Path(ssp.partition("#")[0]).resolve().stem
    return concluded(prepared, out or default, force)
