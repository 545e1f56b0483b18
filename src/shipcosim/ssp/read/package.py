"""Files of a system: a .ssp (unpacked temporarily), a folder, or a .ssd with its files."""

import filecmp
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote, urlsplit

from shipcosim.errors import ShipcosimError, it_has, suggestion
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.read.addresses import meant
from shipcosim.ssp.xml.archive import read_entry, unpack
from shipcosim.ssp.xml.document import (
    AnyPath,
    Document,
    Findings,
    parsed,
    read_document,
)
from shipcosim.temporary import temporary_folder

SYSTEM_STRUCTURE = "SystemStructure.ssd"
TABLES = (".csv", ".csv.gz", ".nc", ".parquet", ".xlsx")
PARTS = {".ssv": "parameter set", ".ssm": "parameter mapping", ".ssb": "signal dictionary"}
OSP_STRUCTURE = "OspSystemStructure.xml"
INSIDE = "Put the file beside the SSD, in resources/, and name it so."


@dataclass(frozen=True)
class Package:
    """An SSP: files that belong together. Of an archive nothing outside it and `fmus` is read.

    Parameters
    ----------
    folder : Path
        Their root on disk.
    shown : str
        The root's name in messages.
    ssd : str
        Name of the SSD, relative to the root.
    fmus : tuple of Path
        Folders searched for FMUs that are not in the package.
    unpacked : TemporaryDirectory or None
        Holds the folder; it is removed with the last reference to it.
    held : dict of Path to Document or Path
        What stands for a file of the folder: a document in memory, or a file elsewhere. For systems that are edited.
    located : dict of str to Path
        Files that were asked for, by their names in the package: where they are.
    moved : dict of str to str
        Names in the package for addresses that are none of the standard.
    """

    folder: Path
    shown: str
    ssd: str = SYSTEM_STRUCTURE
    fmus: tuple[Path, ...] = ()
    unpacked: tempfile.TemporaryDirectory | None = field(default=None, repr=False, compare=False)
    held: dict[Path, Document | Path] = field(default_factory=dict, repr=False, compare=False)
    located: dict[str, Path] = field(default_factory=dict, repr=False, compare=False)
    moved: dict[str, str] = field(default_factory=dict, repr=False, compare=False)

    def show(self, path: AnyPath) -> str:
        """Name of a file of the package for messages."""
        path = Path(path).resolve()
        folder = self.folder.resolve()
        return (
            f"{self.shown}/{path.relative_to(folder).as_posix()}"
            if path.is_relative_to(folder)
            else str(path)
        )

    def __getstate__(self) -> dict:
        # a copy in another process uses the files, and does not remove them
        return self.__dict__ | {"unpacked": None, "held": {}}

    def document(self, findings: Findings) -> Document | None:
        """The SSD, or None if it cannot be read."""
        return self.read(self.folder / self.ssd, findings)

    def read(self, path: AnyPath, findings: Findings) -> Document | None:
        """Document of one of the package's files."""
        held = self.held.get(Path(path).resolve())
        return (
            held if isinstance(held, Document) else read_document(path, self.show(path), findings)
        )

    def locate(self, uri: str, base: Path, place: str, findings: Findings) -> Path | None:
        """File of a relative address, or None with an error.

        Parameters
        ----------
        uri : str
            As in the SSD, perhaps percent-encoded.
        base : Path
            Folder of the SSD.
        place : str
            Where the address stands, for messages.
        findings : Findings
            Takes what is wrong.
        """
        try:
            return self._located(uri, base, place, findings)
        except (
            ValueError,
            OSError,
        ) as error:  # a NUL in it, longer than any file system takes, ...
            findings.error(place, f"'{uri[:80]}' is no usable address: {error}.")
            return None

    def _located(self, uri: str, base: Path, place: str, findings: Findings) -> Path | None:
        folder = self.folder.resolve()
        # A standard address is relative and stays within the package.
        parts = urlsplit(uri)
        wild = None
        plain = not (parts.scheme or parts.netloc or uri.startswith("/")) and bool(parts.path)
        # As percent-encoded text, or with a literal percent sign.
        paths = (
            [(base / name).resolve() for name in (unquote(parts.path), parts.path)] if plain else []
        )
        inside = plain and all(path.is_relative_to(folder) for path in paths)
        # FMUs may also lie in the searched folders.
        elsewhere = [
            folder / paths[0].name for folder in self.fmus if inside and paths[0].suffix == ".fmu"
        ]
        file = (
            next((path for path in (*paths, *elsewhere) if self._is_there(path)), None)
            if inside
            else None
        )
        # Non-standard addresses are accepted if they can mean one file only.
        if file is None and (wild := meant(uri, base, folder, self.unpacked is None)) is not None:
            return self._taken(uri, wild, place, findings)
        # Explain what is wrong with the address.
        if not plain:
            remedy = "Addresses are relative to the SSD, e.g. resources/name.fmu."
            findings.error(place, f"'{uri}' is no address within the package.", remedy)
            return None
        if not inside:
            # Of an archive nothing outside is looked at.
            is_missing = self.unpacked is None and not any(path.exists() for path in paths)
            findings.error(
                place,
                f"'{uri}' lies outside the package{', and there is no such file' if is_missing else ''}.",
                "Put the file beside the SSD, in resources/.",
            )
            return None
        if file is None:
            is_folder = any(path.is_dir() for path in (*paths, *elsewhere))
            what = "is a folder, not a file" if is_folder else "does not exist"
            findings.error(place, f"The file '{uri}' {what}.", self._present(paths[0]))
            return None
        # An edited package may hold the file elsewhere; remember where it belongs.
        held = self.held.get(file)
        if isinstance(held, Path):
            file, name = held, file
        else:
            name = file if file in paths else paths[0]
            remark_copy(file, elsewhere, place, findings)
        self.located[name.relative_to(folder).as_posix()] = file
        return file

    def _taken(self, uri: str, file: Path, place: str, findings: Findings) -> Path | None:
        """Accept the file of a non-standard address: report it, keep it for writing the package."""
        shown = self.show(file)
        findings.flaw(place, f"'{uri}' is no address within the package; {shown} is taken.", INSIDE)
        folder = self.folder.resolve()
        # A file outside comes into resources/ when the package is written.
        name = (
            file.relative_to(folder).as_posix()
            if file.is_relative_to(folder)
            else f"resources/{file.name}"
        )
        # Two different files must not get one name.
        if self.located.setdefault(name, file) != file:
            findings.error(
                place,
                f"Two files are named {file.name}: {shown} and {self.located[name]}.",
                INSIDE,
            )
            return None
        self.moved[uri] = name
        return file

    def _is_there(self, path: Path) -> bool:
        held = self.held.get(path, path)
        return isinstance(held, Document) or held.is_file()

    def _present(self, path: Path) -> str:
        folders = [path.parent, *(self.fmus if path.suffix == ".fmu" else ())]
        files = [
            file for folder in folders if folder.is_dir() for file in folder.glob(f"*{path.suffix}")
        ]
        there = {file.name for file in files if file.is_file()}
        return f"In {' and '.join(map(str, folders))} there{suggestion(path.name, there).removeprefix('There')}"


