"""Conformance cases: one feature each, a file in features/, made into systems on disk, whole or broken in one place."""

import hashlib
import re
import shutil
import tomllib
import zipfile
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from shipcosim.fmi.builder import build_fmu

HERE = Path(__file__).resolve().parent
NAMES = {
    "ssd": "SystemStructureDescription",
    "ssc": "SystemStructureCommon",
    "ssv": "SystemStructureParameterValues",
    "ssm": "SystemStructureParameterMapping",
    "ssb": "SystemStructureSignalDictionary",
}
SPACES = " ".join(f'xmlns:{prefix}="http://ssp-standard.org/SSP1/{name}"' for prefix, name in NAMES.items())
SPACES += ' xmlns:osp="https://opensimulationplatform.com/SSP/OSPAnnotations"'
DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>\n'
ROOTS = {
    ".ssd": ("ssd:SystemStructureDescription", ' name="case"'),
    ".ssv": ("ssv:ParameterSet", ' name="numbers"'),
    ".ssm": ("ssm:ParameterMapping", ""),
    ".ssb": ("ssb:SignalDictionary", ""),
}
FORMS = {
    "folder, 1.0": ("folder", "1.0", str),
    "ssp, 1.0": ("ssp", "1.0", str),
    "ssd, 2.0": ("ssd", "2.0", str),
    "ssp, 2.0, other prefixes": ("ssp", "2.0", lambda text: with_other_prefixes(text)),
    "ssp, 1.0, other prefixes": ("ssp", "1.0", lambda text: with_other_prefixes(text)),
    "ssp, 2.0": ("ssp", "2.0", str),
}
"""Ways to write down a system: packing, version of the standard, prefixes. Every case is run in the first four."""


@dataclass(frozen=True)
class Twin:
    """A case's system broken in one place.

    Parameters
    ----------
    change, into : str
        Text that occurs once in the case's files, and what stands there instead.
    says : str
        Part of what the problem says, remedy included.
    at : str
        Text in the line that the problem names, where it is not that of the change; "-": it names no line.
    follow : int
        How many errors follow from it, which come after it.
    versions : tuple of str
        Of the standard, in which it is an error.
    """

    change: str
    into: str
    says: str
    at: str = ""
    follow: int = 0
    versions: tuple = ("1.0", "2.0")


@dataclass(frozen=True)
class Case:
    """A feature with its system.

    Parameters
    ----------
    name : str
        Of its file.
    group, feature, about : str
        Heading, row of the table in the docs, one sentence.
    expect : dict of str to str
        Closed form of signals: of `t`, the times, `h`, the step, and `late`, the times one step before.
    twins : tuple of Twin
        Broken ones.
    fmus : dict
        By name of the FMU: of which part it is made (`part`, the same name if not given), its `file` in the package,
        and by variable the attributes that its description has otherwise.
    files : dict of str to str
        Contents of XML files without their outermost element, by name.
    remarks : tuple of str
        Parts of remarks that reading it makes.
    stop_time, step_size, start_time : float
        Of the run. [s]
    top : str
        What is read.
    run : dict of str to float
        Those of them that the system says itself.
    versions : tuple of str
        Of the standard, that the case can be written in.
    gap : str
        Part of what shipcosim says where it does not do this.
    tolerance : float
        Relative, within which numbers are those of the closed form.
    """

    name: str
    group: str
    feature: str
    about: str
    expect: dict
    twins: tuple
    fmus: dict
    files: dict
    remarks: tuple = ()
    stop_time: float | None = 2.0
    step_size: float | None = 0.25
    start_time: float = 0.0
    versions: tuple = ("1.0", "2.0")
    top: str = "SystemStructure.ssd"
    tolerance: float = 1e-12
    gap: str = ""
    run: dict = field(default_factory=dict)

    @property
    def needs_compiler(self):
        """Whether an FMU of it is made from C."""
        return any(how.get("part", "").startswith("c:") for how in self.fmus.values())

    @property
    def forms(self):
        """Names of the forms that it can have."""
        return [name for name, (_, version, _) in list(FORMS.items())[:4] if version in self.versions]

    def keywords(self):
        """What a run is told beside the system."""
        given = {"stop_time": self.stop_time, "step_size": self.step_size}
        return {key: value for key, value in given.items() if key not in self.run}

    def times(self):
        """Times of the rows. [s]"""
        stop, step = self.run.get("stop_time", self.stop_time), self.run.get("step_size", self.step_size)
        return self.start_time + step * np.arange(round((stop - self.start_time) / step) + 1)

    def closed_form(self, signal):
        """(n,) array of what a signal must be."""
        t = self.times()
        step = self.run.get("step_size", self.step_size)
        late = np.maximum(t - step, self.start_time)
        known = {"t": t, "h": step, "late": late, "n": np.arange(len(t)), "np": np}
        value = eval(self.expect[signal], {"__builtins__": {}}, known)  # an expression of the case's own file
        return np.broadcast_to(np.asarray(value), t.shape)


@cache
def cases():
    """All cases by name."""
    return {path.stem: _case(path) for path in sorted((HERE / "features").glob("*.toml"))}


