"""Inputs that left the range which the model description of their FMU gives."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from shipcosim.cosim.master.plan import Layout, Plan, label
from shipcosim.cosim.master.result import recorded_rows

ROUNDING = 1e-9
"""Part of a bound by which a value may miss it: conversions of units round."""


def range_remarks(
    plan: Plan, times: np.ndarray, recorded: Mapping[str, Sequence[np.ndarray]]
) -> Iterator[str]:
    """A remark for each input or tunable parameter that was outside its range in a row of the table.

    FMI leaves open what an FMU does then, and most compute on.

    Parameters
    ----------
    plan : Plan
        Of the run.
    times : (n,) array
        Of the rows. [s]
    recorded : dict of str to list of (n,) array
        By kind: outputs, external values and inputs as the recorder has them.
    """
    for kind, columns in recorded.items():
        layout = plan.layouts[kind]
        arrived = _arrived(plan, kind, layout, columns)
        for end, values in zip(layout.inputs, arrived, strict=True):
            variable = plan.variable(end)
            low = -np.inf if variable.minimum is None else variable.minimum
            high = np.inf if variable.maximum is None else variable.maximum
            if values is None or kind == "Boolean" or (low, high) == (-np.inf, np.inf):
                continue
            # How far each row lies beyond the nearer bound.
            excess = np.maximum(low - values, values - high)
            bound = max(abs(b) for b in (low, high) if np.isfinite(b))
            if len(excess) and (worst := int(np.argmax(excess))) >= 0:
                if excess[worst] > ROUNDING * max(bound, 1e-300):
                    unit = f" {variable.unit}" if variable.unit not in (None, "", "1") else ""
                    yield (
                        f"{label(end)}: {values[worst]:.6g}{unit} at {times[worst]:g} s. Its FMU states a range"
                        f" of {low:g} to {high:g}{unit}."
                    )


def _arrived(
    plan: Plan, kind: str, layout: Layout, columns: Sequence[np.ndarray]
) -> Iterator[np.ndarray | None]:
    """Values of each input of a kind, (n,); None where a source is not recorded."""
    external, inputs = recorded_rows(plan, kind)
    n_outputs = len(layout.outputs)
    rows = [*range(n_outputs), *(n_outputs + row for row in external)]
    sources = dict(zip(rows, columns, strict=False))
    as_set = dict(zip(inputs, columns[len(rows) :], strict=True))
    for row, connection in enumerate(layout.connections):
        terms = connection.terms or (connection,)
        if row in as_set:
            yield as_set[row]
        elif all(term.source in sources for term in terms):
            # In each row the newest value: a connection of longer period passes on fewer of them.
            single = [replace(term, period=1, added=()) for term in terms]
            yield np.sum([term.transferred(sources[term.source]) for term in single], axis=0)
        else:
            yield None
