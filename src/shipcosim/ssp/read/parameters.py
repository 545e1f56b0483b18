"""Parameter sets (SSV), parameter mappings (SSM) and signal dictionaries (SSB).

Reference: System Structure and Parameterization 1.0, sections 4.5, 6, 7 and 8.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import lxml.etree as etree

from shipcosim.ssp.read.attributes import attribute
from shipcosim.ssp.xml.definitions import noted_units, read_enumerations
from shipcosim.ssp.xml.document import (
    NAMESPACES,
    AnyPath,
    Document,
    Findings,
    children,
    is_true,
    local,
    parts_in,
    qualified,
    reporting,
)
from shipcosim.ssp.xml.mend import mend
from shipcosim.ssp.xml.validation import validate
from shipcosim.ssp.xml.values import KINDS, Value, read_value, typed_part
from shipcosim.units import Unit, find_unit

TOLERANCE = "shipcosim.tolerance"
"""Type of the annotation with a parameter's tolerance."""

MAPPINGS = {
    "BooleanMappingTransformation": "Boolean",
    "IntegerMappingTransformation": "Integer",
    "EnumerationMappingTransformation": "Enumeration",
}


@dataclass(frozen=True)
class Transformation:
    """Transformation of a value by a connection or by an entry of a parameter mapping.

    Parameters
    ----------
    kind : str
        ``"Linear"``, or of a table: ``"Boolean"``, ``"Integer"``, ``"Enumeration"`` (its entries are item names).
    factor, offset : float
        target = factor * source + offset, after the conversion of units.
    table : mapping
        Target by source; a value that is not in it stays as it is.
    """

    kind: str = "Linear"
    factor: float = 1.0
    offset: float = 0.0
    table: Mapping[Value, Value] = field(default_factory=dict)


@dataclass(frozen=True)
class ParameterValue:
    """A value in a parameter set.

    Parameters
    ----------
    name : str
        Of the parameter, with the names of the elements before it: ``"vessel.mass"``.
    kind : str
        Real, Integer, Boolean, String, Enumeration or Binary.
    value : float, int, bool, str or bytes
        An enumeration's value is the name of its item.
    unit : Unit or None
        Of a real value.
    description : str
        What it is and where the number comes from.
    place : str
        Where it stands, for messages.
    tolerance : float or None
        Standard deviation within which the value counts as known, in `unit`; kept in an annotation of ours.
    dimensions : tuple of int
        Of an array, whose `value` is a tuple, the last index fastest; empty for a scalar.
    """

    name: str
    kind: str
    value: Value
    unit: Unit | None = None
    description: str = ""
    place: str = ""
    tolerance: float | None = None
    dimensions: tuple[int, ...] = ()


@dataclass(frozen=True)
class ParameterSet:
    """A parameter set (SSV): a name, values, and the file that it stands in, for messages."""

    name: str
    values: tuple[ParameterValue, ...]
    file: str = ""


ParameterSets = AnyPath | ParameterSet | Iterable[AnyPath | ParameterSet]
"""Parameter sets given for a run: one or several, each read already or the path of its .ssv."""


@dataclass(frozen=True)
class MappingEntry:
    """An entry of a parameter mapping (SSM): a parameter of the set, and the one of the element that gets its value.

    Parameters
    ----------
    source, target : str
        Names in the parameter set and in the element.
    transformation : Transformation or None
        Of the value.
    suppress_unit_conversion : bool
        Leave the value as it is even if units differ.
    place : str
        Where it stands, for messages.
    """

    source: str
    target: str
    transformation: Transformation | None = None
    suppress_unit_conversion: bool = False
    place: str = ""


@dataclass(frozen=True)
class DictionaryEntry:
    """An entry of a signal dictionary (SSB): a signal's name and type.

    Parameters
    ----------
    name : str
        Unique within the dictionary.
    kind : str
        Real, Integer, Boolean, String, Enumeration or Binary.
    unit : Unit or None
        Of a Real.
    items : mapping of str to int
        Of an Enumeration.
    """

    name: str
    kind: str
    unit: Unit | None = None
    items: Mapping[str, int] = field(default_factory=dict)


