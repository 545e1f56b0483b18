"""The command `shipcosim run`."""

from collections.abc import Sequence
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
from shipcosim.errors import error_at

if TYPE_CHECKING:
    from shipcosim.calls.runs import PreparedRun


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
    from shipcosim.calls.runs import prepare_run
    from shipcosim.cli.requests import isolation, parsed_components, parsed_settings
    from shipcosim.cli.runs import exit_if_failed, run_and_print

    asked = {
        "parameters": parameters or [],
        "fmus": fmus or [],
        "strict": strict,
        "engine": engine,
        "until": until,
    }
    asked |= {
        "set": parsed_settings(settings or []),
        "components": parsed_components(components or ()),
    }
    asked |= {"resume": resume, **isolation(isolate, timeout)}
    if files := library.scenarios(scenario):
        if store or resume:
            found = (
                "This is a folder of scenarios: there is no one state to store or to go on from."
            )
            raise error_at(scenario, found, "Name one scenario, or leave out --store and --from.")
        name = files[0].resolve().parent.name
        prepared = [prepare_run(file, **asked) for file in files]
        _run_all(prepared, out or Path("results") / name, name, force)
        return
    prepared = prepare_run(scenario, store=store, **asked)
    exit_if_failed(run_and_print(prepared, out or Path("results") / prepared.scenario.name, force))


def _run_all(prepared: "Sequence[PreparedRun]", out: Path, name: str, force: bool) -> None:
    """Run scenarios one after another, and write the table of all of them."""
    from shipcosim.cli.console import print_overview
    from shipcosim.cli.exits import FAILED
    from shipcosim.cli.runs import run_and_print
    from shipcosim.report import ScenarioRow, digest, overview_outcome, write_overview
    from shipcosim.staging import set_aside

    rows = []
    set_aside(out, ["report.html", *(one.scenario.name for one in prepared)], force=force)
    for planned in prepared:
        happening = planned.scenario
        result = run_and_print(planned, out / happening.name, force)
        page = f"{happening.name}/report.html"
        outcome = digest(result.table, result.expectations)
        rows.append(ScenarioRow(happening.name, happening.description, page, outcome))
    page = out / "report.html"
    write_overview(rows, page, title=f"Scenarios of {name}")
    print_overview(overview_outcome(rows), [(row.name, row.outcome) for row in rows], page)
    if overview_outcome(rows).kind == "failed":
        raise typer.Exit(FAILED)
