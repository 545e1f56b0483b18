"""Section 4 of the page: what was changed in the system?"""

from dataclasses import dataclass
from typing import Literal

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
    content: str = ""
    system: str = ""
    parameters: str = ""
    values: Table = Table(())
    inserted: str = ""
    remarks: tuple[str, ...] = ()


def extension_section(diagnosis: Diagnosis) -> ExtensionSection:
    """Section 4 of the page for the template."""
    extension = diagnosis.extension
    # Nothing was extended: no cause of the ship was found, or the extension failed.
    if extension is None:
        of_ship = any(finding.logs != (finding.component,) for finding in diagnosis.physics)
        return ExtensionSection("none", "failed" if of_ship else "no cause")
    rows = tuple(
        (of.name, "–" if of.before is None else plain(of.before, 5), plain(of.after, 5), of.unit)
        for of in diagnosis.changes
    )
    of_form = "Those numbers of the other form that the FMUs have"
    return ExtensionSection(
        found="extended.ssp",
        state="extended" if extension.values else "log only",
        content=of_form if diagnosis.verdict == "form" else "The named causes",
        system=extension.ssp.name,
        parameters=extension.ssv.name,
        values=Table(rows, head=("Number", "Was", "Is", "Unit")),
        inserted=", ".join(extension.components),
        remarks=tuple(extension.remarks),
    )
