"""A system ready to run: flat, checked, every value in the unit of the FMU that gets it."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import isfinite
from pathlib import Path

from shipcosim.errors import Problem, ShipcosimError, it_has, suggestion
from shipcosim.ssp.flatten.connectors import Key
from shipcosim.ssp.flatten.hierarchy import Tree
from shipcosim.ssp.flatten.start_values import Settings, check_bounds
from shipcosim.ssp.flatten.wiring import Connection, connect
from shipcosim.ssp.fmu.arrays import RESIZE, resized, sizes_wanted
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.read.parameters import ParameterSet, read_parameter_set
from shipcosim.ssp.read.structure import Experiment, read_structure
from shipcosim.ssp.xml.document import Findings, read_document


@dataclass(frozen=True)
class Component:
    """An FMU in the system.

    Parameters
    ----------
    name : str
        With the names of the systems around it before it: ``"ship.vessel"``.
    fmu : FmuDescription
        Its FMU; several components can share one.
    start : mapping of str to value
        Start values that the system sets, in the FMU's unit and type; the others stay as the FMU has them.
    step_size : float or None
        The step that an annotation asks for; None: the base step. [s]
    implementation : str
        ``"any"``, ``"CoSimulation"`` or ``"ModelExchange"``.
    tolerances : mapping of str to float
        Standard deviations within which start values count as known, where the system says so, in the FMU's unit.
    """

    name: str
    fmu: FmuDescription
    start: Mapping = field(default_factory=dict)
    step_size: float | None = None
    implementation: str = "any"
    tolerances: Mapping = field(default_factory=dict)

    def start_value(self, variable):
        """Start value of a variable: the system's, else the FMU's own, else None."""
        return self.start.get(variable, self.fmu.variables[variable].start)


@dataclass(frozen=True)
class Signal:
    """A connector of the outermost system.

    Parameters
    ----------
    name, type, unit, description : str
        Type and unit are those of the variables behind it where the SSD leaves them open; unit may be None.
    start : value or None
        In `unit`. None: no value is set or derived, and the components' own start values hold until something feeds it.
    items : mapping of str to int
        Of an enumeration.
    """

    name: str
    type: str | None
    unit: str | None = None
    description: str = ""
    start: object = None
    items: Mapping = field(default_factory=dict)


@dataclass(frozen=True)
class System:
    """A system that a master can execute without looking at any file but the FMUs.

    FMUs unpacked from an .ssp stay on disk as long as the system (or one made from it) is referred to.

    Parameters
    ----------
    name : str
        Of the system structure.
    file : str
        Where it was read from.
    components : mapping of str to Component
        By full name, in the order of the file.
    connections : tuple of Connection
        From variable to variable.
    inputs, outputs, parameters : mapping of str to Signal
        Connectors of the outermost system.
    experiment : Experiment
        Default start, stop and step.
    remarks : tuple of Problem
        What a user should know although it stops nothing.
    given : tuple of Connection
        From parameters of the outermost system to variables; the start values follow them already.
    """

    name: str
    file: str
    components: Mapping
    connections: tuple[Connection, ...] = ()
    inputs: Mapping = field(default_factory=dict)
    outputs: Mapping = field(default_factory=dict)
    parameters: Mapping = field(default_factory=dict)
    experiment: Experiment = Experiment()
    remarks: tuple[Problem, ...] = ()
    given: tuple[Connection, ...] = ()
    _packages: tuple = field(default=(), repr=False, compare=False)  # keeps what was unpacked on disk

    def split(self, signal, where=""):
        """Component and variable that a signal's name means.

        Parameters
        ----------
        signal : str
            ``component.variable``, or a connector of the outermost system alone.
        where : str
            Where the name stands, for messages.

        Returns
        -------
        tuple of (str or None, str)
            None for a connector of the outermost system.

        Raises
        ------
        ShipcosimError
            If there is no such signal.
        """
        if any(signal in group for group in (self.inputs, self.outputs, self.parameters)):
            return None, signal
        owners = [name for name in self.components if signal.startswith(f"{name}.")]
        for name in sorted(owners, key=len, reverse=True):
            if signal[len(name) + 1 :] in self.components[name].fmu.variables:
                return name, signal[len(name) + 1 :]
        raise ShipcosimError(self._no_signal(signal, owners, where))

    def _no_signal(self, signal, owners, where):
        if owners:
            owner = max(owners, key=len)
            variable = signal[len(owner) + 1 :]
            known = self.components[owner].fmu.variables
            return Problem(where, f"{owner} has no variable '{variable}'.", it_has(variable, known))
        element = signal.split(".")[0]
        known = [*self.components, *self.inputs, *self.outputs, *self.parameters]
        return Problem(where, f"There is no component or connector '{element}'.", suggestion(element, known))


def assemble_package(package, parameters, file, findings, described=None):
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
    described : dict, optional
        Keeps descriptions of FMUs from one call to the next.
    """
    document = package.document(findings)
    structure = None if document is None else read_structure(document, findings)
    if structure is None:
        return None
    sets = list(parameter_sets(parameters, findings))
    before = len(findings.problems)

    def grown(sizes):
        tree = Tree(findings, described, sizes)
        tree.grow(structure, package)
        for values in sets:
            tree.bind(values)
        return _system(tree, structure, file, findings)

    system = grown({})
    if any(found for component in system.components.values() for found in resized(component)):
        findings.back_to(before)
        system = grown(sizes_wanted(system.components))
    return system


