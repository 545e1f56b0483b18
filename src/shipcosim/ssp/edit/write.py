"""Write parameter sets, and pack systems into an .ssp."""

from collections.abc import Iterable, Mapping
from copy import deepcopy
from pathlib import Path
from urllib.parse import quote

import lxml.etree as etree

from shipcosim.errors import ShipcosimError, error_at
from shipcosim.ssp.edit.parameter_sets import write_value
from shipcosim.ssp.flatten.assemble import assemble_package
from shipcosim.ssp.flatten.system import System
from shipcosim.ssp.read.package import open_package
from shipcosim.ssp.read.parameters import ParameterValue
from shipcosim.ssp.xml.archive import replaced, write_archive
from shipcosim.ssp.xml.document import AnyPath, Findings, qualified
from shipcosim.ssp.xml.markup import add, ensure, to_bytes
from shipcosim.ssp.xml.values import Value
from shipcosim.units import as_python, find_unit

KIND_OF = {bool: "Boolean", int: "Integer", float: "Real", str: "String", bytes: "Binary"}
PREFIXES = {".ssd": ("ssd", "ssc", "ssv", "osp"), ".ssv": ("ssv", "ssc")}
"Namespace prefixes that a written file declares, by its ending."


def parameter(
    name: str,
    value: Value,
    unit: str | None = None,
    description: str = "",
    *,
    tolerance: float | None = None,
) -> ParameterValue:
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
        If the unit's spelling makes no sense, or the value is of another type.
    """
    # A unit must be convertible, or the value has no meaning.
    defined = find_unit(unit)
    if defined is not None and defined.exponents is None:
        raise error_at(name, f"The unit '{unit}' is not known.", "Spell it as in FMI: 'kg.m2/s'.")
    value = as_python(value)
    kind = "Real" if unit is not None and type(value) is int else KIND_OF.get(type(value))
    if kind is None:
        raise error_at(name, f"found {value!r:.60}.", "Give a number, True or False, or a text.")
    return ParameterValue(name, kind, value, defined, description, tolerance=tolerance)


def parameters_of(system: System) -> list[ParameterValue]:
    """Parameters of a system that can be set, with the values that they have now.

    Parameters
    ----------
    system : System
        Of a structure or of one FMU.

    Returns
    -------
    list of ParameterValue
        By component, in the order of its FMU; arrays and parameters without a start value are left out. Those of one
        FMU have its own names, so that the set can be bound to any component of it.
    """
    values = []
    is_one = system.file.lower().endswith(".fmu")
    for component, variable in system.all_variables():
        value = component.start_value(variable.name)
        if variable.causality not in ("parameter", "structuralParameter"):
            continue
        if value is None or variable.dimensions:
            continue
        # An SSV holds an enumeration's value as the name of its item.
        names = {number: item for item, number in variable.items.items()}
        values.append(
            ParameterValue(
                variable.name if is_one else f"{component.name}.{variable.name}",
                variable.kind,
                names.get(value, value) if variable.kind == "Enumeration" else value,
                find_unit(variable.unit, component.fmu.units),
                variable.description,
                tolerance=component.tolerances.get(variable.name),
            )
        )
    return values


def write_ssv(path: AnyPath, name: str, values: Iterable[ParameterValue]) -> None:
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
    write_file(Path(path), ssv_text(name, values))


def ssv_text(name: str, values: Iterable[ParameterValue]) -> bytes:
    """Text of a parameter set; arguments as for `write_ssv`."""
    root = etree.Element(qualified("ssv:ParameterSet"), {"version": "1.0", "name": name})
    listed = ensure(root, "ssv:Parameters")
    for value in values:
        write_value(root, add(listed, "ssv:Parameter", name=value.name), value)
    return to_bytes(root, "ssv", "ssc")


def mapping_text(values: Iterable[ParameterValue]) -> bytes:
    """Text of a parameter mapping (SSM) from each of the values' names to itself, to change its source."""
    root = etree.Element(qualified("ssm:ParameterMapping"), {"version": "1.0"})
    for value in values:
        add(root, "ssm:MappingEntry", source=value.name, target=value.name)
    return to_bytes(root, "ssm", "ssc")


def write_file(path: Path, data: bytes) -> None:
    """Write a file, complete or not at all; its folder is made if needed.

    Raises
    ------
    ShipcosimError
        If it cannot be written.
    """
    with replaced(path) as partial:
        partial.write_bytes(data)


def pack(folder: AnyPath, fmus: Iterable[AnyPath], out: AnyPath) -> None:
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
    # Check the system first: a faulty package is not written.
    findings = Findings()
    folder = Path(folder)
    package = open_package(folder, findings, fmus)
    if package is not None:
        assemble_package(package, (), str(folder), findings)
    if package is None or findings.errors:
        raise ShipcosimError(list(dict.fromkeys(findings.errors)))
    # Files of the folder come before FMUs of the same name from elsewhere.
    paths = package.located | files_in(folder)
    files = {name: path.read_bytes() for name, path in paths.items()}
    # Addresses of FMUs elsewhere become those within the package.
    if package.moved and (document := package.document(findings)) is not None:
        files[package.ssd] = to_bytes(relocated(document.root, package.moved), *PREFIXES[".ssd"])
    write_archive(out, files)


def files_in(folder: Path) -> dict[str, Path]:
    """Files in a folder and its folders by their names from there, except hidden ones."""
    paths = {path.relative_to(folder): path for path in folder.rglob("*") if path.is_file()}
    return {
        name.as_posix(): path
        for name, path in paths.items()
        if not any(part.startswith(".") for part in name.parts)
    }


def relocated(root: etree._Element, moved: Mapping[str, str]) -> etree._Element:
    """An SSD with non-standard addresses replaced by those of files in the written package.

    Parameters
    ----------
    root : lxml element
        Stays as it is.
    moved : mapping of str to str
        Names in the package by address.
    """
    if not moved:
        return root
    root = deepcopy(root.getroottree()).getroot()
    for element in root.iter("{*}*"):
        if element.get("source") in moved:
            element.set("source", quote(moved[element.get("source", "")]))
    return root
