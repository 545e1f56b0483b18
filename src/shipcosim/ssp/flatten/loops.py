"""Algebraic loops: connections and direct feedthrough that lead back to their start."""

from collections import defaultdict, deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from typing import Any

from shipcosim.errors import Problem
from shipcosim.ssp.flatten.system import System
from shipcosim.ssp.fmu.feedthrough import feedthrough

MOST_STARTS = 50
"""Most variables of a loop from which its shortest cycle is searched."""
MOST_TRIED = 50
"""Most components that are tried as breaks of a loop."""


Node = tuple[Any, Any]
"""Component and variable; None stands for all inputs of a component whose FMU says nothing of its outputs."""

Edge = tuple[Node, Node]
"""A value goes from the first to the second: a connection, or direct feedthrough of a component."""


@dataclass(frozen=True)
class AlgebraicLoop:
    """An algebraic loop, or several that share variables.

    Parameters
    ----------
    links : list of (source, target)
        The shortest cycle: names of the variables that connections join, in order.
    others : int
        Connections that belong to it beside these.
    components : list of str
        That it goes through, in the system's order.
    silent : list of str
        Those of them whose FMU does not say what its outputs follow at once, so that all of them may follow all inputs.
    breaking : list of str
        Each of them alone would break it, if its outputs followed its inputs a step later.
    """

    links: list[Edge]
    others: int
    components: list[str]
    silent: list[str]
    breaking: list[str]


def find_loops(system: System) -> list[AlgebraicLoop]:
    """Loops of a checked system in the run; the master says where a start does not settle.

    Parameters
    ----------
    system : System
        Flat.

    Returns
    -------
    list of AlgebraicLoop
    """
    # Coarse search first: a loop of variables is also a loop of components. Only their FMUs need to
    # be read.
    links = [c for c in system.connections if c.source[0] and c.target[0] and not c.initial]
    links = list({(c.source, c.target): None for c in links})
    rough = [(source[0], target[0]) for source, target in links]
    circling = {name for part in _strong(rough) for name in part}
    links = [link for link in links if link[0][0] in circling and link[1][0] in circling]
    fmus = {name: system.components[name].fmu for name in circling}
    # Each FMU file is read once, however many components use it.
    read = {fmu.path: feedthrough(fmu) for fmu in {fmu.path: fmu for fmu in fmus.values()}.values()}
    stated = {name: read[fmu.path] for name, fmu in fmus.items()}
    # Graph of variables: connections between components, feedthrough inside them. Each strongly
    # connected part is a loop.
    edges = links + [edge for name in circling for edge in _inside(name, links, stated[name])]
    return [_loop(part, edges, links, list(system.components)) for part in _strong(edges)]


def loop_problems(system: System) -> Iterator[Problem]:
    """A remark on each loop."""
    for loop in find_loops(system):
        shown = ", ".join(
            f"{'.'.join(source)} -> {'.'.join(target)}" for source, target in loop.links
        )
        message = f"An algebraic loop, outputs that follow inputs at once: {shown}."
        if loop.others:
            message += f" {loop.others} more connections belong to it."
        message += " In a run with fixed steps each link delays by one step,"
        message += " and the start is iterated, which may not settle."
        if loop.silent:
            message += f" These FMUs do not declare it, so it is assumed: {', '.join(loop.silent)}."
        yield Problem(
            f"{system.file}: {', '.join(loop.components)}", message, _remedy(loop), "remark"
        )


def _remedy(loop: AlgebraicLoop) -> str:
    delay = 'delay outputs by a step and declare that in ModelStructure (dependencies="")'
    if loop.breaking:
        return f"To break the loop, one of these FMUs must {delay}: {', '.join(loop.breaking)}."
    # Of a large loop it is not known whether one would be enough.
    several = "FMUs of it" if len(loop.components) > MOST_TRIED else "several of these FMUs"
    return f"To break the loop, {several} must {delay}."


def _inside(name: str, links: list[Edge], stated: Mapping[str, frozenset[str]]) -> Iterator[Edge]:
    """Edges from inputs to outputs; an output without declared dependencies follows all."""
    inputs = {target for _, target in links if target[0] == name}
    # One node for all inputs keeps the graph small: n + m edges instead of n × m.
    knot = name, None
    yield from ((end, knot) for end in sorted(inputs))
    for output in {source: None for source, _ in links if source[0] == name}:
        if output[1] in stated:
            yield from ((end, output) for end in sorted(inputs) if end[1] in stated[output[1]])
        else:
            yield knot, output


def _loop(part: set[Node], edges: list[Edge], links: list[Edge], names: list[str]) -> AlgebraicLoop:
    inside, edges = (
        [edge for edge in several if part.issuperset(edge)] for several in (links, edges)
    )
    # A shortest cycle explains the loop best; the rest is only counted.
    way = _shortest(inside, edges)
    components = [name for name in names if any(end[0] == name for end in part)]
    silent = [name for name in components if (name, None) in part]
    # Components whose delay alone would break the loop are the remedies to offer.
    breaking = [name for name in components[:MOST_TRIED] if _breaks(name, edges)]
    return AlgebraicLoop(way, len(inside) - len(way), components, silent, breaking)


def _breaks(name: str, edges: list[Edge]) -> bool:
    """True if no cycle remains without the inside of a component."""
    rest = [edge for edge in edges if not edge[0][0] == edge[1][0] == name]
    try:
        TopologicalSorter(_graph(rest)).prepare()
    except CycleError:
        return False
    return True


def _shortest(links: list[Edge], edges: list[Edge]) -> list[Edge]:
    """Connections of the shortest cycle."""
    graph = _graph(edges)
    ways = []
    inner = set(links)
    # Breadth-first search from the end of each connection back to its start.
    for source, target in links[:MOST_STARTS]:
        before: dict[Node, Node | None] = {target: None}
        queue = deque([target])
        while queue and source not in before:
            node = queue.popleft()
            for following in graph[node]:
                if following not in before:
                    before[following] = node
                    queue.append(following)
        # Follow the predecessors back to get the path.
        way = [source]
        node = source
        while (node := before[node]) is not None:
            way.insert(0, node)
        # Keep only connections: edges inside components are no part of the message.
        steps = list(zip([source, *way], way, strict=False))
        ways.append([step for step in steps if step in inner])
    return min(ways, key=len)


def _graph(edges: Iterable[tuple]) -> dict:
    graph = defaultdict(list)
    for source, target in edges:
        graph[source].append(target)
        graph[target]
    return dict(graph)


def _strong(edges: Sequence[tuple]) -> list[set]:
    """Strongly connected parts with an inner edge, in the order of the edges."""
    graph = _graph(edges)
    back = _graph([(target, source) for source, target in edges])
    parts = []
    left = set(graph)
    for start in graph:
        if start not in left:
            continue
        # Nodes that lead to the start; those of them that it leads to are its part.
        part = _reached(graph, start, _reached(back, start, left))
        left -= part
        # A single node counts only if it has an edge to itself.
        if len(part) > 1 or start in graph[start]:
            parts.append(part)
    return parts


def _reached(graph: Mapping, start: Node, within: set) -> set:
    """The start, and all nodes to which the edges of a graph lead from it within some nodes."""
    found = {start}
    due = [start]
    while due:
        fresh = within.intersection(graph[due.pop()]) - found
        found |= fresh
        due += fresh
    return found
