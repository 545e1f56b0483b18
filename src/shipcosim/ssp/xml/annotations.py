"""Annotations of other tools: step sizes, which are used, and algorithms, which are reported as not used.

The standard leaves step size and algorithm to the tools. Known are those of OSP (libcosim), ecos and Vico, and
OMSimulator; elements are found by their names in any namespace, since ecos and older versions of OSP use their own.
"""

import re
from collections.abc import Iterator, Mapping

import lxml.etree as etree

from shipcosim.ssp.xml.document import (
    Document,
    Findings,
    child,
    children,
    local,
    parent_of,
    qualified,
)

STEP_SIZES = {"FixedStepAlgorithm": "baseStepSize", "FixedStepMaster": "stepSize"}
"""Where annotations give the base step size: libcosim and ecos; OMSimulator and older OSP."""

STEP_SIZE_HINTS = {"StepSizeHint": "value"}
"""Where annotations of a component give its own step size: ecos and Vico."""

ASKS = re.compile(r"(Algorithm|Master|Solver|StepSizeHint|Bus|^Connection)$")


def step_sizes(root: etree._Element) -> Iterator[tuple[etree._Element, str]]:
    """Elements and attributes that state the base step size in an SSD; the first one counts."""
    for owner in (child(root, "ssd:DefaultExperiment"), child(root, "ssd:System")):
        yield from stated(owner, STEP_SIZES)


def stated(
    owner: etree._Element | None, names: Mapping[str, str]
) -> Iterator[tuple[etree._Element, str]]:
    """Elements and attributes in an element's own annotations that give a number under one of these names."""
    for annotation in () if owner is None else children(owner, "ssd:Annotations", "ssc:Annotation"):
        for part in annotation.iter("{*}*"):
            attribute = names.get(local(part))
            if attribute and part.get(attribute) is not None:
                yield part, attribute


def remark_ignored(document: Document, findings: Findings) -> None:
    """Add a remark on each algorithm, step size and connection that annotations of an SSD ask for and do not get.

    Parameters
    ----------
    document : Document
        The SSD.
    findings : Findings
        Takes what is wrong.
    """
    honoured = [part for part, _ in list(step_sizes(document.root))[:1]]
    for component in document.root.iter(qualified("ssd:Component")):
        honoured += [part for part, _ in list(stated(component, STEP_SIZE_HINTS))[:1]]
    for annotation in document.root.iter(qualified("ssc:Annotation")):
        for part in annotation.iter("{*}*"):
            if _asks(part) and part not in honoured and not _repeats(part, honoured[:1]):
                _remark(part, annotation, document, findings)


def _asks(part: etree._Element) -> bool:
    """Whether an element asks for an algorithm or a step itself, rather than through one in it."""
    within = [inner for inner in part.iterdescendants("{*}*") if ASKS.search(local(inner))]
    return bool(ASKS.search(local(part))) and not within


def _repeats(part: etree._Element, honoured: list[etree._Element]) -> bool:
    """Whether an element states the step size that holds anyway."""
    sizes = [one.get(STEP_SIZES.get(local(one), "stepSize")) for one in (part, *honoured)]
    return len(sizes) == 2 and sizes[0] is not None and sizes[0] == sizes[1]


def _remark(
    part: etree._Element, annotation: etree._Element, document: Document, findings: Findings
) -> None:
    owner = parent_of(parent_of(annotation))
    numbers = STEP_SIZES | STEP_SIZE_HINTS
    attribute = (
        "description" if part.get("description") else numbers.get(local(part), "description")
    )
    detail = f" ({part.get(attribute)})" if part.get(attribute) else ""
    found = f"An annotation asks for {local(part)}{detail}, which is ignored."
    remedy = "All components step with one fixed base step, or a multiple of it that their StepSizeHint gives."
    if local(part) in ("Bus", "Connection"):
        remedy = "Only the connections of the standard are made."
    findings.remark(document.place(part, owner.get("name") or local(owner)), found, remedy)
