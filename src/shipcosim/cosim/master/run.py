"""Our engine: FMUs instantiated through FMPy, run by the master, their values in one table."""

from __future__ import annotations

import json
from math import lcm
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.cosim.master.algorithm import Failure, Master
from shipcosim.cosim.master.component import Part, set_start_values
from shipcosim.cosim.master.events import actions_of, settings_over_time
from shipcosim.cosim.master.inputs import digest, feed
from shipcosim.cosim.master.interrupt import held_back
from shipcosim.cosim.master.order import ORDERS, stepping_order
from shipcosim.cosim.master.plan import make_plan
from shipcosim.cosim.master.recorder import Recorder
from shipcosim.cosim.master.restore import check_fit, check_storable, put_back, take
from shipcosim.cosim.master.result import attributes_of, columns_of, recorded_rows
from shipcosim.cosim.master.signals import Exchange
from shipcosim.cosim.master.snapshot import Snapshot, opened, writer
from shipcosim.cosim.master.string_connections import Handover, Text
from shipcosim.cosim.master.time_grid import Span, span_of
from shipcosim.cosim.processes.parent import Isolated
from shipcosim.cosim.slaves.instances import Instances
from shipcosim.cosim.slaves.interface_type import interface_type_of
from shipcosim.cosim.slaves.slave import BUFFER_TYPES, SlaveError
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.options import RunOptions
from shipcosim.scenario import Scenario
from shipcosim.series import make_table
from shipcosim.ssp import System

if TYPE_CHECKING:
    import xarray


class RunError(ShipcosimError):
    """A run failed; `table` holds the rows before that, and is marked as incomplete."""

    def __init__(self, problems, table):
        super().__init__(problems)
        self.table = table


class Interrupted(KeyboardInterrupt):
    """A run was interrupted; `table` holds the rows before that, and is marked as incomplete."""

    def __init__(self, table):
        super().__init__("the run was interrupted")
        self.table = table


def run(system: System, scenario: Scenario, options: RunOptions) -> xarray.Dataset:
    """Run a checked system with our own master. See `shipcosim.cosim.simulate`."""
    resume, store = opened(options.resume), writer(options.store)
    if resume is not None:
        check_fit(resume, system, scenario)
    if store is not None:
        check_storable(system)
    start_time, first = (resume.start_time, resume.step) if resume else (options.start_time, 0)
    journey = Journey(system, scenario, span_of(scenario, start_time, first, options.until), options, resume)
    instances = Isolated(system, options.timeout) if options.isolate else Instances()
    with held_back() as check_interrupt, instances:
        journey.run(instances, check_interrupt, options.progress)
        if store is not None:
            store(journey.snapshot())
        journey.end()
    return journey.table(complete=True)


