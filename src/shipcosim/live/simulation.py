"""A system that steps without end: its simulation, and its state between two steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from shipcosim.cosim.interactive import LONGEST, changeable_inputs, last_step
from shipcosim.cosim.master.algorithm import Master
from shipcosim.cosim.master.events import modifiers_of
from shipcosim.cosim.master.run import Simulation
from shipcosim.cosim.master.signals import Exchange, Modifiers
from shipcosim.cosim.master.time_grid import TimeGrid, time_grid_of
from shipcosim.cosim.processes.remote_slave import IsolatedInstances
from shipcosim.cosim.slaves.instances import Instances
from shipcosim.cosim.slaves.pythonfmu_code import module_clashes
from shipcosim.options import TIMEOUT, RunOptions
from shipcosim.scenario import Scenario, step_times
from shipcosim.ssp import System

Change = tuple[int, str, str, Any]
"""Step before which it acts; override, bias or reset; signal; value."""


@dataclass(frozen=True)
class SystemState:
    """A system between two steps: states of the FMUs by name, arrays and modifiers of each exchange."""

    fmus: dict[str, bytes]
    arrays: list[list[np.ndarray]]
    modifiers: list[list[dict]]


def endless_grid(scenario: Scenario) -> TimeGrid:
    """Time grid of a run that ends when nobody can want it any more."""
    grid = time_grid_of(scenario)
    step = scenario.step_size
    last = last_step(grid, step)
    # The step of a slow component may go beyond the end.
    times = step_times(step, 0, last + int(LONGEST / 24 / step))
    return TimeGrid(0.0, float(times[-1]), 0, last, times, grid.steps_per_row)


def endless_simulation(system: System, scenario: Scenario, grid: TimeGrid) -> Simulation:
    """The simulation of such a run; its events are left to who calls `apply_changes`."""
    # The page changes any input, and all events act between two steps as what it changes does.
    named = [name for event in scenario.events for _, name, _ in event.changes]
    names = list(dict.fromkeys([*changeable_inputs(system), *named]))
    quiet = scenario.model_copy(update={"events": []})
    return Simulation(system, quiet, grid, RunOptions(engine="native"), changeable=names)


def instances_of(system: System) -> Instances | IsolatedInstances:
    """Instances of a system's FMUs: processes of their own where two bring other Python modules of one name."""
    apart = module_clashes(system, late_alone=True)
    return IsolatedInstances(system, TIMEOUT) if apart else Instances()


def apply_changes(simulation: Simulation, step: int, due: Sequence[Change]) -> None:
    """Apply the changes that act before a step."""
    plan = simulation.plan
    exchanges = simulation.exchanges
    # Inputs of the system are passed on with the values of this time, as `Master.run` does with external ones.
    for _, action, name, value in due:
        end = plan.system.split(name)
        for kind, exchange in exchanges.items() if end[0] is None else ():
            layout = plan.layouts[kind]
            if end in layout.external:
                start: Any = layout.external[end] or 0
                given = value if action == "override" else start + value
                exchange.external[list(layout.external).index(end)] = given
    if due:
        for exchange in exchanges.values():
            exchange.transfer(step)
    # Overrides come after that: an output that is overridden now shows it from what this step puts out.
    for _, action, name, value in due:
        end = plan.system.split(name)
        if end[0] is not None:
            modifiers, row = modifiers_of(end, plan, exchanges)
            modifiers.put(row, 0 if action == "override" else 1, value)
    for exchange in exchanges.values() if due else ():
        exchange.refresh()


def state_of(simulation: Simulation, master: Master) -> SystemState:
    """The state between two steps. Raises SlaveError."""
    master.give_back()
    fmus = {name: component.slave.state() for name, component in simulation.components.items()}
    exchanges = simulation.exchanges.values()
    arrays = [[values.copy() for values in arrays_of(exchange)] for exchange in exchanges]
    return SystemState(fmus, arrays, [[m.active for m in modifiers_in(e)] for e in exchanges])


def restore(simulation: Simulation, master: Master, state: SystemState) -> None:
    """Go on from a state. Raises SlaveError."""
    # FMUs first, then the values that are exchanged.
    for name, component in simulation.components.items():
        component.restore(state.fmus[name])
    for exchange, arrays, active in zip(
        simulation.exchanges.values(), state.arrays, state.modifiers, strict=True
    ):
        for values, before in zip(arrays_of(exchange), arrays, strict=True):
            values[:] = before
        for modifiers, wanted in zip(modifiers_in(exchange), active, strict=True):
            for row in modifiers.active:
                modifiers.reset(row)
            for row, modifier in wanted.items():
                modifiers.put(row, *modifier)
    # Texts are passed on again, since the FMUs may have others; compiled components take the numbers of their FMUs.
    for connection in simulation.strings:
        connection.last = None
    master.take_back()


def arrays_of(exchange: Exchange) -> list[np.ndarray]:
    """Arrays of an exchange that change from step to step."""
    return [exchange.sources, exchange.modified_sources, exchange.transferred, exchange.inputs]


def modifiers_in(exchange: Exchange) -> tuple[Modifiers, Modifiers]:
    """Overrides and biases of an exchange's outputs and inputs."""
    return exchange.output_modifiers, exchange.input_modifiers
