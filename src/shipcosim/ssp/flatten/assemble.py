"""From a package to a system ready to run: flatten, set values, check."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from os import PathLike

from shipcosim.errors import shortened
from shipcosim.ssp.flatten.array_sizes import RESIZE, resized, sizes_wanted
from shipcosim.ssp.flatten.bindings import apply_set
from shipcosim.ssp.flatten.connections import Connection, connect
from shipcosim.ssp.flatten.hierarchy import Hierarchy, Swapped
from shipcosim.ssp.flatten.outer_signals import OuterSignals
from shipcosim.ssp.flatten.own_steps import with_whole_steps
from shipcosim.ssp.flatten.ports import Key
from shipcosim.ssp.flatten.start_values import Settings
from shipcosim.ssp.flatten.system import Component, System, alias_remarks
from shipcosim.ssp.flatten.walk import take_in
from shipcosim.ssp.read.package import Package
from shipcosim.ssp.read.parameters import ParameterSet, ParameterSets, read_parameter_set
from shipcosim.ssp.read.structure import Structure
from shipcosim.ssp.read.structure_reader import read_structure
from shipcosim.ssp.xml.document import Findings, read_document


def assemble_package(
    package: Package,
    parameters: ParameterSets,
    file: str,
    findings: Findings,
    swapped: Swapped = None,
) -> System | None:
    """System of a package, None or incomplete where there are errors.

    Parameters
    ----------
    package : Package
        Where the files are.
    parameters : path or ParameterSet, or iterable of them
        Applied over those of the system.
    file : str
        The system's name for messages.
    findings : Findings
        Takes what is wrong.
    swapped : mapping of str to Path, optional
        FMUs that components run in place of their own.
    """
    document = package.document(findings)
    structure = None if document is None else read_structure(document, findings)
    if structure is None:
        return None
    # Parameter sets are read once, also if the system is laid out twice.
    sets = list(parameter_sets(parameters, findings))
    before = len(findings.problems)

    # Collect the hierarchy, apply the sets over the system's own values, and flatten it.
    def flat(sizes: Mapping[str, Mapping[str, int]]) -> System:
        tree = Hierarchy(findings, sizes, swapped)
        take_in(tree, structure, package)
        for values in sets:
            apply_set(tree, values)
        return _system(tree, structure, file, findings)

    # Lay out with the FMUs' own array sizes. If the values set other sizes, do it once more with
    # these; findings of the first pass are dropped.
    system = flat({})
    if any(problem for component in system.components.values() for problem in resized(component)):
        findings.back_to(before)
        system = flat(sizes_wanted(system.components))
    return system


def parameter_sets(parameters: ParameterSets, findings: Findings) -> Iterator[ParameterSet]:
    """Parameter sets given for a run, read if they are paths.

    Parameters
    ----------
    parameters : path or ParameterSet, or iterable of them
        The last one wins.
    findings : Findings
        Takes what is wrong.
    """
    if isinstance(parameters, (str, PathLike, ParameterSet)):
        parameters = (parameters,)
    for given in parameters:
        if isinstance(given, ParameterSet):
            yield given
        elif (document := read_document(given, str(given), findings)) is not None:
            yield read_parameter_set(document, findings)


def _system(tree: Hierarchy, structure: Structure, file: str, findings: Findings) -> System:
    # Order: connections first (they add undeclared ports), then values, then components.
    connections = connect(tree, findings)
    settings = Settings(tree, findings)
    settings.apply()
    experiment = structure.experiment
    experiment = replace(
        experiment, step_size=experiment.step_size or structure.system.annotated_step_size
    )
    components = with_whole_steps(components_of(tree, settings), experiment.step_size, findings)
    _check_names(tree, findings)
    for component in components.values():
        for problem in resized(component):
            findings.error(component.name, problem, RESIZE)
    findings.problems += alias_remarks(components, connections)
    _remark_replaced(components, connections, findings)
    # With errors the rest cannot be relied on; the components suffice for further messages.
    name = structure.name or structure.system.name
    if findings.errors:
        return System(name, file, components)
    signals = OuterSignals(tree, components, connections, settings.system_start)
    # Connections from parameters of the system are done already, by its start values.
    return System(
        name=name,
        file=file,
        components=components,
        connections=tuple(c for c in connections if not _is_given(c, tree)),
        given=tuple(c for c in connections if _is_given(c, tree)),
        inputs=signals.of("input"),
        outputs=signals.of("output", "local", "calculatedParameter", "constant"),
        parameters=signals.of("parameter", "structuralParameter"),
        experiment=experiment,
        remarks=tuple(dict.fromkeys(findings.remarks)),
        swapped={name: str(file) for name, file in tree.swapped.items()},
        _packages=tuple(tree.library.packages),
    )


def _remark_replaced(
    components: Mapping[str, Component], connections: Iterable[Connection], findings: Findings
) -> None:
    """Remark values of variables that are connected, since a connection replaces them at the start."""
    fed = {line.target for line in connections if line.source[0] is not None}
    for name, component in components.items():
        replaced = [variable for variable in component.start if (name, variable) in fed]
        if replaced:
            findings.remark(
                name,
                f"Connections replace the values that are set for {shortened(replaced)}.",
                "Take the values or the connections out.",
            )


def components_of(tree: Hierarchy, settings: Settings) -> dict[str, Component]:
    """Components of a hierarchy by full name; those whose FMU cannot be read are left out.

    Parameters
    ----------
    tree : Hierarchy
        Has the components.
    settings : Settings
        Applied; has their start values.

    Returns
    -------
    dict of str to Component
    """
    return {
        ".".join(path): Component(
            ".".join(path),
            fmu,
            dict(settings.start[path]),
            element.step_size,
            element.implementation,
            dict(settings.tolerances[path]),
        )
        for path, (element, fmu) in tree.components.items()
        if fmu is not None
    }


def _is_given(connection: Connection, tree: Hierarchy) -> bool:
    """True if a connection hands in a parameter of the outermost system; start values cover it."""
    owner, name = connection.source
    return owner is None and tree.ports[Key((), name)].kind in ("parameter", "structuralParameter")


def _check_names(tree: Hierarchy, findings: Findings) -> None:
    """Report components with the same full name, which results could not tell apart."""
    seen = {}
    for path, (element, _) in tree.components.items():
        name = ".".join(path)
        if name in seen:
            findings.error(
                element.place, f"Two components have the full name '{name}'.", "Rename one of them."
            )
        seen[name] = element
    # Signals of the results: variables of components and connectors of the outermost system.
    signals = {}
    for path, (element, fmu) in tree.components.items():
        for name in () if fmu is None else fmu.named("input", "output", "parameter"):
            signal = ".".join((*path, name))
            if signals.setdefault(signal, path) != path:
                findings.error(
                    element.place,
                    f"Two components have a variable whose full name is '{signal}'.",
                    "Rename one of the components.",
                )
    for key, port in tree.ports.items():
        if key.path == () and port.owner == "system":
            if key.name == "time":
                findings.error(
                    port.place,
                    "A connector of the system is called 'time', as the time of the results.",
                    "Rename it.",
                )
            elif key.name in signals:
                findings.error(
                    port.place,
                    f"A connector of the system is called as the variable {key.name}.",
                    "Rename it.",
                )
