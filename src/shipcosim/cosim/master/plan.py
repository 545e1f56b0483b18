"""Before anything is instantiated: which values travel where, in rows of a few arrays, and what happens when."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import lcm

from shipcosim.cosim.master.signals import Wire
from shipcosim.cosim.slaves.interface_type import interface_type_of, missing_interface_type
from shipcosim.cosim.slaves.slave import BUFFER_TYPES
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.scenario import Scenario, whole_steps
from shipcosim.ssp import Connection, System, Variable
from shipcosim.ssp.flatten.array_sizes import RESIZE, resized

KINDS = {"Integer": "Integer", "Enumeration": "Integer", "Boolean": "Boolean", "Real": "Real"}
"""Arrays that values of a type travel in."""

WIDE = ("UInt32", "Int64", "UInt64")
"""Types of FMI 3.0 for which the Integers of a system travel in 64 bits."""

End = tuple[str | None, str]
"""Component (None: the outermost system) and variable."""


@dataclass
class Layout:
    """Rows of one kind.

    Parameters
    ----------
    outputs : list of End
        Outputs of all components, component by component.
    settings : dict of End to start value
        Values from outside: inputs of the system, inputs that hang on no connection but change, and sources of
        another kind.
    inputs : list of End
        Inputs that are set in every step, component by component.
    wires : list of Wire
        What feeds each of the inputs.
    crossings : list of (setting, kind, source)
        Settings that follow a row of another kind.
    """

    outputs: list[End] = field(default_factory=list)
    settings: dict[End, object] = field(default_factory=dict)
    inputs: list[End] = field(default_factory=list)
    wires: list[Wire] = field(default_factory=list)
    crossings: list[tuple[int, str, int]] = field(default_factory=list)

    @property
    def names(self):
        """Names of the sources and of the inputs, for messages."""
        return [label(end) for end in (*self.outputs, *self.settings)], [label(end) for end in self.inputs]

    @property
    def carried(self):
        """Names of all that connections carry: the inputs and, behind them, the terms of those that are sums."""
        sums = [(label(end), len(wire.terms)) for end, wire in zip(self.inputs, self.wires, strict=True)]
        return [label(end) for end in self.inputs] + [f"{name}[{i}]" for name, n in sums for i in range(n)]


@dataclass(frozen=True)
class Plan:
    """What a run will do.

    Parameters
    ----------
    system : System
        With the scenario's start values.
    multiples : dict of str to int
        Step of each component, in base steps.
    layouts : dict of str to Layout
        By kind.
    texts, handovers : list of Connection
        Between String or Binary variables; from component to component into a parameter, once at the start.
    fed, touched : set of End
        Inputs that a connection feeds; what events change.
    kinds : mapping of str to str
        KINDS, as this system needs them.
    """

    system: System
    multiples: dict[str, int]
    layouts: dict[str, Layout]
    texts: list[Connection]
    handovers: list[Connection]
    fed: set[End]
    touched: set[End]
    kinds: Mapping

    def variable(self, end: End) -> Variable:
        """The FMU's variable."""
        return self.system.components[end[0]].fmu.variables[end[1]]

    def kind(self, variable: Variable) -> str | None:
        """Kind of the arrays that a variable's values travel in, or None where they travel in none."""
        return self.kinds.get(variable.kind)

    def rows(self, kind: str, name: str) -> tuple[tuple, tuple]:
        """First row and variables of a component's outputs and inputs."""
        return tuple(self._block(ends, name) for ends in (self.layouts[kind].outputs, self.layouts[kind].inputs))

    def _block(self, ends, name):
        rows = [row for row, end in enumerate(ends) if end[0] == name]
        return (rows[0] if rows else 0), [self.variable(ends[row]) for row in rows]


def label(end: End) -> str:
    """Name of a signal as users write it."""
    return end[1] if end[0] is None else f"{end[0]}.{end[1]}"


def make_plan(system: System, scenario: Scenario, fed=(), changed=(), start_time: float = 0.0) -> Plan:
    """Plan of a run.

    Parameters
    ----------
    system : System
        With the scenario's start values.
    scenario : Scenario
        Checked against the system.
    fed : collection of str
        Inputs of the system that a table feeds.
    changed : collection of str
        Signals that are overridden or biased from the beginning.
    start_time : float
        Of the run. [s]

    Raises
    ------
    ShipcosimError
        If the master cannot run this: no form that it can, steps that do not fit.
    """
    base, duration = scenario.step_size, scenario.stop_time - start_time
    problems = [p for c in system.components.values() for p in _component_problems(c, base, duration)]
    if problems := problems + list(_connection_problems(system)):
        raise ShipcosimError(problems)
    touched = {system.split(signal) for event in scenario.events for _, signal, _ in event.changes}
    touched |= {system.split(signal) for signal in changed}
    multiples = {name: whole_steps(c.step_size or base, base) for name, c in system.components.items()}
    layouts = {kind: Layout() for kind in BUFFER_TYPES}
    plan = Plan(system, multiples, layouts, [], [], set(), touched, _kinds(system))
    into = {}
    for connection in system.connections:
        if connection.target[0] is None or not _is_fed(connection.source, plan, fed):
            continue
        plan.fed.add(connection.target)
        if connection.initial:
            plan.handovers.append(connection)
        elif plan.variable(connection.target).kind in ("String", "Binary"):
            plan.texts.append(connection)
        else:
            into.setdefault(connection.target, []).append(connection)
    _lay_out(plan, into)
    return plan


