"""Editing of XML in place: added elements stand where the schema requires, all else stays.

Added elements are indented like their neighbours.
"""

from collections.abc import Container
from copy import deepcopy

import lxml.etree as etree

from shipcosim.ssp.xml.document import NAMESPACES, child, children, local, parent_of, qualified

INDENT = "  "
ORDER = {
    "SystemStructureDescription": (
        "System",
        "Enumerations",
        "Units",
        "DefaultExperiment",
        "Annotations",
    ),
    "System": (
        "Connectors",
        "ElementGeometry",
        "ParameterBindings",
        "Elements",
        "Connections",
        "SignalDictionaries",
        "SystemGeometry",
        "GraphicalElements",
        "Annotations",
    ),
    "Component": ("Connectors", "ElementGeometry", "ParameterBindings", "Annotations"),
    "ParameterSet": ("Parameters", "Enumerations", "Units", "Annotations"),
    "Parameter": ("Real", "Integer", "Boolean", "String", "Enumeration", "Binary", "Annotations"),
}
"""Children in the order of the schema, of the elements that have several. All others take theirs in any order."""

OSP = "https://opensimulationplatform.com/SSP/OSPAnnotations"
OSP_TYPE = "com.opensimulationplatform"
OSP_MARK = "opensimulationplatform"


def add(parent: etree._Element, tag: str, **attributes: str | None) -> etree._Element:
    """Add a new element where the schema requires it: after its kind, before later kinds.

    Parameters
    ----------
    parent : lxml element
        Changed in place.
    tag : str
        With our prefix: ``"ssd:Connector"``.
    **attributes : str or None
        None: left out.

    Returns
    -------
    lxml element
    """
    given = {name: value for name, value in attributes.items() if value is not None}
    element = parent.makeelement(qualified(tag), given)
    put(parent, element)
    return element


def put(parent: etree._Element, element: etree._Element) -> None:
    """Insert an element into a parent where the schema requires it."""
    # Before the first element that the schema orders after it.
    order = ORDER.get(local(parent), ())
    later = order[order.index(local(element)) + 1 :] if local(element) in order else ()
    index = next((parent.index(part) for part in parent if local(part) in later), len(parent))
    # Indent the new element, and the white space around it, as its neighbours.
    level = sum(1 for _ in parent.iterancestors())
    before = parent[index - 1] if index else None
    parent.insert(index, element)
    etree.indent(element, space=INDENT, level=level + 1)
    if before is None:
        parent.text = "\n" + INDENT * (level + 1)
    else:
        before.tail = "\n" + INDENT * (level + 1)
    element.tail = "\n" + INDENT * (level + (index + 1 < len(parent)))


def ensure(parent: etree._Element, *tags: str) -> etree._Element:
    """Child of the last tag of a path, created if missing."""
    for tag in tags:
        inner = child(parent, tag)
        parent = add(parent, tag) if inner is None else inner
    return parent


def drop(element: etree._Element) -> None:
    """Remove an element, and its list if that is then empty: the schema forbids empty lists."""
    # White space after the element moves to the one before.
    parent = parent_of(element)
    before = element.getprevious()
    if element.getnext() is None and before is not None:
        before.tail = element.tail
    parent.remove(element)
    if parent.find("*") is None and parent.getparent() is not None and not parent.attrib:
        drop(parent)


def add_osp(root: etree._Element, parent: etree._Element, *names: str, **attributes: str) -> None:
    """Put an OSP annotation into an element of an SSD.

    Parameters
    ----------
    root, parent : lxml element
        The SSD's outermost element, and the one that is annotated.
    *names : str
        Elements within the annotation, each in the one before.
    **attributes : str
        Of the last of them.
    """
    # One annotation of OSP's type holds all of its elements.
    listed = ensure(parent, "ssd:Annotations")
    marked = [part for part in children(listed, "ssc:Annotation") if part.get("type") == OSP_TYPE]
    element = marked[0] if marked else add(listed, "ssc:Annotation", type=OSP_TYPE)
    uri = osp_namespace(root)
    for name in names:
        inner = element.makeelement(f"{{{uri}}}{name}", nsmap={"osp": uri})
        put(element, inner)
        element = inner
    element.attrib.update(attributes)


def to_bytes(root: etree._Element, *prefixes: str) -> bytes:
    """Serialise an element, with the standard prefixes declared on the root.

    libcosim identifies elements by these very prefixes, and OSP's only if declared on the root.
    Everything else, also what no schema knows, stays unchanged.

    Parameters
    ----------
    root : lxml element
        Outermost element.
    *prefixes : str
        Declared whether they are used or not; those in use are anyway.
    """
    # Prefixes of the standard that are in use, that of the root first.
    used = {etree.QName(element).namespace for element in root.iter(etree.Element)}
    spaces = NAMESPACES | {"osp": osp_namespace(root)}
    spaces = dict(
        sorted(spaces.items(), key=lambda item: item[1] != etree.QName(root).namespace)
    )  # its own one first
    names = {prefix: uri for prefix, uri in spaces.items() if prefix in prefixes or uri in used}
    # Foreign prefixes stay, unless they would clash.
    foreign = {
        p: uri
        for p, uri in root.nsmap.items()
        if p and p not in names and uri not in names.values()
    }
    # Copy into a root with these declarations, with comments around it.
    copied = etree.Element(root.tag, dict(root.attrib), names | foreign)
    copied.text = root.text
    copied.extend(
        deepcopy(part) for part in root
    )  # which brings their prefixes in line with the root's
    for outside in reversed(list(root.itersiblings(preceding=True))):
        copied.addprevious(deepcopy(outside))
    for outside in reversed(list(root.itersiblings())):
        copied.addnext(deepcopy(outside))
    return (
        etree.tostring(copied.getroottree(), xml_declaration=True, encoding="UTF-8").rstrip()
        + b"\n"
    )


def osp_namespace(root: etree._Element) -> str:
    """Namespace of OSP's annotations in a file, the algorithm's first; the usual one if none."""
    annotated = [
        element.tag for element in root.iter("{*}Algorithm", "{*}*") if OSP_MARK in element.tag
    ]
    annotated.sort(key=lambda tag: not tag.endswith("}Algorithm"))
    return etree.QName(annotated[0]).namespace if annotated else OSP


def free_name(name: str, taken: Container[str]) -> str:
    """The name, with a number behind it if taken.

    Examples
    --------
    >>> free_name("line", ["line", "line_2"])
    'line_3'
    """
    number = 1
    free = name
    while free in taken:
        number += 1
        free = f"{name}_{number}"
    return free
