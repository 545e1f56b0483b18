"""A system as one HTML file that runs it: from a disk, from a mail, without a network."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from shipcosim.cosim import simulate
from shipcosim.cosim.interactive import changeable_inputs
from shipcosim.cosim.master.plan import Plan, make_plan
from shipcosim.cosim.systems import prepared
from shipcosim.cosim.webassembly import make_module
from shipcosim.options import CountProgress, RunOptions
from shipcosim.report.live.page import LivePage, page_of, render
from shipcosim.scenario import Scenario
from shipcosim.series import write_file
from shipcosim.ssp import AnyPath, System

FIRST_ROWS = 3
"""Rows of the run from which the scene is made: which signals belong to one ship shows where they move."""


Others = Sequence[tuple[System, Scenario]]
"""The system with other FMUs in its components, each with its scenario."""


def live_page(
    system: System,
    scenario: Scenario,
    progress: CountProgress | None = None,
    others: Others = (),
) -> str:
    """The page that runs a system itself, as HTML.

    Parameters
    ----------
    system : System
        Checked.
    scenario : Scenario
        Its start values and events; its expectations are not judged.
    progress : callable, optional
        Called with (components written as C, in all).
    others : sequence of (System, Scenario)
        The system with other FMUs in its components: the reader chooses one at a start.

    Raises
    ------
    NotForPages
        With every component that has no native code, and why.
    ShipcosimError
        There is no compiler; system and scenario do not fit; or nothing in it is a ship.
    """
    pages = [
        _page(*pair, lambda plan, numbers: make_module(plan, numbers, progress))
        for pair in ((system, scenario), *others)
    ]
    return render(pages, _labels([system, *(other for other, _ in others)]) if others else [])


def _labels(systems: Sequence[System]) -> list[str]:
    """The FMUs of each system, in the components in which they are not the same."""
    fmus = [{name: part.fmu.path for name, part in s.components.items()} for s in systems]
    swapped = [name for name in fmus[0] if len({paths[name] for paths in fmus}) > 1]
    return [", ".join(f"{name}: {paths[name].stem}" for name in swapped) for paths in fmus]


def server_page(system: System, scenario: Scenario) -> str:
    """The page of a system that a server runs, as HTML. Arguments as of `live_page`; raises ShipcosimError."""
    return render([_page(system, scenario, lambda plan, numbers: b"")], [])


def _page(
    system: System, scenario: Scenario, compiled: Callable[[Plan, Scenario], bytes]
) -> LivePage:
    system, numbers = prepared(system, scenario)
    plan = make_plan(system, numbers, (), changeable_inputs(system))
    # Compile first: a component without native code is reported before anything runs.
    code = compiled(plan, numbers)
    interval = scenario.output_interval or scenario.step_size
    until = min(FIRST_ROWS * interval, scenario.stop_time)
    table = simulate(plan.system, scenario, RunOptions(until=until))
    return page_of(plan, code, table, numbers, scenario)


def export_page(
    system: System,
    scenario: Scenario,
    path: AnyPath,
    progress: CountProgress | None = None,
    others: Others = (),
) -> None:
    """Write that page; it is there completely or not at all.

    Parameters
    ----------
    system, scenario, progress, others
        As of `live_page`.
    path : path
        HTML file.

    Raises
    ------
    ShipcosimError
        As of `live_page`; or the file cannot be written.
    """
    write_file(path, live_page(system, scenario, progress, others).encode())
