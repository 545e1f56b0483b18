"""Our engine: FMUs instantiated through FMPy, run by the master, their values in one table."""

import json
from contextlib import ExitStack
from math import lcm

import numpy as np

from shipcosim.cosim.carry import Handover, Text
from shipcosim.cosim.events import actions_of, settings_over_time
from shipcosim.cosim.exchange import Exchange
from shipcosim.cosim.feed import feed
from shipcosim.cosim.interrupt import held_back
from shipcosim.cosim.master import Failure, Master, step_times
from shipcosim.cosim.order import ORDERS, stepping_order
from shipcosim.cosim.part import Part, set_start_values
from shipcosim.cosim.plan import KINDS, make_plan
from shipcosim.cosim.recorder import Recorder
from shipcosim.cosim.result import recorded_rows, table_of
from shipcosim.cosim.slave import BUFFER_TYPES, Slave2, Slave3, SlaveError
from shipcosim.cosim.unpacked import Unpacked
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.scenario import whole_steps


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


def run(system, scenario, inputs=None, progress=None, order="jacobi"):
    """Run a checked system. See `shipcosim.cosim.simulate`."""
    if order not in ORDERS:
        raise ShipcosimError(f"There is no order of exchange '{order}'. {suggestion(order, ORDERS)}")
    times = step_times(scenario.step_size, 0, whole_steps(scenario.stop_time, scenario.step_size))
    fed = feed(inputs, system, times) if inputs is not None else {}
    plan = make_plan(system, scenario, fed)
    exchanges, trajectories = _exchanges(plan, scenario, len(times) - 1, fed)
    rows = _Rows(plan, scenario, times, exchanges, {"engine": "fmpy", "order": order})
    with ExitStack() as stack:
        check_interrupt = stack.enter_context(held_back())
        try:
            parts = _parts(plan, exchanges, stack, check_interrupt)
            rows.parts = list(parts.values())
            master = Master(
                [parts[name] for name in stepping_order(plan, order)],
                exchanges,
                _texts(plan, parts),
                _handovers(plan, parts),
                {kind: plan.layouts[kind].names for kind in exchanges},
                check_interrupt,
                sequential=order == "gauss-seidel",
            )
            master.initialise(scenario.stop_time)
            actions = actions_of(scenario, plan, exchanges)
            master.run(times, actions, trajectories, rows.record, rows.every, progress)
        except Failure as failure:
            raise RunError(failure.problem, rows.table(complete=False)) from failure
        except KeyboardInterrupt:
            raise Interrupted(rows.table(complete=False)) from None
        for part in parts.values():
            part.slave.terminate()
    return rows.table(complete=True)


class _Rows:
    """The rows of a run, and the table they make."""

    def __init__(self, plan, scenario, times, exchanges, attributes):
        self.plan, self.scenario, self.attributes, self.parts = plan, scenario, attributes, []
        self.every = whole_steps(scenario.output_interval or scenario.step_size, scenario.step_size)
        self.times, self.n = times[:: self.every], 0
        self.recorders = {
            kind: Recorder(exchange, len(self.times), *recorded_rows(plan, kind))
            for kind, exchange in exchanges.items()
        }

    def record(self, row):
        """Keep the present values."""
        for recorder in self.recorders.values():
            recorder.record(row)
        self.n = row + 1

    def table(self, complete):
        """Table of the rows so far. Its attribute `complete` is 1 or 0, since NetCDF knows no truth values."""
        columns = {kind: recorder.columns(self.n) for kind, recorder in self.recorders.items()}
        remarks = list(dict.fromkeys(text for part in self.parts for text in part.slave.remarks()))
        known = self.attributes | {"complete": int(complete), "remarks": json.dumps(remarks)}
        return table_of(self.plan, self.scenario, self.times[: self.n], columns, known)


def _exchanges(plan, scenario, n_steps, fed):
    """Exchange of each kind that occurs, and what the settings among them do over time."""
    exchanges, trajectories = {}, []
    for kind, dtype in BUFFER_TYPES.items():  # Real is last: its settings may follow the others
        layout = plan.layouts[kind]
        if not (layout.outputs or layout.inputs):
            continue
        settings = np.array(list(layout.settings.values()), dtype=dtype)
        crossings = [(setting, exchanges[source], row) for setting, source, row in layout.crossings]
        exchange = exchanges[kind] = Exchange(len(layout.outputs), settings, layout.wires, crossings)
        values = settings_over_time(scenario, plan, kind, n_steps, fed)
        if values is not None:
            exchange.settings[:] = values[0]
            trajectories.append((exchange.settings, values))
    return exchanges, trajectories


def _parts(plan, exchanges, stack, check_interrupt):
    """The components, instantiated, their start values set; the stack frees them."""
    unpacked, parts = stack.enter_context(Unpacked()), {}
    for component in plan.system.components.values():
        check_interrupt()
        fmu, name = component.fmu, component.name
        kind = Slave3 if fmu.fmi_version.startswith("3") else Slave2
        try:
            slave = kind(name, unpacked.folder(fmu.path), fmu.model_identifier, fmu.token)
            stack.callback(slave.free)
            set_start_values(slave, [(fmu.variables[variable], value) for variable, value in component.start.items()])
        except SlaveError as error:
            raise Failure(Problem(name, f"{fmu.path.name} cannot be started. {error}")) from error
        part = parts[name] = Part(name, slave, plan.multiples[name])
        for kind, exchange in exchanges.items():
            part.bind(kind, exchange, *plan.rows(kind, name))
    return parts


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
            ends.append((parts[end[0]].slave, variable, KINDS[variable.kind]))
        handovers.append(Handover(*ends, connection.factor, connection.offset, connection.mapping))
    return handovers
