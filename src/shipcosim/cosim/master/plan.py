"""The plan of a run: which values go where, in rows of a few arrays."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from math import lcm

from shipcosim.cosim.master.signals import InputConnection
from shipcosim.cosim.slaves.interface_type import interface_type_of, missing_interface_type
from shipcosim.cosim.slaves.slave import BUFFER_TYPES
from shipcosim.errors import Problem, raise_errors
from shipcosim.scenario import Scenario
from shipcosim.ssp import Connection, System, Variable
from shipcosim.ssp.flatten.array_sizes import RESIZE, resized
from shipcosim.ssp.read.structure import End, label
from shipcosim.units import whole_steps

KINDS = {"Integer": "Integer", "Enumeration": "Integer", "Boolean": "Boolean", "Real": "Real"}
"""Kind of the arrays that hold values of a type."""

WIDE = ("UInt32", "Int64", "UInt64")
"""Types of FMI 3.0 for which the Integers of a system are held in 64 bits."""


@dataclass
class Layout:
    """Rows of one kind.

    Parameters
    ----------
    outputs : list of End
        Outputs of all components, component by component.
    external : dict of End to start value
        Values from outside: inputs of the system, inputs without connection that events change, and sources of
        another kind.
    inputs : list of End
        Inputs that are set in every step, component by component.
    connections : list of InputConnection
        What feeds each of the inputs.
    type_changes : list of (row of external, kind, source)
        External values that follow a row of another kind.
    """

    outputs: list[End] = field(default_factory=list)
    external: dict[End, object] = field(default_factory=dict)
    inputs: list[End] = field(default_factory=list)
    connections: list[InputConnection] = field(default_factory=list)
    type_changes: list[tuple[int, str, int]] = field(default_factory=list)

    @property
    def names(self) -> tuple[list[str], list[str]]:
        """Names of the sources and of the inputs, for messages."""
        return [label(end) for end in (*self.outputs, *self.external)], [
            label(end) for end in self.inputs
        ]

    @property
    def transferred_names(self) -> list[str]:
        """Names of all values that connections bring: the inputs, then the terms of their sums."""
        sums = [
            (label(end), len(c.terms)) for end, c in zip(self.inputs, self.connections, strict=True)
        ]
        return [label(end) for end in self.inputs] + [
            f"{name}[{i}]" for name, n in sums for i in range(n)
        ]


@dataclass(frozen=True)
class Plan:
    """The plan of a run.

    Parameters
    ----------
    system : System
        With the scenario's start values.
    multiples : dict of str to int
        Step of each component, in base steps.
    layouts : dict of str to Layout
        By kind.
    string_connections, parameter_connections : list of Connection
        Between String or Binary variables; from component to component into a parameter, once at the start.
    connected, modified : set of End
        Inputs that a connection feeds; what events change.
    kinds : mapping of str to str
        KINDS, as this system needs them.
    """

    system: System
    multiples: dict[str, int]
    layouts: dict[str, Layout]
    string_connections: list[Connection]
    parameter_connections: list[Connection]
    connected: set[End]
    modified: set[End]
    kinds: Mapping[str, str]

    def variable(self, end: End) -> Variable:
        """The FMU's variable."""
        component, name = end
        assert component is not None  # variables are those of components
        return self.system.components[component].variables[name]

    def kind(self, variable: Variable) -> str | None:
        """Kind of the arrays that hold a variable's values, or None."""
        return self.kinds.get(variable.kind)

    def kind_of(self, end: End) -> str:
        """Kind of the arrays that hold the values of a component's variable."""
        return self.kinds[self.variable(end).kind]

    def rows(self, kind: str, name: str) -> tuple["Rows", "Rows"]:
        """Rows of a component's outputs and of its inputs."""
        layout = self.layouts[kind]
        return self._rows(layout.outputs, name), self._rows(layout.inputs, name)

    def _rows(self, ends, name):
        rows = [row for row, end in enumerate(ends) if end[0] == name]
        return (rows[0] if rows else 0), [self.variable(ends[row]) for row in rows]


