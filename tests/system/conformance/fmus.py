"""FMUs of the cases: built from parts/, or from C, with descriptions that a case changes."""

import hashlib
import os
import tempfile
import zipfile
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

from conformance.texts import document

from shipcosim.fmi.export.builder import build_fmu

HERE = Path(__file__).resolve().parent


def _frozen(how):
    """A table as something hashable."""
    return (
        tuple(sorted((key, _frozen(value)) for key, value in how.items()))
        if isinstance(how, dict)
        else how
    )


def _thawed(how):
    return {key: _thawed(value) for key, value in how} if isinstance(how, tuple) else how


def fmu_of(name, how):
    """Path of an FMU made of a part, with a description that a case changes; see `Case.fmus`."""
    return _fmu(name, _frozen(how))


@cache
def _fmu(name, how):
    how = _thawed(how)
    part = build_part(how.pop("part", name))
    how.pop("file", None)
    digest = hashlib.sha256(part.read_bytes() + repr((name, how)).encode()).hexdigest()
    target = part.parent / digest[:16] / f"{name}.fmu"
    if target.exists() or not how:
        return target if how else part
    target.parent.mkdir(exist_ok=True)
    # Other processes may read or make the same file: it is there whole or not at all.
    handle, temporary = tempfile.mkstemp(dir=target.parent)
    os.close(handle)
    with zipfile.ZipFile(part) as old, zipfile.ZipFile(temporary, "w") as new:
        for entry in old.infolist():
            data = old.read(entry)
            if entry.filename == "modelDescription.xml":
                data = changed_description(data, how, target.parent.name)
            new.writestr(entry, data)
        for path, text in how.get("extra", {}).items():
            new.writestr(path, document(path, text, "1.0"))
    os.replace(temporary, target)
    return target


@cache
def build_part(name):
    """Path of the FMU of parts/NAME.py or, for a name of ``c:NAME``, of the one made from C."""
    if name.startswith("c:"):
        from conformance.c_parts import build_c

        return build_c(name[2:], build_folder() / "c")
    return build_fmu(HERE / "parts" / f"{name}.py", build_folder())


@cache
def build_folder():
    """Folder for built FMUs; beside the others of the project, which git does not know."""
    folder = HERE.parents[2] / "build" / "conformance"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def changed_description(data, how, guid):
    """Model description with other attributes of variables: of the element, its type, or ``items`` of an enumeration.

    An FMU is known by its GUID in some tools, which take the first one of two for both; so this gets one of its own.
    """
    root = ElementTree.fromstring(data)
    root.set("guid", f"{{{guid}}}")
    for variable in list(root.iter("ScalarVariable")):
        for key, value in how.get(variable.get("name"), {}).items():
            if key == "items":
                _make_enumeration(root, variable, value)
            elif key == "twice":
                _add_second(root, variable, value)
            elif key == "unit":
                variable[0].attrib.pop("declaredType", None)
                variable[0].set("unit", value)
                _define(root, value)
            elif key in ("start", "min", "max"):
                variable[0].set(key, value)
            else:
                variable.set(key, value)
                if key == "causality" and value in ("calculatedParameter", "local"):
                    variable[0].attrib.pop("start", None)
                    variable.set("initial", "calculated")
    _mend_structure(root)
    return ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)


def _add_second(root, variable, other):
    """A second variable of a name, with the value of another variable."""
    second = ElementTree.fromstring(ElementTree.tostring(variable))
    named = {one.get("name"): one.get("valueReference") for one in root.iter("ScalarVariable")}
    second.set("valueReference", named[other])
    second.set("causality", "local")
    root.find("ModelVariables").append(second)


UNITS = {
    "km": {"m": "1", "factor": "1000"},
    "deg": {"rad": "1", "factor": "0.017453292519943295"},
    "rad": {"rad": "1"},
}
UNITS |= {
    "K": {"K": "1"},
    "degC": {"K": "1", "offset": "273.15"},
    "m": {"m": "1"},
    "kg": {"kg": "1"},
}
UNITS |= {"bar": {}}  # as tools write a base unit that they do not know


def _define(root, name):
    listed = root.find("UnitDefinitions")
    if name in UNITS and name not in [unit.get("name") for unit in listed]:
        ElementTree.SubElement(
            ElementTree.SubElement(listed, "Unit", name=name), "BaseUnit", UNITS[name]
        )


def _make_enumeration(root, variable, items):
    types = root.find("TypeDefinitions")
    if types is None:
        types = ElementTree.Element("TypeDefinitions")
        root.insert(list(root).index(root.find("LogCategories")), types)
    name = f"{variable.get('name')}_type"
    simple = ElementTree.SubElement(types, "SimpleType", name=name)
    listed = ElementTree.SubElement(simple, "Enumeration")
    for item, value in items.items():
        ElementTree.SubElement(listed, "Item", name=item, value=str(value))
    typed = variable[0]
    typed.tag = "Enumeration"
    typed.set("declaredType", name)


def _mend_structure(root):
    """Only outputs are listed as outputs."""
    kinds = [variable.get("causality") for variable in root.iter("ScalarVariable")]
    outputs = root.find("ModelStructure/Outputs")
    for unknown in list(outputs):
        if kinds[int(unknown.get("index")) - 1] != "output":
            outputs.remove(unknown)
    if not len(outputs):
        root.find("ModelStructure").remove(outputs)
