"""Events of a scenario as what they do to the arrays, and when.

As in OSP: an event at time t acts on the step that starts at t. An overridden or biased input differs from what feeds
it from this step on; an output from what this step puts out.
"""

from collections import defaultdict
from functools import partial

import numpy as np

from shipcosim.cosim.plan import KINDS, Plan
from shipcosim.cosim.slave import BUFFER_TYPES
from shipcosim.scenario import Scenario, whole_steps


def actions_of(scenario: Scenario, plan: Plan, exchanges: dict) -> dict[int, list]:
    """Calls that events on components' variables make, by the number of the step before which they are due."""
    actions = defaultdict(list)
    for k, change, end, value in _changes(scenario, plan):
        if end[0] is not None:
            variable = plan.variable(end)
            kind = KINDS[variable.kind]
            layout, exchange = plan.layouts[kind], exchanges[kind]
            if end in layout.inputs:
                target, row = exchange.input_changes, layout.inputs.index(end)
            else:
                target, row = exchange.output_changes, layout.outputs.index(end)
            actions[k].append(partial(getattr(target, change), row, *([] if change == "reset" else [value])))
    return dict(actions)


def settings_over_time(scenario: Scenario, plan: Plan, kind: str, n_steps: int, fed: dict):
    """Settings of a kind at each step, or None where they never change.

    Parameters
    ----------
    scenario, plan
        Of the run.
    kind : str
        Real, Integer or Boolean.
    n_steps : int
        Steps of the run.
    fed : mapping of str to (n_steps + 1,) array
        Values of the system's inputs that a table feeds.

    Returns
    -------
    (n_steps + 1, settings) array or None
    """
    ends = list(plan.layouts[kind].settings)
    changing = [end for end in ends if end[0] is None and (end in plan.touched or end[1] in fed)]
    if not changing:
        return None
    start = np.array(list(plan.layouts[kind].settings.values()), dtype=BUFFER_TYPES[kind])
    values = np.tile(start, (n_steps + 1, 1))
    for end in changing:
        column = ends.index(end)
        values[:, column] = fed.get(end[1], values[:, column])
        _bend(values[:, column], [c for c in _changes(scenario, plan) if c[2] == end])
    return values


def _bend(values, changes):
    """Lay overrides and biases over the values that an input of the system would have."""
    plain = values.copy()
    for k, change, _, value in changes:
        if change == "override":
            values[k:] = value
        else:
            values[k:] = plain[k:] + (value if change == "bias" else 0)


def _changes(scenario, plan):
    """(step, override or bias or reset, end, value) in the order in which they act."""
    for event in sorted(scenario.events, key=lambda event: event.time):
        k = whole_steps(event.time, scenario.step_size)
        for change, name, value in event.changes:
            end = plan.system.split(name)
            items = plan.system.inputs[name].items if end[0] is None else plan.variable(end).items
            yield k, change, end, items.get(value, value)
