"""A system as one HTML file that runs it: from a disk, from a mail, without a network."""

from __future__ import annotations

from collections.abc import Callable

from shipcosim.cosim import simulate
from shipcosim.cosim.interactive import changeable_inputs
from shipcosim.cosim.master.plan import Plan, make_plan
from shipcosim.cosim.systems import prepared
from shipcosim.cosim.webassembly import make_module
from shipcosim.options import CountProgress, RunOptions
from shipcosim.report.live.page import render_live
from shipcosim.scenario import Scenario
from shipcosim.series import write_file
from shipcosim.ssp import AnyPath, System

FIRST_ROWS = 3
"""Rows of the run from which the scene is made: which signals belong to one ship shows where they move."""


def live_page(system: System, scenario: Scenario, progress: CountProgress | None = None) -> str:
    """The page that runs a system itself, as HTML.

    Parameters
    ----------
    system : System
        Checked.
    scenario : Scenario
        Its start values and events; its expectations are not judged.
    progress : callable, optional
        Called with (components written as C, in all).

    Raises
    ------
    NotForPages
        With every component that has no native code, and why.
    ShipcosimError
        There is no compiler; system and scenario do not fit; or nothing in it is a ship.
    """
    return _rendered(system, scenario, lambda plan, numbers: make_module(plan, numbers, progress))


def server_page(system: System, scenario: Scenario) -> str:
    """The page of a system that a server runs, as HTML. Arguments as of `live_page`; raises ShipcosimError."""
    return _rendered(system, scenario, lambda plan, numbers: b"")


def _rendered(
    system: System, scenario: Scenario, compiled: Callable[[Plan, Scenario], bytes]
) -> str:
    system, numbers = prepared(system, scenario)
    plan = make_plan(system, numbers, (), changeable_inputs(system))
    # Compile first: a component without native code is reported before anything runs.
    code = compiled(plan, numbers)
    interval = scenario.output_interval or scenario.step_size
    until = min(FIRST_ROWS * interval, scenario.stop_time)
    table = simulate(plan.system, scenario, RunOptions(until=until))
    return render_live(plan, code, table, numbers, scenario)


def export_page(
    system: System, scenario: Scenario, path: AnyPath, progress: CountProgress | None = None
) -> None:
    """Write that page; it is there completely or not at all.

    Parameters
    ----------
    system, scenario, progress
        As of `live_page`.
    path : path
        HTML file.

    Raises
    ------
    ShipcosimError
        As of `live_page`; or the file cannot be written.
    """
    write_file(path, live_page(system, scenario, progress).encode())