Rows = tuple[int, list[Variable]]
"""First row of a component among those of one kind, and its variables from there on."""


def make_plan(
    system: System,
    scenario: Scenario,
    from_table: Collection[str] = (),
    modified: Collection[str] = (),
    start_time: float = 0.0,
) -> Plan:
    """Plan of a run.

    Parameters
    ----------
    system : System
        With the scenario's start values.
    scenario : Scenario
        Checked against the system.
    from_table : collection of str
        Inputs of the system that a table feeds.
    modified : collection of str
        Signals that are overridden or biased from the beginning.
    start_time : float
        Of the run. [s]

    Raises
    ------
    ShipcosimError
        If the master cannot run this: no interface type that it can run, steps that do not fit.
    """
    # First the problems of all components and connections, reported together.
    base = scenario.step_size
    duration = scenario.stop_time - start_time
    problems = [
        p for c in system.components.values() for p in _component_problems(c, base, duration)
    ]
    raise_errors(problems + list(_connection_problems(system)))
    # Variables that events change need a row of their own, even if nothing feeds them.
    ends = {system.split(signal) for event in scenario.events for _, signal, _ in event.changes}
    ends |= {system.split(signal) for signal in modified}
    multiples = {
        name: whole_steps(c.step_size or base, base) or 1 for name, c in system.components.items()
    }
    layouts = {kind: Layout() for kind in BUFFER_TYPES}
    plan = Plan(system, multiples, layouts, [], [], set(), ends, _kinds(system))
    _lay_out(plan, _sorted_connections(plan, from_table))
    return plan


def _sorted_connections(plan, from_table):
    """Sort connections by the input that they feed; parameters and strings go into lists."""
    by_input = {}
    for connection in plan.system.connections:
        # An output of the system gets no value here, and a source without value feeds nothing.
        if connection.target[0] is None or not _has_values(connection.source, plan, from_table):
            continue
        plan.connected.add(connection.target)
        # Nobody asks for another value than the FMU's own, and some FMUs refuse to be set.
        ends = {connection.source, connection.target}
        is_fed = connection.source[1] in from_table or not plan.modified.isdisjoint(ends)
        if not is_fed and passes_own_start(connection, plan.system):
            kind = plan.kind(plan.variable(connection.target))
            if kind is not None:  # the table shows the input of the system
                start = plan.system.inputs[connection.source[1]].start
                plan.layouts[kind].external.setdefault(connection.source, start)
            continue
        if connection.initial:
            plan.parameter_connections.append(connection)
        elif plan.variable(connection.target).kind in ("String", "Binary"):
            plan.string_connections.append(connection)
        else:
            by_input.setdefault(connection.target, []).append(connection)
    return by_input


def _kinds(system):
    # One FMU with wide integers widens the integers of the whole system: an exchange has one type.
    types = {variable.type for component, variable in system.all_variables()}
    return KINDS | ({"Integer": "Long", "Enumeration": "Long"} if types.intersection(WIDE) else {})


def _component_problems(component, base, duration):
    step = component.step_size
    if interface_type_of(component) is None:
        yield Problem(component.name, *missing_interface_type(component))
    if step is not None and not whole_steps(step, base):
        yield Problem(
            component.name, f"its step of {step:g} s is no multiple of the step size {base:g} s."
        )
    elif step is not None and whole_steps(duration, step) is None:
        yield Problem(
            component.name, f"its step of {step:g} s does not divide the run's {duration:g} s."
        )
    arrays = [variable.name for variable in component.variables.values() if variable.dimensions]
    if arrays:
        yield Problem(
            component.name, f"has arrays that are not taken apart: {', '.join(arrays[:5])}."
        )
    for variable in component.variables.values():
        if (
            variable.type == "UInt64"
            and (start := component.start_value(variable.name) or 0) >= 2**63
        ):
            yield Problem(
                component.name,
                f"{variable.name} starts with {start}.",
                "Values of 64 bits end at 2**63 - 1.",
            )
    for problem in resized(component):
        yield Problem(component.name, problem, RESIZE)


