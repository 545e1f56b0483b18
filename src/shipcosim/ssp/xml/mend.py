"""Flaws with only one possible meaning, corrected in the tree before it is read.

Files in the wild have them: missing namespaces, empty attributes or lists, parts in another order.
Each is reported as a flaw of the document.
"""

import re
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

import lxml.etree as etree

from shipcosim.ssp.xml.document import NAMESPACES, Document, Findings, local, parts_in
from shipcosim.ssp.xml.schemas import is_slip, names_of
from shipcosim.ssp.xml.values import KINDS

PREFIXES = {
    "SystemStructureDescription": "ssd",
    "ParameterSet": "ssv",
    "ParameterMapping": "ssm",
    "SignalDictionary": "ssb",
}
"""Prefix of the kind of a file by its outermost element."""

COMMON = (
    "Unit",
    "BaseUnit",
    "Item",
    "Annotation",
    "MapEntry",
    "Dimension",
    "MetaData",
    "Signature",
)
EMPTY_IS_ABSENT = (
    "startElement",
    "endElement",
    "source",
    "sourceBase",
    "implementation",
    "type",
    "unit",
    "id",
)
EMPTY_IS_ABSENT += ("suppressUnitConversion", "startTime", "stopTime", "factor", "offset")
ORDER = {
    "SystemStructureDescription": "System Enumerations Units DefaultExperiment MetaData Annotations",
    "System": "Connectors ElementGeometry ParameterBindings Elements Connections SignalDictionaries SystemGeometry"
    " GraphicalElements MetaData Annotations",
    "Component": "Connectors ElementGeometry ParameterBindings MetaData Annotations",
    "SignalDictionaryReference": "Connectors ElementGeometry ParameterBindings Annotations",
    "ParameterBinding": "ParameterValues ParameterMapping MetaData Annotations",
    "ParameterSet": "Parameters Enumerations Units MetaData Annotations",
    "SignalDictionary": "DictionaryEntry Enumerations Units MetaData Annotations",
}
"""Parts of elements in the order of the standard."""

LISTS = (
    "Connectors",
    "Elements",
    "Connections",
    "ParameterBindings",
    "Enumerations",
    "Units",
    "SignalDictionaries",
)
LISTS += ("GraphicalElements", "Annotations")
ONCE = ("MappingEntry", "MapEntry", "Unit", "Enumeration", "Item")
"""Elements that may be repeated with equal content without effect."""


def mend(document: Document, tag: str) -> None:
    """Correct a document of a kind in place; corrections become flaws of the document.

    Parameters
    ----------
    document : Document
        Changed in place.
    tag : str
        Of the outermost element that it should have: ``"ssv:ParameterSet"``.
    """
    prefix, name = tag.split(":")
    if document.mended or local(document.root) != name:
        return
    document.mended = True
    # Namespaces first: all other corrections find elements by them.
    noted = Findings()
    _set_namespaces(document, prefix, noted)
    _complete(document, noted)
    names = names_of("ssd").elements | KINDS.keys() | {"Dimension", "MetaData", "Signature"}
    for element in list(_own_elements(document.root)):
        drop_empty_attributes(document, element, noted)
        _move_source(document, element, noted)
        # The type of a connector that is an enumeration without a name gets an empty one.
        is_type = (
            local(element) == "Enumeration" and element.get("value") is None and not len(element)
        )
        if is_type and element.get("name") is None and _prefix_in(element) == "ssc":
            element.set("name", "")
        mend_boolean(document, element, noted)
        _drop_what_1_0_lacks(document, element, names, noted)
        sort_parts(document, element, ORDER.get(local(element), "").split(), noted)
        _join_lists(document, element, noted)
        _drop_empty_lists(document, element, noted)
        _drop_repeated(document, element, noted)
    # Each once, in their order.
    document.flaws[:] = dict.fromkeys([*document.flaws, *noted.problems])


def _own_elements(element: etree._Element) -> Iterator[etree._Element]:
    """An element and its parts that the standard describes, without contents of annotations."""
    ahead = [element]
    while ahead:
        element = ahead.pop()
        yield element
        if local(element) != "Annotation":
            ahead += parts_in(element)[::-1]


