"""Schemas of SSP 1.0 and FMI, as FMPy brings them; where a file breaks one is said in words that an engineer knows."""

import re
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import lxml.etree as etree

from shipcosim.ssp.xml.document import Findings, remedy_for

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


def report_schema(checker: etree.XMLSchema, root: etree._Element, file: str, findings: Findings) -> None:
    """Note every place where an element breaks a schema.

    Parameters
    ----------
    checker : lxml.etree.XMLSchema
        The schema.
    root : lxml element
        To be checked.
    file : str
        Name for messages.
    findings : Findings
        Takes what is wrong.
    """
    if checker.validate(root):
        return
    for entry in checker.error_log:
        text = re.sub(r"\{(http|urn)[^}]*\}", "", entry.message)
        for kind, word in WORDS.items():
            text = text.replace(f"a valid value of the atomic type 'xs:{kind}'", word)
        text, _, choice = re.sub(r"\[facet '[^']*'\] ", "", text).partition(" is not an element of the set ")
        found, _, expected = (f"{text} does not exist." if choice else text).partition(" Expected is ")
        where = f"{file}, line {entry.line}" if entry.line else file
        findings.refused_lines.add(where)
        if choice:
            expected = f"one of: {choice.strip('{}.')}."
        findings.error(where, found, f"Expected is {expected}" if expected else remedy_for(found))


@cache
def schema_of(name: str) -> etree.XMLSchema:
    """Schema by its name in SCHEMAS."""
    fmpy = find_spec("fmpy")  # finds FMPy without running its slow import
    folder = Path((fmpy and fmpy.submodule_search_locations or [""])[0])
    parser = etree.XMLParser(no_network=True)
    return etree.XMLSchema(etree.parse(str(folder / SCHEMAS[name]), parser))
