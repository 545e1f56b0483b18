"""A run on another engine: its job, and the table made from the outputs that it returns.

The engine gets the components, their start values and the connections between them. What no component feeds is known
before the run: inputs of the system, and inputs without connection that events change. These are set from here.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from shipcosim.cosim.master.algorithm import now_and_then
from shipcosim.cosim.master.events import changes, external_values, modify
from shipcosim.cosim.master.inputs import digest, input_values
from shipcosim.cosim.master.interrupt import delayed_interrupt
from shipcosim.cosim.master.plan import WIDE, End, make_plan
from shipcosim.cosim.master.ranges import range_remarks
from shipcosim.cosim.master.result import attributes_of, columns_of, recorded_rows
from shipcosim.cosim.master.run import Interrupted, RunError
from shipcosim.cosim.master.time_grid import time_grid_of
from shipcosim.cosim.slaves.interface_type import interface_type_of
from shipcosim.cosim.slaves.pythonfmu_code import module_clashes
from shipcosim.cosim.slaves.slave import BUFFER_TYPES
from shipcosim.errors import Problem, ShipcosimError, error_at
from shipcosim.options import RunOptions
from shipcosim.scenario import Scenario
from shipcosim.series import make_table
from shipcosim.ssp import Connection, System, Variable

if TYPE_CHECKING:
    import xarray

MOST_STEPS = 100
"""Most steps that an engine makes before it is asked whether the user wants to stop."""


class EngineError(Exception):
    """An engine failed. The text is the engine's message."""


@dataclass(frozen=True)
class ExternalInput:
    """An input that no component feeds.

    Parameters
    ----------
    start : number
        During the initialisation.
    values : (n + 1,) array
        From each step on.
    """

    start: float
    values: np.ndarray


