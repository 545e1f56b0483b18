"""Collected elements of an SSD: components with FMUs, ports, wires, and values set.

A port is a connector at its place in the hierarchy. Nested systems, systems in other files and signal dictionaries all
become ports with wires between them, so that what follows knows no hierarchy.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from shipcosim.ssp.flatten.ports import Key, Port, Setting, Wire
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.read.library import Library
from shipcosim.ssp.read.package import Package
from shipcosim.ssp.read.parameters import DictionaryEntry
from shipcosim.ssp.read.structure import ComponentElement, Structure, SystemElement
from shipcosim.ssp.xml.document import Findings

Swapped = Mapping[str, Path] | None
"""FMUs that components run in place of their own."""


ElementPath = tuple[str, ...]
"""Names of the elements around something and its own; empty for the outermost system."""

Dictionaries = dict[str, tuple[ElementPath, dict[str, DictionaryEntry]]]
"""Signal dictionaries of a system by name: their place among the ports, and their entries."""


class Hierarchy:
    """Everything found in the nested elements.

    Parameters
    ----------
    findings : Findings
        Takes what is wrong.
    sizes : mapping of str to mapping of str to int, optional
        Values of structural parameters that give the sizes of arrays, by component, where they are not the FMU's own.
    swapped : mapping of str to Path, optional
        FMUs that components run in place of their own, by full name.

    Attributes
    ----------
    components : dict of path to (ComponentElement, FmuDescription or None)
        None where the FMU cannot be read, which is an error already.
    systems : dict of path to SystemElement
        The outermost one and all nested ones.
    ports : dict of Key to Port
        All connectors.
    wires : list of Wire
        All connections, in the order in which they were found.
    settings : list of Setting
        All values set, in the order in which they are applied.
    left_out : dict of place to name
        Values that a mapping does not name and that nothing else asks for by their name.
    arrays : dict of path to dict of str to tuple of int
        Dimensions of an element's connectors that are arrays, by their names.
    references : dict of Key to Key
        Entry of a signal dictionary that a connector of a dictionary reference stands for.
    library : Library
        Files read on the way.
    """

    def __init__(
        self,
        findings: Findings,
        sizes: Mapping[str, Mapping[str, int]] | None = None,
        swapped: Swapped = None,
    ):
        self.findings = findings
        self.components: dict[ElementPath, tuple[ComponentElement, FmuDescription | None]] = {}
        self.systems: dict[ElementPath, SystemElement] = {}
        self.ports: dict[Key, Port] = {}
        self.wires: list[Wire] = []
        self.settings: list[Setting] = []
        self.left_out: dict[str, str] = {}
        self.arrays: dict[ElementPath, dict[str, tuple[int, ...]]] = {}
        self.references: dict[Key, Key] = {}
        self.library = Library(findings)
        self.sizes = sizes or {}
        self.swapped = swapped or {}


@dataclass(frozen=True)
class Surroundings:
    """The surroundings of an element: its file, visible dictionaries, and enclosing systems.

    Parameters
    ----------
    structure : Structure
        The SSD that it stands in.
    package : Package
        The files that addresses in it mean.
    dictionaries : tuple of Dictionaries
        Of the systems around it, the innermost first.
    around : tuple of str
        Places of the whole files around it, so that a file which contains itself is found.
    """

    structure: Structure
    package: Package
    dictionaries: tuple[Dictionaries, ...]
    around: tuple[str, ...]

    @property
    def folder(self) -> Path:
        """Folder that relative addresses start from."""
        return self.structure.document.folder