def _kinds(system):
    types = {variable.type for component in system.components.values() for variable in component.fmu.variables.values()}
    return KINDS | ({"Integer": "Long", "Enumeration": "Long"} if types.intersection(WIDE) else {})


def _component_problems(component, base, duration):
    step = component.step_size
    if interface_type_of(component) is None:
        yield Problem(component.name, *missing_interface_type(component))
    if step is not None and not whole_steps(step, base):
        yield Problem(component.name, f"its step of {step:g} s is no multiple of the step size {base:g} s.")
    elif step is not None and whole_steps(duration, step) is None:
        yield Problem(component.name, f"its step of {step:g} s does not divide the run's {duration:g} s.")
    arrays = [variable.name for variable in component.fmu.variables.values() if variable.dimensions]
    if arrays:
        yield Problem(component.name, f"has arrays that are not taken apart: {', '.join(arrays[:5])}.")
    for variable in component.fmu.variables.values():
        if variable.type == "UInt64" and (start := component.start_value(variable.name) or 0) >= 2**63:
            yield Problem(
                component.name, f"{variable.name} starts with {start}.", "Values of 64 bits end at 2**63 - 1."
            )
    for found in resized(component):
        yield Problem(component.name, found, RESIZE)


def _connection_problems(system):
    for connection in system.connections:
        name = connection.target[0]
        if name is not None and system.components[name].fmu.variables[connection.target[1]].kind == "Clock":
            found = "is a Clock. FMUs are stepped without event mode, in which clocks do not tick."
            yield Problem(label(connection.target), found, "Leave the clock unconnected.")
        if connection.initial and name is not None and system.components[name].fmu.fmi_version == "1.0":
            found = "its value comes from a connection, but FMI 1.0 has no initialisation mode to set it in."
            yield Problem(label(connection.target), found, "Set it as a start value.")


def _is_fed(source, plan, fed):
    """Whether something comes from a source: inputs of the system may have neither start value nor table nor event."""
    component, name = source
    if component is not None:
        return True
    signal = plan.system.inputs.get(name)  # what a parameter of the system passes on are start values already
    if signal is None or signal.type == "String":
        return False
    return signal.start is not None or name in fed or source in plan.touched


def _lay_out(plan, into):
    sources = {connection.source for connections in into.values() for connection in connections}
    for component in plan.system.components.values():
        for variable in component.fmu.variables.values():
            end, kind = (component.name, variable.name), plan.kind(variable)
            if kind is not None and (variable.causality == "output" or end in sources):
                plan.layouts[kind].outputs.append(end)
    for component in plan.system.components.values():
        for variable in component.fmu.variables.values():
            end = component.name, variable.name
            if end in into or (end in plan.touched and variable.causality != "output"):
                layout = plan.layouts[plan.kind(variable)]
                layout.inputs.append(end)
                first, *more = [_wire(plan, layout, end, connection) for connection in into.get(end, [None])]
                layout.wires.append(replace(first, added=tuple(more)))


def _wire(plan, layout, end, connection):
    """What feeds an input: a connection, or where there is none a setting of its own."""
    own = plan.multiples[end[0]]
    if connection is None:
        start = plan.system.components[end[0]].start_value(end[1])
        return Wire(_setting(layout, end, start or 0), period=own)
    how = connection.factor, connection.offset, connection.mapping
    component, name = connection.source
    if component is None:
        return Wire(_setting(layout, connection.source, plan.system.inputs[name].start or 0), *how, own)
    period = lcm(own, plan.multiples[component])
    kind = plan.kind(plan.variable(connection.source))
    outputs = plan.layouts[kind].outputs
    row = outputs.index(connection.source)
    if plan.layouts[kind] is layout:
        return Wire(row, *how, period)
    setting = _setting(layout, connection.source, 0)
    layout.crossings.append((setting - len(layout.outputs), kind, row))
    return Wire(setting, *how, period)


def _setting(layout, end, start):
    """Row of a setting among the sources; made if there is none of this name."""
    layout.settings.setdefault(end, start)
    return len(layout.outputs) + list(layout.settings).index(end)
