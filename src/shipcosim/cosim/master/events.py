"""Events of a scenario as changes of arrays, with their steps.

As in OSP: an event at time t acts on the step that starts at t. An overridden or biased input differs from what feeds
it from this step on; an output from what this step puts out.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from time import perf_counter, sleep
from typing import Any, NamedTuple

import numpy as np

from shipcosim.cosim.master.plan import End, Plan
from shipcosim.cosim.master.signals import Exchange, Modifier, Modifiers
from shipcosim.cosim.master.time_grid import TimeGrid
from shipcosim.cosim.slaves.slave import BUFFER_TYPES
from shipcosim.scenario import Scenario
from shipcosim.units import whole_steps


class SignalChange(NamedTuple):
    """The effect of an event on one variable.

    Parameters
    ----------
    step : int
        Before which it acts.
    action : str
        ``"override"``, ``"bias"`` or ``"reset"``.
    end : End
        Component and variable.
    value : number, bool, text or None
        None for a reset.
    """

    step: int
    action: str
    end: End
    value: Any


def changes(scenario: Scenario, plan: Plan, grid: TimeGrid) -> Iterator[SignalChange]:
    """Changes in the order in which they act, none from before the time grid's first step."""
    # In order of time, since a later change of the same signal replaces an earlier one.
    for event in sorted(scenario.events, key=lambda event: event.time):
        step = whole_steps(event.time - grid.start_time, scenario.step_size)
        assert step is not None  # which the time grid has checked
        # Changes before the first step are part of the snapshot already.
        for action, name, value in event.changes if step >= grid.first else ():
            end = plan.system.split(name)
            # The name of an enumeration's item stands for its number.
            items = plan.system.described(*end).items
            yield SignalChange(
                step, action, end, items.get(value, value) if isinstance(value, str) else value
            )


def event_actions(
    scenario: Scenario, plan: Plan, exchanges: Mapping[str, Exchange], grid: TimeGrid
) -> dict[int, list[Callable[[], None]]]:
    """Calls of the events on components' variables, by the step before which they are due."""
    actions = defaultdict(list)
    for change in changes(scenario, plan, grid):
        # Events on the system's own inputs are part of the external values, see `external_values`.
        if change.end[0] is not None:
            modifiers, row = modifiers_of(change.end, plan, exchanges)
            arguments = [] if change.action == "reset" else [change.value]
            actions[change.step].append(partial(getattr(modifiers, change.action), row, *arguments))
    return dict(actions)


LONGEST_SLEEP = 0.2
"""Time after which a run that waits for the clock looks for Ctrl-C. Assumed: nobody notices it. [s]"""


def add_pace(
    actions: dict[int, list[Callable[[], None]]],
    grid: TimeGrid,
    realtime: float,
    check_interrupt: Callable[[], None],
) -> None:
    """Have each step wait until its time has come on the clock.

    Parameters
    ----------
    actions : dict of int to list of callable
        By the step before which they are due; those of the waiting are added.
    grid : TimeGrid
    realtime : float
        Seconds of the run in a second of the clock. A run that is late catches up.
    check_interrupt : callable
        Raises KeyboardInterrupt where the user wants to stop.
    """
    begin = 0.0

    def wait(step: int) -> None:
        nonlocal begin
        # The clock starts with the first step: loading the FMUs is no part of the run.
        begin = begin or perf_counter()
        due = begin + (grid.times[step] - grid.times[grid.first]) / realtime
        while (early := due - perf_counter()) > 0.0:
            check_interrupt()
            sleep(min(early, LONGEST_SLEEP))

    for step in range(grid.first, grid.last):
        actions.setdefault(step, []).append(partial(wait, step))


def modifiers_of(end: End, plan: Plan, exchanges: Mapping[str, Exchange]) -> tuple[Modifiers, int]:
    """The modifiers that hold a variable's overrides and biases, and its row there."""
    kind = plan.kind_of(end)
    layout = plan.layouts[kind]
    exchange = exchanges[kind]
    if end in layout.inputs:
        return exchange.input_modifiers, layout.inputs.index(end)
    return exchange.output_modifiers, layout.outputs.index(end)


def external_values(
    scenario: Scenario,
    plan: Plan,
    kind: str,
    grid: TimeGrid,
    fed: Mapping[str, np.ndarray],
    active: Mapping[str, Modifier],
) -> np.ndarray | None:
    """External values of a kind at each step of a time grid, or None where they never change.

    Parameters
    ----------
    scenario, plan
        Of the run.
    kind : str
        Real, Integer or Boolean.
    grid : TimeGrid
        With n steps.
    fed : mapping of str to (n + 1,) array
        Values of the system's inputs that a table feeds.
    active : mapping of str to (scale, shift)
        Overrides and biases of signals that act from the first step on.

    Returns
    -------
    (n + 1, external values) array or None
    """
    # Only inputs of the system can change over time: by events or by a table.
    ends = list(plan.layouts[kind].external)
    changing = [end for end in ends if end[0] is None and (end in plan.modified or end[1] in fed)]
    if not changing:
        return None
    # Start values at all times; then the table's values; then the events over both.
    start = np.array(list(plan.layouts[kind].external.values()), dtype=BUFFER_TYPES[kind])
    values = np.tile(start, (grid.last - grid.first + 1, 1))
    for end in changing:
        column = ends.index(end)
        values[:, column] = fed.get(end[1], values[:, column])
        due = [
            c._replace(step=c.step - grid.first)
            for c in changes(scenario, plan, grid)
            if c.end == end
        ]
        modify(values[:, column], active.get(end[1]), due)
    return values


def modifiers_after(
    scenario: Scenario, plan: Plan, grid: TimeGrid, active: Mapping[str, Modifier]
) -> dict[str, Modifier]:
    """Overrides and biases of the system's inputs, just before the events at the grid's end.

    Parameters
    ----------
    scenario, plan, grid
        Of the run.
    active : mapping of str to (scale, shift)
        Those that act at its beginning, by signal.
    """
    after = {name: modifier for name, modifier in active.items() if name in plan.system.inputs}
    # The last change of each signal counts; a reset is a bias of zero.
    for change in changes(scenario, plan, grid):
        component, name = change.end
        if component is None and change.step < grid.last:
            after[name] = (0 if change.action == "override" else 1, change.value or 0)
    return after


def modify(values: np.ndarray, active: Modifier | None, changes: Sequence[SignalChange]) -> None:
    """Apply overrides and biases to the values that a signal would have.

    Parameters
    ----------
    values : (n,) array
        At each step; changed in place.
    active : (scale, shift) or None
        Override or bias that acts from the first step on.
    changes : sequence of SignalChange
        Their steps count from the first value.
    """
    # Each change acts on the unmodified signal: a bias after an override starts from the signal
    # itself.
    unmodified = values.copy()
    if active is not None:
        values[:] = active[0] * unmodified + active[1]
    for step, action, _, value in changes:
        if action == "override":
            values[step:] = value
        else:
            values[step:] = unmodified[step:] + (value if action == "bias" else 0)
