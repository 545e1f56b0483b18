"""Input to the portability checks: an SSP as written in its outermost file, and as resolved."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property

import lxml.etree as etree

from shipcosim.ssp.flatten.assemble import assemble_package
from shipcosim.ssp.flatten.hierarchy import Hierarchy, Swapped
from shipcosim.ssp.flatten.ports import Key, Port
from shipcosim.ssp.flatten.system import System
from shipcosim.ssp.flatten.walk import take_in
from shipcosim.ssp.fmu.description import FmuDescription, Variable
from shipcosim.ssp.read.package import Package, open_package
from shipcosim.ssp.read.parameters import ParameterSet, ParameterValue, read_parameter_set
from shipcosim.ssp.read.structure import (
    Binding,
    ComponentElement,
    DictionaryReference,
    Link,
    Structure,
    SystemElement,
)
from shipcosim.ssp.read.structure_reader import read_structure
from shipcosim.ssp.xml.document import AnyPath, Document, Findings, local
from shipcosim.ssp.xml.values import KINDS, SSP_1_TYPES

Found = Iterator[tuple[str, str]]
"""Places that have a feature, each with what is there; an empty text stands for the feature's own words."""


@dataclass(frozen=True)
class Subject:
    """A system to be checked: its outermost file as written, and the system as resolved.

    Parameters
    ----------
    document : Document
        The SSD or OspSystemStructure.xml.
    system : System
        Flat.
    structure : Structure or None
        What an SSD says; None for an OspSystemStructure.xml.
    package : Package or None
        An SSP's files.
    tree : Hierarchy
        An SSP's ports and wires; empty for an OspSystemStructure.xml.
    """

    document: Document
    system: System
    structure: Structure | None = None
    package: Package | None = None
    tree: Hierarchy = field(default_factory=lambda: Hierarchy(Findings()))

    @property
    def is_ssp(self) -> bool:
        """True for an SSP, false for an OspSystemStructure.xml."""
        return self.structure is not None

    @property
    def place(self) -> str:
        """Where its outermost element stands, for messages."""
        return self.document.place(self.document.root)

    @cached_property
    def elements(self) -> tuple[ComponentElement | DictionaryReference | SystemElement, ...]:
        """Elements of the outermost system."""
        return () if self.structure is None else self.structure.system.elements

    @cached_property
    def components(self) -> list[ComponentElement]:
        """Components of the outermost system."""
        return [part for part in self.elements if isinstance(part, ComponentElement)]

    @cached_property
    def links(self) -> list[tuple[Link, Port | None, Port | None]]:
        """Connections between elements of the outermost system, with their ports if known."""
        links = []
        for link in () if self.structure is None else self.structure.system.links:
            if link.start_element and link.end_element:
                start = self._port(link.start_element, link.start_connector)
                links.append((link, start, self._port(link.end_element, link.end_connector)))
        return links

    def _port(self, element: str, connector: str) -> Port | None:
        return self.tree.ports.get(Key((element,), connector))

    @cached_property
    def sets(self) -> list[tuple[ComponentElement, FmuDescription | None, Binding, ParameterSet]]:
        """(component element, FMU, binding, ParameterSet) of sets bound to components."""
        sets = []
        for part in self.components:
            _, fmu = self.tree.components.get((part.name,), (None, None))
            for binding in part.bindings:
                document = binding.values.inline or self._file(binding)
                if document is not None:
                    sets.append((part, fmu, binding, read_parameter_set(document, Findings())))
        return sets

    def _file(self, binding: Binding) -> Document | None:
        """File of a set that is bound by an address in the package."""
        source = binding.values
        if self.package is None or not source.uri or source.in_component:
            return None
        file = self.package.locate(source.uri, self.document.folder, "", Findings())
        return None if file is None else self.package.read(file, Findings())

    @cached_property
    def documents(self) -> list[Document]:
        """The SSD and the files of its components' sets; none for an OspSystemStructure.xml."""
        files = [self._file(binding) for part in self.components for binding in part.bindings]
        return (
            [document for document in (self.document, *files) if document is not None]
            if self.is_ssp
            else []
        )

    @cached_property
    def values(self) -> list[tuple[ParameterValue, Variable, FmuDescription]]:
        """(value, variable, FMU) of values bound to components under their own names."""
        entries = []
        # A mapping renames parameters: these are not the FMU's names.
        for _, fmu, binding, values in self.sets:
            if fmu is None or binding.mapping is not None:
                continue
            for value in values.values:
                variable = fmu.variables.get(value.name.removeprefix(binding.prefix))
                if variable is not None:
                    entries.append((value, variable, fmu))
        return entries

    @cached_property
    def fmus(self) -> list[tuple[str, FmuDescription]]:
        """(component's name, FMU) of all components."""
        return [(name, component.fmu) for name, component in self.system.components.items()]


def subject_of(
    path: AnyPath,
    fmus: Iterable[AnyPath] = (),
    components: Swapped = None,
) -> Subject | None:
    """Subject of an SSP, or None if it has errors.

    Parameters
    ----------
    path, fmus, components
        As for `shipcosim.ssp.read_system`.

    Returns
    -------
    Subject or None
    """
    findings = Findings()
    # The file as written, then as resolved.
    package = open_package(path, findings, fmus)
    document = None if package is None else package.document(findings)
    structure = None if document is None else read_structure(document, findings)
    if package is None or document is None or structure is None:
        return None
    # Ports and wires of the hierarchy, then the flat system.
    tree = Hierarchy(findings, swapped=components)
    take_in(tree, structure, package)
    system = assemble_package(package, (), str(path), findings, swapped=components)
    return (
        None
        if system is None or findings.errors
        else Subject(document, system, structure, package, tree)
    )


def elements_of(subject: Subject, *tags: str) -> Iterator[etree._Element]:
    """Elements of an SSD with these local names; none for an OspSystemStructure.xml."""
    if subject.is_ssp:
        yield from (
            part for part in subject.document.root.iter(etree.Element) if local(part) in tags
        )


def types_of_2(element: etree._Element) -> list[str]:
    """Types of SSP 2.0 in an element of a connector or value."""
    return [
        local(part) for part in element if local(part) in KINDS and local(part) not in SSP_1_TYPES
    ]


def is_fmi_1(fmu: FmuDescription) -> bool:
    """True for an FMU of FMI 1.0."""
    return fmu.fmi_version.startswith("1")
