"""Run a system through a scenario, on the engine that the options name."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cosim.engines.registry import ENGINES, OWN, OWN_OPTIONS
from shipcosim.cosim.systems import prepared, system_of
from shipcosim.errors import ShipcosimError, error_at, suggestion
from shipcosim.options import RunOptions
from shipcosim.scenario import Scenario, odd_values
from shipcosim.snapshot import opened
from shipcosim.ssp import AnyPath, System

if TYPE_CHECKING:
    import xarray


def with_open_snapshot(options: RunOptions) -> RunOptions:
    """Options with the snapshot itself in place of its path, so that the file is read once."""
    return replace(options, resume=opened(options.resume))


def clock_start(options: RunOptions) -> float:
    """Time from which the steps of a run count; one that continues keeps the clock of the run before. [s]"""
    resume = opened(options.resume)
    return options.start_time if resume is None else resume.start_time


def simulate(
    system: System | AnyPath, scenario: Scenario, options: RunOptions | None = None
) -> xarray.Dataset:
    """Run a system through a scenario.

    Parameters
    ----------
    system : System or path
        What runs; a path is read with the scenario's parameter sets and components.
    scenario : Scenario
        Steps, start values, events.
    options : RunOptions, optional
        How it runs: engine, inputs, start and end, processes.

    Returns
    -------
    Dataset
        One row per output interval from the start or the snapshot to the end: outputs of all components, inputs that
        nothing feeds or an event changes, inputs and outputs of the system. Its attributes say what is needed to
        repeat the run.

    Raises
    ------
    ShipcosimError
        If system, scenario and options do not fit together. As RunError, with the rows so far, if the run fails on
        its way.
    Interrupted
        On Ctrl-C, with the rows so far.
    """
    options = options or RunOptions()
    if options.engine not in ENGINES:
        raise ShipcosimError(
            f"There is no engine '{options.engine}'. {suggestion(options.engine, ENGINES)}"
        )
    if not isinstance(system, System):
        system = system_of(scenario, system=Path(system))
    # The checks need names and values as written, the run needs numbers.
    system, numbers = prepared(system, scenario, clock_start(options))
    # Unusual values do not stop the run, but the table notes them.
    odd = [str(remark) for remark in odd_values(scenario, system)]
    # Other engines would ignore these options, so refuse them.
    if options.engine not in OWN and (unknown := options.changed(OWN_OPTIONS)):
        raise error_at(
            f"engine '{options.engine}'",
            f"It does not know {', '.join(unknown)}.",
            "The engines 'fmpy' and 'native' do.",
        )
    table = ENGINES[options.engine](system, numbers, options)
    return table.assign_attrs(
        remarks=json.dumps([*odd, *json.loads(table.attrs.get("remarks", "[]"))])
    )
