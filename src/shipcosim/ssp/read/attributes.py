"""Numbers in attributes of SSP files; an invalid one is an error, and read as None."""

from collections.abc import Mapping

import lxml.etree as etree

from shipcosim.ssp.xml.annotations import stated
from shipcosim.ssp.xml.document import Document, Findings, local, reporting
from shipcosim.ssp.xml.values import Value, read_value


def attribute(
    document: Document,
    element: etree._Element,
    name: str,
    kind: str,
    findings: Findings,
    what: str = "",
) -> Value | None:
    """Value of an attribute; None if missing or, with an error, invalid.

    Parameters
    ----------
    document : Document
        The file.
    element : lxml element
        In it.
    name : str
        Of the attribute.
    kind : str
        Real, Integer, Boolean, ...
    findings : Findings
        Takes what is wrong.
    what : str
        The attribute's name in messages, where it is another.
    """
    value = None
    text = element.get(name)
    if text is not None:
        with reporting(document, element, findings, what or name):
            value = read_value(kind, text)
    return value


def whole_numbers(
    document: Document, element: etree._Element, name: str, findings: Findings
) -> tuple[int, ...]:
    """Whole numbers listed in an attribute.

    Parameters
    ----------
    document : Document
        The file.
    element : lxml element
        In it.
    name : str
        Of the attribute.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    tuple of int
        With 0 in the place of one that makes no sense; empty where the attribute is missing.
    """
    numbers = []
    for text in (element.get(name) or "").split():
        number = 0
        with reporting(document, element, findings, name):
            number = read_value("Integer", text)
        numbers.append(number)
    return tuple(numbers)


def annotated_number(
    document: Document, owner: etree._Element, names: Mapping[str, str], findings: Findings
) -> float | None:
    """Positive number that any tool's annotation gives for an element, or None.

    Parameters
    ----------
    document : Document
        The file.
    owner : lxml element
        That has the annotations.
    names : mapping of str to str
        Elements in annotations that give it, and their attributes.
    findings : Findings
        Takes what is wrong.
    """
    # The first annotation that gives it counts.
    element, name = next(stated(owner, names), (None, ""))
    if element is None:
        return None
    number = attribute(document, element, name, "Real", findings)
    if number is not None and number <= 0.0:
        place = document.place(element, local(element))
        findings.error(place, f"{name} is {number:g}.", "It must be positive.")
    return number
