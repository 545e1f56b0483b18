"""Features of an OspSystemStructure.xml that libcosim reads differently.

Each function takes a Subject and yields (place, description); an empty text: the feature's words.
"""

import lxml.etree as etree

from shipcosim.ssp.osp.groups import file_names
from shipcosim.ssp.portability.subject import Found, Subject
from shipcosim.ssp.xml.document import local


def _osp(subject: Subject, *tags: str) -> list[etree._Element]:
    return (
        []
        if subject.is_ssp
        else [part for part in subject.document.root.iter(etree.Element) if local(part) in tags]
    )


def osp_without_algorithm(subject: Subject) -> Found:
    """An OspSystemStructure.xml without an algorithm."""
    if not subject.is_ssp and not _osp(subject, "Algorithm"):
        yield subject.place, ""


def osp_second_targets(subject: Subject) -> Found:
    """A second connection from the output of a function."""
    # libcosim makes only the first connection from an output.
    seen = set()
    for part in _osp(subject, "Signal", "SignalGroup"):
        end = part.get("function"), part.get("name")
        if end in seen and end[1].startswith("out"):
            yield subject.document.place(part), f"a second connection from {end[0]}:{end[1]}"
        seen.add(end)


def osp_group_files(subject: Subject) -> Found:
    """Variable groups in a file that does not have the model's name."""
    for name in dict.fromkeys(part.get("simulator") for part in _osp(subject, "VariableGroup")):
        fmu = subject.system.components[name].fmu
        places = [
            folder / file_names(fmu)[0] for folder in (fmu.path.parent, subject.document.folder)
        ]
        if not any(place.is_file() for place in places):
            yield name, f"variable groups that are not in {places[0].name}"
