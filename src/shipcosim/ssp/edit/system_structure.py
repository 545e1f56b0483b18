"""A system structure that can be changed: read, edited in SSP's words, written as the same system or the changed one.

The XML itself is what is edited, so that everything nobody asked to change comes out as it was: annotations of other
tools, geometry, descriptions, files of any kind in the package.
"""

import tempfile
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import quote

from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.ssp.check import problems_of
from shipcosim.ssp.edit.connectors import declare, declare_variable
from shipcosim.ssp.edit.draft import Draft
from shipcosim.ssp.edit.experiment import write_step_size
from shipcosim.ssp.edit.names import attached, best_pair, connections, find_connector, find_element, split_owner, walk
from shipcosim.ssp.edit.start_values import StartValues
from shipcosim.ssp.fmu.description import read_fmu
from shipcosim.ssp.osp.reader import osp_file
from shipcosim.ssp.read.package import SYSTEM_STRUCTURE, Package, open_package
from shipcosim.ssp.read.parameters import has_root
from shipcosim.ssp.read.structure import FMU, KIND_NAMES
from shipcosim.ssp.xml.annotations import step_sizes
from shipcosim.ssp.xml.definitions import read_units
from shipcosim.ssp.xml.document import Document, Findings, child, children, local, parse
from shipcosim.ssp.xml.markup import add, add_osp, drop, ensure
from shipcosim.units import find_unit

EMPTY = """<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
  version="1.0" name="">
  <ssd:System name=""/>
</ssd:SystemStructureDescription>
"""


def read(path, *, fmus=None):
    """Read a system structure to look at it, change it, run it, write it.

    Parameters
    ----------
    path : path
        A .ssp (with ``#Variant.ssd`` behind it for another SSD), a folder with a SystemStructure.ssd, or a .ssd.
    fmus : iterable of path, optional
        Folders searched for FMUs that are not beside the SSD; build/fmus of the project around it if not given.

    Returns
    -------
    SystemStructure
        It may have faults: `check` tells them.

    Raises
    ------
    ShipcosimError
        If there is no such file, or no system structure in it.
    """
    findings = Findings()
    if osp_file(path):
        found = "An OspSystemStructure.xml cannot be edited."
        raise ShipcosimError(Problem(str(path), found, "`simulate` and `read_system` take it."))
    package = open_package(path, findings, built_fmus(path) if fmus is None else fmus)
    document = None if package is None else package.document(findings)
    if document is not None and has_root(document, "ssd:SystemStructureDescription", findings):
        if child(document.root, "ssd:System") is None:
            findings.error(document.place(document.root), "There is no System in it.", "Add <System name=...>.")
    if findings.errors:
        raise ShipcosimError(findings.errors)
    return SystemStructure(Draft(package, document, str(path)))


def built_fmus(path):
    """Folder build/fmus of the project around a system, in a list; empty where there is none."""
    start = Path(str(path).partition("#")[0]).resolve()
    return [folder for above in (start, *start.parents) if (folder := above / "build" / "fmus").is_dir()][:1]


def new(name):
    """An empty system structure.

    Parameters
    ----------
    name : str
        Of the system.

    Returns
    -------
    SystemStructure
    """
    folder = tempfile.TemporaryDirectory(prefix="shipcosim-")
    root = parse(EMPTY.encode(), name, Findings())
    for element in (root, child(root, "ssd:System")):
        element.set("name", name)
    package = Package(Path(folder.name), name, unpacked=folder)
    document = Document(f"{name}/{SYSTEM_STRUCTURE}", root, package.folder)
    return SystemStructure(Draft(package, document, name))


