"""Groups of model-exchange components that are integrated as one system."""

from collections.abc import Mapping, Sequence

from shipcosim.cosim.master.component import ComponentInstance
from shipcosim.cosim.master.plan import Plan, label
from shipcosim.cosim.slaves.interface_type import interface_type_of
from shipcosim.cosim.slaves.model_exchange import ModelExchange
from shipcosim.cosim.slaves.slave import OK
from shipcosim.ssp import Connection

WIRED_OTHERWISE = (
    "the connection adds up in its input, goes through a mapping, or back into its own component"
)
"""Why a connection is not carried that nothing else keeps a common solver from."""


def inner_connections(plan: Plan) -> list[Connection]:
    """Connections that a common solver carries: Real to Real between model-exchange components.

    Both step with the base step, nothing adds up in the input, and no event of the run changes either end.

    Parameters
    ----------
    plan : Plan
        Of the run.
    """
    into = [connection.target for connection in plan.system.connections]
    return [c for c in plan.system.connections if into.count(c.target) == 1 and _is_inner(c, plan)]


def _is_inner(connection: Connection, plan: Plan) -> bool:
    # Excluded: parameters, mappings, and connections with the outermost system.
    outermost = None in (connection.source[0], connection.target[0])
    if connection.initial or connection.mapping or outermost:
        return False
    return _is_of_models(connection, plan) and not _why_apart(connection, plan)


def exchanged_at_steps(
    plan: Plan, inner: Sequence[Connection], how: str, step_size: float
) -> list[str]:
    """Remarks on model-exchange components that are connected but not integrated as one system.

    Parameters
    ----------
    plan : Plan
        Of the run.
    inner : sequence of Connection
        That a common solver carries over.
    how : str
        Why the run has no common solver, as a sentence's part; empty where it has.
    step_size : float
        Of the master. [s]

    Returns
    -------
    list of str
        A sentence for each pair.
    """
    # One remark per pair; pairs inside a group are integrated together and need none.
    groups = groups_of(inner)
    by_pair = {}
    for c in plan.system.connections:
        pair = tuple(sorted({c.source[0] or "", c.target[0] or ""}))
        is_carried = c in inner and any(set(pair) <= group for group in groups)
        if is_carried or "" in pair or pair in by_pair or not _is_of_models(c, plan):
            continue
        what = (
            "run in model exchange, wired together"
            if len(pair) > 1
            else "runs in model exchange, wired to itself"
        )
        why = how or _why_apart(c, plan) or WIRED_OTHERWISE
        by_pair[pair] = (
            f"{' and '.join(pair)} {what}, but not as one system: {why}. What they exchange is held for "
            f"{step_size:g} s: an error of first order in the step."
        )
    return list(by_pair.values())


def _is_of_models(connection: Connection, plan: Plan) -> bool:
    """True for a connection from Real to Real between model-exchange components."""
    ends = (connection.source, connection.target)
    names = [plan.system.components[name or ""] for name, _ in ends]
    return all(interface_type_of(name) == "ModelExchange" for name in names) and all(
        plan.variable(end).kind == "Real" for end in ends
    )


def _why_apart(connection: Connection, plan: Plan) -> str:
    """What keeps a common solver from a connection between model-exchange components; empty where nothing does."""
    ends = (connection.source, connection.target)
    components = {name: plan.system.components[name or ""] for name, _ in ends}
    # State events would need one event search for the whole group, which is not done.
    if eventful := [
        str(name) for name, component in components.items() if component.fmu.n_event_indicators
    ]:
        return f"{' and '.join(eventful)} can have events of state (event indicators)"
    # A common solver steps with the base step, and it cannot see events that change the ends.
    if slow := [str(name) for name in components if plan.multiples[name or ""] != 1]:
        return f"{' and '.join(slow)} steps with a step of its own"
    if changed := [label(end) for end in ends if end in plan.modified]:
        return f"the run itself changes {' and '.join(changed)}"
    return ""


def groups_of(connections: Sequence[Connection]) -> list[set[str]]:
    """Components that connections join, directly or through others."""
    # Union of sets: a connection merges all groups that it touches.
    groups: list[set[str]] = []
    for connection in connections:
        joined = {connection.source[0] or "", connection.target[0] or ""}
        apart = [group for group in groups if group.isdisjoint(joined)]
        groups = [*apart, joined.union(*(group for group in groups if group not in apart))]
    # A component connected to itself alone is no group.
    return [group for group in groups if len(group) > 1]


def followed_inputs(connections: Sequence[Connection], name: str) -> frozenset[tuple[str, str]]:
    """Kind and name of a component's inputs to which a common solver carries values."""
    groups = groups_of(connections)
    return frozenset(
        ("Real", c.target[1])
        for c in connections
        if c.target[0] == name and any(name in group for group in groups)
    )


def couple(
    plan: Plan,
    instances: Mapping[str, ComponentInstance],
    order: Sequence[str],
    connections: Sequence[Connection],
) -> None:
    """Give each group of a run one solver; its last component makes the step.

    Parameters
    ----------
    plan : Plan
        Of the run.
    instances : mapping of str to ComponentInstance
        By name; the slaves of the groups run in this process.
    order : sequence of str
        Names in the order of the steps.
    connections : sequence of Connection
        Of `inner_connections`.
    """
    from shipcosim.cosim.slaves.coupled import CoupledModels, Wire

    for group in groups_of(connections):
        # The solver runs at the step of the last member, when the inputs of all members are set.
        names = [name for name in order if name in group]
        members = {
            name: slave
            for name in names
            if isinstance(slave := instances[name].slave, ModelExchange)
        }
        wires = [
            Wire(
                (c.source[0] or "", plan.variable(c.source)),
                (c.target[0] or "", plan.variable(c.target)),
                c.factor,
                c.offset,
            )
            for c in connections
            if c.source[0] in group
        ]
        coupled = CoupledModels(members, wires)
        # The last member owns the solver and frees it.
        members[names[-1]].close_group = coupled.close
        # The other members do nothing in their step: the group's solver has moved them.
        for name in names:
            instances[name].steps_by(coupled.stepper() if name == names[-1] else _nothing)


def _nothing(time: float, step_size: float) -> int:
    return OK
