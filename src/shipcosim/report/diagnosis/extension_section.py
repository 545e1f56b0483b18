"""Section 4 of the page: what was changed in the system?"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from shipcosim.diagnose.extension.extend import Extension
from shipcosim.diagnose.extension.extended_system import NumberChange
from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.theme.numbers import plain
from shipcosim.report.theme.views import Table


@dataclass(frozen=True)
class ExtensionSection:
    """The extended system.

    Attributes
    ----------
    found : str
        The result in a few words.
    state : str
        "extended"; or why nothing was: "no cause", "failed", "log only" (the log is to be corrected, not the system).
    content : str
        What is in it.
    system, parameters : str
        Names of the files with the extended system and its parameter set.
    values : Table
        Numbers before and after.
    inserted : str
        Components that were inserted, as one text.
    remarks : tuple of str
    """

    found: str
    state: Literal["extended", "no cause", "failed", "log only"]
    content: str = "The named causes"
    system: str = ""
    parameters: str = ""
    values: Table = Table(())
    inserted: str = ""
    remarks: tuple[str, ...] = ()


def extension_section(diagnosis: Diagnosis) -> ExtensionSection:
    """Section 4 of the page for the template."""
    section = section_of(diagnosis.extension, diagnosis.changes, bool(diagnosis.physics))
    if diagnosis.verdict == "form":
        section = replace(section, content="Those numbers of the other form that the FMUs have")
    return section


def section_of(
    extension: Extension | None, changes: Sequence[NumberChange], is_found: bool
) -> ExtensionSection:
    """Section on an extended system.

    Parameters
    ----------
    extension : Extension or None
    changes : sequence of NumberChange
    is_found : bool
        Whether a cause of the physics was found, that could have gone into the system.
    """
    # Nothing was extended: no cause was found, or the extension failed.
    if extension is None:
        return ExtensionSection("none", "failed" if is_found else "no cause")
    rows = tuple(
        (of.name, "–" if of.before is None else plain(of.before, 5), plain(of.after, 5), of.unit)
        for of in changes
    )
    return ExtensionSection(
        found="extended.ssp",
        state="extended" if extension.values else "log only",
        system=extension.ssp.name,
        parameters=extension.ssv.name,
        values=Table(rows, head=("Number", "Was", "Is", "Unit"), tight=(1, 2, 3)),
        inserted=", ".join(extension.components),
        remarks=tuple(extension.remarks),
    )
