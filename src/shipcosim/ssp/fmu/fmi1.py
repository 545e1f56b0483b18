"""Model descriptions of FMI 1.0 in the terms of FMI 2.0, where the two differ.

Reference: FMI 1.0.1 for co-simulation, section 3.3; FMI 1.0.1 for model exchange, section 3.
"""

from typing import Any

import lxml.etree as etree

from shipcosim.ssp.xml.definitions import by_name
from shipcosim.ssp.xml.document import is_true, local, parts_in


def interfaces_of(root: etree._Element) -> dict[str, dict[str, str]]:
    """Attributes of the FMU's interface: co-simulation with an Implementation, else exchange."""
    attributes = {"modelIdentifier": root.get("modelIdentifier", "")}
    implementation = next(iter(parts_in(root, "Implementation")), None)
    if implementation is None:
        return {"ModelExchange": attributes}
    # Capabilities, and whether another tool must run the FMU.
    for part in implementation.iter():
        if local(part) == "Capabilities":
            attributes |= dict(part.attrib)
        elif local(part) == "CoSimulation_Tool":
            attributes["needsExecutionTool"] = "true"
    return {"CoSimulation": attributes}


def traits_of(element: etree._Element, typed: etree._Element, kind: str) -> dict[str, Any]:
    """Causality, variability and initial of a variable, as FMI 2.0 would state them.

    Parameters
    ----------
    element, typed : lxml element
        The ScalarVariable, and the element in it that has the type.
    kind : str
        Of the type.

    Returns
    -------
    dict of str to (str or None)
    """
    # FMI 1.0 marks parameters by variability, not by causality.
    causality = element.get("causality", "internal")
    variability = element.get("variability", "continuous")
    if variability == "parameter":
        return {"causality": "parameter", "variability": "fixed", "initial": "exact"}
    # Only reals can be continuous.
    if variability == "continuous" and kind != "Real":
        variability = "discrete"
    # FMI 1.0 states by `fixed` whether a start value is exact.
    initial = None
    if causality != "input" and typed.get("start") is not None:
        initial = "exact" if is_true(typed.get("fixed", "true")) else "approx"
    return {
        "causality": causality if causality in ("input", "output") else "local",
        "variability": variability,
        "initial": initial,
    }


def is_negated(element: etree._Element) -> bool:
    """True if a variable is the negative of the one with the same value reference."""
    return element.get("alias") == "negatedAlias"


def items_of(declaration: etree._Element | None) -> dict[str, int]:
    """Items of an enumeration, numbered from its least value, by default 1."""
    if declaration is None:
        return {}
    first = int(declaration.get("min") or 1)
    items = parts_in(declaration, "Item")
    return by_name("item", ((item.get("name"), i) for i, item in enumerate(items, start=first)))
