"""Arguments and options that several commands share, each declared once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from shipcosim.cli.start.completion import ENGINES, names_of, words_of


def _time(given: str) -> float:
    from shipcosim.units import UnitError, seconds

    try:
        return seconds(given)
    except UnitError as error:
        raise typer.BadParameter(str(error)) from None


def time_option(name: str, meaning: str) -> Any:
    """An option that takes a time: seconds, or an amount such as '10 min'."""
    return typer.Option(name, parser=_time, metavar="TIME", help=meaning)


def out_option(meaning: str, metavar: str = "DIR") -> Any:
    """The option for the folder or file that a command writes."""
    return typer.Option("--out", metavar=metavar, help=meaning)


Parameters = Annotated[
    list[Path] | None,
    typer.Option("--parameters", metavar="X.SSV", help="Parameter set; repeatable, last wins."),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="COMPONENT.NAME=VALUE",
        help="Start value, over all others, such as 5 or '10 kn'; repeatable.",
    ),
]
Components = Annotated[
    list[str] | None,
    typer.Option(
        "--component",
        metavar="COMPONENT=FMU",
        help="Run another FMU in a component's place: a name or a path, such as allocator=extended_allocator; "
        "repeatable.",
    ),
]
Swaps = Annotated[
    list[str] | None,
    typer.Option(
        "--swap",
        metavar="COMPONENT=FMU",
        help="Let the page start again with this FMU in a component's place, too; repeatable.",
    ),
]
Fmus = Annotated[
    list[Path] | None,
    typer.Option(
        "--fmus",
        metavar="DIR",
        help="Folder in which FMUs are looked for first, such as build/native; repeatable.",
        exists=True,
        file_okay=False,
    ),
]
OspEvents = Annotated[
    Path | None,
    typer.Option(
        "--scenario",
        metavar="FILE",
        help="Scenario file of OSP (.json, .yaml): what happens in the run.",
    ),
]
SystemOrScenario = Annotated[
    str,
    typer.Argument(
        metavar="SSP_OR_SCENARIO",
        help="A scenario, as for run, or a system.",
        autocompletion=names_of("scenario", "system"),
    ),
]
Channels = Annotated[
    Path | None,
    typer.Option("--channels", metavar="X.TOML", help="Which column is what, in which unit."),
]
Ship = Annotated[
    str | None,
    typer.Option(
        "--system",
        metavar="SSP",
        help="The ship: a path, or a system's name. [default: gunnerus_open]",
        autocompletion=names_of("system"),
    ),
]
Effects = Annotated[
    Path | None,
    typer.Option("--effects", metavar="FOLDER", help="Causes of your own, one .toml each."),
]
Learn = Annotated[
    bool,
    typer.Option("--learn", help="Learn a craft that no file describes; needs --length."),
]
Length = Annotated[
    str | None,
    typer.Option("--length", metavar="LENGTH", help='With --learn: her length, "1.2 m".'),
]
SystemsStopTime = Annotated[
    float | None,
    time_option("--stop-time", "In s, or with a unit: '10 min'. Default: the system's."),
]
SystemsStepSize = Annotated[
    float | None,
    time_option("--step-size", "In s, or with a unit: '50 ms'. Default: the system's."),
]
ScenariosStopTime = Annotated[
    float | None,
    time_option("--stop-time", "In s, or with a unit: '10 min'. Default: the scenario's."),
]
ScenariosStepSize = Annotated[
    float | None,
    time_option("--step-size", "In s, or with a unit: '50 ms'. Default: the scenario's."),
]
Out = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="Folder of the results.", show_default=False),
]
Engine = Annotated[
    str,
    typer.Option(
        "--engine",
        help="What runs the FMUs: fmpy (ours), native (ours, with the models compiled), auto (native for long runs), "
        "libcosim or ecos.",
        autocompletion=words_of(*ENGINES),
    ),
]
Order = Annotated[
    str | None,
    typer.Option(
        "--order",
        help="Order of stepping: jacobi (all with what was put out before the step), or gauss-seidel (each with what "
        "those before it have just put out). Default: the scenario's.",
        autocompletion=words_of("jacobi", "gauss-seidel"),
    ),
]
Record = Annotated[
    list[str] | None,
    typer.Option(
        "--record",
        metavar="SIGNALS",
        help="Keep these signals alone: 'vessel.*', a component, a connector; or a LogConfig.xml of libcosim; "
        "repeatable.",
    ),
]
Every = Annotated[
    float | None,
    time_option("--every", "Time between the rows that are kept; in s, or with a unit: '500 ms'."),
]
Realtime = Annotated[
    float | None,
    typer.Option(
        "--realtime",
        metavar="FACTOR",
        help="Wait for the clock: 1.0 runs in real time, 2.0 twice as fast. Default: as fast as possible.",
    ),
]
Profiled = Annotated[
    bool,
    typer.Option(
        "--profile", help="Count the seconds of each component and phase, and print them."
    ),
]
Force = Annotated[
    bool,
    typer.Option("--force", help="Replace earlier results instead of keeping them in DIR-1, ..."),
]
Until = Annotated[
    float | None,
    time_option("--until", "End here, before the stop time; in s, or with a unit: '10 min'."),
]
Store = Annotated[
    Path | None,
    typer.Option(
        "--store", metavar="FILE", help="Store the whole system's state at the end, for --from."
    ),
]
From = Annotated[
    Path | None,
    typer.Option("--from", metavar="FILE", help="Continue from a state that --store left."),
]
Isolate = Annotated[
    bool,
    typer.Option(
        "--isolate", help="Run each component in a process of its own, which may crash or hang."
    ),
]
Timeout = Annotated[
    float | None,
    time_option(
        "--timeout",
        "Longest wait for a component of --isolate; in s, or with a unit: '2 min'. Default: 60.",
    ),
]
AsJson = Annotated[
    bool, typer.Option("--json", help="Print what was found as JSON, and nothing else on stdout.")
]
Junit = Annotated[
    Path | None,
    typer.Option("--junit", metavar="FILE", help="Write what was checked as JUnit's XML, for CI."),
]
Quiet = Annotated[
    bool, typer.Option("--quiet", "-q", help="Print only the verdict and what is wrong.")
]
Strict = Annotated[
    bool,
    typer.Option("--strict", help="Refuse what breaks a standard, even if its meaning is clear."),
]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]
