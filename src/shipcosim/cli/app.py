"""Commands, their arguments and their exit codes."""

from __future__ import annotations

import functools
import math
from pathlib import Path
from typing import Annotated

import typer

from shipcosim.errors import Problem, ShipcosimError

FAILED, UNUSABLE, INTERRUPTED = 1, 2, 130

EXIT_CODES = (
    "Exit codes: 0 done; 1 the work ran and what it checked does not hold; 2 unusable input or arguments; "
    "130 interrupted. --debug with any command shows the traceback of an error."
)
app = typer.Typer(
    help="Co-simulation of ships: FMUs, system structures, scenarios.",
    epilog=EXIT_CODES,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
)


def _finite(value: float | None) -> float | None:
    if value is not None and not math.isfinite(value):
        raise typer.BadParameter(f"{value} is no time. Give it in seconds.")
    return value


Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]
Out = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Folder of the results.", show_default=False)]
Engine = Annotated[str, typer.Option("--engine", help="What runs the FMUs: fmpy (ours), libcosim or ecos.")]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="COMPONENT.NAME=VALUE", help="Start value, over all others; repeatable."),
]
Until = Annotated[float | None, typer.Option("--until", callback=_finite, help="[s] End here, before the stop time.")]
Store = Annotated[
    Path | None, typer.Option("--store", metavar="FILE", help="Store the whole system's state at the end, for --from.")
]
From = Annotated[Path | None, typer.Option("--from", metavar="FILE", help="Continue from a state that --store left.")]
Isolate = Annotated[
    bool, typer.Option("--isolate", help="Run each component in a process of its own, which may crash or hang.")
]
Timeout = Annotated[
    float | None,
    typer.Option("--timeout", callback=_finite, help="[s] Longest wait for a component of --isolate. Default: 60."),
]
OspEvents = Annotated[
    Path | None,
    typer.Option("--scenario", metavar="FILE", help="Scenario file of OSP (.json, .yaml): what happens in the run."),
]


def command(function, group=app):
    """Make a function a command of a group: errors become a readable block on stderr and an exit code."""

    @functools.wraps(function)
    def guarded(*args, debug=False, **kwargs):
        try:
            return function(*args, debug=debug, **kwargs)
        except typer.Exit:
            raise
        except ShipcosimError as error:
            _explain(error.problems, debug)
            raise typer.Exit(UNUSABLE) from None
        except KeyboardInterrupt:
            typer.echo("Interrupted.", err=True)
            raise typer.Exit(INTERRUPTED) from None
        except Exception as error:
            remedy = "This is a fault of shipcosim. Run the command again with --debug for the traceback."
            _explain([Problem("shipcosim", f"{type(error).__name__}: {error}", remedy)], debug)
            raise typer.Exit(UNUSABLE) from None

    return group.command(epilog=EXIT_CODES)(guarded)


def _explain(problems, debug):
    from shipcosim.cli.console import print_problems

    print_problems(problems)
    if debug:
        import traceback

        traceback.print_exc()


@app.callback(invoke_without_command=True)
def options(
    version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False,
):
    """Co-simulation of ships: FMUs, system structures, scenarios."""
    if version:
        from shipcosim import __version__

        typer.echo(f"shipcosim {__version__}")
        raise typer.Exit()


@command
def build(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[NAME]...", help="FMUs and systems; all if none.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder to build into. [default: build]")
    ] = None,
    debug: Debug = False,
):
    """Build the FMUs in fmus/ and pack each system in ssp/."""
    from shipcosim.cli.console import progress_of, shown_path
    from shipcosim.cli.project import build_named, find_project

    project = find_project(Path.cwd())
    if project is None:
        raise ShipcosimError(
            Problem(str(Path.cwd()), "There is no project here.", "A project has a folder fmus/ or ssp/; go there.")
        )
    with progress_of("Building") as progress:
        built = build_named(project, names or [], out or project / "build", progress)
    for path in built:
        typer.echo(shown_path(path))


@command
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
):
    """Run a scenario and check what it expects. Leaves result.nc, result.csv and report.html in results/SCENARIO.

    A part of a run is checked for what is expected within it.
    """
    from shipcosim.cli.console import print_problems
    from shipcosim.cli.project import build_stale, find_scenario, parsed_settings
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
    course = {"until": until, "store": store, "resume": resume} | _isolated(isolate, timeout)
    _simulate_and_save(system, happening, out or Path("results") / happening.name, engine, **course)


