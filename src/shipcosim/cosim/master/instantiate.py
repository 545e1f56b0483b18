"""Instantiate the components of a run, and make arrays and connections, from its plan."""

from collections.abc import Callable, Mapping, Sequence
from math import lcm
from typing import Protocol

import numpy as np

from shipcosim.cosim.master.algorithm import Failure
from shipcosim.cosim.master.component import ComponentInstance, set_start_values
from shipcosim.cosim.master.connections import ParameterConnection, Port, StringConnection
from shipcosim.cosim.master.groups import followed_inputs
from shipcosim.cosim.master.plan import End, Plan
from shipcosim.cosim.master.signals import Exchange
from shipcosim.cosim.slaves.interface_type import interface_type_of
from shipcosim.cosim.slaves.model_exchange import ModelExchange
from shipcosim.cosim.slaves.slave import BUFFER_TYPES, Slave, SlaveError
from shipcosim.errors import Problem
from shipcosim.ssp import Component, Connection

Components = dict[str, ComponentInstance]
"""By name."""


class SlaveSource(Protocol):
    """Source of FMU instances: `Instances` in this process, `IsolatedInstances` in others."""

    def instance_of(self, component: Component) -> Slave:
        """Instance of a component's FMU in which nothing has been set yet. Raises SlaveError if there is none."""
        ...


def make_exchanges(plan: Plan) -> dict[str, Exchange]:
    """Exchange of each kind that occurs in a plan."""
    exchanges = {}
    for (
        kind,
        dtype,
    ) in BUFFER_TYPES.items():  # Real is last: its external values may follow the others
        layout = plan.layouts[kind]
        if layout.outputs or layout.inputs:
            # Values that change type between exchanges are copied from the exchange of their
            # source.
            external = np.array(list(layout.external.values()), dtype=dtype)
            type_changes = [
                (row, exchanges[source_kind], source)
                for row, source_kind, source in layout.type_changes
            ]
            exchanges[kind] = Exchange(
                len(layout.outputs), external, layout.connections, type_changes
            )
    return exchanges


def make_components(
    plan: Plan,
    exchanges: Mapping[str, Exchange],
    slaves: SlaveSource,
    base_step: float,
    check_interrupt: Callable[[], None],
    inner: Sequence[Connection] = (),
) -> Components:
    """The components of a plan, instantiated, their start values set.

    Parameters
    ----------
    plan : Plan
        Of the run.
    exchanges : mapping of str to Exchange
        By kind.
    slaves : SlaveSource
        Where the FMUs' instances come from.
    base_step : float
        Step size of the run. [s]
    check_interrupt : callable
        Raises KeyboardInterrupt where the user wants to stop.
    inner : sequence of Connection
        That a common solver of components in model exchange carries over.

    Raises
    ------
    Failure
        If an FMU cannot be instantiated or does not take its start values.
    """
    instances = {}
    # A component that feeds no other one needs no iteration at the start.
    feeding = {
        connection.source[0]
        for connection in plan.system.connections
        if connection.target[0] is not None
    }
    for component in plan.system.components.values():
        check_interrupt()
        fmu = component.fmu
        name = component.name
        multiple = plan.multiples[component.name]
        try:
            # Model exchange must know which inputs a common solver carries: they cause no event at
            # a step.
            slave = slaves.instance_of(component)
            if isinstance(slave, ModelExchange):
                slave.followed = followed_inputs(inner, name)
            set_start_values(
                slave,
                [(fmu.variables[variable], value) for variable, value in component.start.items()],
            )
        except SlaveError as error:
            raise Failure(Problem(name, f"{fmu.path.name} cannot be started. {error}")) from error
        # The step, for an FMU that can take no other one.
        step = base_step * multiple
        is_free = component.fmu.capability("canHandleVariableCommunicationStepSize")
        fixed_step = None if is_free or interface_type_of(component) == "ModelExchange" else step
        instances[name] = ComponentInstance(name, slave, multiple, fixed_step, name in feeding)
        # Bind the arrays of all kinds to the FMU's calls once.
        for kind, exchange in exchanges.items():
            instances[name].prepare(kind, exchange, *plan.rows(kind, name))
    return instances


def make_string_connections(plan: Plan, components: Components) -> list[StringConnection]:
    """Connections between String or Binary variables."""
    made = []
    for connection in plan.string_connections:
        source, target = (
            _instance(components, end) for end in (connection.source, connection.target)
        )
        ends = (
            source.slave,
            plan.variable(connection.source),
            target.slave,
            plan.variable(connection.target),
        )
        # Two steps of different length: pass on where both end, at the least common multiple.
        made.append(
            StringConnection(*ends, connection.mapping, lcm(source.multiple, target.multiple))
        )
    return made


def make_parameter_connections(plan: Plan, components: Components) -> list[ParameterConnection]:
    """Connections into parameters."""

    def port(end: End) -> Port:
        return Port(_instance(components, end).slave, plan.variable(end), plan.kind_of(end))

    return [
        ParameterConnection(port(c.source), port(c.target), c) for c in plan.parameter_connections
    ]


def _instance(components, end):
    return components[end[0]]