def _case(path):
    given = tomllib.loads(path.read_text(encoding="utf-8"))
    twins = tuple(Twin(**twin) for twin in given.pop("broken", ()))
    given["remarks"] = tuple(given.get("remarks", ()))
    given["versions"] = tuple(given.get("versions", ("1.0", "2.0")))
    return Case(path.stem, twins=twins, **given)


def write(case, folder, form="folder, 1.0", twin=None):
    """Write a case's system.

    Parameters
    ----------
    case : Case
        Which.
    folder : Path
        Where to; made.
    form : str
        A key of FORMS.
    twin : Twin, optional
        How it is broken.

    Returns
    -------
    Path
        What `read` takes.
    """
    packing, version, prefixes = FORMS[form]
    root = folder / "system"
    for name, text in documents(case, version, twin).items():
        file = root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(prefixes(text), encoding="utf-8")
    for name, how in case.fmus.items():
        file = root / how.get("file", f"resources/{name}.fmu")
        file.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(fmu_of(name, how), file)
    for name in [name for name in case.files if name.endswith(".ssp/SystemStructure.ssd")]:
        inner = (root / name).parent
        _zip(inner, root / "packed")
        shutil.rmtree(inner)
        (root / "packed").rename(inner)
    if packing == "ssp":
        return _zip(root, folder / "system.ssp")
    return root / case.top if packing == "ssd" or case.top != "SystemStructure.ssd" else root


def documents(case, version="1.0", twin=None):
    """Texts of the case's files by name, perhaps broken."""
    texts = {name: _document(name, text, version) for name, text in case.files.items()}
    if twin is not None:
        found = [name for name, text in texts.items() if twin.change in text]
        assert len(found) == 1 and texts[found[0]].count(twin.change) == 1, f"'{twin.change}' is {len(found)} times in"
        texts[found[0]] = texts[found[0]].replace(twin.change, twin.into)
    return texts


def line_of(case, twin):
    """Name of the file and number of the line that the problem of a twin is to name."""
    for name, text in documents(case, twin=twin).items():
        before = documents(case)[name]
        mark = twin.at or (twin.change if before != text else "")
        text = text if twin.at else before
        if mark and mark in text:
            return name, text[: text.index(mark)].count("\n") + 1
    raise AssertionError(f"'{twin.at}' is in no file of {case.name}")


def _document(name, text, version):
    tag, attributes = ROOTS.get(Path(name).suffix, ("", ""))
    if not tag or text.lstrip().startswith("<?xml"):
        return text
    if Path(name).suffix == ".ssd" and not text.lstrip().startswith('<ssd:System name="case">'):
        text = f'<ssd:System name="case">\n{text.strip()}\n</ssd:System>'
    text = re.sub(r'version="1\.0"', f'version="{version}"', text)
    return f'{DECLARATION}<{tag} version="{version}"{attributes} {SPACES}>\n{text.strip()}\n</{tag}>\n'


def with_other_prefixes(text):
    """The same as tools write it that have a default namespace and prefixes of their own."""
    for prefix, other in (("ssc", "common"), ("ssv", "v"), ("ssm", "ns3"), ("ssb", "ssd1")):
        text = re.sub(rf"(</?|xmlns:){prefix}\b", rf"\g<1>{other}", text)
    return re.sub(r"(</?)ssd:", r"\1", text).replace("xmlns:ssd=", "xmlns=")


def _zip(folder, path):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(folder.rglob("*")):
            if file.is_file():
                archive.write(file, file.relative_to(folder).as_posix())
    return path


# FMUs


def _frozen(how):
    """A table as something hashable."""
    return tuple(sorted((key, _frozen(value)) for key, value in how.items())) if isinstance(how, dict) else how


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
    with zipfile.ZipFile(part) as old, zipfile.ZipFile(target, "w") as new:
        for entry in old.infolist():
            data = old.read(entry)
            if entry.filename == "modelDescription.xml":
                data = changed_description(data, how, target.parent.name)
            new.writestr(entry, data)
        for path, text in how.get("extra", {}).items():
            new.writestr(path, _document(path, text, "1.0"))
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
    folder = HERE.parents[1] / "build" / "conformance"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def changed_description(data, how, guid):
    """Model description with other attributes of variables: of the element, its type, or ``items`` of an enumeration.

    An FMU is known by its GUID in some tools, which take the first one of two for both; so this gets one of its own.
    """
    root = ElementTree.fromstring(data)
    root.set("guid", f"{{{guid}}}")
    for variable in root.iter("ScalarVariable"):
        for key, value in how.get(variable.get("name"), {}).items():
            if key == "items":
                _make_enumeration(root, variable, value)
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


UNITS = {"km": {"m": "1", "factor": "1000"}, "deg": {"rad": "1", "factor": "0.017453292519943295"}, "rad": {"rad": "1"}}
UNITS |= {"K": {"K": "1"}, "degC": {"K": "1", "offset": "273.15"}, "m": {"m": "1"}, "kg": {"kg": "1"}}


def _define(root, name):
    listed = root.find("UnitDefinitions")
    if name in UNITS and name not in [unit.get("name") for unit in listed]:
        ElementTree.SubElement(ElementTree.SubElement(listed, "Unit", name=name), "BaseUnit", UNITS[name])


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
