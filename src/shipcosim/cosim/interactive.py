"""What a page shows and changes of a running system, whether the page runs it or a server does."""

from __future__ import annotations

from dataclasses import dataclass

from shipcosim.cosim.master.plan import Plan, label
from shipcosim.cosim.master.result import recorded_ends
from shipcosim.cosim.master.time_grid import TimeGrid
from shipcosim.cosim.slaves.slave import BUFFER_TYPES
from shipcosim.ssp import System

LONGEST = 86400.0
"""A run ends after a day at the latest. [s]"""
MOST_STEPS, MOST_ROWS = 2_000_000, 400_000
"""It ends earlier where memory for its times and rows would not do: 1 GB for rows of 300 signals."""


@dataclass(frozen=True)
class StartValue:
    """A start value, which the page can change before a start where it is a number.

    Attributes
    ----------
    place : int
        Among all of them.
    signal, unit : str
    value : number, bool or text
    kind : str
        Real, Integer, Boolean or String.
    """

    place: int
    signal: str
    value: object
    unit: str
    kind: str


def changeable_inputs(system: System) -> list[str]:
    """Inputs and tunable parameters of all components: each gets a row, so that it can be changed."""
    return [
        label((component.name, variable.name))
        for component, variable in system.all_variables()
        if (variable.causality == "input" or variable.variability == "tunable")
        and variable.kind in ("Real", "Integer", "Boolean")
    ]


def last_step(grid: TimeGrid, step_size: float) -> int:
    """Steps after which a run without end ends."""
    return min(int(LONGEST / step_size), MOST_STEPS, MOST_ROWS * grid.steps_per_row)


def kinds_of(plan: Plan) -> list[str]:
    """Kinds of values that are exchanged, in the order of the tables of rows."""
    layouts = plan.layouts
    return [kind for kind in BUFFER_TYPES if layouts[kind].outputs or layouts[kind].inputs]


def row_signals(plan: Plan, kind: str) -> list[str]:
    """Signals of a recorded row of a kind."""
    return [label(end) for end in recorded_ends(plan, kind)]


def start_values_of(plan: Plan) -> list[StartValue]:
    """All start values, in the order in which the FMUs get them; parameters without one have their FMU's number."""
    values = []
    for component in plan.system.components.values():
        variables = component.fmu.variables
        numbers = {
            name: variable.start
            for name, variable in variables.items()
            if variable.causality == "parameter" and isinstance(variable.start, int | float)
        }
        # The values of the system in their order, then those that only an FMU gives.
        for name, value in {**component.start, **numbers, **component.start}.items():
            variable = variables[name]
            kind = "String" if isinstance(value, str) else plan.kind(variable) or ""
            signal = label((component.name, name))
            values.append(StartValue(len(values), signal, value, variable.unit or "", kind))
    return values
