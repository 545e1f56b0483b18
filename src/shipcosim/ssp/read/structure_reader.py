"""Reader of the SSD: each of its elements becomes a record of `shipcosim.ssp.read.structure`."""

from collections.abc import Iterable, Mapping

import lxml.etree as etree

from shipcosim.errors import suggestion
from shipcosim.ssp.read.attributes import annotated_number, attribute, whole_numbers
from shipcosim.ssp.read.parameters import has_root, read_transformation
from shipcosim.ssp.read.structure import (
    FMU,
    KIND_NAMES,
    Binding,
    ComponentElement,
    Connector,
    DictionaryReference,
    Experiment,
    Link,
    Source,
    Structure,
    SystemElement,
    label,
)
from shipcosim.ssp.xml.annotations import STEP_SIZE_HINTS, STEP_SIZES, remark_ignored
from shipcosim.ssp.xml.definitions import noted_units, read_enumerations
from shipcosim.ssp.xml.document import (
    Document,
    Findings,
    child,
    children,
    is_true,
    local,
    parts_in,
    reporting,
)
from shipcosim.ssp.xml.schemas import is_slip
from shipcosim.ssp.xml.validation import validate
from shipcosim.ssp.xml.values import KINDS, typed_part
from shipcosim.units import find_unit


def read_structure(document: Document, findings: Findings) -> Structure | None:
    """Structure of an SSD document, or None if it breaks the schema.

    Parameters
    ----------
    document : Document
        The file.
    findings : Findings
        Takes what is wrong.
    """
    if not has_root(document, "ssd:SystemStructureDescription", findings):
        return None
    # A missing system is reported once, by the schema or here.
    root = document.root
    sound = validate(root, "ssd", document.file, findings)
    system = child(root, "ssd:System")
    if system is None:
        if sound:
            findings.error(
                document.place(root), "There is no System in it.", "Add <System name=...>."
            )
        return None
    # The outermost system contains all others.
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
    # Algorithms and steps in annotations that are not used deserve a remark.
    remark_ignored(document, findings)
    return structure