def _set_namespaces(document: Document, prefix: str, noted: Findings) -> None:
    """Correct namespaces that are missing or of another part of the standard, by place."""
    # Walk down with the kind of file, which changes within bindings.
    noted_pairs = set()
    ahead = [(document.root, prefix)]
    names = names_of("ssd").elements
    # Some tools write the standard's names under an address of their own.
    endings = tuple(f"/{uri.rpartition('/')[2]}" for uri in NAMESPACES.values())
    while ahead:
        element, kind = ahead.pop()
        name = local(element)
        space = etree.QName(element).namespace or ""
        # Variants of our namespaces, such as https, count as ours.
        plain = space.replace("https:", "http:").rstrip("/")
        ours = not space or plain.endswith(endings)
        right = NAMESPACES[_prefix_of(element, kind)]
        # Report each pair of wrong and right namespace once.
        if ours and space != right and name in names:
            if (space, right) not in noted_pairs:
                its = f"the namespace '{space}'" if space else "no namespace"
                message = f"<{name}> is in {its}"
                noted.flaw(
                    document.place(element),
                    f"{message}; it is taken for one of {right}.",
                    "Correct xmlns.",
                )
            noted_pairs.add((space, right))
            element.tag = f"{{{right}}}{name}"
        if name != "Annotation" and (ours or name in names):
            ahead += [(part, _kind_within(element, part, kind)) for part in parts_in(element)]


def _prefix_of(element: etree._Element, kind: str) -> str:
    """Prefix of an element in a kind of file."""
    name = local(element)
    parent = element.getparent()
    if name in COMMON or name.endswith("Transformation"):
        return "ssc"
    if name == "Enumeration" and parent is not None and local(parent) == "Enumerations":
        return "ssc"
    return "ssc" if name in KINDS and kind != "ssv" else kind


def _kind_within(element: etree._Element, part: etree._Element, kind: str) -> str:
    """Kind of a part of an element: it changes within the bindings of an SSD."""
    inline = (
        kind == "ssd"
        and local(part) in PREFIXES
        and local(element) in ("ParameterValues", local(part))
    )
    return PREFIXES[local(part)] if inline else kind


def _complete(document: Document, noted: Findings) -> None:
    """Add version and name where the outermost element or a set has none."""
    # A set without a version has that of the file.
    outer = document.root.get("version") or "1.0"
    for element in document.root.iter(
        *(f"{{{NAMESPACES[p]}}}{name}" for name, p in PREFIXES.items())
    ):
        if (
            local(element) != "ParameterMapping"
            and not element.get("name")
            and local(element) != "SignalDictionary"
        ):
            element.set("name", Path(document.file).stem)
            noted.flaw(
                document.place(element), f"<{local(element)}> has no name.", 'Add name="...".'
            )
        is_binding = local(element) in (
            "ParameterMapping",
            "SignalDictionary",
        ) and "ssd" == _prefix_in(element)
        if not element.get("version") and not is_binding:
            element.set("version", outer)
            noted.flaw(
                document.place(element),
                f"<{local(element)}> has no version; {outer} is taken.",
                "Add it.",
            )


def _prefix_in(element: etree._Element) -> str:
    space = etree.QName(element).namespace
    return next((prefix for prefix, uri in NAMESPACES.items() if uri == space), "")


def drop_empty_attributes(
    document: Document,
    element: etree._Element,
    noted: Findings,
    names: tuple[str, ...] = EMPTY_IS_ABSENT,
) -> None:
    """Drop empty attributes of these names, except where an empty text means something."""
    for name in names:
        # An empty attribute counts as absent, except where an empty text means something.
        if element.get(name) == "" and not (
            name == "source" and local(element) in ("Component", "MapEntry")
        ):
            if name == "source" and local(element) == "MappingEntry":
                continue
            del element.attrib[name]
            noted.flaw(
                document.place(element),
                f'{name}="" is taken as if it were not there.',
                "Leave it out.",
            )