def parameter_sets(parameters, findings):
    """Sets given for this run, read where they are paths."""
    if isinstance(parameters, (str, Path, ParameterSet)):
        parameters = (parameters,)
    for given in parameters:
        if isinstance(given, ParameterSet):
            yield given
        elif (document := read_document(given, str(given), findings)) is not None:
            yield read_parameter_set(document, findings)


def _system(tree, structure, file, findings):
    connections = connect(tree, findings)
    settings = Settings(tree, findings)
    settings.apply()
    components = components_of(tree, settings)
    _check_names(tree, findings)
    for component in components.values():
        for found in resized(component):
            findings.error(component.name, found, RESIZE)
    remark_unconnected(components, connections, findings)
    name = structure.name or structure.system.name
    if findings.errors:
        return System(name, file, components)
    signals = _Signals(tree, components, connections, settings.system_start)
    return System(
        name=name,
        file=file,
        components=components,
        connections=tuple(c for c in connections if not _is_given(c, tree)),
        given=tuple(c for c in connections if _is_given(c, tree)),
        inputs=signals.of("input"),
        outputs=signals.of("output", "local", "calculatedParameter", "constant"),
        parameters=signals.of("parameter", "structuralParameter"),
        experiment=_experiment(structure),
        remarks=tuple(dict.fromkeys(findings.remarks)),
        _packages=tuple(tree.library.packages),
    )


def components_of(tree, settings):
    """Components of a tree by full name, with their start values; those whose FMU cannot be read are left out."""
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


def _is_given(connection, tree):
    """Whether a connection only hands in a parameter of the outermost system, whose value is among the start values."""
    owner, name = connection.source
    return owner is None and tree.ports[Key((), name)].kind in ("parameter", "structuralParameter")


def _experiment(structure):
    experiment = structure.experiment
    return replace(experiment, step_size=experiment.step_size or structure.system.annotated_step_size)


def _check_names(tree, findings):
    """Two components can end up with one full name where names have dots; results could not tell them apart."""
    seen = {}
    for path, (element, _) in tree.components.items():
        name = ".".join(path)
        if name in seen:
            findings.error(element.place, f"Two components have the full name '{name}'.", "Rename one of them.")
        seen[name] = element


def remark_unconnected(components, connections, findings):
    """Note which inputs nothing feeds."""
    connected = {connection.target for connection in connections}
    for component in components.values():
        free = [name for name in component.fmu.named("input") if (component.name, name) not in connected]
        if free:
            findings.remark(component.name, f"Unconnected inputs keep their start value: {', '.join(free)}.")