@command
def simulate(
    ssp: Annotated[
        str, typer.Argument(metavar="SSP", help="A .ssp, a .ssd, an OspSystemStructure.xml, or a folder with one.")
    ],
    stop_time: Annotated[float | None, typer.Option("--stop-time", help="[s] Default: the system's.")] = None,
    step_size: Annotated[float | None, typer.Option("--step-size", help="[s] Default: the system's.")] = None,
    out: Out = None,
    engine: Engine = "fmpy",
    parameters: Annotated[
        list[Path] | None, typer.Option("--parameters", metavar="X.SSV", help="Parameter set; repeatable, last wins.")
    ] = None,
    inputs: Annotated[
        Path | None, typer.Option("--inputs", metavar="TABLE", help="CSV or NetCDF that feeds the system's inputs.")
    ] = None,
    interpolate: Annotated[
        list[str] | None,
        typer.Option("--interpolate", metavar="INPUT", help="Linear between rows, not held; '*' for all; repeatable."),
    ] = None,
    max_gap: Annotated[
        float | None,
        typer.Option(
            "--max-gap", callback=_finite, help="[s] Longest time without a row. Default: 5 x an even spacing."
        ),
    ] = None,
    start_time: Annotated[
        float | None,
        typer.Option("--start-time", callback=_finite, help="[s] On the clock of the table. Default: the system's."),
    ] = None,
    settings: Settings = None,
    events: OspEvents = None,
    until: Until = None,
    store: Store = None,
    resume: From = None,
    isolate: Isolate = False,
    timeout: Timeout = None,
    debug: Debug = False,
):
    """Run a system, anybody's FMUs. Leaves result.nc, result.csv and report.html in results/SSP.

    Running an FMU runs its author's code: run only what you trust. `shipcosim check` runs nothing.
    """
    from shipcosim.cli.project import (
        build_stale,
        check_is_system,
        experiment_of,
        feeding,
        find_project,
        parsed_settings,
        with_osp_events,
    )
    from shipcosim.ssp import read_system, with_values

    check_is_system(ssp)
    project = find_project(Path(ssp.partition("#")[0]))
    system = read_system(ssp, parameters or (), fmus=[build_stale(project)] if project else ())
    system = with_values(system, parsed_settings(settings or []), "--set")
    happening = experiment_of(system, stop_time, step_size)
    table = feeding(inputs, system, interpolate or (), max_gap)
    default = Path("results") / Path(ssp.partition("#")[0]).resolve().stem
    if start_time is None:
        start_time = system.experiment.start_time if resume is None else 0.0
    happening = with_osp_events(happening, events, start_time)
    course = {"start_time": start_time, "until": until, "store": store, "resume": resume}
    course |= _isolated(isolate, timeout)
    _simulate_and_save(system, happening, out or default, engine, table, **course)


@command
def compare(
    what: Annotated[str, typer.Argument(metavar="SCENARIO_OR_SSP", help="A scenario, as for run, or a system.")],
    stop_time: Annotated[float | None, typer.Option("--stop-time", help="[s] Default: the scenario's.")] = None,
    step_size: Annotated[float | None, typer.Option("--step-size", help="[s] Default: the scenario's.")] = None,
    parameters: Annotated[
        list[Path] | None, typer.Option("--parameters", metavar="X.SSV", help="Parameter set; repeatable, last wins.")
    ] = None,
    events: OspEvents = None,
    tolerance: Annotated[
        float, typer.Option("--tolerance", min=0.0, help="Largest difference between engines, of a signal's range.")
    ] = 1e-9,
    as_read: Annotated[
        bool, typer.Option("--as-read", help="libcosim and ecos read the file themselves, as their users run it.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Report as JSON.")] = False,
    debug: Debug = False,
):
    """Run on every engine that is installed, and on ours with half the step; show by how much each signal differs."""
    from contextlib import nullcontext

    from shipcosim.cli.comparison import matter_of, print_comparison, reading
    from shipcosim.cli.console import progress_of
    from shipcosim.cosim.compare import compare as compare_engines
    from shipcosim.options import RunOptions

    system, happening = matter_of(what, parameters or (), stop_time, step_size, events)
    how = reading(what, system, happening, parameters) if as_read else nullcontext({})
    with how as tools, progress_of("Comparing") as progress:
        options = RunOptions(progress=progress)
        comparison = compare_engines(system, happening, options, tolerance=tolerance, **tools)
    print_comparison(comparison, as_json)
    if not comparison.agree:
        raise typer.Exit(FAILED)


