"""The order in which components step: Jacobi or Gauss-Seidel."""

from shipcosim.cosim.master.plan import Plan
from shipcosim.ssp import System

ORDERS = ("jacobi", "gauss-seidel")


def stepping_order(plan: Plan, order: str) -> list[str]:
    """Names of the components in stepping order.

    Jacobi has no order: the system's. Gauss-Seidel puts every component behind those that feed it; where these form a
    loop, the first of it in the system goes first.
    """
    return list(plan.system.components) if order == "jacobi" else sources_first(plan.system)


def sources_first(system: System) -> list[str]:
    """Names of the components, each after those that feed it, as far as there is no loop."""
    names = list(system.components)
    feeds = {name: set() for name in names}
    for connection in system.connections:
        source = connection.source[0]
        target = connection.target[0]
        if source and target and source != target:
            feeds[target].add(source)
    # Topological order. In a loop no component is ready: then the first one in the system goes.
    ordered = []
    while names:
        ready = (name for name in names if feeds[name].issubset(ordered))
        ordered.append(next(ready, names[0]))
        names.remove(ordered[-1])
    return ordered