def _move_source(document: Document, element: etree._Element, noted: Findings) -> None:
    """Move the address of a parameter set from ParameterValues to its binding."""
    parent = element.getparent()
    if local(element) == "ParameterValues" and element.get("source") and parent is not None:
        if parent.get("source") in (None, "", element.get("source")):
            parent.set("source", element.attrib.pop("source"))
            noted.flaw(
                document.place(element),
                "The source stands at <ParameterValues>; it is taken for that of the binding.",
                "Write it at <ParameterBinding>.",
            )
            parent.remove(element)


def mend_boolean(document: Document, element: etree._Element, noted: Findings) -> None:
    """Correct True and FALSE, as programs without XML libraries write them."""
    for name in ("value", "suppressUnitConversion"):
        text = element.get(name)
        of_type = name != "value" or local(element) == "Boolean"
        if (
            text is not None
            and of_type
            and text.lower() in ("true", "false")
            and text != text.lower()
        ):
            element.set(name, text.lower())
            noted.flaw(
                document.place(element),
                f"'{text}' is taken for {text.lower()}.",
                "Write true or false.",
            )


def _drop_what_1_0_lacks(
    document: Document, element: etree._Element, names: Collection[str], noted: Findings
) -> None:
    """Remove parts that SSP 1.0 does not know; what 1.0 lacks may be something of 2.0."""
    if (document.root.get("version") or "").startswith("2"):
        return
    if local(element) in names and local(element) != "Annotation" and local(element) not in KINDS:
        drop_unknown(document, element, names, noted)


def drop_unknown(
    document: Document, element: etree._Element, names: Collection[str], noted: Findings
) -> None:
    """Remove unknown parts of an element, except misspelt known ones."""
    for part in parts_in(element):
        name = local(part)
        if name not in names and not is_slip(name, names):
            noted.flaw(
                document.place(part),
                f"The element <{name}> is not of the standard. It is not used.",
                "Remove it.",
            )
            element.remove(part)


def sort_parts(
    document: Document, element: etree._Element, order: Sequence[str], noted: Findings
) -> None:
    """Sort the parts of an element as the standard orders them; only where all of them are known."""
    parts = parts_in(element)
    if not order or any(local(part) not in order for part in parts):
        return
    ordered = sorted(parts, key=lambda part: order.index(local(part)))
    if ordered != parts:
        element[:] = ordered
        listed = ", ".join(dict.fromkeys(local(part) for part in ordered))
        noted.flaw(
            document.place(element),
            f"Its parts are in another order than the standard's: {listed}.",
            "Sort them.",
        )


def _join_lists(document: Document, element: etree._Element, noted: Findings) -> None:
    """Join lists of one name, such as two ParameterBindings, in the first of them."""
    first: dict[str, etree._Element] = {}
    for part in parts_in(element, *LISTS):
        name = local(part)
        if name not in first:
            first[name] = part
            continue
        first[name].extend(list(part))
        element.remove(part)
        noted.flaw(
            document.place(part),
            f"A second <{name}>; its parts are taken for parts of the first.",
            "Write them into one list.",
        )


def _drop_empty_lists(document: Document, element: etree._Element, noted: Findings) -> None:
    for part in parts_in(element, *LISTS):
        if not any(local(inner) for inner in part):
            element.remove(part)
            noted.flaw(
                document.place(part),
                f"<{local(part)}> is empty; it is taken as if it were not there.",
                "Remove it.",
            )


def _drop_repeated(document: Document, element: etree._Element, noted: Findings) -> None:
    """Remove elements that repeat an earlier one."""
    seen = {}
    for part in parts_in(element, *ONCE):
        content = _content(part)
        if content in seen:
            noted.flaw(
                document.place(part, part.get("name") or ""),
                f"<{local(part)}> says the same as line {seen[content]}; it counts once.",
                "Keep one of them.",
            )
            element.remove(part)
        seen.setdefault(content, part.sourceline)


def _content(element: etree._Element) -> tuple:
    """Content of an element, without drawing and description."""
    attributes = {
        name: text for name, text in element.attrib.items() if name not in ("id", "description")
    }
    parts = [
        part
        for part in element
        if local(part) and not re.search("Geometry$|^Annotations$", local(part))
    ]
    return (
        element.tag,
        tuple(sorted(attributes.items())),
        (element.text or "").strip(),
        tuple(map(_content, parts)),
    )
