"""OspSystemStructure.xml read: the configuration file of the Open Simulation Platform, as a system ready to run.

What its elements mean is what libcosim (tried: libcosimpy 0.0.6) makes of them, where that is known.
"""

from math import isfinite
from pathlib import Path
from urllib.parse import unquote, urlsplit
from urllib.request import url2pathname

from shipcosim.errors import it_has, suggestion
from shipcosim.ssp.flatten.array_sizes import resized, sizes_wanted
from shipcosim.ssp.flatten.assemble import components_of, parameter_sets, remark_unconnected
from shipcosim.ssp.flatten.bindings import apply_set
from shipcosim.ssp.flatten.connections import Connection
from shipcosim.ssp.flatten.hierarchy import Hierarchy
from shipcosim.ssp.flatten.ports import Setting
from shipcosim.ssp.flatten.start_values import Settings
from shipcosim.ssp.flatten.system import System
from shipcosim.ssp.fmu.arrays import without_arrays
from shipcosim.ssp.fmu.reader import describe_fmu
from shipcosim.ssp.osp.functions import Wiring, read_function
from shipcosim.ssp.osp.groups import file_names, read_groups
from shipcosim.ssp.osp.schema import NAMESPACE, validate_osp
from shipcosim.ssp.osp.times import own_step, read_experiment
from shipcosim.ssp.read.parameters import ParameterValue
from shipcosim.ssp.read.structure import FMU, ComponentElement
from shipcosim.ssp.xml.document import local, read_document, reporting
from shipcosim.ssp.xml.values import read_value
from shipcosim.units import find_unit, relation

OSP_STRUCTURE = "OspSystemStructure.xml"
SOURCES = ("output", "calculatedParameter")
HERE = ("", "file")
"""Schemes of addresses that mean a file."""


def osp_file(path):
    """OspSystemStructure.xml that a path means, itself or in a folder without an SSD, or None."""
    path = Path(path)
    if path.is_dir() and not (path / "SystemStructure.ssd").is_file():
        path = path / OSP_STRUCTURE
    return path if path.suffix.lower() == ".xml" and path.is_file() else None


def assemble_osp(path, parameters, fmus, findings):
    """System of an OspSystemStructure.xml.

    Parameters
    ----------
    path : Path
        The file.
    parameters : path or ParameterSet, or iterable of them
        Applied over its initial values.
    fmus : iterable of path
        Folders searched for FMUs that are not where it says.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    System, None or incomplete where there are errors
    """
    document = read_document(path, str(path), findings)
    if document is None or not _is_osp(document, findings):
        return None
    before = len(findings.errors)
    validate_osp(document, findings)
    if len(findings.errors) > before:
        return None
    before, sets = list(findings.problems), list(parameter_sets(parameters, findings))
    folders = [Path(folder) for folder in fmus]
    system = _Reader(document, folders, findings).system(sets)
    if any(found for component in system.components.values() for found in resized(component)):
        findings.problems[:] = before
        system = _Reader(document, folders, findings, sizes_wanted(system.components)).system(sets)
    return system


def _is_osp(document, findings):
    if document.root.tag == f"{{{NAMESPACE}}}OspSystemStructure":
        return True
    found = f"Its outermost element is <{local(document.root)}> of '{document.root.tag.partition('}')[0].lstrip('{')}'."
    remedy = f'Right would be <OspSystemStructure xmlns="{NAMESPACE}">.'
    findings.error(document.place(document.root), found, remedy)
    return False


