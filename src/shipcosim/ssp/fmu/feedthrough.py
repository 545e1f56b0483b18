"""Direct feedthrough of an FMU: outputs that depend on inputs at once, by its ModelStructure.

Reference: FMI 1.0 co-simulation, section 3.3 (DirectDependency); FMI 2.0.4, section 2.2.8; FMI 3.0.1, section 2.4.8.
"""

from collections.abc import Iterable

import lxml.etree as etree

from shipcosim.errors import ShipcosimError
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.xml.archive import read_entry
from shipcosim.ssp.xml.document import Findings, parse, parts_in, parts_of


def feedthrough(fmu: FmuDescription) -> dict[str, frozenset[str]]:
    """Inputs that outputs depend on at once in a run.

    Parameters
    ----------
    fmu : FmuDescription
        Whose file is read again.

    Returns
    -------
    dict of str to frozenset of str
        By output. One that is not in it may follow every input: the FMU does not say.
    """
    # An FMU that cannot be read states nothing.
    try:
        data = read_entry(fmu.path, "modelDescription.xml")
    except ShipcosimError:
        data = None
    root = None if data is None else parse(data, fmu.path.name, Findings(), utf8=False)
    if root is None:
        return {}
    # FMI 1.0 lists direct dependencies at each output.
    variables = parts_of(root, "ModelVariables")
    if root.get("fmiVersion", "").startswith("1"):
        return _direct(variables)
    structure = parts_of(root, "ModelStructure")
    # FMI 3.0 refers to variables by value reference, FMI 2.0 by their index.
    if root.get("fmiVersion", "").startswith("3"):
        key = "valueReference"
        names = {part.get("valueReference"): part.get("name") for part in variables}
        listed = parts_in(structure, "Output")
    else:
        key = "index"
        names = {str(number): part.get("name") for number, part in enumerate(variables, start=1)}
        outputs = parts_in(structure, "Outputs")
        listed = [part for group in outputs for part in parts_in(group)]
    # An output with an attribute `dependencies`, which may be empty, states what it follows.
    return {
        names[part.get(key)]: frozenset(
            names[index] for index in part.get("dependencies").split() if index in names
        )
        for part in listed
        if part.get("dependencies") is not None and part.get(key) in names
    }


def _direct(variables: Iterable[etree._Element]) -> dict[str, frozenset[str]]:
    """Outputs of FMI 1.0 with a list of direct dependencies."""
    outputs = {}
    for variable in variables:
        for part in parts_in(variable, "DirectDependency"):
            outputs[variable.get("name")] = frozenset(
                (name.text or "").strip() for name in parts_in(part)
            )
    return outputs