class Journey:
    """One run of a checked system, planned before anything is instantiated.

    Parameters
    ----------
    system : System
        With the scenario's start values.
    scenario : Scenario
        Checked against the system.
    span : Span
        The steps that are done.
    options : RunOptions
        Order of the exchange, and the table that feeds inputs of the system.
    resume : Snapshot, optional
        Where the run continues from; checked.

    Raises
    ------
    ShipcosimError
        If this cannot be run.
    """

    def __init__(
        self, system: System, scenario: Scenario, span: Span, options: RunOptions, resume: Snapshot | None = None
    ):
        order, inputs = options.order, options.inputs
        if order not in ORDERS:
            raise ShipcosimError(f"There is no order of exchange '{order}'. {suggestion(order, ORDERS)}")
        self._scenario, self._span, self._order, self._inputs, self._resume = scenario, span, order, inputs, resume
        fed = feed(inputs, system, span.run_times) if inputs is not None else {}
        self._in_force = resume.changes if resume else {}
        self._plan = make_plan(system, scenario, fed, self._in_force, span.start_time)
        self._exchanges, self._trajectories = _exchanges(self._plan, scenario, span, fed, self._in_force)
        self._parts, self._texts, self._n_rows = {}, [], 0
        self._recorders = {
            kind: Recorder(exchange, len(span.row_times), *recorded_rows(self._plan, kind))
            for kind, exchange in self._exchanges.items()
        }

    def run(self, instances, check_interrupt, progress=None):
        """Go to the end of the span.

        Parameters
        ----------
        instances : Instances
            Where the FMUs come from.
        check_interrupt : callable
            Raises KeyboardInterrupt where the user wants to stop.
        progress : callable, optional
            As for `simulate`.

        Raises
        ------
        RunError, Interrupted
            With the table so far.
        """
        span = self._span
        try:
            self._parts = _parts(self._plan, self._exchanges, instances, check_interrupt, self._scenario.step_size)
            self._texts = _texts(self._plan, self._parts)
            master = self._master(check_interrupt)
            master.initialise(span.start_time, span.stop_time)
            if self._resume is not None:
                put_back(self._resume, self._plan, self._exchanges, self._texts, self._parts)
                master.resume(span.first)
            actions = actions_of(self._scenario, self._plan, self._exchanges, span)
            master.run(span, actions, self._trajectories, self._record, progress)
        except Failure as failure:
            raise RunError(failure.problem, self.table(complete=False)) from failure
        except KeyboardInterrupt:
            raise Interrupted(self.table(complete=False)) from None

    def snapshot(self):
        """State of the whole system at the end of the span. Raises RunError if an FMU does not give its state."""
        try:
            return take(self._plan, self._exchanges, self._parts, self._span, self._scenario, self._in_force)
        except Failure as failure:
            raise RunError(failure.problem, self.table(complete=True)) from failure

    def end(self):
        """End the simulation in all FMUs."""
        for part in self._parts.values():
            part.slave.terminate()

    @property
    def row_times(self):
        """Times of the rows so far. [s]"""
        return self._span.row_times[: self._n_rows]

    def columns(self):
        """Columns of the table of the rows so far: (name, values, unit, long name)."""
        recorded = {kind: recorder.columns(self._n_rows) for kind, recorder in self._recorders.items()}
        return columns_of(self._plan, self._n_rows, recorded)

    def attributes(self, complete):
        """What is known about the run. `complete` is 1 or 0, since NetCDF knows no truth values."""
        known = attributes_of(self._plan.system, self._scenario)
        known |= {"start_time": self._span.start_time, "engine": "fmpy", "order": self._order}
        if self._inputs is not None:
            known["inputs_sha256"] = digest(self._inputs)
        if self._span.run_times[-1] < self._span.times[-1]:
            known["until"] = float(self._span.run_times[-1])
        if self._resume is not None:
            known["continued_from"] = self._resume.time
        remarks = list(dict.fromkeys(text for part in self._parts.values() for text in part.slave.remarks()))
        return known | {"complete": int(complete), "remarks": json.dumps(remarks)}

    def table(self, complete):
        """Table of the rows so far."""
        return make_table(self.row_times, self.columns(), self.attributes(complete))

    def _record(self):
        for recorder in self._recorders.values():
            recorder.record(self._n_rows)
        self._n_rows += 1

    def _master(self, check_interrupt):
        return Master(
            [self._parts[name] for name in stepping_order(self._plan, self._order)],
            self._exchanges,
            self._texts,
            _handovers(self._plan, self._parts),
            {kind: self._plan.layouts[kind].names for kind in self._exchanges},
            check_interrupt,
            sequential=self._order == "gauss-seidel",
        )


def _exchanges(plan, scenario, span, fed, in_force):
    """Exchange of each kind that occurs, and what the settings among them do over time."""
    exchanges, trajectories = {}, []
    for kind, dtype in BUFFER_TYPES.items():  # Real is last: its settings may follow the others
        layout = plan.layouts[kind]
        if not (layout.outputs or layout.inputs):
            continue
        settings = np.array(list(layout.settings.values()), dtype=dtype)
        crossings = [(setting, exchanges[source], row) for setting, source, row in layout.crossings]
        exchange = exchanges[kind] = Exchange(len(layout.outputs), settings, layout.wires, crossings)
        values = settings_over_time(scenario, plan, kind, span, fed, in_force)
        if values is not None:
            exchange.settings[:] = values[0]
            trajectories.append((exchange.settings, values))
    return exchanges, trajectories


def _parts(plan, exchanges, instances, check_interrupt, base):
    """The components, instantiated, their start values set."""
    parts = {}
    for component in plan.system.components.values():
        check_interrupt()
        fmu, name = component.fmu, component.name
        try:
            slave = instances.instance_of(component)
            set_start_values(slave, [(fmu.variables[variable], value) for variable, value in component.start.items()])
        except SlaveError as error:
            raise Failure(Problem(name, f"{fmu.path.name} cannot be started. {error}")) from error
        part = parts[name] = Part(
            name, slave, plan.multiples[name], _fixed_step(component, base * plan.multiples[name])
        )
        for kind, exchange in exchanges.items():
            part.bind(kind, exchange, *plan.rows(kind, name))
    return parts


def _fixed_step(component, step):
    """The step, for an FMU that can take no other one."""
    is_free = component.fmu.capability("canHandleVariableCommunicationStepSize")
    return None if is_free or interface_type_of(component) == "ModelExchange" else step


def _texts(plan, parts):
    texts = []
    for connection in plan.texts:
        source, target = parts[connection.source[0]], parts[connection.target[0]]
        ends = source.slave, plan.variable(connection.source), target.slave, plan.variable(connection.target)
        texts.append(Text(*ends, connection.mapping, lcm(source.multiple, target.multiple)))
    return texts


def _handovers(plan, parts):
    handovers = []
    for connection in plan.handovers:
        ends = []
        for end in (connection.source, connection.target):
            variable = plan.variable(end)
            ends.append((parts[end[0]].slave, variable, plan.kind(variable)))
        handovers.append(Handover(*ends, connection.factor, connection.offset, connection.mapping))
    return handovers
