"""Files of a system: each is read once, and its faults are reported once."""

from collections.abc import Callable, Hashable, Iterable
from pathlib import Path
from typing import Any, Protocol

from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.fmu.reader import describe_fmu
from shipcosim.ssp.read.package import Package, open_package, read_in_component
from shipcosim.ssp.read.structure import Source, Structure
from shipcosim.ssp.read.structure_reader import read_structure
from shipcosim.ssp.xml.document import Document, Findings


class Addressing(Protocol):
    """An element with an address in it; `place` says where it stands, for messages."""

    @property
    def place(self) -> str: ...


class InPackage(Protocol):
    """Where an address stands: the package, and the folder in it that relative addresses start from."""

    @property
    def package(self) -> Package: ...

    @property
    def folder(self) -> Path: ...


class Library:
    """Reads the files that a system refers to, and caches them.

    Parameters
    ----------
    findings : Findings
        Takes what is wrong.

    Attributes
    ----------
    packages : list of Package
        Opened on the way.
    """

    def __init__(self, findings: Findings):
        self.findings = findings
        self.packages = list[Package]()
        self._kept: dict[Hashable, Any] = {}

    def _once(self, key: Hashable, make: Callable[[], Any]) -> Any:
        if key not in self._kept:
            self._kept[key] = make()
        return self._kept[key]

    def file(self, owner: Addressing, uri: str, place: InPackage) -> Path | None:
        """File of an element's address, or None with an error.

        Parameters
        ----------
        owner : Addressing
            The element; it must live as long as the library.
        uri : str
            Its address.
        place : InPackage
            What the address starts from.

        Returns
        -------
        Path or None
        """
        # Found files are shared by all owners; a missing one is reported for each owner.
        at = "at", place.package.folder, place.folder, uri
        if self._kept.get(at) is None:  # a missing one is reported for each owner, once
            self._kept[at] = self._once((id(owner), uri), lambda: self._located(owner, uri, place))
        return self._kept[at]

    def _located(self, owner: Addressing, uri: str, place: InPackage) -> Path | None:
        # Folders are searched once for what is missing, however many elements refer to it.
        key = "missing", place.package.folder, place.folder, uri
        if first := self._kept.get(key):
            self.findings.error(owner.place, first.found, first.remedy)
            return None
        located = place.package.locate(uri, place.folder, owner.place, self.findings)
        if located is None:
            self._kept[key] = self.findings.problems[-1]
        return located

    def package(self, address: str | Path, fmus: Iterable[Path], shown: str) -> Package | None:
        """Package at an address, or None."""
        return self._once(("package", address), lambda: self._opened(address, fmus, shown))

    def _opened(self, address: str | Path, fmus: Iterable[Path], shown: str) -> Package | None:
        package = open_package(address, self.findings, fmus, shown)
        self.packages += [] if package is None else [package]
        return package

    def structure(self, package: Package, file: Path) -> Structure | None:
        """Structure of an SSD, or None."""
        return self._once(("structure", file), lambda: self._structure(package, file))

    def _structure(self, package: Package, file: Path) -> Structure | None:
        document = package.read(file, self.findings)
        return None if document is None else read_structure(document, self.findings)

    def content(
        self, source: Source, place: InPackage, fmu: FmuDescription | None = None
    ) -> Document | None:
        """Document of a set, mapping or dictionary, inline or from a file; None with an error.

        Parameters
        ----------
        source : Source
            As the SSD gives it.
        place : InPackage
            What its address starts from.
        fmu : FmuDescription, optional
            Of the component; the file can be inside it.

        Returns
        -------
        Document or None
        """
        # Inline, inside an FMU, or a file of the package.
        uri = source.uri
        if source.inline is not None or uri is None:
            return source.inline
        if source.in_component:
            return (
                None
                if fmu is None
                else self._once(
                    (fmu.path, uri),
                    lambda: read_in_component(fmu, uri, source.place, self.findings),
                )
            )
        file = self.file(source, uri, place)
        return (
            None
            if file is None
            else self._once(("file", file), lambda: place.package.read(file, self.findings))
        )

    def parsed(self, read: Callable[[Document, Findings], Any], document: Document) -> Any:
        """What `read_parameter_set`, `read_mapping` or `read_dictionary` reads from a document."""
        return self._once((read, id(document.root)), lambda: read(document, self.findings))

    def fmu(self, file: Path, package: Package) -> FmuDescription | None:
        """Description of an FMU, or None."""
        return self._once(
            ("fmu", file), lambda: describe_fmu(file, self.findings, package.show(file))
        )