class Job:
    """The task of an engine.

    Parameters
    ----------
    system, scenario, options
        As for `shipcosim.cosim.simulate`; of the options inputs, order and progress.

    Attributes
    ----------
    progress : callable or None
        As in RunOptions.
    plan : Plan
        Rows of the outputs that have to be recorded, steps of the components.
    times : (n + 1,) array
        Of the steps. [s]
    external : dict of End to ExternalInput
        Inputs to set from outside.
    connections : list of Connection
        To make between components.
    changes : list of Change
        To make to what the engine passes on itself: outputs and connected inputs.
    """

    def __init__(self, system: System, scenario: Scenario, options: RunOptions):
        # The other engines exchange all values at the same time, which is Jacobi's order.
        order = options.order or scenario.order
        if order != "jacobi":
            raise ShipcosimError(
                f"Only the engine fmpy knows the order '{order}'; the others have jacobi."
            )
        self.system = system
        self.scenario = scenario
        self._grid = time_grid_of(scenario)
        self.progress = options.progress
        inputs = options.inputs
        self.times = self._grid.times
        self._fed = input_values(inputs, system, self.times) if inputs is not None else {}
        self._known = {"inputs_sha256": digest(inputs)} if inputs is not None else {}
        self.plan = make_plan(system, scenario, self._fed)
        # Connections with the outermost system are not the engine's: their values are set from
        # here.
        self.connections = [
            c for c in system.connections if c.source[0] is not None and c.target[0] is not None
        ]
        # Events act on external inputs (known before the run) or on values that the engine passes
        # on. Only the latter are changes for the engine.
        self._all_changes = list(changes(scenario, self.plan, self._grid))
        self._values = {kind: self._external_values(kind) for kind in self.plan.layouts}
        self.external = dict(self._external_inputs())
        # Two changes of one signal at one step: the last one counts.
        last = {(change.step, change.end): change for change in self._all_changes}
        self.changes = [
            c for c in last.values() if c.end[0] is not None and c.end not in self.external
        ]

    @property
    def n_steps(self) -> int:
        """Number of steps."""
        return len(self.times) - 1

    def starts(self, name: str) -> dict[str, Any]:
        """Start values of a component, those of its external inputs among them."""
        external = {end[1]: signal.start for end, signal in self.external.items() if end[0] == name}
        return dict(self.system.components[name].start) | external

    def intervals(self) -> Iterator[tuple[int, int, dict[End, float]]]:
        """(first step, last, {End: value} that change before it), over the whole run."""
        # Values before and after each step, to find where any input changes.
        values = np.array([signal.values for signal in self.external.values()], dtype=float)
        values = values.reshape(len(self.external), self.n_steps + 1)
        # An interval ends where an input moves, and after MOST_STEPS, so that Ctrl-C is noticed.
        moving = np.flatnonzero((np.diff(values[:, :-1], axis=1) != 0).any(axis=0)) + 1
        starts = sorted({*range(0, self.n_steps, MOST_STEPS), *moving.tolist()})
        before = {end: signal.start for end, signal in self.external.items()}
        # Pass on only the inputs that differ from the interval before.
        for first, last in zip(starts, [*starts[1:], self.n_steps], strict=True):
            now = {end: signal.values[first].item() for end, signal in self.external.items()}
            yield first, last, {end: value for end, value in now.items() if value != before[end]}
            before = now

    def table(
        self, outputs: Mapping[str, Sequence[np.ndarray]], attributes: Mapping[str, object]
    ) -> xarray.Dataset:
        """Table of a run.

        Parameters
        ----------
        outputs : dict of str to list of (m,) array
            By kind: the plan's outputs at the first m steps.
        attributes : dict
            What is known beyond the plan and the scenario.
        """
        # A failed engine may have fewer rows; use those that all columns have.
        rows = min(
            (len(column) for columns in outputs.values() for column in columns),
            default=len(self.times),
        )
        # Engines record every step; the table has a row per output interval.
        every = slice(0, rows, self._grid.steps_per_row)
        recorded = {
            kind: [c[every] for c in self._columns(kind, arrays)]
            for kind, arrays in outputs.items()
        }
        times = self.times[every]
        metadata = (
            attributes_of(self.system, self.scenario)
            | self._known
            | {"start_time": 0.0}
            | dict(attributes)
        )
        remarks = json.loads(str(metadata.get("remarks", "[]")))
        metadata["remarks"] = json.dumps([*remarks, *range_remarks(self.plan, times, recorded)])
        return make_table(times, columns_of(self.plan, len(times), recorded), metadata)

    def _external_values(self, kind):
        """(n + 1, external values) array."""
        # The values over time as events and tables give them, or constant start values.
        over_time = external_values(self.scenario, self.plan, kind, self._grid, self._fed, {})
        if over_time is not None:
            return over_time
        start = np.array(list(self.plan.layouts[kind].external.values()), dtype=BUFFER_TYPES[kind])
        return np.tile(start, (self.n_steps + 1, 1))

    def _external_inputs(self):
        # An external source reaches inputs through connections; apply the connection and then the
        # events on the input itself.
        for kind, layout in self.plan.layouts.items():
            from_other_type = {row for row, _, _ in layout.type_changes}
            for end, connection in zip(layout.inputs, layout.connections, strict=True):
                row = connection.source - len(layout.outputs)
                if row >= 0 and row not in from_other_type and not connection.added:
                    values = connection.transferred(self._values[kind][:, row])
                    yield end, ExternalInput(values[0].item(), self._modified(values, end))

    def _columns(self, kind, outputs):
        """Outputs, external values and inputs that the table shows, in the order of the recorder."""
        layout = self.plan.layouts[kind]
        external, inputs = recorded_rows(self.plan, kind)
        # The order is that of our own recorder, so that the tables have the same columns.
        yield from outputs
        yield from (self._values[kind][:, row] for row in external)
        for i in inputs:
            end = layout.inputs[i]
            connection = layout.connections[i]
            if end in self.external:
                yield self.external[end].values
            else:
                # The engine does not return connected inputs: compute them from the outputs.
                yield self._modified(connection.input_values(outputs), end)

    def _modified(self, values, end):
        """Values of an input with the events on it."""
        modified = values.copy()
        modify(modified, None, [change for change in self._all_changes if change.end == end])
        return modified


class Session(Protocol):
    """A run of a job in an engine. Each method may raise EngineError."""

    @property
    def n_done(self) -> int:
        """Steps done."""
        ...

    def set_input(self, end: End, value: float) -> None:
        """Set an input that no component feeds, from the next step on."""
        ...

    def advance(self, last: int) -> None:
        """Go on to the step of this number."""
        ...

    def outputs(self) -> dict[str, list[np.ndarray]]:
        """By kind the plan's outputs at the start and after each step, (steps done + 1,) arrays. Ends the session."""
        ...


