"""Parameter sets written, and systems packed into an .ssp."""

import os
from contextlib import suppress
from pathlib import Path
from urllib.parse import unquote

from lxml import etree

from shipcosim.errors import Problem, ShipcosimError
from shipcosim.ssp.archive import write_archive
from shipcosim.ssp.package import open_package
from shipcosim.ssp.parameters import TOLERANCE, ParameterValue
from shipcosim.ssp.structure import FMU, ComponentElement, SystemElement, read_structure
from shipcosim.ssp.system import read_system
from shipcosim.ssp.units import BASE, find_unit
from shipcosim.ssp.xml import NAMESPACES, Findings, qualified

KIND_OF = {bool: "Boolean", int: "Integer", float: "Real", str: "String", bytes: "Binary"}


def parameter(name, value, unit=None, description="", *, tolerance=None):
    """A value for a parameter set, of the kind of its Python type.

    Parameters
    ----------
    name : str
        ``"vessel.mass"``, or the variable alone in a set for one component.
    value : float, int, bool, str or bytes
        The value; an int with a unit is a Real.
    unit : str, optional
        FMI's spelling, e.g. ``"kg.m2"``.
    description : str
        What it is and where the number comes from.
    tolerance : float, optional
        Standard deviation within which the value counts as known, in `unit`.

    Returns
    -------
    ParameterValue

    Raises
    ------
    ShipcosimError
        If the unit's spelling makes no sense.
    """
    if unit is not None and find_unit(unit).exponents is None:
        raise ShipcosimError(Problem(name, f"The unit '{unit}' is not known.", "Spell it as in FMI: 'kg.m2/s'."))
    kind = "Real" if unit is not None and type(value) is int else KIND_OF[type(value)]
    return ParameterValue(name, kind, value, find_unit(unit), description, tolerance=tolerance)


def write_ssv(path, name, values):
    """Write a parameter set; complete or not at all.

    Parameters
    ----------
    path : path
        The .ssv.
    name : str
        Of the set; some tools apply none without.
    values : iterable of ParameterValue
        As `parameter` makes them.

    Raises
    ------
    ShipcosimError
        If it cannot be written.
    """
    used = {prefix: NAMESPACES[prefix] for prefix in ("ssv", "ssc")}
    root = etree.Element(qualified("ssv:ParameterSet"), {"version": "1.0", "name": name}, used)
    listed = etree.SubElement(root, qualified("ssv:Parameters"))
    values = list(values)
    for value in values:
        _add_parameter(listed, value)
    units = {value.unit.name: value.unit for value in values if value.unit is not None}
    if units:
        defined = etree.SubElement(root, qualified("ssv:Units"))
        for unit in units.values():
            _add_unit(defined, unit)
    _write(Path(path), etree.tostring(root, pretty_print=True, xml_declaration=True, encoding="UTF-8"))


def _add_parameter(listed, value):
    given = {"description": value.description} if value.description else {}
    element = etree.SubElement(listed, qualified("ssv:Parameter"), given, name=value.name)
    typed = etree.SubElement(element, qualified(f"ssv:{value.kind}"), value=_text(value.value))
    if value.unit is not None:
        typed.set("unit", value.unit.name)
    if value.tolerance is not None:
        annotations = etree.SubElement(element, qualified("ssv:Annotations"))
        annotation = etree.SubElement(annotations, qualified("ssc:Annotation"), type=TOLERANCE)
        etree.SubElement(annotation, "tolerance", value=repr(float(value.tolerance)))


def _text(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    return value.hex() if isinstance(value, bytes) else str(value)


def _add_unit(defined, unit):
    element = etree.SubElement(defined, qualified("ssc:Unit"), name=unit.name)
    powers = {name: str(power) for name, power in zip(BASE, unit.exponents, strict=True) if power}
    base = etree.SubElement(element, qualified("ssc:BaseUnit"), powers)
    for name, neutral in (("factor", 1.0), ("offset", 0.0)):
        if getattr(unit, name) != neutral:
            base.set(name, repr(getattr(unit, name)))


def _write(path, data):
    partial = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        partial.write_bytes(data)
        os.replace(partial, path)
    except OSError as error:
        with suppress(OSError):
            partial.unlink()
        raise ShipcosimError(Problem(str(path), f"Cannot be written: {error.strerror}.")) from None


def pack(folder, fmus, out):
    """Pack a folder with a SystemStructure.ssd and its FMUs into an .ssp; the same input gives the same bytes.

    Parameters
    ----------
    folder : path
        With the SSD and its resources; hidden files stay out.
    fmus : iterable of path
        Folders with the FMUs that are not in `folder`.
    out : path
        The .ssp.

    Raises
    ------
    ShipcosimError
        With everything that is wrong with the system, or if the archive cannot be written.
    """
    read_system(folder, fmus=fmus)
    folder = Path(folder)
    files = {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not any(part.startswith(".") for part in path.relative_to(folder).parts)
    }
    findings = Findings()
    package = open_package(folder, findings, fmus)
    structure = read_structure(package.document(findings), findings)
    for element in _fmu_elements(structure.system):
        name = unquote(element.source)
        if name not in files:
            files[name] = package.locate(element.source, folder, element.place, findings).read_bytes()
    write_archive(out, files)


def _fmu_elements(system):
    for element in system.elements:
        if isinstance(element, SystemElement):
            yield from _fmu_elements(element)
        elif isinstance(element, ComponentElement) and element.type == FMU:
            yield element
