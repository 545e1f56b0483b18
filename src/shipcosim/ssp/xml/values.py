"""Types and values of variables as written in SSP and FMI."""

from collections.abc import Callable
from typing import Any

import lxml.etree as etree

from shipcosim.ssp.xml.document import parts_in
from shipcosim.units import is_finite

KINDS = {
    "Real": "Real",
    "Float64": "Real",
    "Float32": "Real",
    "Integer": "Integer",
    **{f"{sign}Int{bits}": "Integer" for sign in ("", "U") for bits in (8, 16, 32, 64)},
    "Boolean": "Boolean",
    "String": "String",
    "Enumeration": "Enumeration",
    "Binary": "Binary",
    "Clock": "Clock",
}
"""Kind of each type name of FMI 2.0, FMI 3.0 and SSP: what can be connected and converted alike."""

Value = Any
"""A value of a variable: float, int, bool, str or bytes, as its kind says; of an enumeration the name of its item."""

SSP_1_TYPES = ("Real", "Integer", "Boolean", "String", "Enumeration", "Binary")
"""Types of SSP 1.0; the kinds of all others (FMI 3.0) are among them, except for clocks."""

BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


def read_value(kind: str, text: str) -> Value:
    """Value from the text of an attribute.

    Parameters
    ----------
    kind : str
        A value of KINDS. An enumeration's item stays a text.
    text : str
        As in the file.

    Returns
    -------
    float, int, bool, str or bytes

    Raises
    ------
    ValueError
        With a sentence on what is wrong.

    Examples
    --------
    >>> read_value("Boolean", "1"), read_value("Real", " 2.5 ")
    (True, 2.5)
    """
    if kind == "Real":
        return _number(float, text, "number")
    if kind == "Integer":
        return _number(int, text, "whole number")
    if kind == "Boolean":
        if text.strip() not in BOOLEANS:
            raise ValueError(f"'{text}' is not a Boolean (true, false, 1, 0).")
        return BOOLEANS[text.strip()]
    if kind == "Binary":
        return bytes.fromhex(text)
    return text


def _number(convert: Callable[[str], float], text: str, name: str) -> float:
    try:
        value = convert(
            text.replace("_", "x")
        )  # Python would take "1_000" for a number, XML does not
    except ValueError:
        raise ValueError(f"'{text}' is not a {name}.") from None
    if not is_finite(value):
        raise ValueError(f"'{text:.60}' is not a finite number.")
    return value


def text_of(value: Value) -> str:
    """Text of a value, from which `read_value` makes the same value.

    Examples
    --------
    >>> text_of(True), text_of(0.1), text_of(b"~")
    ('true', '0.1', '7e')
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    return value.hex() if isinstance(value, bytes) else str(value)


def typed_part(element: etree._Element) -> etree._Element | None:
    """Child element with the type, such as <Real>; None without one."""
    return next(iter(parts_in(element, *KINDS)), None)