def open_package(
    path: AnyPath,
    findings: Findings,
    fmus: Iterable[AnyPath] = (),
    shown: str | None = None,
) -> Package | None:
    """Open the package of a path, or None with an error.

    Parameters
    ----------
    path : path
        A .ssp (with ``#Variant.ssd`` behind it for another SSD than the default one), a folder with an SSD, or a .ssd.
    findings : Findings
        Takes what is wrong.
    fmus : iterable of path
        Folders searched for FMUs that are not in the package.
    shown : str, optional
        Name of the path in messages, where it is another.
    """
    # A variant's SSD is named after '#'.
    text, _, variant = str(path).partition("#")
    path = Path(text)
    shown = shown or text
    fmus = tuple(Path(folder) for folder in fmus)
    # A folder, a single SSD, or an archive that is unpacked for as long as the package lives.
    if path.is_dir():
        tables = sorted(file for file in path.iterdir() if file.name.endswith(TABLES))
        if tables and not variant and not any(path.glob("*.ssd")):
            # Someone means the logs in it.
            message = f"This folder has no system, but logs or tables, such as {tables[0].name}."
            findings.error(shown, message, f"Give one of them: {Path(shown) / tables[0].name}.")
            return None
        remark_others(path, shown, variant or SYSTEM_STRUCTURE, variant, findings)
        return Package(path, shown, variant or SYSTEM_STRUCTURE, fmus)
    if not path.is_file():
        findings.error(
            shown,
            "There is no such file or folder.",
            "Right would be a .ssp, a .ssd or a folder with one.",
        )
        return None
    if path.suffix.lower() == ".ssd":
        return Package(path.parent, str(Path(shown).parent), path.name, fmus)
    if path.name.endswith(TABLES):
        remedy = "`shipcosim check` looks at one, `shipcosim report` compares two."
        findings.error(shown, "This is a table, no system.", remedy)
        return None
    if kind := PARTS.get(path.suffix.lower()):
        remedy = "Give the system; `--parameters` gives it a parameter set."
        findings.error(shown, f"This is a {kind}, no system.", remedy)
        return None
    unpacked = temporary_folder()
    try:
        unpack(path, unpacked.name, shown)
    except ShipcosimError as error:
        findings.problems += error.problems
        return None
    package = Package(Path(unpacked.name), shown, variant or SYSTEM_STRUCTURE, fmus, unpacked)
    # The archive must contain the wanted SSD.
    if not (package.folder / package.ssd).is_file():
        there = [file.name for file in package.folder.glob("*.ssd")]
        findings.error(
            shown, f"The archive has no {package.ssd} at its top.", it_has(package.ssd, there)
        )
        return None
    remark_others(package.folder, shown, package.ssd, variant, findings)
    return package


