"""Schemas of SSP 1.0 and FMI from FMPy; violations are reported in plain words."""

import re
from collections.abc import Collection
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import lxml.etree as etree

from shipcosim.errors import LONGEST_NAME
from shipcosim.ssp.xml.document import Findings, remedy_for
from shipcosim.ssp.xml.values import KINDS

SCHEMAS = {
    "ssd": "ssp/schema/SystemStructureDescription.xsd",
    "ssv": "ssp/schema/SystemStructureParameterValues.xsd",
    "ssm": "ssp/schema/SystemStructureParameterMapping.xsd",
    "ssb": "ssp/schema/SystemStructureSignalDictionary.xsd",
    "fmi1": "schema/fmi1/fmiModelDescription.xsd",
    "fmi2": "schema/fmi2/fmi2ModelDescription.xsd",
    "fmi3": "schema/fmi3/fmi3ModelDescription.xsd",
}
WORDS = {"double": "a number", "int": "a whole number", "boolean": "a Boolean (true, false, 1, 0)"}


HARMLESS = re.compile(
    r"^Element '(UnitDefinitions|TypeDefinitions|LogCategories|Outputs|Derivatives|InitialUnknowns|VendorAnnotations|"
    r"ModelVariables)': Missing child element"
    r"|^Element 'fmiModelDescription': Missing child element\(s\)\. Expected is .*\bModelStructure\b"
    r"|attribute 'generationDateAndTime'"
)
"""Violations in model descriptions that leave nothing open."""
SAYING = ("LinearTransformation", "MapEntry", "BaseUnit", "Item", "MappingEntry", *KINDS)
"""Elements all of whose attributes matter: one that is not known is a slip."""


@dataclass(frozen=True)
class Names:
    """Names that schemas have for elements and for attributes."""

    elements: frozenset[str]
    attributes: frozenset[str]


def is_slip(name: str, names: Collection[str]) -> bool:
    """True if an unknown name looks like a misspelt known one.

    Examples
    --------
    >>> is_slip("startConector", ["startConnector"]), is_slip("comment", ["startConnector"])
    (True, False)
    """
    shown = name[:LONGEST_NAME].lower()
    return name in names or bool(
        get_close_matches(shown, [candidate.lower() for candidate in names], n=1, cutoff=0.77)
    )


def report_schema(
    checker: etree.XMLSchema, names: Names, root: etree._Element, file: str, findings: Findings
) -> None:
    """Report every violation of a schema; unknown attributes are flaws unless they look misspelt.

    Parameters
    ----------
    checker : lxml.etree.XMLSchema
        The schema.
    names : Names
        Those that it knows.
    root : lxml element
        To be checked.
    file : str
        Name for messages.
    findings : Findings
        Takes what is wrong.
    """
    if checker.validate(root):
        return
    # Translate the message of the schema checker into plain words.
    for entry in checker.error_log:
        text = re.sub(r"\{(http|urn)[^}]*\}", "", entry.message)
        for kind, word in WORDS.items():
            text = text.replace(f"a valid value of the atomic type 'xs:{kind}'", word)
        text, _, choice = re.sub(r"\[facet '[^']*'\] ", "", text).partition(
            " is not an element of the set "
        )
        complaint, _, expected = (f"{text} does not exist." if choice else text).partition(
            " Expected is "
        )
        where = f"{file}, line {entry.line}" if entry.line else file
        # A flaw has one possible meaning; everything else is an error.
        if _is_flaw(text, names):
            findings.flaw(
                where,
                f"{text.partition(' Expected is ')[0]} It is not used.",
                "Correct its name or remove it.",
            )
            continue
        # Values on this line are not checked again.
        findings.refused_lines.add(where)
        if choice:
            expected = f"one of: {choice.strip('{}.')}."
        findings.error(
            where, complaint, f"Expected is {expected}" if expected else remedy_for(complaint)
        )


def _is_flaw(text: str, names: Names) -> bool:
    """True if a violation has only one possible meaning."""
    unknown = re.search(
        r"^Element '(\w+)', attribute '([^']+)': The attribute '\2' is not allowed\.", text
    )
    if unknown is None:
        return HARMLESS.search(text) is not None
    return unknown[1] not in SAYING and not is_slip(unknown[2], names.attributes)


@cache
def schema_of(name: str) -> etree.XMLSchema:
    """Schema by its name in SCHEMAS."""
    parser = etree.XMLParser(no_network=True)
    return etree.XMLSchema(etree.parse(str(_file_of(name)), parser))


@cache
def names_of(name: str) -> Names:
    """Names in a schema of SCHEMAS and in its neighbours."""
    schemas = sorted(_file_of(name).parent.glob("*.xsd"))
    return names_in("".join(file.read_text(encoding="utf-8") for file in schemas))


def names_in(text: str) -> Names:
    """Names that a schema's text declares."""
    return Names(
        *(
            frozenset(re.findall(rf'<xs:{kind} name="([^"]+)"', text))
            for kind in ("element", "attribute")
        )
    )


def _file_of(name: str) -> Path:
    fmpy = find_spec("fmpy")  # finds FMPy without running its slow import
    return Path((fmpy and fmpy.submodule_search_locations or [""])[0]) / SCHEMAS[name]