def has_root(document: Document, tag: str, findings: Findings) -> bool:
    """Check that the outermost element has this tag, with an error if not.

    Deviations from the standard with only one possible meaning are corrected first, and reported.

    Parameters
    ----------
    document : Document
        The file.
    tag : str
        With our prefix: ``"ssv:ParameterSet"``.
    findings : Findings
        Takes what is wrong.
    """
    mend(document, tag)
    findings.problems += document.flaws
    if document.root.tag == qualified(tag):
        return True
    message = f"Its outermost element is <{local(document.root)}>."
    prefix, name = tag.split(":")
    findings.error(
        document.place(document.root),
        message,
        f'Right would be <{name} xmlns="{NAMESPACES[prefix]}">.',
    )
    return False


def read_parameter_set(document: Document, findings: Findings) -> ParameterSet:
    """Read the values of an SSV document.

    Parameters
    ----------
    document : Document
        File or inline element.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    ParameterSet, empty where the document is no such thing
    """
    root = document.root
    if not has_root(document, "ssv:ParameterSet", findings):
        return ParameterSet("", (), document.file)
    # Read values only from a document that keeps its schema.
    sound = validate(root, "ssv", document.file, findings)
    values = {}
    # Units first: values refer to them.
    units = noted_units(document, children(root, "ssv:Units", "ssc:Unit"), findings)
    for element in children(root, "ssv:Parameters", "ssv:Parameter") if sound else ():
        value = _parameter(document, element, units, findings)
        # The same parameter twice: equal values are a flaw, different ones an error.
        if value is not None and value.name in values:
            first = values[value.name]
            line = first.place.rpartition(", line ")[2].partition(":")[0]
            message = f"The set has this parameter already, in line {line}"
            if (first.kind, first.value, first.unit) == (value.kind, value.value, value.unit):
                findings.flaw(
                    value.place,
                    f"{message}, with the same value; it counts once.",
                    "Keep one of them.",
                )
            else:
                findings.error(value.place, f"{message}.", "Keep one of them.")
        elif value is not None:
            values[value.name] = value
    return ParameterSet(root.get("name", ""), tuple(values.values()), document.file)


def _parameter(
    document: Document, element: etree._Element, units: Mapping[str, Unit], findings: Findings
) -> ParameterValue | None:
    name = element.get("name", "")
    typed = typed_part(element)
    if typed is None or not name:
        findings.error(
            document.place(element, name),
            "A parameter needs a name and one element with type and value.",
        )
        return None
    # Arrays of SSP 2.0 have their sizes as elements.
    kind = KINDS[local(typed)]
    try:
        sizes = tuple(
            read_value("Integer", part.get("size", "")) for part in parts_in(element, "Dimension")
        )
        value = _values(kind, typed) if sizes else read_value(kind, _text(typed))
        tolerance = tolerance_of(element)
    except ValueError as error:
        findings.error(
            document.place(element, name),
            str(error),
            "Correct it, or leave the parameter to its default.",
        )
        return None
    unit = find_unit(typed.get("unit"), units)
    description = element.get("description", "")
    return ParameterValue(
        name, kind, value, unit, description, document.place(element, name), tolerance, sizes
    )


def _values(kind: str, typed: etree._Element) -> tuple[Value, ...]:
    """Values of an array: a list in one attribute, or an element each where blanks may occur."""
    listed = _listed(typed) or typed.get("value", "").split()
    return tuple(read_value(kind, text) for text in listed)


def _listed(typed: etree._Element) -> list[str]:
    return [part.get("value") or part.text or "" for part in parts_in(typed, "Value")]


def _text(typed: etree._Element) -> str:
    """Text of a single value, which SSP 2.0 allows in an element of its own."""
    listed = _listed(typed)
    return typed.get("value", listed[0] if len(listed) == 1 else "")


def tolerance_of(element: etree._Element) -> float | None:
    """Tolerance in our annotation of a Parameter element, or None."""
    for annotation in children(element, "ssv:Annotations", "ssc:Annotation"):
        if annotation.get("type") == TOLERANCE and len(annotation):
            return read_value("Real", annotation[0].get("value", ""))
    return None


