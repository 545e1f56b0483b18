"""Flaws of an OspSystemStructure.xml with only one possible meaning, corrected before it is read.

The same as `shipcosim.ssp.xml.mend` does for the files of SSP: each is reported as a flaw.
"""

import lxml.etree as etree

from shipcosim.ssp.osp.schema import NAMESPACE, SCHEMA
from shipcosim.ssp.xml.document import Document, Findings, local, parts_in
from shipcosim.ssp.xml.mend import drop_empty_attributes, drop_unknown, mend_boolean, sort_parts
from shipcosim.ssp.xml.schemas import names_in

VERSION = "0.1"
"""The only version of the format."""

ORDER = (
    "StartTime",
    "EndTime",
    "BaseStepSize",
    "Algorithm",
    "Simulators",
    "Functions",
    "Connections",
    "EccoConfiguration",
)
"""Parts of the outermost element in the order of the schema."""

EMPTY_IS_ABSENT = ("stepSize", "causality", "powerBond", "factor", "offset")
TEXTS = ("StartTime", "EndTime", "BaseStepSize", "Algorithm")
"""Elements without meaning if they have no text."""


def mend_osp(document: Document, findings: Findings) -> None:
    """Correct a document in place; without effect if its outermost element is of another name.

    Parameters
    ----------
    document : Document
        Changed in place.
    findings : Findings
        Takes the flaws.
    """
    root = document.root
    if local(root) != "OspSystemStructure":
        return
    _set_namespace(document, findings)
    version = root.get("version")
    if version != VERSION:
        message = "It has no version" if not version else f"Its version is '{version}'"
        root.set("version", VERSION)
        findings.flaw(
            document.place(root), f"{message}; {VERSION} is taken.", f'Write version="{VERSION}".'
        )
    names = names_in(SCHEMA).elements
    for element in list(root.iter(etree.Element)):
        drop_unknown(document, element, names, findings)
        drop_empty_attributes(document, element, findings, EMPTY_IS_ABSENT)
        mend_boolean(document, element, findings)
    # An empty time or algorithm says nothing.
    for part in parts_in(root):
        if local(part) in TEXTS and not (part.text or "").strip():
            root.remove(part)
            message = f"<{local(part)}> is empty; it is taken as if it were not there."
            findings.flaw(document.place(part), message, "Remove it.")
    sort_parts(document, root, ORDER, findings)


def _set_namespace(document: Document, findings: Findings) -> None:
    """Put elements without a namespace, or in another one than OSP's, into OSP's."""
    root = document.root
    space = etree.QName(root).namespace or ""
    if space == NAMESPACE:
        return
    for element in root.iter(f"{{{space}}}*"):
        element.tag = f"{{{NAMESPACE}}}{local(element)}"
    its = f"the namespace '{space}'" if space else "no namespace"
    findings.flaw(
        document.place(root),
        f"It is in {its}; it is taken for one of {NAMESPACE}.",
        f'Add xmlns="{NAMESPACE}".',
    )