class _Reader:
    """Reads one document that keeps its schema."""

    def __init__(self, document, fmus, findings, sizes=None):
        self.document, self.searched, self.findings, self.sizes = document, fmus, findings, sizes or {}
        self.tree, self._described, self._groups = Hierarchy(findings), {}, {}
        self.functions, self.connections, self._fed = {}, [], {}

    def system(self, sets):
        for element in self._parts("Simulators"):
            self._simulator(element)
        for element in self._parts("Functions"):
            self._function(element)
        self._connect()
        for values in sets:
            apply_set(self.tree, values)
        settings = Settings(self.tree, self.findings)
        settings.apply()
        components = components_of(self.tree, settings)
        experiment = read_experiment(self.document, self.findings)
        remark_unconnected(components, self.connections, self.findings)
        return System(
            name=Path(self.document.file).resolve().parent.name,
            file=self.document.file,
            components=components,
            connections=tuple(self.connections),
            experiment=experiment,
            remarks=tuple(dict.fromkeys(self.findings.remarks)),
        )

    def _parts(self, name):
        return [part for listed in self.document.root if local(listed) == name for part in listed if local(part)]

    def _place(self, element, what=""):
        return self.document.place(element, what)

    # ---------------------------------------------------------------- simulators

    def _simulator(self, element):
        name = element.get("name")
        place = self._place(element, name)
        if (name,) in self.tree.components:
            self.findings.error(place, f"A second simulator is named '{name}'.", "Names must differ.")
            return
        fmu = self._fmu(element.get("source"), place)
        step = own_step(self.document, element, self.findings)
        described = ComponentElement(name, element.get("source"), FMU, "any", (), (), step, place)
        fmu = fmu and without_arrays(fmu, place, self.findings, self.sizes.get(name))
        self.tree.components[name,] = described, fmu
        self.tree.arrays[name,] = {} if fmu is None else dict(fmu.arrays)
        for initial in element.iter(f"{{{NAMESPACE}}}InitialValue"):
            self._initial(name, initial)

    def _initial(self, name, element):
        variable = element.get("variable")
        (typed,) = (part for part in element if local(part))
        place = self._place(element, f"{name}.{variable}")
        with reporting(self.document, element, self.findings, f"{name}.{variable}"):
            value = read_value(local(typed), typed.get("value"))
            given = ParameterValue(variable, local(typed), value, place=place)
            self.tree.settings.append(Setting((name,), variable, given, near=True))

    def _fmu(self, source, place):
        file = self._located(source, place)
        if file is None:
            return None
        if file not in self._described:
            self._described[file] = describe_fmu(file, self.findings)
        return self._described[file]

    def _located(self, source, place):
        """File that a source means, or None with an error; it may lie anywhere, as in OSP's own examples."""
        try:
            parts = urlsplit(source)
            if parts.scheme not in HERE:
                remedy = "Name the FMU's file: proxies and servers of FMUs are not supported."
                self.findings.error(place, f"'{source}' is an address of the kind '{parts.scheme}'.", remedy)
                return None
            path = url2pathname(parts.path) if parts.scheme else unquote(parts.path)
            paths = [self.document.folder / path, self.document.folder / source]
            paths += [folder / Path(path).name for folder in self.searched]
            found = next((path for path in paths if path.is_file()), None)
        except (ValueError, OSError) as error:
            self.findings.error(place, f"'{source[:80]}' is no usable address: {error}.")
            return None
        if found is None:
            there = {file.name for file in paths[0].parent.glob("*.fmu")} if paths[0].parent.is_dir() else ()
            remedy = f"In {paths[0].parent} there{suggestion(paths[0].name, there).removeprefix('There')}"
            self.findings.error(place, f"The file '{source}' does not exist.", remedy)
        return found

    # ---------------------------------------------------------------- connections

    def _function(self, element):
        name = element.get("name")
        place = self._place(element, name)
        if name in self.functions or (name,) in self.tree.components:
            self.findings.error(place, f"'{name}' is the name of something else already.", "Names must differ.")
            return
        if not all(isfinite(float(element.get(part, 0.0))) for part in ("factor", "offset")):
            self.findings.error(place, "Its factor or offset is no finite number.")
            return
        function = read_function(element, place, self.findings)
        if function is not None:
            self.functions[name] = function

    def _connect(self):
        self.wiring = Wiring(self.functions, self.findings)
        kinds = {"Signal": self._signal, "SignalGroup": self._signal_group}
        for element in self._parts("Connections"):
            ends = {local(part): part for part in element if local(part)}
            shown = " - ".join(_shown(part) for part in element if local(part))
            place = self._place(element, shown)
            if element.get("powerBond"):
                self.findings.remark(place, "powerBond is not used: it is for the algorithm ecco alone.")
            if kind := next((name for name in kinds if name in ends), None):
                variable = ends["Variable" if kind == "Signal" else "VariableGroup"]
                kinds[kind](variable, ends[kind], place)
            else:
                self._pair(*(part for part in element if local(part)), place)
        for signal, connection in self.wiring.connections():
            self._add(connection, signal)

    def _pair(self, one, other, place):
        """A connection of two variables, or of the variables of two groups one by one."""
        if local(one) == "Variable":
            ends = [self._end(part, place) for part in (one, other)]
            if None not in ends:
                self._direct(*ends, place)
            return
        groups = [self._group(part, place) for part in (one, other)]
        if None not in groups:
            self._join(groups, [one.get("simulator"), other.get("simulator")], place)

    def _join(self, groups, simulators, place):
        """Connect two groups: the groups in them by their order, and so their variables."""
        counts = [(len(group.variables), len(group.groups)) for group in groups]
        if counts[0] != counts[1]:
            names = [f"{simulator}.{group.name}" for simulator, group in zip(simulators, groups, strict=True)]
            found = f"{names[0]} has {_counted(*counts[0])}, {names[1]} {_counted(*counts[1])}."
            self.findings.error(place, found, "Connect groups of one make.")
            return
        if groups[0].kind != groups[1].kind:
            found = f"A {groups[0].kind} is connected to a {groups[1].kind}, one variable after the other."
            self.findings.remark(place, found)
        for inner in zip(groups[0].groups, groups[1].groups, strict=True):
            self._join(inner, simulators, place)
        for pair in zip(groups[0].variables, groups[1].variables, strict=True):
            ends = list(zip(simulators, pair, strict=True))
            if all(self._variable(end) is not None for end in ends):
                self._direct(*ends, place)

    def _direct(self, one, other, place):
        """A connection in the direction that the causalities say."""
        source, target = (one, other) if self._variable(one).causality in SOURCES else (other, one)
        self._add(Connection(source, target, place=place))

    def _add(self, connection, signal=None):
        """Keep a connection; `signal` is the one of a function that it comes from, which may add up several."""
        source, target = (self._variable(end) for end in (connection.source, connection.target))
        names, place = [".".join(end) for end in (connection.source, connection.target)], connection.place
        feeding = self._fed.get(connection.target)
        self._fed[connection.target] = signal or (place,)
        if source.causality not in SOURCES or target.causality != "input":
            found = f"{names[0]} is of causality {source.causality}, {names[1]} {target.causality}."
            self.findings.error(place, found, "A connection leads from an output to an input.")
        elif source.kind != target.kind or (signal and target.kind != "Real"):
            found = f"{names[0]} is {source.kind}, {names[1]} is {target.kind}."
            remedy = "Functions take and give Real alone." if signal else "Connect equal types."
            self.findings.error(place, found, remedy)
        elif feeding is not None and feeding != signal:
            self.findings.error(place, f"A second connection into {names[1]}.", "Remove one of them.")
        else:
            if (connection.factor, connection.offset) == (1.0, 0.0):
                self._compare_units(connection, names)
            self.connections.append(connection)

    def _compare_units(self, connection, names):
        units = []
        for name, variable in (connection.source, connection.target):
            fmu = self.tree.components[name,][1]
            units.append(find_unit(fmu.variables[variable].unit, fmu.units))
        if None not in units and relation(*units) in ("convertible", "incompatible"):
            found = f"{names[0]} is in {units[0].name}, {names[1]} in {units[1].name}: OSP converts no units."
            self.findings.remark(connection.place, found, "Put a LinearTransformation between them.")

    def _signal(self, variable, signal, place):
        end = self._end(variable, place)
        if self._has_function(signal, place):
            self.wiring.take(signal.get("function"), signal.get("name"), end, place)

    def _signal_group(self, group, signal, place):
        found = self._group(group, place)
        if not self._has_function(signal, place):
            return
        function, name = self.functions[signal.get("function")], signal.get("name")
        if name not in function.groups:
            text = f"The {function.kind} '{function.name}' has no group of signals '{name}'."
            self.findings.error(place, text, it_has(name, function.groups))
            return
        if found is None:
            self.wiring.give_up(function.name)
            return
        if len(found.variables) != function.dimension:
            self.wiring.give_up(function.name)
            text = f"{group.get('simulator')}.{found.name} has {_counted(len(found.variables), 0)}, "
            self.findings.error(place, f"{text}{function.name} the dimension {function.dimension}.")
            return
        for j, variable in enumerate(found.variables):
            end = group.get("simulator"), variable
            self.wiring.take(function.name, f"{name}[{j}]", end if self._variable(end) else None, place)

    def _has_function(self, signal, place):
        name = signal.get("function")
        if name not in self.functions:
            self.findings.error(place, f"There is no function '{name}'.", suggestion(name, self.functions))
        return name in self.functions

    def _group(self, element, place):
        simulator, name = element.get("simulator"), element.get("name")
        fmu = self._known(simulator, place)
        if fmu is None:
            return None
        if fmu.path not in self._groups:
            self._groups[fmu.path] = read_groups(fmu, self.document.folder, self.findings)
        groups = self._groups[fmu.path]
        if groups is None:
            found = f"The variable groups of {fmu.path.name} are described nowhere."
            self.findings.error(place, found, f"Put {file_names(fmu)[0]} beside it.")
        elif name not in groups:
            self.findings.error(place, f"{simulator} has no variable group '{name}'.", it_has(name, groups))
        return (groups or {}).get(name)

    def _end(self, element, place):
        """(simulator, variable) that an end means, or None with an error."""
        simulator, name = element.get("simulator"), element.get("name")
        fmu = self._known(simulator, place)
        if fmu is None:
            return None
        if name not in fmu.variables:
            self.findings.error(place, f"{simulator} has no variable '{name}'.", it_has(name, fmu.variables))
            return None
        return simulator, name

    def _known(self, simulator, place):
        """FMU of a simulator, or None, with an error unless there is one already."""
        if (simulator,) not in self.tree.components:
            known = [".".join(path) for path in self.tree.components]
            self.findings.error(place, f"There is no simulator '{simulator}'.", suggestion(simulator, known))
            return None
        return self.tree.components[simulator,][1]

    def _variable(self, end):
        fmu = self.tree.components[end[0],][1]
        return fmu.variables.get(end[1])


def _shown(element):
    return f"{element.get('simulator') or element.get('function')}.{element.get('name')}"


def _counted(variables, groups):
    text = f"{variables} variable{'s' * (variables != 1)}"
    return text + (f" and {groups} group{'s' * (groups != 1)}" if groups else "")
