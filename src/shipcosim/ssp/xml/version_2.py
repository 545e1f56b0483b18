"""Validation of SSP 2.0 by the schema of 1.0: additions are removed in a copy.

No package contains the schemas of 2.0. Unknown parts may be of 2.0, so they are remarks; missing
parts and wrong values are errors.

Reference: System Structure and Parameterization 2.0, sections 4 to 8.
"""

from copy import deepcopy

import lxml.etree as etree

from shipcosim.ssp.xml.document import NAMESPACES, Findings, local, parts_in
from shipcosim.ssp.xml.schemas import names_of, report_schema, schema_of
from shipcosim.ssp.xml.values import KINDS, read_value

RANGES = {f"Int{n}": (-(2 ** (n - 1)), 2 ** (n - 1) - 1) for n in (8, 16, 32, 64)}
RANGES |= {f"UInt{n}": (0, 2**n - 1) for n in (8, 16, 32, 64)}
ADDED = ("Dimension", "MetaData", "Signature", "Clock")
ADDED_ATTRIBUTES = ("startIndices", "endIndices", "systemInnerX", "systemInnerY")
UNKNOWN = ("is not expected", "is not allowed")


def validate_2(root: etree._Element, schema: str, file: str, findings: Findings) -> None:
    """Check an element of SSP 2.0; see `shipcosim.ssp.xml.validation.validate`."""
    # Reduce a copy to what 1.0 has, checking ranges of integers on the way.
    reduced = deepcopy(root)
    for element in list(reduced.iter("{*}*")):
        if element.tag.startswith(tuple(f"{{{uri}}}" for uri in NAMESPACES.values())):
            if wrong := _out_of_range(element):
                findings.error(f"{file}, line {element.sourceline}", *wrong)
            _reduce(element)
    # Check the copy, and sort the findings: unknown parts are only remarks.
    complaints = Findings()
    report_schema(schema_of(schema), names_of(schema), reduced, file, complaints)
    findings.refused_lines |= complaints.refused_lines
    for problem in complaints.problems:
        if problem.flaw:
            findings.flaw(problem.where, problem.found, problem.remedy)
        elif any(mark in problem.found for mark in UNKNOWN):
            findings.remark(problem.where, problem.found, "It is not used. " + problem.remedy)
        else:
            findings.error(problem.where, problem.found, problem.remedy)


def _reduce(element: etree._Element) -> None:
    """Turn an element into one of SSP 1.0, or remove it if 1.0 has nothing like it."""
    name = local(element)
    parent = element.getparent()
    # Elements that only 2.0 has.
    if name in ADDED and parent is not None:
        parent.remove(element)
        return
    # Version, attributes and values that 1.0 does not know.
    if (element.get("version") or "").startswith("2."):
        element.set("version", "1.0")
    for attribute in ADDED_ATTRIBUTES:
        element.attrib.pop(attribute, None)
    if name == "Connector" and element.get("kind") is not None:
        element.set("kind", "inout")  # which kinds there are is known where connectors are read
    if name == "Component":
        element.set("source", element.get("source", "none"))
        if element.get("implementation") == "ScheduledExecution":
            element.set("implementation", "any")
    if name in KINDS:
        _reduce_type(element, name)


def _reduce_type(element: etree._Element, name: str) -> None:
    """Rename a type as in 1.0, with one representative value of several."""
    space = element.tag.partition("}")[0]
    # Values as elements of their own become one attribute.
    listed = parts_in(element, "Value")
    for part in listed:
        element.remove(part)
    if listed:
        element.set("value", listed[0].get("value") or listed[0].text or "")
    kind = KINDS[name]
    text = element.get("value")
    if text is not None and kind in ("Real", "Integer", "Boolean"):
        # A wrong value stands for all, so that the schema reports it.
        texts = text.split() or [""]
        bad = [text for text in texts if not _is(kind, text)]
        element.set("value", bad[0] if bad else "0" if kind == "Integer" else texts[0])
    element.tag = f"{space}}}{kind}"


def _is(kind: str, text: str) -> bool:
    try:
        return read_value(kind, text) is not None
    except ValueError:
        return False


def _out_of_range(element: etree._Element) -> tuple[str, str] | None:
    """Found and remedy if an integer cannot have its value in so many bits, or None."""
    low, high = RANGES.get(local(element), (0, 0))
    texts = (element.get("value") or "").split() if high else []
    bad = [
        text
        for text in texts
        if _is("Integer", text) and not low <= read_value("Integer", text) <= high
    ]
    if not bad:
        return None
    return f"'{bad[0]}' is not a value of {local(element)}.", f"It has those from {low} to {high}."
