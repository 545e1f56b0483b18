"""A system that is looked at for what other tools take otherwise: its outermost file as written, and what it means."""

from dataclasses import dataclass
from functools import cached_property

import lxml.etree as etree

from shipcosim.ssp.flatten.assemble import assemble_package
from shipcosim.ssp.flatten.hierarchy import Hierarchy
from shipcosim.ssp.flatten.ports import Key
from shipcosim.ssp.flatten.system import System
from shipcosim.ssp.flatten.walk import take_in
from shipcosim.ssp.read.package import Package, open_package
from shipcosim.ssp.read.parameters import read_parameter_set
from shipcosim.ssp.read.structure import ComponentElement, Structure
from shipcosim.ssp.read.structure_reader import read_structure
from shipcosim.ssp.xml.document import Document, Findings, local


@dataclass(frozen=True)
class Subject:
    """A system that is looked at: the outermost file as written, and what it means.

    Parameters
    ----------
    document, structure, package, tree
        Of an SSP; None for an OspSystemStructure.xml.
    system : System
        Flat.
    osp : Document or None
        The OspSystemStructure.xml, where it is one.
    """

    document: Document | None
    structure: Structure | None
    package: Package | None
    tree: Hierarchy | None
    system: System
    osp: Document | None = None

    @cached_property
    def elements(self):
        """Elements of the outermost system."""
        return () if self.structure is None else self.structure.system.elements

    @cached_property
    def components(self):
        """Components of the outermost system."""
        return [part for part in self.elements if isinstance(part, ComponentElement)]

    @cached_property
    def links(self):
        """Connections of the outermost system between its elements, with their ends' ports where they are known."""
        found = []
        for link in () if self.structure is None else self.structure.system.links:
            ends = [
                self.tree.ports.get(Key((element,), name))
                for element, name in (
                    (link.start_element, link.start_connector),
                    (link.end_element, link.end_connector),
                )
            ]
            if link.start_element and link.end_element:
                found.append((link, *ends))
        return found

    @cached_property
    def sets(self):
        """(component element, FMU, binding, ParameterSet) of sets bound to components."""
        found = []
        for part in self.components:
            _, fmu = self.tree.components.get((part.name,), (None, None))
            for binding in part.bindings:
                document = binding.values.inline
                if document is None and not binding.values.in_component:
                    file = self.package.locate(binding.values.uri, self.document.folder, "", Findings())
                    document = None if file is None else self.package.read(file, Findings())
                if document is not None:
                    found.append((part, fmu, binding, read_parameter_set(document, Findings())))
        return found

    @cached_property
    def documents(self):
        """The outermost file, and the files of the sets that are bound to its components."""
        found = [] if self.document is None else [self.document]
        for binding in (binding for part in self.components for binding in part.bindings):
            if binding.values.uri and not binding.values.in_component:
                file = self.package.locate(binding.values.uri, self.document.folder, "", Findings())
                found.append(None if file is None else self.package.read(file, Findings()))
        return [document for document in found if document is not None]

    @cached_property
    def values(self):
        """(value, variable, fmu) of the values that are bound to components by their own names."""
        found = []
        for _, fmu, binding, values in self.sets:
            for value in values.values if fmu is not None and binding.mapping is None else ():
                variable = fmu.variables.get(value.name.removeprefix(binding.prefix))
                if variable is not None:
                    found.append((value, variable, fmu))
        return found

    @cached_property
    def fmus(self):
        """(component's name, FMU) of all components."""
        return [(name, component.fmu) for name, component in self.system.components.items()]


def subject_of(path, fmus=()):
    """Subject of an SSP, or None where it has errors."""
    findings = Findings()
    package = open_package(path, findings, fmus)
    document = None if package is None else package.document(findings)
    structure = None if document is None else read_structure(document, findings)
    if structure is None:
        return None
    tree = Hierarchy(findings)
    take_in(tree, structure, package)
    system = assemble_package(package, (), str(path), findings)
    return None if findings.errors else Subject(document, structure, package, tree, system)


def elements_of(subject, *tags):
    """Elements of the outermost file of these local names."""
    if subject.document is not None:
        yield from (part for part in subject.document.root.iter(etree.Element) if local(part) in tags)
