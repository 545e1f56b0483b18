"""The command `shipcosim run`."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from shipcosim import library
from shipcosim.cli.options import (
    Components,
    Debug,
    Engine,
    Fmus,
    Force,
    From,
    Isolate,
    Out,
    Parameters,
    Settings,
    Store,
    Strict,
    Timeout,
    Until,
)
from shipcosim.cli.start.completion import names_of
from shipcosim.errors import Problem, ShipcosimError

if TYPE_CHECKING:
    from shipcosim.options import RunOptions
    from shipcosim.scenario import Scenario
    from shipcosim.ssp import System


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
    engine: Engine = "fmpy",
    parameters: Parameters = None,
    settings: Settings = None,
    components: Components = None,
    fmus: Fmus = None,
    until: Until = None,
    store: Store = None,
    resume: From = None,
    isolate: Isolate = False,
    timeout: Timeout = None,
    strict: Strict = False,
    force: Force = False,
    debug: Debug = False,
) -> None:
    """Run a scenario and check what it expects. Leaves result.nc, result.csv, report.html and, where something
    predicts, predictions.csv in results/SCENARIO.

    A part of a run is checked for what is expected within it. The scenarios of a folder are run one after another;
    report.html in results/FOLDER is a table of all of them, and the results of each are in a folder beside it.
    Earlier results are kept in results/SCENARIO-1, -2, ... unless --force is given.

    --parameters takes sets that were made for another system too, as extended.ssv of a diagnosis: what the scenario's
    system has is taken, over what the scenario says, and what it has not is said.

    Example: shipcosim run four_corner --set environment.wind_speed='10 kn' --until 300
    """
    from shipcosim.cli.requests import changed_by, isolation, parsed_components, parsed_settings
    from shipcosim.cli.runs import simulate_and_save
    from shipcosim.options import RunOptions

    given = parsed_settings(settings or [])
    options = RunOptions(engine=engine, until=until, resume=resume, **isolation(isolate, timeout))
    changed = changed_by(settings, parameters, options, resume, components, fmus)
    reading = _ReadOptions(parameters or [], parsed_components(components or ()), given, strict, changed, fmus or [])
    if files := library.scenarios(scenario):
        if store or resume:
            found = "This is a folder of scenarios: there is no one state to store or to go on from."
            raise ShipcosimError(Problem(scenario, found, "Name one scenario, or leave out --store and --from."))
        _run_all(files, out or Path("results") / files[0].resolve().parent.name, reading, options)
        return
    system, happening = _prepared(library.find("scenario", scenario), reading)
    simulate_and_save(system, happening, out or Path("results") / happening.name, options, store, reading.changed)


@dataclass(frozen=True)
class _ReadOptions:
    """How scenarios and systems are read: with which parameter sets, FMUs and values, how strictly, and from where."""

    parameters: list[Path]
    components: dict[str, Path]
    given: dict[str, object]
    strict: bool
    changed: list[str]
    fmus: list[Path]


def _run_all(files: list[Path], out: Path, reading: _ReadOptions, options: "RunOptions") -> None:
    """Run scenarios one after another, and write the table of all of them. All are read before the first one runs."""
    from shipcosim.cli.console import print_overview
    from shipcosim.cli.exits import FAILED
    from shipcosim.cli.runs import simulated_and_saved
    from shipcosim.report import ScenarioRow, digest, overview_outcome, write_overview
    from shipcosim.staging import set_aside

    rows = []
    prepared = [_prepared(file, reading) for file in files]
    set_aside(out, ["report.html", *(happening.name for _, happening in prepared)])
    for system, happening in prepared:
        table, verdicts = simulated_and_saved(system, happening, out / happening.name, options, changed=reading.changed)
        page = f"{happening.name}/report.html"
        rows.append(ScenarioRow(happening.name, happening.description, page, digest(table, verdicts)))
    page = out / "report.html"
    write_overview(rows, page, title=f"Scenarios of {files[0].resolve().parent.name}")
    print_overview(overview_outcome(rows), [(row.name, row.outcome) for row in rows], page)
    if overview_outcome(rows).kind == "failed":
        raise typer.Exit(FAILED)


def _prepared(path: Path, reading: _ReadOptions) -> "tuple[System, Scenario]":
    """System and scenario of a file, checked, with the values that are set for this run."""
    from shipcosim.cli.console import print_problems
    from shipcosim.cosim import system_of
    from shipcosim.scenario import check_files, read_scenario
    from shipcosim.ssp import fitting_values, with_values

    happening = read_scenario(path)
    if missing := check_files(happening):
        raise ShipcosimError(missing)
    system = system_of(happening, components=reading.components, strict=reading.strict, fmus=reading.fmus)
    with_values(system, reading.given, "--set")
    fitting = {}
    for file in reading.parameters:
        values, left_out = fitting_values(file, system)
        print_problems(left_out)
        fitting |= values
    swapped = happening.components | {name: str(file) for name, file in reading.components.items()}
    return system, happening.model_copy(update={"set": happening.set | fitting | reading.given, "components": swapped})
