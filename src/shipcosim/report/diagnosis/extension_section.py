"""Section 4 of the page: what was changed in the system?"""

from dataclasses import dataclass
from typing import Any, Literal

from shipcosim.report.diagnosis.story import Story
from shipcosim.report.theme.numbers import plain
from shipcosim.report.theme.views import Table
from shipcosim.ssp import System


@dataclass(frozen=True)
class ExtensionSection:
    """The extended system.

    Attributes
    ----------
    found : str
        The result in a few words.
    state : str
        "extended"; or why nothing was: "no cause", "failed", "log only" (the log is to be corrected, not the system).
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
    system: str = ""
    parameters: str = ""
    values: Table = Table(())
    inserted: str = ""
    remarks: tuple[str, ...] = ()


def extension_section(story: Story) -> ExtensionSection:
    """The section as the template fills it in."""
    extension = story.extension
    if extension is None:
        found = any(f.kind == "physics" for f in story.diagnosis.findings)
        return ExtensionSection("none", "failed" if found else "no cause")
    after = story.extended or story.system
    rows = tuple((name, *_before_after(name, value, story.system, after)) for name, value in extension.values.items())
    return ExtensionSection(
        found="extended.ssp",
        state="extended" if extension.values else "log only",
        system=extension.ssp.name,
        parameters=extension.ssv.name,
        values=Table(rows, head=("Number", "Was", "Is", "Unit"), tight=(1, 2, 3)),
        inserted=", ".join(extension.components),
        remarks=tuple(extension.remarks),
    )


def _before_after(name: str, value: Any, system: System, extended: System) -> tuple[str, str, str]:
    """A number before and after, and its unit."""
    component, _, variable = name.rpartition(".")
    start = system.components[component].start_value(variable) if component in system.components else None
    known = extended.components[component].fmu.variables if component in extended.components else extended.inputs
    unit = known[variable].unit if variable in known else ""
    was = plain(float(start), 5) if isinstance(start, int | float) else "–"
    return was, plain(float(value), 5), "" if unit in (None, "1") else unit