class _Signals:
    """Connectors of the outermost system, with what follows from what they are connected to."""

    def __init__(self, tree, components, connections, start):
        self.tree, self.components, self.start = tree, components, start
        self.connections = connections

    def of(self, *kinds):
        """Signals of these kinds of connector, by name."""
        keys = [key for key, port in self.tree.ports.items() if key.path == () and port.owner == "system"]
        return {key.name: self._signal(key) for key in keys if self.tree.ports[key].kind in kinds}

    def _signal(self, key):
        port = self.tree.ports[key]
        ends = self._ends(key)
        unit = port.unit.name if port.unit else next((end.unit for end, _ in ends if end.unit), None)
        start = self.start.get(key.name)
        if start is None and port.kind == "input":
            start = self._derived(ends, key)
        kind = port.type or next((end.kind for end, _ in ends), None)
        return Signal(key.name, kind, unit, port.description, start, port.items)

    def _ends(self, key):
        """Variables at the other ends of a connector's connections, with the connections."""
        near = (None, key.name)
        pairs = [(c.target, c) for c in self.connections if c.source == near]
        pairs += [(c.source, c) for c in self.connections if c.target == near]
        return [(self.components[name].fmu.variables[variable], c) for (name, variable), c in pairs if name]

    def _derived(self, ends, key):
        """Start of an input that none is set for: what the variables behind it start with, where they agree."""
        starts = set()
        for _, connection in ends:
            name, variable = connection.target
            value = self.components[name].start_value(variable)
            if value is None or connection.mapping is not None or connection.factor == 0.0:
                return None
            linear = (connection.factor, connection.offset) != (1.0, 0.0)
            starts.add((value - connection.offset) / connection.factor if linear else value)
        return starts.pop() if len(starts) == 1 else None


def with_values(system, values, where=""):
    """System with other start values, e.g. from a scenario or the command line.

    Parameters
    ----------
    system : System
        As read.
    values : mapping of str to value
        By signal (``"vessel.mass"``), in the FMU's unit; items of enumerations by name or number.
    where : str
        Where the values come from, for messages.

    Returns
    -------
    System

    Raises
    ------
    ShipcosimError
        With every name that does not exist and every value that does not fit.
    """
    findings = Findings()
    starts = {name: dict(component.start) for name, component in system.components.items()}
    inputs, feeding = dict(system.inputs), {connection.target: connection.source for connection in system.connections}
    for signal, value in values.items():
        place = f"{where}: {signal}" if where else signal
        try:
            component, name = system.split(signal, place)
        except ShipcosimError as error:
            findings.problems += error.problems
            continue
        if (component, name) in feeding:
            source = ".".join(filter(None, feeding[component, name]))
            remedy = "Set what feeds it, or hold it with an event (override)."
            findings.error(place, f"It is connected: {source} gives its value.", remedy)
        elif component is not None:
            _set(starts[component], system.components[component].fmu.variables[name], value, place, findings)
        elif name in inputs:
            if _fits(value, inputs[name], inputs[name].type, place, findings):
                inputs[name] = replace(inputs[name], start=value)
        else:
            findings.error(place, "It is no input of the system.", f"Inputs: {', '.join(inputs) or 'none'}.")
    if findings.errors:
        raise ShipcosimError(findings.errors)
    components = {name: replace(component, start=starts[name]) for name, component in system.components.items()}
    return replace(system, components=components, inputs=inputs)


PYTHON = {"Real": (int, float), "Integer": (int,), "Boolean": (bool,), "String": (str,), "Enumeration": (int,)}
WANTED = {
    "Real": "Give a number, with a decimal point",
    "Integer": "Give a whole number",
    "Boolean": "Give true or false",
}
LARGEST = 2**31  # FMI's integers have 32 bits


def _set(start, variable, value, place, findings):
    """Put a value for a variable into `start`, checked and in the variable's type."""
    if variable.items and isinstance(value, str):
        value = variable.items.get(value, value)
    if not _fits(value, variable, variable.kind, place, findings):
        return
    if not variable.settable:
        found = f"It is of causality {variable.causality}, a value that the FMU calculates."
        findings.error(place, found, "Set parameters and inputs.")
    elif check_bounds(value, variable, place, variable.name, findings):
        start[variable.name] = float(value) if variable.kind == "Real" else value


def _fits(value, owner, kind, place, findings):
    """Whether a value is of a kind, with an error if not; `owner` has the items of an enumeration."""
    right = kind is None or isinstance(value, PYTHON.get(kind, (bytes,)))
    if not right or (isinstance(value, bool) and kind not in ("Boolean", None)):
        remedy = f"Items: {', '.join(owner.items)}." if owner.items else _wanted(kind, owner.unit)
        findings.error(place, f"{value!r} is no {kind}.", remedy)
        return False
    if isinstance(value, float) and not isfinite(value):
        findings.error(place, f"{value} is not a finite number.", _wanted("Real", owner.unit))
        return False
    if kind == "Integer" and not -LARGEST <= value < LARGEST:
        findings.error(place, f"{value} is too large for an Integer.", f"Give one from {-LARGEST} to {LARGEST - 1}.")
        return False
    return True


def _wanted(kind, unit):
    return f"{WANTED[kind]}{f', in {unit}' if kind == 'Real' and unit else ''}." if kind in WANTED else ""
