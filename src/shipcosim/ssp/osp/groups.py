"""Variable groups of an FMU, from the OspModelDescription.xml next to it."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import lxml.etree as etree

from shipcosim.errors import it_has
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.xml.document import Document, Findings, local, parts_in, read_document

ENDING = "_OspModelDescription.xml"


@dataclass(frozen=True)
class Group:
    """A variable group.

    Parameters
    ----------
    name, kind : str
        Its name, and its element: ``"Force"``, ``"LinearMechanicalPort"``, ``"Generic"``, ...
    variables : tuple of str
        Names of the FMU's variables, in order.
    groups : tuple of Group
        Groups in it, in order.
    """

    name: str
    kind: str
    variables: tuple[str, ...]
    groups: tuple["Group", ...] = ()

    def all(self) -> Iterator["Group"]:
        """The group and all in it."""
        yield self
        for group in self.groups:
            yield from group.all()


def read_groups(fmu: FmuDescription, folder: Path, findings: Findings) -> dict[str, Group] | None:
    """Groups of an FMU by name, inner groups too, as libcosim finds them.

    Parameters
    ----------
    fmu : FmuDescription
        Whose file is looked for beside it and beside the system structure.
    folder : Path
        Of the system structure.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    dict of str to Group, or None where there is no such file
    """
    file = _file(fmu, folder, findings)
    document = None if file is None else read_document(file, str(file), findings)
    if document is None:
        return None
    groups = {}
    # Inner groups are found by their own names, so all names must differ.
    for listed in parts_in(document.root, "VariableGroups"):
        for element in filter(local, listed):
            for group in _group(element, fmu, document, findings).all():
                if group.name in groups:
                    findings.error(
                        document.place(element, group.name),
                        "A second group has this name.",
                        "Rename it.",
                    )
                groups[group.name] = group
    return groups


def file_names(fmu: FmuDescription) -> list[str]:
    """Names of the file: by the model's name, as libcosim looks for it, or by the FMU's file."""
    return list(dict.fromkeys(f"{name}{ENDING}" for name in (fmu.model_name, fmu.path.stem)))


def _file(fmu: FmuDescription, folder: Path, findings: Findings) -> Path | None:
    # Next to the FMU, then next to the system structure.
    names = file_names(fmu)
    for name in names:
        for place in (fmu.path.parent, folder):
            if "/" not in name and (place / name).is_file():
                if name != names[0]:
                    findings.remark(
                        str(place / name),
                        f"libcosim looks for {names[0]} instead, by the model's name.",
                        "Rename the file.",
                    )
                return place / name
    return None


def _group(
    element: etree._Element, fmu: FmuDescription, document: Document, findings: Findings
) -> Group:
    variables = []
    groups = []
    # Variables and inner groups in order: connections match them one by one.
    for part in filter(local, element):
        if local(part) == "Variable":
            name = part.get("ref", "")
            if name not in fmu.variables:
                findings.error(
                    document.place(part, element.get("name", "")),
                    f"{fmu.path.name} has no variable '{name}'.",
                    it_has(name, fmu.variables),
                )
            variables.append(name)
        else:
            groups.append(_group(part, fmu, document, findings))
    return Group(element.get("name", ""), local(element), tuple(variables), tuple(groups))
