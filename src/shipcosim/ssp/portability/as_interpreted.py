"""A system as a tool interprets its file: with the values and connections that the tool applies.

Refusals and crashes are not considered; see `shipcosim.ssp.portability.support_table`.
"""

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass, replace

from shipcosim.errors import shortened
from shipcosim.ssp.flatten.connections import Connection
from shipcosim.ssp.flatten.system import Component, System
from shipcosim.ssp.fmu.description import FmuDescription, Variable
from shipcosim.ssp.portability.connection_features import linear_without_factor
from shipcosim.ssp.portability.structure_features import hints_of_others, model_exchange_asked
from shipcosim.ssp.portability.subject import Subject, subject_of
from shipcosim.ssp.read.parameters import ParameterValue, Transformation
from shipcosim.ssp.xml.document import AnyPath
from shipcosim.ssp.xml.values import Value


@dataclass(frozen=True)
class Taken:
    """One deviation in how a tool interprets a system.

    Parameters
    ----------
    what : str
        In words: which values are not applied, which connections are something else.
    system : System
        As we take it except for this.
    """

    what: str
    system: System


def told_set(path: AnyPath, *, fmus: Iterable[AnyPath] = ()) -> str | None:
    """Name of the first parameter set on a component, which ecos is given, or None.

    Parameters
    ----------
    path, fmus
        As for `shipcosim.ssp.read_system`.

    Returns
    -------
    str or None
    """
    subject = subject_of(path, fmus)
    return next((values.name for *_, values in subject.sets), None) if subject is not None else None


def taken_by(
    host: str, path: AnyPath, *, fmus: Iterable[AnyPath] = ()
) -> tuple[list[Taken], System | None]:
    """Deviations in how a tool interprets a system, and the system with all of them.

    Parameters
    ----------
    host : str
        ``"libcosim"`` or ``"ecos"``; that is told the name of the first parameter set.
    path, fmus
        As for `shipcosim.ssp.portability.check.check_for`.

    Returns
    -------
    list of Taken, System
        Nothing and None where the file cannot be read.
    """
    subject = subject_of(path, fmus)
    if subject is None:
        return [], None
    whole = subject.system
    # Each kind of deviation alone, for its description, and all of them together.
    taken = []
    for change in (_values, _connections, _steps, _forms):
        what, changed = change(host, subject, subject.system)
        if what:
            taken.append(Taken(what, changed))
            whole = change(host, subject, whole)[1]
    return taken, whole


def _values(host: str, subject: Subject, system: System) -> tuple[str, System]:
    """Start values as a tool applies them: of the first set, in ecos the last of that name."""
    # Which set the tool takes for each component.
    applied = {name: {} for name in system.components}
    sets = list(subject.sets)
    for k, (part, fmu, _, values) in enumerate(sets):
        first = all(part is not other for other, *_ in sets[:k])
        if fmu is not None and (first if host == "libcosim" else values.name == sets[0][-1].name):
            applied[part.name] = {}
            # Only values of kinds that the tool can apply.
            for value in values.values:
                variable = fmu.variables.get(value.name)
                if variable is not None and _takes(host, value, variable, fmu):
                    applied[part.name][value.name] = (
                        float(value.value) if variable.kind == "Real" else value.value
                    )
    # Values that differ from ours, and components with the tool's values.
    other = [
        f"{name}.{variable} is {_value(component, variable, applied[name])!r} "
        f"instead of {component.start_value(variable)!r}"
        for name, component in system.components.items()
        for variable in {**component.start, **applied[name]}
        if _value(component, variable, applied[name]) != component.start_value(variable)
    ]
    components = {
        name: replace(part, start=applied[name]) for name, part in system.components.items()
    }
    return _listed("parameters are not applied", other), replace(system, components=components)


def _takes(host: str, value: ParameterValue, variable: Variable, fmu: FmuDescription) -> bool:
    if host == "libcosim":
        causalities = ("input",) if fmu.fmi_version.startswith("1") else ("parameter", "input")
        if value.kind != variable.kind or variable.causality not in causalities:
            return False
    return variable.kind in ("Real", "Integer", "Boolean", "String") and value.kind != "Enumeration"


def _value(component: Component, variable: str, applied: Mapping[str, Value]) -> Value | None:
    return applied.get(variable, component.variables[variable].start)


def _connections(host: str, subject: Subject, system: System) -> tuple[str, System]:
    """Connections as written, without units and mappings; those from input to output left out."""
    # Connections of the file with the transformation that is written.
    links = {}
    for link, _, _ in subject.links:
        ends = link.ends
        how = link.transformation
        linear = how if how is not None and how.kind == "Linear" else Transformation()
        links[ends] = (linear.factor, linear.offset), link.place
    # ecos reads a missing factor as 0.
    if host == "ecos":
        misread = {place for place, _ in linear_without_factor(subject)}
        lines = {place.partition(": ")[0] for place in misread}
        links = {
            ends: ((0.0, how[1]), place) if _holds(place, lines) else (how, place)
            for ends, (how, place) in links.items()
        }
    taken = []
    other = []
    # Compare each of our connections with how the tool reads it.
    for connection in system.connections:
        ends = (connection.source, connection.target)
        name = connection.arrow
        if ends in links and not connection.initial:
            # The same factor and offset, without a mapping: no deviation.
            (factor, offset), _ = links[ends]
            ours = (connection.factor, connection.offset)
            if (factor, offset) != ours or connection.mapping is not None:
                other.append(f"{name} is {_how(factor, offset, connection)}")
            taken.append(replace(connection, factor=factor, offset=offset, mapping=None))
        elif connection.source[0] is None or connection.target[0] is None:
            # Connections of the outermost system's own connectors stay as they are.
            taken.append(connection)
        else:
            other.append(f"{name} is not made")
    return _listed("connections are something else", other), replace(
        system, connections=tuple(taken)
    )


def _holds(place: str, lines: Container[str]) -> bool:
    """True if a connection's place is that of a transformation: in the same line or the next."""
    file, _, line = place.partition(": ")[0].rpartition(", line ")
    return line.isdigit() and any(f"{file}, line {int(line) + more}" in lines for more in (0, 1))


def _how(factor: float, offset: float, connection: Connection) -> str:
    if connection.mapping is not None:
        return "made without its mapping"
    return f"{factor:g} times plus {offset:g} instead of {connection.factor:g} times plus {connection.offset:g}"


def _steps(host: str, subject: Subject, system: System) -> tuple[str, System]:
    """Component steps that only another tool's annotation states."""
    if not any(True for _ in hints_of_others(subject)):
        return "", system
    plain = {name: replace(part, step_size=None) for name, part in system.components.items()}
    other = [
        f"{name} steps with the base step"
        for name, part in system.components.items()
        if part.step_size
    ]
    return _listed("step sizes are not read", other), replace(system, components=plain)


def _forms(host: str, subject: Subject, system: System) -> tuple[str, System]:
    """Co-simulation in every case, even where the system asks for model exchange."""
    plain = {name: replace(part, implementation="any") for name, part in system.components.items()}
    other = [f"{name} runs as co-simulation" for name, _ in model_exchange_asked(subject)]
    return _listed("forms are not looked at", other), replace(system, components=plain)


def _listed(what: str, texts: list[str]) -> str:
    return f"{what}: {shortened(texts, between='; ')}" if texts else ""
