"""Annotations of other tools: step sizes, which are used, and algorithms, which are reported.

The standard leaves step size and algorithm to the tools. Those of OSP (libcosim), ecos, Vico and
OMSimulator are known; elements match in any namespace, since ecos and older OSP use their own.
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
    """Elements and attributes in an element's annotations that give a number under such a name."""
    for annotation in () if owner is None else children(owner, "ssd:Annotations", "ssc:Annotation"):
        for part in annotation.iter("{*}*"):
            attribute = names.get(local(part))
            if attribute and part.get(attribute) is not None:
                yield part, attribute


def remark_ignored(document: Document, findings: Findings) -> None:
    """Remark each algorithm, step size and connection in annotations that is not used.

    Parameters
    ----------
    document : Document
        The SSD.
    findings : Findings
        Takes what is wrong.
    """
    # The first stated base step and each component's own step are used.
    honoured = [part for part, _ in list(step_sizes(document.root))[:1]]
    for component in document.root.iter(qualified("ssd:Component")):
        honoured += [part for part, _ in list(stated(component, STEP_SIZE_HINTS))[:1]]
    # Everything else that asks for an algorithm or a step is
    # reported, unless it repeats the base step.
    for annotation in document.root.iter(qualified("ssc:Annotation")):
        for part in annotation.iter("{*}*"):
            if _asks(part) and part not in honoured and not _repeats(part, honoured[:1]):
                _remark(part, annotation, document, findings)


def _asks(part: etree._Element) -> bool:
    """True if the element itself asks for an algorithm or a step, not one inside it."""
    within = [inner for inner in part.iterdescendants("{*}*") if ASKS.search(local(inner))]
    return bool(ASKS.search(local(part))) and not within


def _repeats(part: etree._Element, honoured: list[etree._Element]) -> bool:
    """True if an element states the step size that applies anyway."""
    sizes = [
        annotation.get(STEP_SIZES.get(local(annotation), "stepSize"))
        for annotation in (part, *honoured)
    ]
    return len(sizes) == 2 and sizes[0] is not None and sizes[0] == sizes[1]


def _remark(
    part: etree._Element, annotation: etree._Element, document: Document, findings: Findings
) -> None:
    owner = parent_of(parent_of(annotation))
    # Tell which element asks for what, with its number or description.
    numbers = STEP_SIZES | STEP_SIZE_HINTS
    attribute = (
        "description" if part.get("description") else numbers.get(local(part), "description")
    )
    detail = f" ({part.get(attribute)})" if part.get(attribute) else ""
    message = f"An annotation asks for {local(part)}{detail}, which is ignored."
    remedy = "All components step with one fixed base step, or a multiple of it that their StepSizeHint gives."
    if local(part) in ("Bus", "Connection"):
        remedy = "Only the connections of the standard are made."
    findings.remark(document.place(part, owner.get("name") or local(owner)), message, remedy)