def run_on(
    engine: str,
    open_session: Callable[[Job], AbstractContextManager[Session]],
    job: Job,
    about: Mapping[str, object],
) -> xarray.Dataset:
    """Run a job on an engine.

    Parameters
    ----------
    engine : str
        Its name.
    open_session : callable
        Opens the context manager of a session; may raise EngineError.
    job : Job
        Its task.
    about : dict
        Attributes of the table: the engine's version, remarks on it.

    Returns
    -------
    Dataset

    Raises
    ------
    RunError, Interrupted
        With the rows so far.
    """

    def table(complete):
        metadata = {
            "engine": engine,
            "order": "jacobi",
            "complete": int(complete),
            "remarks": json.dumps([]),
        }
        return job.table(session.outputs(), metadata | dict(about))

    # Ctrl-C is checked between intervals, so the engine is never stopped within a call.
    with delayed_interrupt() as check_interrupt, _opened(engine, open_session, job) as session:
        # On an error the rows so far are kept: they show what led to it.
        try:
            _advance(session, job, check_interrupt)
        except EngineError as error:
            message = f"failed in the step from t = {job.times[session.n_done]:.9g} s. {error}"
            raise RunError(Problem(engine, message), table(complete=False)) from error
        except KeyboardInterrupt:
            raise Interrupted(table(complete=False)) from None
        return table(complete=True)


def _opened(engine, open_session, job):
    try:
        return open_session(job)
    except EngineError as error:
        raise error_at(engine, f"refuses the system. {error}") from error


def _advance(session, job, check_interrupt):
    tell = now_and_then(job.progress)
    for first, last, inputs in job.intervals():
        check_interrupt()
        for end, value in inputs.items():
            # Inputs first: they hold from the step that starts now.
            session.set_input(end, value)
        tell(first, job.n_steps)
        session.advance(last)
    tell(job.n_steps, job.n_steps)


def unsupported(
    engine: str,
    job: Job,
    complaint_of: Callable[[Connection], str | None],
    others: Iterable[Problem] = (),
) -> list[Problem]:
    """Problems of an engine with a job, which it would otherwise ignore or crash on.

    Parameters
    ----------
    engine : str
        Its name.
    job : Job
        The job to check.
    complaint_of : callable
        Problem of a connection between variables of one type, for this engine.
    others : iterable of Problem
        Problems other than those of connections.
    """
    problems = [*others, *module_clashes(job.system)]
    # Types and interfaces that the engine does not have, by component.
    for component in job.system.components.values():
        if interface_type_of(component) == "ModelExchange":
            message = f"runs as model exchange, which {engine} does not do."
            problems.append(Problem(component.name, message, "The engine fmpy does."))
        if wide := [v.name for v in component.variables.values() if v.type in WIDE]:
            message = (
                f"has Integers of more than 32 bits, which {engine} has not: {', '.join(wide[:5])}."
            )
            problems.append(Problem(component.name, message))
        if items := [v.name for v in component.variables.values() if v.kind == "Enumeration"]:
            problems.append(
                Problem(
                    component.name,
                    f"has enumerations, which {engine} has not: {', '.join(items[:5])}.",
                )
            )
    # Connections: problems common to all other engines first, then the engine's own.
    for connection in job.connections:
        if message := _unsupported_connection(job, connection) or complaint_of(connection):
            message = f"{engine} cannot make this connection: {message}."
            problems.append(Problem(connection.arrow, message, "The engine fmpy can."))
    return problems


def _unsupported_connection(job, connection):
    kinds = [job.plan.variable(end).kind for end in (connection.source, connection.target)]
    if connection.initial:
        return "it sets a parameter"
    if connection.mapping is not None:
        return "it maps values"
    if kinds[0] != kinds[1]:
        return f"it goes from {kinds[0]} to {kinds[1]}"
    if kinds[0] != "Real" and connection.is_linear:
        return f"it transforms values of type {kinds[0]}"
    return None


def sums(connections: list[Connection]) -> list[Connection]:
    """Connections whose values are added to others in an input."""
    count = Counter(connection.target for connection in connections)
    return [connection for connection in connections if count[connection.target] > 1]


def indices(job: Job, name: str, kind: str) -> tuple[list[int], list[Variable]]:
    """Rows among the outputs of a kind that a component has, and their variables."""
    rows = [row for row, end in enumerate(job.plan.layouts[kind].outputs) if end[0] == name]
    return rows, [job.plan.variable(job.plan.layouts[kind].outputs[row]) for row in rows]


def held(values: np.ndarray, steps: np.ndarray, n_rows: int) -> np.ndarray:
    """Values at each step; a value known only at some steps holds until the next one."""
    # A component with a longer step has fewer values. Take the last at or before each step.
    if len(values) == n_rows:
        return values
    return values[np.searchsorted(steps, np.arange(n_rows), side="right") - 1]
