"""Reader of an FMU's variables, whichever version of FMI describes them."""

from collections.abc import Mapping
from typing import Any

import lxml.etree as etree

from shipcosim.ssp.fmu.description import Variable
from shipcosim.ssp.fmu.fmi1 import is_negated, items_of, traits_of
from shipcosim.ssp.xml.definitions import by_name
from shipcosim.ssp.xml.document import Document, Findings, local, parts_in, parts_of
from shipcosim.ssp.xml.values import KINDS, Value, read_value, typed_part

Sizes = Mapping[str, tuple[str, str | None]]
"""Name and start value of the variables by value reference, for dimensions of arrays that are given by one of them."""


def read_variables(document: Document, findings: Findings) -> dict[str, Variable]:
    """Variables of a model description by name; aliases of FMI 3.0 are variables of their own.

    FMI 1.0 and 2.0 put the type into a child element, FMI 3.0 makes it the element itself.

    Parameters
    ----------
    document : Document
        The modelDescription.xml.
    findings : Findings
        Takes what is wrong.
    """
    # Declared types, and the variables that have a type we know.
    types = {part.get("name"): part for part in parts_of(document.root, "TypeDefinitions")}
    elements = [
        part
        for part in parts_of(document.root, "ModelVariables")
        if _type_element(part) is not None
    ]
    # Dimensions can refer to variables by value reference.
    sizes = {part.get("valueReference"): (part.get("name"), part.get("start")) for part in elements}
    is_first = document.root.get("fmiVersion", "").startswith("1.")
    variables = {}
    for element in elements:
        for named in (element, *parts_in(element, "Alias")):
            name = named.get("name")
            description = named.get("description", "")
            # A variable with a bad value is left out; the others are still read.
            try:
                variable = _variable(element, name, description, types, sizes, is_first)
                if name in variables:
                    # Say of a second variable of a name what becomes of it: the name means the first one, as in
                    # libcosim.
                    first = (
                        f"{variables[name].type}, value reference {variables[name].value_reference}"
                    )
                    second = f"{variable.type}, value reference {variable.value_reference}"
                    same = first == second
                    what = "the same value" if same else f"another value ({second})"
                    more = "" if same else "; this one cannot be reached"
                    message = f"A second variable has this name, for {what}. The name means the first one{more}."
                    findings.flaw(document.place(element, name), message, "Names must differ.")
                variables.setdefault(name, variable)
                if outside := _start_outside(variable):
                    findings.remark(document.place(element, name), outside)
            except ValueError as error:
                findings.error(document.place(element, name), str(error))
    return variables


def _start_outside(variable: Variable) -> str:
    """Message on a settable variable that starts outside its own range; empty if it does not."""
    low, high = variable.minimum, variable.maximum
    start = variable.start
    if variable.causality not in ("input", "parameter") or variable.required:
        return ""
    if not isinstance(start, (int, float)) or isinstance(start, bool):
        return ""
    if (low is None or start >= low) and (high is None or start <= high):
        return ""
    ends = [
        f"{word} {end:g}" for word, end in (("at least", low), ("at most", high)) if end is not None
    ]
    return f"It starts with {start:g}. Its own range is {' and '.join(ends)}."


def _type_element(element: etree._Element) -> etree._Element | None:
    """The element that carries type, unit, start and bounds."""
    if local(element) != "ScalarVariable":
        return element if local(element) in KINDS else None
    return typed_part(element)


def _variable(
    element: etree._Element,
    name: str,
    description: str,
    types: Mapping[str, etree._Element],
    sizes: Sizes,
    is_first: bool,
) -> Variable:
    typed = _type_element(element)
    assert typed is not None  # the others were left out
    declared = types.get(typed.get("declaredType"))
    kind = KINDS[local(typed)]
    # FMI 3.0 arrays have Dimension elements.
    written = parts_in(element, "Dimension")
    dimensions = tuple(_size(part, sizes) for part in written)
    traits = traits_of(element, typed, kind) if is_first else _traits(element, kind)
    return Variable(
        name=name,
        value_reference=int(element.get("valueReference")),
        type=local(typed),
        **traits,
        unit=_attribute(typed, declared, "unit"),
        start=_start(typed, kind, dimensions),
        minimum=_bound(typed, declared, kind, "min"),
        maximum=_bound(typed, declared, kind, "max"),
        description=description,
        items=_items(declared, is_first) if kind == "Enumeration" else {},
        dimensions=dimensions,
        sizes=tuple(_size_as_written(part, sizes) for part in written),
        negated=is_first and is_negated(element),
        required=_is_marked(element, "required"),
        optional=_is_marked(element, "optional"),
    )


def _is_marked(element: etree._Element, mark: str) -> bool:
    """True if the annotation that our own FMUs have at their variables says so."""
    return any(part.get(mark) == "true" for part in element.iter("Quantity"))


def _traits(element: etree._Element, kind: str) -> dict[str, Any]:
    return {
        "causality": element.get("causality", "local"),
        "variability": element.get("variability", "continuous" if kind == "Real" else "discrete"),
        "initial": element.get("initial"),
    }


def _size(dimension: etree._Element, sizes: Sizes) -> int:
    """Size of one dimension: a number, or the start value of a structural parameter."""
    text = dimension.get("start") or sizes.get(dimension.get("valueReference"), (None, None))[1]
    if text is None:
        raise ValueError(
            "The size of a dimension is neither given nor that of a variable with a start value."
        )
    return read_value("Integer", text)


def _size_as_written(dimension: etree._Element, sizes: Sizes) -> int | str:
    text = dimension.get("start")
    return (
        sizes[dimension.get("valueReference")][0] if text is None else read_value("Integer", text)
    )


def _declaration(declared: etree._Element | None) -> etree._Element | None:
    """Element of a declared type with its attributes, which FMI 1.0 and 2.0 nest in another one."""
    if declared is None or local(declared) not in ("SimpleType", "Type"):
        return declared
    return next((part for part in declared if local(part).removesuffix("Type") in KINDS), None)


def _attribute(typed: etree._Element, declared: etree._Element | None, name: str) -> str | None:
    declaration = _declaration(declared)
    return typed.get(name) or (declaration.get(name) if declaration is not None else None)


def _bound(
    typed: etree._Element, declared: etree._Element | None, kind: str, name: str
) -> float | None:
    text = _attribute(typed, declared, name)
    return None if text is None or kind not in ("Real", "Integer", "Enumeration") else float(text)


def _items(declared: etree._Element | None, is_first: bool) -> dict[str, int]:
    declaration = _declaration(declared)
    if is_first:
        return items_of(declaration)
    items = [] if declaration is None else parts_in(declaration, "Item")
    return by_name("item", ((item.get("name"), int(item.get("value"))) for item in items))


def _start(typed: etree._Element, kind: str, dimensions: tuple[int, ...]) -> Value | None:
    # Items of enumerations are numbers here.
    kind = "Integer" if kind == "Enumeration" else kind
    # Strings and binaries of FMI 3.0 stand in elements of their own.
    nested = [part.get("value") for part in parts_in(typed, "Start")]
    if nested:
        values = tuple(read_value(kind, text) for text in nested)
        return values if dimensions else values[0]
    if typed.get("start") is None:
        return None
    if dimensions:
        return tuple(read_value(kind, text) for text in typed.get("start").split())
    return read_value(kind, typed.get("start"))
