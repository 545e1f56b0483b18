"""Conformance cases: one feature each, a file in features/, made into systems on disk, whole or broken in one place."""

import shutil
import tomllib
import zipfile
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
from conformance.fmus import fmu_of
from conformance.texts import document, with_other_prefixes

HERE = Path(__file__).resolve().parent
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
        return [
            name for name, (_, version, _) in list(FORMS.items())[:4] if version in self.versions
        ]

    def keywords(self):
        """What a run is told beside the system."""
        given = {"stop_time": self.stop_time, "step_size": self.step_size}
        return {key: value for key, value in given.items() if key not in self.run}

    def times(self):
        """Times of the rows. [s]"""
        stop, step = (
            self.run.get("stop_time", self.stop_time),
            self.run.get("step_size", self.step_size),
        )
        return self.start_time + step * np.arange(round((stop - self.start_time) / step) + 1)

    def closed_form(self, signal):
        """(n,) array of what a signal must be."""
        t = self.times()
        step = self.run.get("step_size", self.step_size)
        late = np.maximum(t - step, self.start_time)
        known = {"t": t, "h": step, "late": late, "n": np.arange(len(t)), "np": np}
        value = eval(
            self.expect[signal], {"__builtins__": {}}, known
        )  # an expression of the case's own file
        return np.broadcast_to(np.asarray(value), t.shape)


@cache
def cases():
    """All cases by name."""
    return read_cases(HERE / "features")


def read_cases(folder):
    """Cases of a folder by name."""
    return {path.stem: _case(path) for path in sorted(folder.glob("*.toml"))}


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
    texts = {name: document(name, text, version) for name, text in case.files.items()}
    if twin is not None:
        found = [name for name, text in texts.items() if twin.change in text]
        assert len(found) == 1 and texts[found[0]].count(twin.change) == 1, (
            f"'{twin.change}' is {len(found)} times in"
        )
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


def _zip(folder, path):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(folder.rglob("*")):
            if file.is_file():
                archive.write(file, file.relative_to(folder).as_posix())
    return path