def _connection_problems(system):
    for connection in system.connections:
        name = connection.target[0]
        if (
            name is not None
            and system.components[name].variables[connection.target[1]].kind == "Clock"
        ):
            message = (
                "is a Clock. FMUs are stepped without event mode, in which clocks do not tick."
            )
            yield Problem(label(connection.target), message, "Leave the clock unconnected.")
        if (
            connection.initial
            and name is not None
            and system.components[name].fmu.fmi_version == "1.0"
        ):
            message = "its value comes from a connection, but FMI 1.0 has no initialisation mode to set it in."
            yield Problem(label(connection.target), message, "Set it as a start value.")


def passes_own_start(connection: Connection, system: System) -> bool:
    """True if an input of the system gives an FMU's input the value that this starts with anyway."""
    name = connection.source[1]
    if connection.source[0] is not None or name not in system.inputs or connection.mapping:
        return False
    start = system.inputs[name].start
    component, variable = connection.target
    if component is None or start is None:
        return False
    part = system.components[component]
    return (
        variable not in part.start
        and not connection.is_linear
        and part.start_value(variable) == start
    )


def _has_values(source, plan, from_table):
    """True if a source has values; inputs of the system may have no start value, table or event."""
    component, name = source
    if component is not None:
        return True
    signal = plan.system.inputs.get(
        name
    )  # what a parameter of the system passes on are start values already
    if signal is None or signal.type == "String":
        return False
    return signal.start is not None or name in from_table or source in plan.modified


def _lay_out(plan, by_input):
    """Give each value a row: outputs first, since inputs refer to their rows."""
    # Any variable can be a source, for example a parameter that feeds another component.
    sources = {connection.source for connections in by_input.values() for connection in connections}
    for component, variable in plan.system.all_variables():
        end = (component.name, variable.name)
        kind = plan.kind(variable)
        if kind is not None and (variable.causality == "output" or end in sources):
            plan.layouts[kind].outputs.append(end)
    # Inputs have a row if something feeds or changes them; others keep their start value in the
    # FMU.
    for component, variable in plan.system.all_variables():
        end = component.name, variable.name
        if end in by_input or (end in plan.modified and variable.causality != "output"):
            layout = plan.layouts[plan.kind(variable)]
            layout.inputs.append(end)
            # The first connection carries the others as terms of a sum.
            first, *more = [
                _input_connection(plan, layout, end, c) for c in by_input.get(end, [None])
            ]
            layout.connections.append(replace(first, added=tuple(more)))


def _input_connection(plan, layout, end, connection):
    """The connection of an input; without one, an external value of its own."""
    # An input that only events change is fed by a constant: its start value.
    multiple = plan.multiples[end[0]]
    if connection is None:
        start = plan.system.components[end[0]].start_value(end[1])
        return InputConnection(_external_row(layout, end, start or 0), period=multiple)
    # Values from outside come at every step of the component.
    how = connection.factor, connection.offset, connection.mapping
    component, name = connection.source
    if component is None:
        start = plan.system.inputs[name].start or 0
        return InputConnection(_external_row(layout, connection.source, start), *how, multiple)
    # Two components with different steps exchange where both steps end.
    period = lcm(multiple, plan.multiples[component])
    kind = plan.kind_of(connection.source)
    row = plan.layouts[kind].outputs.index(connection.source)
    # A source of another type comes as an external value that is copied from the other exchange.
    if plan.layouts[kind] is layout:
        return InputConnection(row, *how, period)
    external = _external_row(layout, connection.source, 0)
    layout.type_changes.append((external - len(layout.outputs), kind, row))
    return InputConnection(external, *how, period)


def _external_row(layout, end, start):
    """Row of an external value among the sources; made if it does not exist."""
    layout.external.setdefault(end, start)
    return len(layout.outputs) + list(layout.external).index(end)
