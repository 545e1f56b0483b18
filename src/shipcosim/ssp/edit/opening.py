"""Open system structures for viewing and editing: from a file, or empty."""

from collections.abc import Iterable
from pathlib import Path

import lxml.etree as etree

from shipcosim import library
from shipcosim.errors import ShipcosimError, error_at
from shipcosim.ssp.edit.draft import Draft
from shipcosim.ssp.edit.system_structure import SystemStructure
from shipcosim.ssp.osp.reader import osp_file
from shipcosim.ssp.read.package import SYSTEM_STRUCTURE, Package, open_package
from shipcosim.ssp.read.parameters import has_root
from shipcosim.ssp.xml.document import AnyPath, Document, Findings, child, children
from shipcosim.temporary import temporary_folder

EMPTY = """<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
  version="1.0" name="">
  <ssd:System name=""/>
</ssd:SystemStructureDescription>
"""


def read(path: AnyPath, *, fmus: Iterable[AnyPath] | None = None) -> SystemStructure:
    """Read a system structure to look at it, change it, run it, write it.

    Parameters
    ----------
    path : path
        A .ssp (with ``#Variant.ssd`` behind it for another SSD), a folder with a SystemStructure.ssd, or a .ssd.
    fmus : iterable of path, optional
        Folders searched for FMUs that are not beside the SSD; those of `library.fmus` if not given, nothing built.

    Returns
    -------
    SystemStructure
        It may have faults: `check` tells them.

    Raises
    ------
    ShipcosimError
        If there is no such file, or no system structure in it.
    """
    # OSP structures are run, not edited: they have no place for everything in an SSD.
    findings = Findings()
    if osp_file(path):
        raise error_at(
            str(path),
            "An OspSystemStructure.xml cannot be edited.",
            "`simulate` and `read_system` take it.",
        )
    package = open_package(
        path, findings, library.fmus(path, build=False) if fmus is None else fmus
    )
    # The root element must be an SSD with a system in it.
    document = None if package is None else package.document(findings)
    if document is not None and has_root(document, "ssd:SystemStructureDescription", findings):
        if child(document.root, "ssd:System") is None:
            findings.error(
                document.place(document.root), "There is no System in it.", "Add <System name=...>."
            )
    if package is None or document is None or findings.errors:
        raise ShipcosimError(findings.errors)
    return SystemStructure(Draft(package, document, str(path)))


def new(name: str) -> SystemStructure:
    """An empty system structure.

    Parameters
    ----------
    name : str
        Of the system.

    Returns
    -------
    SystemStructure
    """
    # A package in a temporary folder, until it is written.
    folder = temporary_folder()
    root = etree.fromstring(EMPTY.encode())
    for element in (root, *children(root, "ssd:System")):
        element.set("name", name)
    package = Package(Path(folder.name), name, unpacked=folder)
    document = Document(f"{name}/{SYSTEM_STRUCTURE}", root, package.folder)
    return SystemStructure(Draft(package, document, name))