def read_mapping(document: Document, findings: Findings) -> tuple[MappingEntry, ...]:
    """Read the entries of a parameter mapping (SSM).

    Parameters
    ----------
    document : Document
        File or inline element.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    tuple of MappingEntry, empty where the document is no such thing
    """
    if not has_root(document, "ssm:ParameterMapping", findings):
        return ()
    # Read entries only from a document that keeps its schema.
    sound = validate(document.root, "ssm", document.file, findings)
    entries = {}
    for element in children(document.root, "ssm:MappingEntry") if sound else ():
        source = element.get("source", "")
        target = element.get("target", "")
        place = document.place(element, f"{source} -> {target}")
        # A parameter takes one value only.
        suppressed = is_true(element.get("suppressUnitConversion"))
        if target in entries:
            findings.error(
                place,
                f"'{entries[target].source}' is mapped to this parameter already.",
                "Keep one of them.",
            )
        entries[target] = MappingEntry(
            source, target, read_transformation(document, element, findings), suppressed, place
        )
    return tuple(entries.values())


def read_transformation(
    document: Document, element: etree._Element, findings: Findings
) -> Transformation | None:
    """Transformation of a connection or mapping entry, or None.

    Parameters
    ----------
    document : Document
        The file.
    element : lxml element
        The Connection or MappingEntry.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    Transformation or None
    """
    for part in element:
        # Missing numbers are factor 1 and offset 0.
        if local(part) == "LinearTransformation":
            numbers = [
                _attribute_of(document, part, name, "Real", findings)
                for name in ("factor", "offset")
            ]
            return Transformation(
                factor=1.0 if numbers[0] is None else numbers[0], offset=numbers[1] or 0.0
            )
        if local(part) in MAPPINGS:
            return _table(document, part, MAPPINGS[local(part)], findings)
    return None


def _table(
    document: Document, element: etree._Element, kind: str, findings: Findings
) -> Transformation:
    table = {}
    # Each value is mapped once.
    for entry in children(element, "ssc:MapEntry"):
        source, target = (
            _attribute_of(document, entry, name, kind, findings) for name in ("source", "target")
        )
        if source is None or target is None:
            continue  # an error already
        if source in table:
            findings.error(
                document.place(entry),
                f"The value '{source}' is mapped twice.",
                "Keep one of the entries.",
            )
        table[source] = target
    return Transformation(kind=kind, table=table)


def _attribute_of(
    document: Document, element: etree._Element, name: str, kind: str, findings: Findings
) -> Value | None:
    return attribute(document, element, name, kind, findings, f"{local(element)}, {name}")


def read_dictionary(document: Document, findings: Findings) -> dict[str, DictionaryEntry]:
    """Read the entries of a signal dictionary (SSB) by name.

    Parameters
    ----------
    document : Document
        File or inline element.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    dict of str to DictionaryEntry, empty where the document is no such thing
    """
    if not has_root(document, "ssb:SignalDictionary", findings):
        return {}
    root = document.root
    if not validate(root, "ssb", document.file, findings):
        return {}
    # Units and enumerations first: entries refer to them.
    units = noted_units(document, children(root, "ssb:Units", "ssc:Unit"), findings)
    enumerations = {}
    with reporting(document, root, findings):
        enumerations = read_enumerations(children(root, "ssb:Enumerations", "ssc:Enumeration"))
    entries = {}
    # Names must differ; entries without a type are left out.
    for element in children(root, "ssb:DictionaryEntry"):
        typed = typed_part(element)
        if element.get("name") in entries:
            place = document.place(element, element.get("name"))
            findings.error(place, "The dictionary has this entry already.", "Names must differ.")
        if typed is not None:
            items = enumerations.get(typed.get("name"), {})
            unit = find_unit(typed.get("unit"), units)
            entries[element.get("name")] = DictionaryEntry(
                element.get("name"), KINDS[local(typed)], unit, items
            )
    return entries
