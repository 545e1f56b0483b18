"""The SSD as it is written: systems, elements, connectors, connections and bindings, nothing resolved.

Reference: System Structure and Parameterization 1.0, section 5; type names of 2.0 are understood too.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from shipcosim.ssp.read.parameters import (
    Transformation,
    has_root,
    read_transformation,
)
from shipcosim.ssp.xml.annotations import STEP_SIZE_HINTS, STEP_SIZES, remark_ignored, stated
from shipcosim.ssp.xml.definitions import read_enumerations, read_units
from shipcosim.ssp.xml.document import Document, child, children, is_true, local, reporting
from shipcosim.ssp.xml.validation import validate
from shipcosim.ssp.xml.values import KINDS, read_value
from shipcosim.units import Unit, find_unit

FMU = "application/x-fmu-sharedlibrary"
SSD = "application/x-ssp-definition"
SSP = "application/x-ssp-package"
KIND_NAMES = (
    "input",
    "output",
    "parameter",
    "calculatedParameter",
    "structuralParameter",
    "constant",
    "local",
    "inout",
    "unspecified",
)


@dataclass(frozen=True)
class Connector:
    """A connector of a system, component or dictionary reference.

    Parameters
    ----------
    name : str
        Unique within its owner.
    kind : str
        ``"input"``, ``"output"``, ``"parameter"``, ``"calculatedParameter"``, ``"inout"``, ...
    type : str or None
        Real, Integer, Boolean, String, Enumeration, Binary or Clock; None where the SSD leaves it open.
    unit : Unit or None
        Of a Real.
    items : mapping of str to int
        Items of an Enumeration.
    description : str
        One line.
    place : str
        Where it stands, for messages.
    dimensions : tuple of (int or None)
        Sizes of an array; None where the SSD leaves one open.
    """

    name: str
    kind: str
    type: str | None = None
    unit: Unit | None = None
    items: Mapping = field(default_factory=dict)
    description: str = ""
    place: str = ""
    dimensions: tuple = ()


@dataclass(frozen=True)
class Link:
    """A Connection element: it joins two connectors; which way values go follows from their kinds.

    Indices name a single element of an array, counted from 1.
    """

    start_element: str | None
    start_connector: str
    end_element: str | None
    end_connector: str
    transformation: Transformation | None = None
    suppress_unit_conversion: bool = False
    place: str = ""
    start_indices: tuple[int, ...] = ()
    end_indices: tuple[int, ...] = ()


@dataclass(frozen=True)
class Source:
    """Something given inline (`inline` is set) or by address.

    Parameters
    ----------
    uri : str or None
        Address relative to the SSD or, if `in_component`, to the component.
    inline : Document or None
        The content where it stands in the SSD itself.
    """

    uri: str | None
    inline: Document | None
    in_component: bool = False
    place: str = ""


@dataclass(frozen=True)
class Binding:
    """A ParameterBinding: a set of values, what its names are prefixed with, and perhaps a mapping."""

    values: Source
    mapping: Source | None = None
    prefix: str = ""


@dataclass(frozen=True)
class ComponentElement:
    """A Component: an FMU or a system in another file; without a source it is a plan of one."""

    name: str
    source: str | None
    type: str
    implementation: str
    connectors: tuple[Connector, ...]
    bindings: tuple[Binding, ...]
    step_size: float | None
    place: str


@dataclass(frozen=True)
class DictionaryReference:
    """A SignalDictionaryReference: a window on a dictionary of this system or one around it."""

    name: str
    dictionary: str
    connectors: tuple[Connector, ...]
    place: str


@dataclass(frozen=True)
class SystemElement:
    """A System with everything in it; `dictionaries` are the sources by name."""

    name: str
    connectors: tuple[Connector, ...]
    bindings: tuple[Binding, ...]
    elements: tuple
    links: tuple[Link, ...]
    dictionaries: Mapping
    annotated_step_size: float | None
    place: str
    id: str | None = None


@dataclass(frozen=True)
class Experiment:
    """Default experiment: start and stop time and the base step size that an annotation gives. [s]"""

    start_time: float = 0.0
    stop_time: float | None = None
    step_size: float | None = None


@dataclass(frozen=True)
class Structure:
    """A whole SSD file."""

    name: str
    version: str
    system: SystemElement
    experiment: Experiment
    units: Mapping
    enumerations: Mapping
    document: Document


def read_structure(document, findings):
    """Structure of an SSD document, or None where it breaks the schema.

    Parameters
    ----------
    document : Document
        The file.
    findings : Findings
        Takes what is wrong.
    """
    if not has_root(document, "ssd:SystemStructureDescription", findings):
        return None
    root, before = document.root, len(findings.errors)
    validate(root, "ssd", document.file, findings)
    system = child(root, "ssd:System")
    if system is None:
        if len(findings.errors) == before:
            findings.error(document.place(root), "There is no System in it.", "Add <System name=...>.")
        return None
    reader = _Reader(document, findings)
    structure = Structure(
        name=root.get("name", ""),
        version=root.get("version", ""),
        system=reader.system(system),
        experiment=reader.experiment(),
        units=reader.units,
        enumerations=reader.enumerations,
        document=document,
    )
    remark_ignored(document, findings)
    return structure


class _Reader:
    """Reads the elements of one document, with its units and enumerations at hand."""

    def __init__(self, document, findings):
        self.document, self.findings = document, findings
        self.units, self.enumerations = {}, {}
        self.validated = not document.root.get("version", "").startswith("2.")
        root = document.root
        with reporting(document, root, findings):
            self.units = read_units(children(root, "ssd:Units", "ssc:Unit"))
            self.enumerations = read_enumerations(children(root, "ssd:Enumerations", "ssc:Enumeration"))

    def place(self, element, what=""):
        return self.document.place(element, what)

    def system(self, element):
        readers = {"Component": self.component, "SignalDictionaryReference": self.reference, "System": self.system}
        parts = child(element, "ssd:Elements")
        elements = [] if parts is None else [readers[local(part)](part) for part in parts if local(part) in readers]
        name = element.get("name", "")
        self.distinct(elements, "element", name)
        return SystemElement(
            name=name,
            connectors=self.connectors(element),
            bindings=self.bindings(element),
            elements=tuple(elements),
            links=tuple(self.link(part) for part in children(element, "ssd:Connections", "ssd:Connection")),
            dictionaries={
                part.get("name", ""): self.source(part, part, "ssb:SignalDictionary")
                for part in children(element, "ssd:SignalDictionaries", "ssd:SignalDictionary")
            },
            annotated_step_size=self.annotated(element, STEP_SIZES),
            place=self.place(element, name),
            id=element.get("id"),
        )

    def component(self, element):
        name = element.get("name", "")
        return ComponentElement(
            name=name,
            source=element.get("source"),
            type=element.get("type", FMU),
            implementation=element.get("implementation", "any"),
            connectors=self.connectors(element),
            bindings=self.bindings(element),
            step_size=self.annotated(element, STEP_SIZE_HINTS),
            place=self.place(element, name),
        )

    def reference(self, element):
        name = element.get("name", "")
        dictionary = element.get("dictionary", "")
        return DictionaryReference(name, dictionary, self.connectors(element), self.place(element, name))

    def connectors(self, element):
        owner = element.get("name", "")
        found = [self.connector(part, owner) for part in children(element, "ssd:Connectors", "ssd:Connector")]
        self.distinct(found, "connector", owner)
        return tuple(found)

    def connector(self, element, owner):
        typed = next((part for part in element if local(part) in KINDS), None)
        name, kind = element.get("name", ""), element.get("kind", "")
        place = self.place(element, f"{owner}.{name}")
        if kind not in KIND_NAMES and not self.validated:
            self.findings.error(
                place, f"The kind of connector '{kind}' does not exist.", f"Kinds: {', '.join(KIND_NAMES)}."
            )
        return Connector(
            name=name,
            kind=kind,
            type=None if typed is None else KINDS[local(typed)],
            unit=None if typed is None else find_unit(typed.get("unit"), self.units),
            items=self.items(typed, place),
            description=element.get("description", ""),
            place=place,
            dimensions=tuple(self.size(part) for part in element if local(part) == "Dimension"),
        )

    def size(self, element):
        """Size of a dimension, or None where another connector or nothing gives it."""
        return self.whole(element, "size", element.get("size"))

    def indices(self, element, name):
        return tuple(self.whole(element, name, text) or 0 for text in (element.get(name) or "").split())

    def whole(self, element, name, text):
        number = None
        if text is not None:
            with reporting(self.document, element, self.findings, name):
                number = read_value("Integer", text)
        return number

    def items(self, typed, place):
        if typed is None or local(typed) != "Enumeration":
            return {}
        name = typed.get("name", "")
        if name not in self.enumerations:
            self.findings.error(
                place, f"The enumeration '{name}' is not defined in this file.", "Add it to Enumerations."
            )
        return self.enumerations.get(name, {})

    def distinct(self, named, what, owner):
        seen = set()
        for one in named:
            if one.name in seen:
                self.findings.error(one.place, f"{owner} has a second {what} '{one.name}'.", "Names must differ.")
            seen.add(one.name)

    def link(self, element):
        ends = [element.get(key) for key in ("startElement", "startConnector", "endElement", "endConnector")]
        shown = " -> ".join(signal(ends[i], ends[i + 1] or "") for i in (0, 2))
        return Link(
            ends[0],
            ends[1] or "",
            ends[2],
            ends[3] or "",
            transformation=read_transformation(self.document, element, self.findings),
            suppress_unit_conversion=is_true(element.get("suppressUnitConversion")),
            place=self.place(element, shown),
            start_indices=self.indices(element, "startIndices"),
            end_indices=self.indices(element, "endIndices"),
        )

    def bindings(self, element):
        found = children(element, "ssd:ParameterBindings", "ssd:ParameterBinding")
        return tuple(self.binding(part) for part in found)

    def binding(self, element):
        mapping = child(element, "ssd:ParameterMapping")
        return Binding(
            values=self.source(element, child(element, "ssd:ParameterValues"), "ssv:ParameterSet"),
            mapping=None if mapping is None else self.source(mapping, mapping, "ssm:ParameterMapping"),
            prefix=element.get("prefix", ""),
        )

    def source(self, element, container, tag):
        inline = None if container is None else child(container, tag)
        place = self.place(element, local(element))
        if element.get("source") and inline is not None:
            self.findings.error(place, "It has a source and the same inline.", "Keep one of them.")
        if not element.get("source") and inline is None:
            self.findings.error(place, "It has neither a source nor content.", f"Give a source or an inline <{tag}>.")
        document = None if inline is None else Document(self.document.file, inline, self.document.folder)
        return Source(element.get("source"), document, element.get("sourceBase") == "component", place)

    def experiment(self):
        element = child(self.document.root, "ssd:DefaultExperiment")
        if element is None:
            return Experiment()
        start, stop = (self.number(element, name) for name in ("startTime", "stopTime"))
        start = start or 0.0
        if stop is not None and stop <= start:
            place, found = self.place(element, "DefaultExperiment"), f"startTime is {start:g}, stopTime {stop:g}."
            self.findings.error(place, found, "The stop comes after the start.")
        return Experiment(start, stop, self.annotated(element, STEP_SIZES))

    def annotated(self, element, names):
        """Number that an annotation of any tool gives under one of these names, or None."""
        found = next(stated(element, names), None)
        return None if found is None else self.positive(*found)

    def positive(self, element, name):
        number = self.number(element, name)
        if number is not None and number <= 0.0:
            self.findings.error(self.place(element, local(element)), f"{name} is {number:g}.", "It must be positive.")
        return number

    def number(self, element, name):
        number = None
        if element.get(name) is not None:
            with reporting(self.document, element, self.findings, name):
                number = read_value("Real", element.get(name))
        return number


def signal(element, connector):
    """Name of a connector as users write it: ``component.connector``, or the connector alone on the system itself."""
    return connector if element is None else f"{element}.{connector}"