def remark_copy(copy: Path, elsewhere: Iterable[Path], place: str, findings: Findings) -> None:
    """Add a remark if an FMU beside its system runs, and the project has a different one of that name."""
    other = next((path for path in elsewhere if path.is_file()), copy)
    if not filecmp.cmp(copy, other, shallow=False):
        text = f"{copy.name} beside the system runs. It is not the same as {other}, which does not run."
        findings.remark(place, text, "Delete the copy to run that one, or copy it again.")


def remark_others(folder: Path, shown: str, taken: str, chosen: str, findings: Findings) -> None:
    """Add a remark if a folder has several system structures and the user chose none."""
    others = sorted(
        file.name
        for file in folder.iterdir()
        if file.is_file() and (file.suffix.lower() == ".ssd" or file.name == OSP_STRUCTURE)
    )
    if not chosen and taken in others and len(others) > 1:
        others.remove(taken)
        message = (
            f"It holds {len(others) + 1} system structures. {taken} runs, not {', '.join(others)}."
        )
        findings.remark(shown, message, "Name the one to run: FOLDER/NAME, or ARCHIVE.ssp#NAME.")


def read_in_component(
    fmu: FmuDescription, uri: str, place: str, findings: Findings
) -> Document | None:
    """Read a document inside an FMU (``sourceBase="component"``), or None with an error.

    Parameters
    ----------
    fmu : FmuDescription
        The FMU.
    uri : str
        Address from the FMU's top.
    place : str
        Where the address stands, for messages.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    Document or None
    """
    name = unquote(uri)
    try:
        data = read_entry(fmu.path, name)
    except ShipcosimError as error:
        findings.problems += error.problems
        return None
    if data is None:
        findings.error(
            place, f"{fmu.path.name} has no file '{name}'.", "Addresses start at the FMU's top."
        )
        return None
    file = f"{fmu.path.name}/{name}"
    return parsed(data, file, findings)
