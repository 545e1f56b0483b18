"""An SSP in memory: changes are made together or not at all, checked, and written."""

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import replace
from filecmp import cmp
from pathlib import Path
from typing import TypeVar
from urllib.parse import quote

import lxml.etree as etree

from shipcosim.errors import ShipcosimError, error_at, raise_errors
from shipcosim.ssp.edit.parameter_sets import Sets
from shipcosim.ssp.edit.write import PREFIXES, files_in, relocated, write_file
from shipcosim.ssp.flatten.assemble import assemble_package
from shipcosim.ssp.flatten.hierarchy import Swapped
from shipcosim.ssp.flatten.system import System
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.fmu.reader import describe_fmu
from shipcosim.ssp.read.package import SYSTEM_STRUCTURE, Package
from shipcosim.ssp.read.parameters import ParameterSets
from shipcosim.ssp.read.structure import FMU
from shipcosim.ssp.xml.archive import write_archive
from shipcosim.ssp.xml.document import Document, Findings, children
from shipcosim.ssp.xml.markup import free_name, to_bytes

Content = TypeVar("Content")


class Draft:
    """An SSD in memory, with the package around it.

    Parameters
    ----------
    package : Package
        Where its files are; nothing is written there.
    document : Document
        The SSD; changed in place.
    file : str
        Name of the system as the user knows it.
    """

    def __init__(self, package: Package, document: Document, file: str):
        self.file = file
        self.package = replace(package, held={}, located={})
        self.path = (package.folder / package.ssd).resolve()
        self.package.held[self.path] = document
        self._assembled: tuple[System | None, Findings] | None = None
        self._assembled_from: dict[Path, bytes | Path] = {}
        self._changing = False
        self.assemble()
        self._came_with = set(self.package.located)

    def copy(self) -> "Draft":
        """Copy the draft; both can then be changed independently."""
        copied = Draft(self.package, self.document, self.file)
        copied.package.held.update(self._snapshot())
        copied._came_with = set(self._came_with)
        return copied

    @property
    def document(self) -> Document:
        """The SSD."""
        document = self.package.held[self.path]
        assert isinstance(
            document, Document
        )  # put there on creation; changes only exchange it for a copy
        return document

    @property
    def root(self) -> etree._Element:
        """Outermost element of the SSD."""
        return self.document.root

    @property
    def system(self) -> etree._Element:
        """The outermost System element, without which there is no draft."""
        return children(self.root, "ssd:System")[0]

    @property
    def sets(self) -> Sets:
        """The parameter sets that it binds."""
        return Sets(self.package, self.document)

    def error(self, what: str, message: str, remedy: str = "") -> ShipcosimError:
        """Error about something in the SSD, to be raised."""
        return error_at(f"{self.package.show(self.path)}: {what}", message, remedy)

    # ---------------------------------------------------------------- reading

    def assemble(
        self, parameters: ParameterSets = (), swapped: Swapped = None
    ) -> tuple[System | None, Findings]:
        """Assemble the present system; None or incomplete if there are errors."""
        findings = Findings()
        self.package.located.clear()
        system = assemble_package(self.package, parameters, self.file, findings, swapped)
        return system, findings

    def assembled(self) -> tuple[System | None, Findings]:
        """Like `assemble`, but read only once after each change."""
        if self._assembled is None:
            self._assembled = self.assemble()
            self._assembled_from = self._content()
        return self._assembled

    def reassembled(self) -> tuple[System | None, Findings]:
        """Like `assembled`, after a change within a block of `changes`."""
        self._forget_old()
        return self.assembled()

    def _forget_old(self) -> None:
        """Forget the assembled system if its files say something else by now."""
        # To compare texts takes milliseconds, to assemble a system some tenths of a second.
        if self._assembled_from != self._content():
            self._assembled = None

    def _content(self) -> dict[Path, bytes | Path]:
        """Content of the files from which the system is assembled."""
        return {
            path: etree.tostring(held.root) if isinstance(held, Document) else held
            for path, held in self.package.held.items()
        }

    def fmu_of(self, element: etree._Element) -> FmuDescription | None:
        """Description of a component's FMU; None for other elements, or if it cannot be read."""
        if element.get("type", FMU) != FMU or not element.get("source"):
            return None
        # Where the SSD points to; the description is cached by file and time of change.
        file = self.package.locate(element.get("source", ""), self.document.folder, "", Findings())
        if file is None:
            return None
        return describe_fmu(file, Findings())

    # ---------------------------------------------------------------- changing

    @contextmanager
    def changes(self) -> Iterator[None]:
        """Check the changes of a ``with`` block at its end and undo all of them if they bring new errors.

        A block within a block is part of the outer one.
        """
        # Only the outermost block checks: within it the system may be incomplete.
        if self._changing:
            try:
                yield
            finally:
                self._forget_old()
            return
        # Errors that the system already had do not count.
        before = self._snapshot()
        counts = Counter(problem.found for problem in self.assembled()[1].errors)
        self._changing = True
        try:
            yield
            # New errors undo the whole block, as any other exception does.
            fresh = [p for p in dict.fromkeys(self.reassembled()[1].errors) if not counts[p.found]]
            raise_errors(fresh)
        except BaseException:
            # Return to the state before the block.
            self.package.held.clear()
            self.package.held.update(before)
            self._assembled = None
            raise
        finally:
            self._changing = False

    def _snapshot(self) -> dict[Path, Document | Path]:
        # Copy of an element with what stands before and after it in its file.
        return {
            path: replace(held, root=deepcopy(held.root.getroottree()).getroot())
            if isinstance(held, Document)
            else held
            for path, held in self.package.held.items()
        }

    def resource(self, file: Path) -> str:
        """Address of a file from elsewhere, which from now on belongs to the package."""
        folder = self.path.parent / "resources"
        top = self.package.folder.resolve()
        # The same file, by content, may already be in the package.
        files = {top / name: path for name, path in self.package.located.items()}
        files |= {path: held for path, held in self.package.held.items() if isinstance(held, Path)}
        for place, path in files.items():
            if place.name == file.name and path.is_file() and cmp(path, file, shallow=False):
                return quote(place.relative_to(self.path.parent).as_posix())
        # Else take a name that no file in the package has.
        names = {path.name for path in (*files, *self.package.held, *folder.glob("*"))}
        name = (
            free_name(file.stem, {name.removesuffix(file.suffix) for name in names}) + file.suffix
        )
        self.package.held[folder / name] = file.resolve()
        return quote(f"resources/{name}")

    # ---------------------------------------------------------------- writing

    def write(self, path: Path, fmus: bool) -> None:
        """Write the package: packed into a .ssp, as a .ssd with its files beside it, or as a folder.

        Parameters
        ----------
        path : Path
            Its ending says which.
        fmus : bool
            Whether FMUs that were not in the package come along; a .ssp always has them.
        """
        # FMUs from elsewhere come along only if asked for, or in an archive.
        files = self._files()
        packed = path.suffix.lower() == ".ssp"
        if not (packed or fmus):
            inside = self.package.folder.resolve()
            files = {name: file for name, file in files.items() if not _is_elsewhere(file, inside)}
        # An archive: everything packed, the SSD under its standard name.
        if packed:
            contents = {
                name: file.read_bytes() if isinstance(file, Path) else file
                for name, file in files.items()
            }
            write_archive(path, _with_ssd(contents, self.package.ssd, SYSTEM_STRUCTURE))
            return
        # A folder: write only what is not already there.
        folder, ssd = (
            (path.parent, path.name) if path.suffix.lower() == ".ssd" else (path, SYSTEM_STRUCTURE)
        )
        for name, file in _with_ssd(files, self.package.ssd, ssd).items():
            target = folder / name
            if not (isinstance(file, Path) and target.exists() and target.samefile(file)):
                write_file(target, file.read_bytes() if isinstance(file, Path) else file)

    def _files(self) -> dict[str, Path | bytes]:
        """Contents, or their paths, by name in the package; FMUs of removed components left out."""
        # All files of the package, except hidden ones.
        self.assemble()
        folder = self.package.folder.resolve()
        files: dict[str, Path | bytes] = {}
        # A single .ssd says nothing about its neighbours.
        if not self.file.partition("#")[0].lower().endswith(".ssd"):
            files |= files_in(folder)
        # FMUs that were found elsewhere, then every changed file.
        files |= self.package.located
        for path, held in self.package.held.items():
            if isinstance(held, Document):
                files[path.relative_to(folder).as_posix()] = to_bytes(
                    relocated(held.root, self.package.moved), *PREFIXES.get(path.suffix, ())
                )
        # FMUs that came with the package but are not used any more.
        gone = {
            name for name in self._came_with - set(self.package.located) if name.endswith(".fmu")
        }
        return {name: file for name, file in files.items() if name not in gone}


def _is_elsewhere(file: Path | bytes, folder: Path) -> bool:
    return (
        isinstance(file, Path)
        and file.suffix == ".fmu"
        and not file.resolve().is_relative_to(folder)
    )


def _with_ssd(files: dict[str, Content], name: str, wanted: str) -> dict[str, Content]:
    """Files with the SSD under the wanted name, unless another file has that name."""
    if wanted == SYSTEM_STRUCTURE and SYSTEM_STRUCTURE in files:
        return files
    return {(wanted if file_name == name else file_name): file for file_name, file in files.items()}