@command
def check(
    files: Annotated[
        list[str],
        typer.Argument(metavar="FILE...", help=".ssp .ssd .ssv .ssm .ssb .fmu .xml .toml .json .yaml .csv .nc"),
    ],
    channels: Annotated[
        Path | None, typer.Option("--channels", metavar="X.toml", help="Channel file of measured data.")
    ] = None,
    hosts: Annotated[
        list[str] | None,
        typer.Option("--for", metavar="TOOL", help="libcosim or ecos: what it would ignore or die of; repeatable."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Report as JSON.")] = False,
    debug: Debug = False,
):
    """Validate files: schema, then meaning. Loads no binary and runs nothing. Of an FMU it lists the variables.

    A table whose columns are named by roles, or one with a channel file, is measured data: it is examined for faults.
    """
    from shipcosim.cli.checks import check_any, variables_in
    from shipcosim.cli.console import print_report, print_variables
    from shipcosim.ssp.portability.check import check_host

    for host in hosts or ():
        check_host(host)
    reports = {file: check_any(file, channels, hosts or ()) for file in files}
    print_report(reports, as_json)
    for variables in () if as_json else filter(None, map(variables_in, files)):
        print_variables(variables)
    if any(problem.severity == "error" for problems in reports.values() for problem in problems):
        raise typer.Exit(FAILED)


@command
def diagnose(
    data: Annotated[Path, typer.Argument(metavar="DATA", help="Measured data: .csv, .csv.gz, .parquet or .nc.")],
    channels: Annotated[
        Path | None, typer.Option("--channels", metavar="X.TOML", help="Which column is what, in which unit.")
    ] = None,
    system: Annotated[
        str | None,
        typer.Option("--system", metavar="SSP", help="The ship: a path, or its name in ssp/. [default: gunnerus_open]"),
    ] = None,
    effects: Annotated[
        Path | None, typer.Option("--effects", metavar="FOLDER", help="Causes of your own, one .toml each.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder of the results. [default: results/DATA]")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print diagnosis.json instead of a summary.")] = False,
    debug: Debug = False,
):
    """Say what a simulation gets wrong of a measured log, and why: causes by name, with size and probability.

    Leaves diagnosis.json and report.html; where a cause in the model was named extended.ssp and extended.ssv. Exit
    code 0 if simulation and log agree, 1 if something was found.
    """
    from shipcosim.cli.diagnosis import default_folder, diagnose_log, print_diagnosis
    from shipcosim.cli.results import check_targets

    folder = out or default_folder(data)
    check_targets(folder)
    story = diagnose_log(data, folder, system=system, channels=channels, effects=effects)
    print_diagnosis(story, folder, as_json)
    if story.diagnosis.verdict != "consistent":
        raise typer.Exit(FAILED)


def _isolated(isolate, timeout):
    """What `simulate` is told of --isolate and --timeout."""
    if timeout is not None and not isolate:
        raise ShipcosimError(Problem("--timeout", "Without --isolate there is no limit to a component's time."))
    return {"isolate": isolate} | ({} if timeout is None else {"timeout": timeout})


def _simulate_and_save(system, scenario, out, engine, inputs=None, store=None, **course):
    """Run, judge, write, and say how it went; the exit code follows. `course` is where and how it runs.

    A component that fails in its own process is a finding, not unusable input.
    """
    from shipcosim.cli.console import print_problems, print_summary, progress_of
    from shipcosim.cli.results import check_targets, save
    from shipcosim.cosim import Interrupted, RunError, RunOptions, write_snapshot
    from shipcosim.cosim import simulate as simulate_system
    from shipcosim.scenario import judge

    check_targets(out, store)
    print_problems(problem for problem in system.remarks if problem.where not in system.components)
    snapshots = []
    course |= {"store": snapshots.append} if store else {}
    try:
        with progress_of(scenario.name or system.name, scenario.stop_time) as progress:
            options = RunOptions(engine=engine, inputs=inputs, progress=progress, **course)
            table = simulate_system(system, scenario, options)
    except Interrupted as stop:
        _keep(stop.table, out, scenario, system)
        raise typer.Exit(INTERRUPTED) from None
    except RunError as error:
        try:
            _keep(error.table, out, scenario, system)
        except ShipcosimError as another:
            error.problems += another.problems
        if not course.get("isolate"):
            raise
        _explain(error.problems, debug=False)
        raise typer.Exit(FAILED) from None
    scenario = _part(scenario, table)
    verdicts = judge(table, scenario)
    page = save(table, out, "result", scenario=scenario, verdicts=verdicts, system=system)
    print_summary(table, verdicts, page)
    for snapshot in snapshots:
        write_snapshot(snapshot, store)
    if not all(verdict.passed for verdict in verdicts):
        raise typer.Exit(FAILED)


def _keep(table, out, scenario, system):
    """Save what there is of a run that did not get to its end, unless it did not even start."""
    from shipcosim.cli.console import print_summary
    from shipcosim.cli.results import save

    if table.sizes["time"]:
        page = save(table, out, "result-partial", scenario=scenario, system=system)
        print_summary(table, (), page, to_stderr=True)


def _part(scenario, table):
    """The scenario with what it expects within the table's times."""
    first, last = table["time"].values[[0, -1]]
    inside = [e for e in scenario.expect if not e.during or (first <= e.during[0] and e.during[1] <= last)]
    is_whole = first == 0.0 and last >= scenario.stop_time - 1e-9
    return scenario if is_whole else scenario.model_copy(update={"expect": inside})
