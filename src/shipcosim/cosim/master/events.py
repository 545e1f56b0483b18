"""Events of a scenario as what they do to the arrays, and when.

As in OSP: an event at time t acts on the step that starts at t. An overridden or biased input differs from what feeds
it from this step on; an output from what this step puts out.
"""

from collections import defaultdict
from collections.abc import Iterator
from functools import partial

import numpy as np

from shipcosim.cosim.master.plan import End, Plan
from shipcosim.cosim.master.signals import Changes
from shipcosim.cosim.master.time_grid import Span
from shipcosim.cosim.slaves.slave import BUFFER_TYPES
from shipcosim.scenario import Scenario, whole_steps


def actions_of(scenario: Scenario, plan: Plan, exchanges: dict, span: Span) -> dict[int, list]:
    """Calls that events on components' variables make, by the number of the step before which they are due."""
    actions = defaultdict(list)
    for k, change, end, value in changes(scenario, plan, span):
        if end[0] is not None:
            target, row = target_of(end, plan, exchanges)
            actions[k].append(partial(getattr(target, change), row, *([] if change == "reset" else [value])))
    return dict(actions)


def target_of(end: End, plan: Plan, exchanges: dict) -> tuple[Changes, int]:
    """Where changes of a component's variable are kept, and its row there."""
    kind = plan.kind(plan.variable(end))
    layout, exchange = plan.layouts[kind], exchanges[kind]
    if end in layout.inputs:
        return exchange.input_changes, layout.inputs.index(end)
    return exchange.output_changes, layout.outputs.index(end)


def settings_over_time(scenario: Scenario, plan: Plan, kind: str, span: Span, fed: dict, in_force: dict):
    """Settings of a kind at each step of a span, or None where they never change.

    Parameters
    ----------
    scenario, plan
        Of the run.
    kind : str
        Real, Integer or Boolean.
    span : Span
        With n steps.
    fed : mapping of str to (n + 1,) array
        Values of the system's inputs that a table feeds.
    in_force : mapping of str to (scale, shift)
        Changes of signals that act from the first step on.

    Returns
    -------
    (n + 1, settings) array or None
    """
    ends = list(plan.layouts[kind].settings)
    changing = [end for end in ends if end[0] is None and (end in plan.touched or end[1] in fed)]
    if not changing:
        return None
    start = np.array(list(plan.layouts[kind].settings.values()), dtype=BUFFER_TYPES[kind])
    values = np.tile(start, (span.last - span.first + 1, 1))
    for end in changing:
        column = ends.index(end)
        values[:, column] = fed.get(end[1], values[:, column])
        due = [c for c in changes(scenario, plan, span) if c[2] == end]
        bend(values[:, column], in_force.get(end[1]), [(k - span.first, change, v) for k, change, _, v in due])
    return values


def in_force_after(scenario: Scenario, plan: Plan, span: Span, in_force: dict) -> dict[str, tuple]:
    """Changes of the system's inputs that are in force just before the events at the end of a span act."""
    in_force = {name: change for name, change in in_force.items() if name in plan.system.inputs}
    for k, change, (component, name), value in changes(scenario, plan, span):
        if component is None and k < span.last:
            in_force[name] = (0 if change == "override" else 1, value or 0)
    return in_force


def bend(values: np.ndarray, in_force: tuple | None, changes: list[tuple]) -> None:
    """Lay overrides and biases over the values that a signal would have.

    Parameters
    ----------
    values : (n,) array
        At each step; changed in place.
    in_force : (scale, shift) or None
        Change that acts from the first step on.
    changes : list of (step, override or bias or reset, value)
    """
    plain = values.copy()
    if in_force is not None:
        values[:] = in_force[0] * plain + in_force[1]
    for k, change, value in changes:
        if change == "override":
            values[k:] = value
        else:
            values[k:] = plain[k:] + (value if change == "bias" else 0)


def changes(scenario: Scenario, plan: Plan, span: Span) -> Iterator[tuple]:
    """(step, override or bias or reset, end, value) in the order in which they act, none from before the span."""
    for event in sorted(scenario.events, key=lambda event: event.time):
        k = whole_steps(event.time - span.start_time, scenario.step_size)
        for change, name, value in event.changes if k >= span.first else ():
            end = plan.system.split(name)
            items = plan.system.inputs[name].items if end[0] is None else plan.variable(end).items
            yield k, change, end, items.get(value, value)
