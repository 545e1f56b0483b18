"""Systems in other forms: `shipcosim export fmu`, `osp` and `page`; `shipcosim live` opens that page."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from shipcosim.cli.options import (
    Components,
    Fmus,
    Force,
    OspEvents,
    Parameters,
    ScenariosStepSize,
    ScenariosStopTime,
    Strict,
    Swaps,
    SystemOrScenario,
    out_option,
    time_option,
)
from shipcosim.cli.terminal import say

if TYPE_CHECKING:
    from shipcosim.report.live.export import Others
    from shipcosim.scenario import Scenario
    from shipcosim.ssp import System


def fmu(
    what: SystemOrScenario,
    out: Annotated[Path, out_option("Folder that gets NAME.fmu.")] = Path("."),
    step_size: Annotated[
        float | None,
        time_option(
            "--step-size",
            "Step of the exchange inside; in s, or with a unit: '50 ms'. Default: the system's.",
        ),
    ] = None,
    parameters: Parameters = None,
    components: Components = None,
    connectors_only: Annotated[
        bool,
        typer.Option(
            "--connectors-only", help="Show the system's own connectors, nothing of its components."
        ),
    ] = False,
    unchecked: Annotated[
        bool, typer.Option("--unchecked", help="Do not run FMU and system side by side first.")
    ] = False,
    strict: Strict = False,
    force: Force = False,
) -> None:
    """Make one FMU of a whole system, a block in anyone's tool. FMPy's container FMU does the work in it.

    FMU and system are run side by side for some steps first; where they differ, no FMU is written. Of a scenario its
    parameter sets and start values go into the FMU; its events and expectations do not.

    Example: shipcosim export fmu ferry.ssp --out results
    """
    from shipcosim.calls.arguments import Reading, system_and_scenario
    from shipcosim.cli.console import print_problems, shown_path
    from shipcosim.cli.requests import parsed_components
    from shipcosim.cosim import export_fmu
    from shipcosim.ssp import with_values
    from shipcosim.ssp.xml.archive import replaced
    from shipcosim.staging import set_file_aside
    from shipcosim.temporary import temporary_folder

    reading = Reading(
        parameters=parameters or [], components=parsed_components(components), strict=strict
    )
    keys = {} if step_size is None else {"step_size": step_size}
    system, scenario, _ = system_and_scenario(what, reading, keys, needs_end=False)
    print_problems(system.deviations)
    system = with_values(system, scenario.set, what)
    target = out / f"{system.name}.fmu"
    step = scenario.step_size
    # An earlier FMU is set aside at the end: where nothing could be made, it stays.
    with temporary_folder() as folder:
        made = Path(folder, target.name)
        remarks = export_fmu(
            system, made, step, connectors_only=connectors_only, check=not unchecked
        )
        with replaced(target) as new:
            new.write_bytes(made.read_bytes())
            set_file_aside(target, force=force)
    print_problems(remarks)
    say(shown_path(target))


def page(
    what: SystemOrScenario,
    out: Annotated[
        Path,
        out_option("Folder that gets NAME.html, or the file.", metavar="DIR|FILE.html"),
    ] = Path("."),
    stop_time: ScenariosStopTime = None,
    step_size: ScenariosStepSize = None,
    parameters: Parameters = None,
    components: Components = None,
    swaps: Swaps = None,
    fmus: Fmus = None,
    strict: Strict = False,
    force: Force = False,
) -> None:
    """Make one HTML file that runs the system itself: a desk to steer the ship and fail her units, without a network.

    All components need native code. Events of a scenario happen in the page, too; its expectations are not judged.
    The first time takes about half a minute.

    Example: shipcosim export page four_corner --out results
    """
    from shipcosim.cli.console import shown_path

    times = stop_time, step_size
    first, *others = _systems(what, (parameters, components, fmus, strict), times, swaps)
    say(shown_path(_write_page(first, others, out, force=force)))


def live(
    what: SystemOrScenario,
    out: Annotated[
        Path,
        out_option("Folder that gets NAME.html, or the file.", metavar="DIR|FILE.html"),
    ] = Path("results", "live"),
    stop_time: ScenariosStopTime = None,
    step_size: ScenariosStepSize = None,
    parameters: Parameters = None,
    components: Components = None,
    swaps: Swaps = None,
    fmus: Fmus = None,
    strict: Strict = False,
    no_open: Annotated[
        bool, typer.Option("--no-open", help="Write the page, but do not open the browser.")
    ] = False,
) -> None:
    """Steer a ship live: open the page that runs the system itself, as `export page` writes it.

    Where a component has no native code, a server on this computer runs the system until Ctrl-C, and the page shows it.

    Example: shipcosim live four_corner
    """
    from shipcosim.cli.console import print_problems, shown_path
    from shipcosim.cosim.webassembly import NotForPages

    times = stop_time, step_size
    first, *others = _systems(what, (parameters, components, fmus, strict), times, swaps)
    try:
        path = _write_page(first, others, out, force=True)
    except NotForPages as reason:
        if others:  # a server runs one system
            raise
        print_problems(
            replace(problem, severity="remark", remedy="") for problem in reason.problems
        )
        _serve(*first, no_open)
        return
    say(shown_path(path))
    _open(path.resolve().as_uri(), no_open)


def _serve(system: System, scenario: Scenario, no_open: bool) -> None:
    """Run a system with a server until Ctrl-C."""
    from shipcosim.live import LiveRun, LiveServer
    from shipcosim.report.live import prepared, server_page

    page = server_page(system, scenario)
    with LiveServer(page) as server:
        say(f"A server on this computer runs the system; Ctrl-C ends it: {server.url}")
        _open(server.url, no_open)
        try:
            LiveRun(*prepared(system, scenario), server, say).run()
        except KeyboardInterrupt:
            say("The server has ended.")


def _open(address: str, no_open: bool) -> None:
    """Open a page in the browser, unless that is not wanted."""
    import webbrowser

    if not no_open and not webbrowser.open(address):
        say("No browser was found: open this address in one.")


def _systems(
    what: str,
    options: tuple[Parameters, Components, Fmus, Strict],
    times: tuple[float | None, float | None],
    swaps: Swaps,
) -> Others:
    """The system of a page with its scenario, and the same for each swap."""
    from shipcosim.cli.requests import parsed_components

    parameters, components, fmus, strict = options
    given = parsed_components(components)
    systems = [_system_and_scenario(what, options, times)]
    for swap in swaps or ():
        taken = given | parsed_components([swap], "--swap")
        swapped = [f"{name}={fmu}" for name, fmu in taken.items()]
        systems.append(_system_and_scenario(what, (parameters, swapped, fmus, strict), times))
    return systems


def _system_and_scenario(
    what: str,
    options: tuple[Parameters, Components, Fmus, Strict],
    times: tuple[float | None, float | None],
    events: OspEvents = None,
    needs_end: bool = True,
) -> tuple[System, Scenario]:
    """What is exported, with what the command line changed: stop time and step size [s], sets, components."""
    from shipcosim.calls.arguments import Reading, system_and_scenario
    from shipcosim.cli.console import print_problems
    from shipcosim.cli.requests import parsed_components

    parameters, components, fmus, strict = options
    swapped = parsed_components(components)
    reading = Reading(
        parameters=parameters or [], components=swapped, fmus=fmus or [], strict=strict
    )
    named = zip(("stop_time", "step_size"), times, strict=True)
    keys = {name: time for name, time in named if time is not None}
    system, scenario, remarks = system_and_scenario(
        what, reading, keys, events, needs_end=needs_end
    )
    print_problems([*system.deviations, *remarks])
    # What the command line changed belongs to the scenario that the page saves.
    given = {
        "system": scenario.system or what,
        "parameters": [*scenario.parameters, *map(str, parameters or ())],
        "components": {**scenario.components, **{k: str(v) for k, v in swapped.items()}},
    }
    return system, scenario.model_copy(update=given)


def _write_page(first: tuple[System, Scenario], others: Others, out: Path, *, force: bool) -> Path:
    """Write the page that runs a system, or another in its place; return its path."""
    from shipcosim.cli.console import progress_of
    from shipcosim.report.live import live_page
    from shipcosim.staging import staged

    with progress_of("Compiling") as progress:
        html = live_page(*first, progress, others)
    system, scenario = first
    # An earlier page is set aside at the end: where nothing could be made, it stays.
    name = f"{scenario.name or system.name}.html"
    if out.suffix.lower() in (".html", ".htm") and not out.is_dir():
        out, name = out.parent, out.name
    with staged(out, force=force) as stage:
        (stage / name).write_text(html, encoding="utf-8")
    return out / name


def osp(
    what: SystemOrScenario,
    out: Annotated[Path, out_option("Folder for the files; made if needed.")],
    stop_time: ScenariosStopTime = None,
    step_size: ScenariosStepSize = None,
    parameters: Parameters = None,
    components: Components = None,
    fmus: Fmus = None,
    events: OspEvents = None,
    strict: Strict = False,
    force: Force = False,
) -> None:
    """Write OspSystemStructure.xml, the FMUs and scenario.json, which libcosim runs as they are.

    What OSP cannot express is refused; what gets lost on the way is said.

    Example: shipcosim export osp four_corner --out results/osp
    """
    from shipcosim.cli.console import print_problems, shown_path
    from shipcosim.cosim.export.osp import write_osp

    # OSP's structures need no end; events need one.
    system, scenario = _system_and_scenario(
        what,
        (parameters, components, fmus, strict),
        (stop_time, step_size),
        events,
        needs_end=events is not None,
    )
    has_end = bool(stop_time or system.experiment.stop_time or scenario.path)
    print_problems(write_osp(system, scenario, out, has_end=has_end, force=force))
    for path in sorted(out.glob("*")):
        say(shown_path(path))