class _Reader:
    """Reads the elements of one document, with its units and enumerations."""

    def __init__(self, document: Document, findings: Findings):
        self.document = document
        self.findings = findings
        self.enumerations = {}
        # The schema checks kinds of connectors in version 1 only.
        self.validated = not document.root.get("version", "").startswith("2.")
        root = document.root
        # Units and enumerations first: connectors refer to them.
        self.units = noted_units(document, children(root, "ssd:Units", "ssc:Unit"), findings)
        with reporting(document, root, findings):
            self.enumerations = read_enumerations(
                children(root, "ssd:Enumerations", "ssc:Enumeration")
            )

    def place(self, element: etree._Element, what: str = "") -> str:
        return self.document.place(element, what)

    def system(self, element: etree._Element) -> SystemElement:
        readers = {
            "Component": self.component,
            "SignalDictionaryReference": self.reference,
            "System": self.system,
        }
        # Components, dictionary references and nested systems, in the order of the file.
        parts = child(element, "ssd:Elements")
        elements = (
            []
            if parts is None
            else [readers[local(part)](part) for part in parts if local(part) in readers]
        )
        # Names are unique within a system.
        name = element.get("name", "")
        self.distinct(elements, "element", name)
        return SystemElement(
            name=name,
            connectors=self.connectors(element),
            bindings=self.bindings(element),
            elements=tuple(elements),
            links=tuple(
                self.link(part) for part in children(element, "ssd:Connections", "ssd:Connection")
            ),
            dictionaries={
                part.get("name", ""): self.source(part, part, "ssb:SignalDictionary")
                for part in children(element, "ssd:SignalDictionaries", "ssd:SignalDictionary")
            },
            annotated_step_size=annotated_number(self.document, element, STEP_SIZES, self.findings),
            place=self.place(element, name),
            id=element.get("id"),
        )

    def component(self, element: etree._Element) -> ComponentElement:
        name = element.get("name", "")
        return ComponentElement(
            name=name,
            source=element.get("source"),
            type=element.get("type", FMU),
            implementation=element.get("implementation", "any"),
            connectors=self.connectors(element),
            bindings=self.bindings(element),
            step_size=annotated_number(self.document, element, STEP_SIZE_HINTS, self.findings),
            place=self.place(element, name),
        )

    def reference(self, element: etree._Element) -> DictionaryReference:
        name = element.get("name", "")
        dictionary = element.get("dictionary", "")
        return DictionaryReference(
            name, dictionary, self.connectors(element), self.place(element, name)
        )

    def connectors(self, element: etree._Element) -> tuple[Connector, ...]:
        owner = element.get("name", "")
        connectors = [
            self.connector(part, owner)
            for part in children(element, "ssd:Connectors", "ssd:Connector")
        ]
        self.distinct(connectors, "connector", owner)
        return tuple(connectors)

    def connector(self, element: etree._Element, owner: str) -> Connector:
        # The type is an element; without one the SSD leaves it open.
        typed = typed_part(element)
        name = element.get("name", "")
        kind = element.get("kind", "")
        place = self.place(element, f"{owner}.{name}")
        if kind not in KIND_NAMES and not self.validated:
            self.findings.error(
                place,
                f"The kind of connector '{kind}' does not exist.",
                f"Kinds: {', '.join(KIND_NAMES)}.",
            )
        return Connector(
            name=name,
            kind=kind,
            type=None if typed is None else KINDS[local(typed)],
            unit=None if typed is None else find_unit(typed.get("unit"), self.units),
            items=self.items(typed, place),
            description=element.get("description", ""),
            place=place,
            dimensions=tuple(
                attribute(self.document, part, "size", "Integer", self.findings)
                for part in parts_in(element, "Dimension")
            ),
        )

    def items(self, typed: etree._Element | None, place: str) -> Mapping[str, int]:
        if typed is None or local(typed) != "Enumeration":
            return {}
        name = typed.get("name", "")
        # A similar name is a typing error; otherwise the FMU's items are used.
        if name not in self.enumerations:
            what = (
                f"The enumeration '{name}' is not defined in this file."
                if name
                else "The enumeration has no name."
            )
            if is_slip(name, self.enumerations):
                self.findings.error(place, what, suggestion(name, self.enumerations))
            else:
                self.findings.flaw(
                    place,
                    f"{what} Its items are those of the variable, where there is one.",
                    "Add it to Enumerations.",
                )
        return self.enumerations.get(name, {})

    def distinct(self, named: Iterable, what: str, owner: str) -> None:
        seen = set()
        for part in named:
            if part.name in seen:
                self.findings.error(
                    part.place, f"{owner} has a second {what} '{part.name}'.", "Names must differ."
                )
            seen.add(part.name)

    def link(self, element: etree._Element) -> Link:
        # Both ends, with the element or without one for the system itself.
        ends = [
            element.get(key)
            for key in ("startElement", "startConnector", "endElement", "endConnector")
        ]
        shown = " -> ".join(label((ends[i], ends[i + 1] or "")) for i in (0, 2))
        return Link(
            ends[0],
            ends[1] or "",
            ends[2],
            ends[3] or "",
            transformation=read_transformation(self.document, element, self.findings),
            suppress_unit_conversion=is_true(element.get("suppressUnitConversion")),
            place=self.place(element, shown),
            start_indices=whole_numbers(self.document, element, "startIndices", self.findings),
            end_indices=whole_numbers(self.document, element, "endIndices", self.findings),
        )

    def bindings(self, element: etree._Element) -> tuple[Binding, ...]:
        bindings = children(element, "ssd:ParameterBindings", "ssd:ParameterBinding")
        return tuple(self.binding(part) for part in bindings)

    def binding(self, element: etree._Element) -> Binding:
        mapping = child(element, "ssd:ParameterMapping")
        return Binding(
            values=self.source(element, child(element, "ssd:ParameterValues"), "ssv:ParameterSet"),
            mapping=None
            if mapping is None
            else self.source(mapping, mapping, "ssm:ParameterMapping"),
            prefix=element.get("prefix", ""),
        )

    def source(self, element: etree._Element, container: etree._Element | None, tag: str) -> Source:
        # Exactly one of source and inline content.
        inline = None if container is None else child(container, tag)
        place = self.place(element, local(element))
        if element.get("source") and inline is not None:
            self.findings.error(place, "It has a source and the same inline.", "Keep one of them.")
        if not element.get("source") and inline is None:
            self.findings.error(
                place,
                "It has neither a source nor content.",
                f"Give a source or an inline <{tag}>.",
            )
        document = (
            None if inline is None else Document(self.document.file, inline, self.document.folder)
        )
        return Source(
            element.get("source"), document, element.get("sourceBase") == "component", place
        )

    def experiment(self) -> Experiment:
        element = child(self.document.root, "ssd:DefaultExperiment")
        if element is None:
            return Experiment()
        # A run needs a stop after its start.
        start, stop = (
            attribute(self.document, element, name, "Real", self.findings)
            for name in ("startTime", "stopTime")
        )
        start = start or 0.0
        if stop is not None and stop <= start:
            place = self.place(element, "DefaultExperiment")
            self.findings.error(
                place,
                f"startTime is {start:g}, stopTime {stop:g}.",
                "The stop comes after the start.",
            )
        return Experiment(
            start, stop, annotated_number(self.document, element, STEP_SIZES, self.findings)
        )