class SystemStructure:
    """A system structure that can be changed; made by `read` and `new`.

    Elements are named with the systems around them (``"ship.vessel"``), connectors and parameters with their element
    (``"ship.vessel.mass"``); what belongs to the outermost system has its name alone. A change that would make the
    system wrong raises a ShipcosimError and leaves it as it was.

    Parameters
    ----------
    draft : Draft
        Holds the XML.

    Attributes
    ----------
    parameters : MutableMapping of str to value
        Start values in the FMUs' units, to be read, set and deleted.
    """

    def __init__(self, draft):
        self._draft = draft
        self.parameters = StartValues(draft)

    def __repr__(self):
        counts = f"{len(self.components)} components, {len(self.connections)} connections"
        return f"<SystemStructure {self.name!r}: {counts}>"

    @property
    def name(self):
        """Name of the system structure."""
        return self._draft.root.get("name", "")

    @property
    def elements(self):
        """Full names of all components, systems and dictionary references."""
        return [name for name, _ in walk(self._draft.system) if name]

    @property
    def components(self):
        """Components with their FMUs' descriptions by full name, those in systems of other files included."""
        system = self._draft.assembled()[0]
        return {} if system is None else dict(system.components)

    @property
    def connections(self):
        """Names of the connectors that are joined, (source, target), in the order of the file."""
        return [ends for ends, _ in connections(self._draft.system)]

    def connectors(self, element=""):
        """Kinds of an element's connectors by their names; of the outermost system's, if none is named.

        Raises
        ------
        ShipcosimError
            If there is no such element.
        """
        listed = children(self._element(element), "ssd:Connectors", "ssd:Connector")
        return {part.get("name"): part.get("kind") for part in listed}

    @property
    def start_time(self):
        """Where the default experiment starts. [s]"""
        return self._time("startTime") or 0.0

    @start_time.setter
    def start_time(self, time):
        self._set_time("startTime", time)

    @property
    def stop_time(self):
        """Where the default experiment ends, or None. [s]"""
        return self._time("stopTime")

    @stop_time.setter
    def stop_time(self, time):
        self._set_time("stopTime", time)

    @property
    def step_size(self):
        """Base step that an annotation gives, or None. Setting it writes OSP's, which libcosim needs. [s]"""
        return next((float(part.get(name)) for part, name in step_sizes(self._draft.root)), None)

    @step_size.setter
    def step_size(self, step_size):
        with self.changes():
            write_step_size(self._draft.root, float(step_size))

    def check(self, parameters=()):
        """Everything that is wrong, and remarks on what stops nothing; no binary is loaded.

        Parameters
        ----------
        parameters : path or ParameterSet, or iterable of them
            Applied over those of the system.

        Returns
        -------
        list of Problem
        """
        return problems_of(*self._draft.assemble(parameters))

    def checked(self, parameters=()):
        """The system ready to run, as `shipcosim.ssp.read_system` gives it.

        Parameters
        ----------
        parameters : path or ParameterSet, or iterable of them
            Applied over those of the system.

        Raises
        ------
        ShipcosimError
            With everything that is wrong.
        """
        system, findings = self._draft.assemble(parameters)
        if findings.errors:
            raise ShipcosimError(list(dict.fromkeys(findings.errors)))
        return system

    @contextmanager
    def changes(self):
        """Take the changes of a ``with`` block as one: checked at its end, and all undone if something is wrong.

        Examples
        --------
        >>> system = new("voyage")
        >>> with system.changes():
        ...     system.add_system("ship")
        ...     system.add_connector("ship.speed", "output", unit="m/s")
        >>> system.elements, system.connectors("ship")
        (['ship'], {'speed': 'output'})
        """
        with self._draft.changes():
            yield self

    def add_component(self, name, fmu, *, kinds=("input", "output"), implementation=None, step_size=None):
        """Add a component with the connectors that its FMU's model description gives, and their units.

        Parameters
        ----------
        name : str
            ``"tow"``, or ``"ship.tow"`` for one in a nested system.
        fmu : path
            The FMU. It comes along when the system is written.
        kinds : iterable of str
            Kinds of the variables that get a connector. Parameters need none to be set.
        implementation : str, optional
            ``"CoSimulation"`` or ``"ModelExchange"``, where the FMU offers both.
        step_size : float, optional
            The component's own step, as an OSP annotation. [s]

        Raises
        ------
        ShipcosimError
            If the FMU cannot be read, or the name is taken.
        """
        with self.changes():
            description = read_fmu(fmu)
            source = self._draft.resource(Path(fmu))
            element = self._add_element(name, "Component", type=FMU, source=source, implementation=implementation)
            for variable in description.variables.values():
                if variable.causality in kinds:
                    declare_variable(element, variable, description, self._draft.root)
            if step_size is not None:
                add_osp(self._draft.root, element, "StepSizeHint", value=repr(float(step_size)))

    def add_system(self, name):
        """Add a nested system without content."""
        with self.changes():
            self._add_element(name, "System")

    def add_connector(self, name, kind, *, type="Real", unit=None, description=""):
        """Add a connector to the outermost system, or to a nested one (``"ship.speed"``).

        Parameters
        ----------
        name : str
            Of the connector.
        kind : str
            ``"input"``, ``"output"`` or ``"parameter"``.
        type : str
            Real, Integer, Boolean or String.
        unit : str, optional
            Of a Real, in FMI's spelling.
        description : str
            One line.

        Raises
        ------
        ShipcosimError
            If there is no such system or kind, or it has a connector of this name.
        """
        if kind not in KIND_NAMES:
            raise self._error(name, f"There is no kind '{kind}'.", suggestion(kind, KIND_NAMES))
        with self.changes():
            root = self._draft.root
            owner, short = self._owner(name)
            defined = find_unit(unit, read_units(children(root, "ssd:Units", "ssc:Unit")))
            declare(owner, short, kind, type, defined, ("", {}), description, root)

    def connect(self, source, target, *, factor=None, offset=None, suppress_unit_conversion=False):
        """Connect two connectors of one system; what the FMU has and the SSD does not declare yet is declared.

        Parameters
        ----------
        source, target : str
            ``"tow.force_X"``; a connector of the outermost system by its name alone.
        factor, offset : float, optional
            target = factor * source + offset, after the conversion of units.
        suppress_unit_conversion : bool
            Leave the value as it is even if units differ.

        Raises
        ------
        ShipcosimError
            If there is no such connector, the target is connected already, or types or units do not fit.
        """
        with self.changes():
            draft = self._draft
            ends = best_pair(source, target, draft.system, self._exists, draft.package.show(draft.path))
            for end in ends:
                self._declare(end)
            start, end = reversed(ends) if ends[0].gives() is False or ends[1].gives() else ends
            names = {
                "startElement": start.element_name,
                "startConnector": start.connector,
                "endElement": end.element_name,
                "endConnector": end.connector,
                "suppressUnitConversion": "true" if suppress_unit_conversion else None,
            }
            connection = add(ensure(start.system, "ssd:Connections"), "ssd:Connection", **names)
            given = {"factor": factor, "offset": offset}
            texts = {name: repr(float(number)) for name, number in given.items() if number is not None}
            if texts:
                add(connection, "ssc:LinearTransformation", **texts)

    def disconnect(self, source, target=None):
        """Remove the connection of two connectors, in either order; without `target` all connections of one.

        Raises
        ------
        ShipcosimError
            If there is none.
        """
        wanted = {source, target} - {None}
        found = [element for ends, element in connections(self._draft.system) if wanted <= set(ends)]
        if not found:
            near = [" -> ".join(ends) for ends in self.connections if wanted & set(ends)]
            shown = " -> ".join(filter(None, (source, target)))
            known = near or [" -> ".join(ends) for ends in self.connections]
            raise self._error(shown, "There is no such connection.", suggestion(shown, known))
        with self.changes():
            for element in found:
                drop(element)

    def remove(self, name):
        """Remove an element with its connections and values, or a connector with its connections.

        Raises
        ------
        ShipcosimError
            If there is no such element or connector.
        """
        with self.changes():
            is_element = name in self.elements
            named = self._element(name) if is_element else self._connector(name)
            for element in self._attached(name):
                drop(element)
            drop(named)
            self._draft.sets.rename(name, None, exact=not is_element)

    def rename(self, old, new):
        """Rename an element or a system's connector; connections and parameter sets follow.

        Parameters
        ----------
        old : str
            Its full name: ``"ship.vessel"``.
        new : str
            Its own new name, without the systems around it: ``"hull"``.

        Raises
        ------
        ShipcosimError
            If there is no such element or connector, or the new name is taken.
        """
        with self.changes():
            is_element = old in self.elements
            named = self._element(old) if is_element else self._connector(old)
            owner = named.getparent().getparent()
            if local(owner) == "Component":
                raise self._error(old, "It is named by the FMU.", "Connectors of systems can be renamed.")
            short = named.get("name")
            full = old.removesuffix(short) + new
            if full in self.elements or any(part.get("name") == new for part in named.getparent() if part is not named):
                raise self._error(full, "The name is taken.", "Names must differ.")
            for connection, attribute in attached(self._draft.system, old, is_element):
                connection.set(attribute, new)
            named.set("name", new)
            self._draft.sets.rename(old, full, exact=not is_element)

    def set(self, name, value, unit=None, description="", tolerance=None):
        """Give a parameter or input a start value.

        A value that the system sets is changed where it stands; a new one goes to a parameter set of its component.

        Parameters
        ----------
        name : str
            ``"vessel.mass"``.
        value : float, int, bool, str
            In the FMU's unit if `unit` is not given. An enumeration's item by its name or number.
        unit : str, optional
            Unit of `value`, which is converted to the FMU's.
        description : str
            What it is and where the number comes from.
        tolerance : float, optional
            Standard deviation within which it counts as known, in the FMU's unit.

        Raises
        ------
        ShipcosimError
            If there is no such parameter, or the value does not fit.
        """
        with self.changes():
            self.parameters.put(name, value, unit, description, tolerance)

    def bind(self, source, element="", *, prefix=None):
        """Bind a parameter set in a file to an element or, without one, to the outermost system; the last one wins.

        Parameters
        ----------
        source : path
            An .ssv: a file of the package (``"resources/thesis.ssv"``) or any other, which comes along.
        element : str
            Full name.
        prefix : str, optional
            Before the names in the set.

        Raises
        ------
        ShipcosimError
            If there is no such file or element, or what is in the set does not fit.
        """
        with self.changes():
            inside = (self._draft.path.parent / source).resolve()
            there = not Path(source).is_absolute() and (inside in self._draft.package.held or inside.is_file())
            if not there and not Path(source).is_file():
                raise self._error(str(source), "There is no such file, in the package or elsewhere.")
            uri = quote(Path(source).as_posix()) if there else self._draft.resource(Path(source))
            listed = ensure(self._element(element), "ssd:ParameterBindings")
            add(listed, "ssd:ParameterBinding", source=uri, prefix=prefix)

    def unbind(self, source, element=""):
        """Remove the binding of a parameter set in a file from an element, the outermost system if none is named.

        Raises
        ------
        ShipcosimError
            If it is not bound there.
        """
        listed = children(self._element(element), "ssd:ParameterBindings", "ssd:ParameterBinding")
        found = [part for part in listed if part.get("source") == quote(str(source))]
        if not found:
            known = [part.get("source") for part in listed if part.get("source")]
            raise self._error(str(source), "It is not bound there.", suggestion(str(source), known))
        with self.changes():
            for part in found:
                drop(part)

    def bind_to_components(self):
        """Give each component one set with all its values in its FMU's units, instead of those bound to systems.

        The system stays the same. libcosim takes the first set of each component and no others, and converts no units.
        Values for elements that the system does not have get lost.

        Raises
        ------
        ShipcosimError
            If the system has errors.
        """
        self.checked()
        with self.changes():
            self.parameters.bind_to_components()

    def copy(self):
        """One more of it, changed independently."""
        return SystemStructure(self._draft.copy())

    def write(self, path, *, fmus=True):
        """Write the system with everything that belongs to it; what was not changed stays the same.

        Parameters
        ----------
        path : path
            Ends in .ssp: one packed file. In .ssd: an SSD, and beside it what it refers to. Else: a folder.
        fmus : bool
            Whether FMUs that were not in the package come along; a .ssp always has them.

        Raises
        ------
        ShipcosimError
            With everything that is wrong with the system, or if it cannot be written.
        """
        self.checked()
        self._draft.write(Path(path), fmus)

    # what the methods above share

    def _error(self, what, found, remedy=""):
        return ShipcosimError(self._draft.problem(what, found, remedy))

    def _element(self, name):
        element = find_element(self._draft.system, name)
        if element is None:
            raise self._error(name, "There is no such element.", suggestion(name, self.elements))
        return element

    def _connector(self, name):
        connector = find_connector(self._draft.system, name)
        if connector is None:
            known = [*self.elements, *self.connectors()]
            raise self._error(name, "There is no such element or connector.", suggestion(name, known))
        return connector

    def _attached(self, name):
        """Connections of an element or connector."""
        pairs = attached(self._draft.system, name, name in self.elements)
        return list(dict.fromkeys(connection for connection, _ in pairs))

    def _owner(self, name):
        """System that something new belongs to by its full name, and its own name there."""
        owner, short = split_owner(self._draft.system, name)
        if owner is None:
            systems = [known for known, part in walk(self._draft.system) if known and local(part) == "System"]
            outer = name.rpartition(".")[0]
            raise self._error(name, f"There is no system '{outer}' to put it into.", suggestion(outer, systems))
        return owner, short

    def _add_element(self, name, tag, **attributes):
        owner, short = self._owner(name)
        if name in self.elements:
            raise self._error(name, f"{owner.get('name')} has an element '{short}' already.", "Names must differ.")
        return add(ensure(owner, "ssd:Elements"), f"ssd:{tag}", name=short, **attributes)

    def _exists(self, reading):
        fmu = None if reading.element is None else self._draft.fmu_of(reading.element)
        return reading.declared() is not None or (fmu is not None and reading.connector in fmu.variables)

    def _declare(self, reading):
        """Give a component the connector that a connection needs, if its FMU has it."""
        if reading.element is None or reading.declared() is not None:
            return
        fmu = self._draft.fmu_of(reading.element)
        if fmu is not None and reading.connector in fmu.variables:
            declare_variable(reading.element, fmu.variables[reading.connector], fmu, self._draft.root)

    def _time(self, name):
        element = child(self._draft.root, "ssd:DefaultExperiment")
        text = None if element is None else element.get(name)
        return None if text is None else float(text)

    def _set_time(self, name, time):
        with self.changes():
            ensure(self._draft.root, "ssd:DefaultExperiment").set(name, repr(float(time)))
