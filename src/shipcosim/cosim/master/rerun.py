"""A run in the arrays and instances of another one, where start values alone differ."""

from dataclasses import replace

from shipcosim.cosim.master.instantiate import Components
from shipcosim.cosim.master.plan import Plan
from shipcosim.ssp import Component, System, Variable

Values = list[tuple[Variable, object]]


def can_rewind(plan: Plan, components: Components) -> bool:
    """Whether all components can go back to before their start: those of our shell, with values in arrays alone."""
    ours = all(component.slave.python_object is not None for component in components.values())
    return ours and not plan.string_connections and not plan.parameter_connections


def changed_values(before: System, system: System) -> dict[str, Values] | None:
    """Start values to be set by component, where two systems differ in numbers alone; None where they do not.

    Parameters
    ----------
    before, system : System
        Made from one system by `with_values`.
    """
    if system.connections is not before.connections or list(system.components) != list(
        before.components
    ):
        return None
    inputs = (
        {name: signal.start is None for name, signal in one.inputs.items()}
        for one in (before, system)
    )
    found = {
        name: _changed(before.components[name], component)
        for name, component in system.components.items()
    }
    if next(inputs) != next(inputs) or any(values is None for values in found.values()):
        return None
    return {name: values for name, values in found.items() if values is not None}


def _changed(before: Component, component: Component) -> Values | None:
    if (
        component.fmu is not before.fmu
        or component.step_size != before.step_size
        or before.start.keys() - component.start
    ):
        return None
    variables = component.fmu.variables
    unknown = object()
    pairs = (
        (name, value, before.start.get(name, unknown)) for name, value in component.start.items()
    )
    return [(variables[name], value) for name, value, earlier in pairs if value is not earlier]


def with_numbers(plan: Plan, system: System) -> Plan:
    """The plan of a system that differs from that of a plan in numbers alone."""

    def start(end):
        component, name = end
        return (
            system.inputs[name].start
            if component is None
            else system.components[component].start_value(name)
        ) or 0

    layouts = {}
    for kind, layout in plan.layouts.items():
        following = {row for row, _, _ in layout.type_changes}
        external = {
            end: 0 if row in following else start(end) for row, end in enumerate(layout.external)
        }
        layouts[kind] = replace(layout, external=external)
    return replace(plan, system=system, layouts=layouts)
