"""Repeat a run in the same arrays and instances, where only start values differ."""

from dataclasses import replace

from shipcosim.cosim.master.instantiate import Components
from shipcosim.cosim.master.plan import Plan, passes_own_start
from shipcosim.ssp import Component, System, Variable

Values = list[tuple[Variable, object]]


def can_rewind(plan: Plan, components: Components) -> bool:
    """True if all components can return to before their start: ours, with numeric values only."""
    ours = all(component.slave.python_object is not None for component in components.values())
    return ours and not plan.string_connections and not plan.parameter_connections


def changed_values(before: System, system: System) -> dict[str, Values] | None:
    """Start values to set by component if two systems differ only in numbers; else None.

    Parameters
    ----------
    before, system : System
        Made from one system by `with_values`.
    """
    # The same list object means the same wiring: `with_values` keeps it.
    if system.connections is not before.connections or list(system.components) != list(
        before.components
    ):
        return None
    # An input that is set has a row; one without a value, or with the FMU's own, has none. This must not change.
    rows_before, rows = (
        [
            structure.inputs[c.source[1]].start is None or passes_own_start(c, structure)
            for c in structure.connections
            if c.source[0] is None and c.source[1] in structure.inputs
        ]
        for structure in (before, system)
    )
    # The numbers that differ, by component.
    changed = {
        name: _changed(before.components[name], component)
        for name, component in system.components.items()
    }
    if rows_before != rows or any(values is None for values in changed.values()):
        return None
    return {name: values for name, values in changed.items() if values is not None}


def _changed(before: Component, component: Component) -> Values | None:
    # Another FMU, another step, or a value that is no longer set needs a new start.
    if (
        component.fmu is not before.fmu
        or component.step_size != before.step_size
        or before.start.keys() - component.start
    ):
        return None
    variables = component.variables
    # Compare by identity: equal objects are the same value, others are set again, which does no
    # harm.
    unknown = object()
    pairs = (
        (name, value, before.start.get(name, unknown)) for name, value in component.start.items()
    )
    return [(variables[name], value) for name, value, earlier in pairs if value is not earlier]


def with_numbers(plan: Plan, system: System) -> Plan:
    """The plan for a system that differs from the planned one only in numbers."""
    layouts = {}
    for kind, layout in plan.layouts.items():
        # Values copied from another exchange have no start value.
        following = {row for row, _, _ in layout.type_changes}
        external = {
            end: 0 if row in following else system.start_value(*end) or 0
            for row, end in enumerate(layout.external)
        }
        layouts[kind] = replace(layout, external=external)
    return replace(plan, system=system, layouts=layouts)
