"""Simulators of an OspSystemStructure.xml: components with their FMUs and initial values."""

from pathlib import Path
from urllib.parse import unquote, urlsplit
from urllib.request import url2pathname

import lxml.etree as etree

from shipcosim.errors import suggestion
from shipcosim.ssp.flatten.hierarchy import Hierarchy
from shipcosim.ssp.flatten.ports import Setting
from shipcosim.ssp.fmu.arrays import without_arrays
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.fmu.reader import describe_fmu
from shipcosim.ssp.osp.schema import NAMESPACE
from shipcosim.ssp.osp.times import own_step
from shipcosim.ssp.read.addresses import PROXY, differing_in_case, path_of
from shipcosim.ssp.read.package import remark_copy
from shipcosim.ssp.read.parameters import ParameterValue
from shipcosim.ssp.read.structure import FMU, ComponentElement
from shipcosim.ssp.xml.document import Document, Findings, local, parts_in, reporting
from shipcosim.ssp.xml.values import read_value

HERE = ("", "file")
"""Schemes of addresses that mean a file."""


class Simulators:
    """Collects the simulators of a document in a Hierarchy.

    Parameters
    ----------
    document : Document
        The OspSystemStructure.xml, which keeps its schema.
    searched : list of Path
        Folders searched for FMUs that are not where the document says.
    tree : Hierarchy
        Takes the components and the values set.
    findings : Findings
        Takes what is wrong.
    """

    def __init__(
        self, document: Document, searched: list[Path], tree: Hierarchy, findings: Findings
    ):
        self.document = document
        self.searched = searched
        self.tree = tree
        self.findings = findings
        self._initials: dict[tuple[str, str], object] = {}

    @property
    def names(self) -> list[str]:
        """Names of the simulators so far."""
        return [".".join(path) for path in self.tree.components]

    def fmu_of(self, simulator: str, place: str) -> FmuDescription | None:
        """FMU of a simulator, or None, with an error unless it was reported before."""
        if (simulator,) not in self.tree.components:
            self.findings.error(
                place, f"There is no simulator '{simulator}'.", suggestion(simulator, self.names)
            )
            return None
        return self.tree.components[simulator,][1]

    def take(self, element: etree._Element) -> None:
        """Collect a Simulator element with its FMU and its initial values."""
        # Each needs a name of its own.
        name = element.get("name")
        place = self.document.place(element, name)
        if not name or (name,) in self.tree.components:
            message = (
                f"A second simulator is named '{name}'." if name else "A simulator has no name."
            )
            self.findings.error(place, message, "Names must differ.")
            return
        # The FMU, or the one that replaces it.
        file = self.tree.swapped.get(name) or self._located(element.get("source"), place)
        fmu = None if file is None else describe_fmu(file, self.findings)
        step = own_step(self.document, element, self.findings)
        described = ComponentElement(name, element.get("source"), FMU, "any", (), (), step, place)
        fmu = fmu and without_arrays(fmu, place, self.findings, self.tree.sizes.get(name))
        # Arrays as elements, with the sizes that the system sets.
        self.tree.components[name,] = described, fmu
        self.tree.arrays[name,] = {} if fmu is None else dict(fmu.arrays)
        # Initial values act like a parameter set of this component.
        for initial in element.iter(f"{{{NAMESPACE}}}InitialValue"):
            self._initial(name, initial)

    def _initial(self, name: str, element: etree._Element) -> None:
        variable = element.get("variable")
        # A value that cannot be read is reported at its place in the file.
        (typed,) = parts_in(element)
        place = self.document.place(element, f"{name}.{variable}")
        with reporting(self.document, element, self.findings, f"{name}.{variable}"):
            value = read_value(local(typed), typed.get("value"))
            # Of two values the order would decide.
            if self._initials.setdefault((name, variable), value) != value:
                self.findings.error(place, "It has two initial values.", "Keep one of them.")
            given = ParameterValue(variable, local(typed), value, place=place)
            self.tree.settings.append(Setting((name,), variable, given, near=True))

    def _located(self, source: str, place: str) -> Path | None:
        """File of a source address, or None with an error; any folder, as in OSP's examples."""
        try:
            # A proxy address names a file and a process: only the file is used.
            if "\\" in source:
                located = f"'{source}' has backslashes; they are taken for slashes."
                self.findings.flaw(place, located, "Write an address: folder/name.fmu.")
                source = source.replace("\\", "/")
            parts = urlsplit(source)
            if parts.scheme == PROXY and (text := path_of(source)) is not None:
                located = f"'{source}' is an FMU in a process of its own; {text} is run here."
                self.findings.flaw(
                    place, located, "Name the FMU's file; `--isolate` runs each FMU in a process."
                )
                parts = urlsplit(text)
                source = text
            elif parts.scheme not in HERE and len(parts.scheme) > 1:  # one letter is a drive
                # Other addresses would need a server.
                remedy = "Name the FMU's file: proxies and servers of FMUs are not supported."
                self.findings.error(
                    place, f"'{source}' is an address of the kind '{parts.scheme}'.", remedy
                )
                return None
            # As an address, as a plain name, then by file name in the searched folders.
            path = url2pathname(parts.path) if parts.scheme else unquote(parts.path)
            paths = [self.document.folder / path, self.document.folder / source]
            elsewhere = [folder / Path(path).name for folder in self.searched]
            paths += elsewhere
            paths += differing_in_case(paths[0])  # upper and lower case, as Windows takes them
            located = next((path for path in paths if path.is_file()), None)
            if located is not None:
                remark_copy(located, elsewhere, place, self.findings)
                if located not in paths[:2] and located.name != Path(path).name:
                    self.findings.flaw(
                        place,
                        f"There is no '{source}'; {located.name} is taken.",
                        "Write this name.",
                    )
        except (ValueError, OSError) as error:
            self.findings.error(place, f"'{source[:80]}' is no usable address: {error}.")
            return None
        # Suggest a similar file of the same folder.
        if located is None:
            there = {file.name for file in paths[0].parent.glob("*.fmu")}
            remedy = f"In {paths[0].parent} there{suggestion(paths[0].name, there).removeprefix('There')}"
            self.findings.error(place, f"The file '{source}' does not exist.", remedy)
        return located
