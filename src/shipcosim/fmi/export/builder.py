"""Packs FMUs: `build_fmu` one, `build_all` those of a folder. Only this module uses pythonfmu."""

import ast
import contextlib
import hashlib
import html
import importlib
import importlib.metadata
import importlib.util
import io
import sys
import traceback
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import ModuleType

from shipcosim.errors import Problem, ShipcosimError, error_at, suggestion
from shipcosim.fmi.export.bundle import Bundle, bundle, entry_module
from shipcosim.fmi.export.description import model_description
from shipcosim.fmi.export.loader import SUFFIXES, loader_for
from shipcosim.fmi.fmu import Fmu
from shipcosim.temporary import replace_file, temporary_folder

EPOCH = (1980, 1, 1, 0, 0, 0)
PAGE = """<!DOCTYPE html>
<html><head><meta charset="utf-8"><title>{title}</title></head>
<body><pre>{text}</pre></body></html>
"""


def build_fmu(source: Path | str, out: Path | str) -> Path:
    """Build one FMU; the same source gives the same bytes.

    Parameters
    ----------
    source : Path or str
        Folder ``<name>`` that holds ``<name>.py``, or the script itself. README.md and reference.csv come along.
    out : Path or str
        Folder for ``<name>.fmu``, made if needed.

    Returns
    -------
    Path
        The FMU.

    Raises
    ------
    ShipcosimError
        The script is missing, not Python, does not hold exactly one FMU, or the FMU cannot be written.
    """
    # Code, entry module, binaries and documentation; the
    # description last, since its GUID needs them.
    with fmu_class(source) as (cls, script, bundled):
        files = {f"resources/{path}": data for path, data in bundled.files.items()}
        files[f"resources/{bundled.entry}.py"] = entry_module(bundled, cls.__name__)
        files["resources/slavemodule.txt"] = bundled.entry.encode()
        files |= _binaries(script.stem) | documentation(script)
        files["modelDescription.xml"] = _description(cls, script, files)
    return write_archive(Path(out) / f"{script.stem}.fmu", files)


@contextlib.contextmanager
def fmu_class(source: Path | str) -> Iterator[tuple[type[Fmu], Path, Bundle]]:
    """Class of an FMU as it will run, its script and its files; unloaded afterwards.

    Parameters
    ----------
    source : Path or str
        As of `build_fmu`.

    Raises
    ------
    ShipcosimError
        As of `build_fmu`.
    """
    script = _script(Path(source))
    bundled = bundle(script)
    with _imported(bundled) as module:
        yield _fmu_class(module, script), script, bundled


def build_all(
    root: Path | str, names: Iterable[str] = (), out: Path | str = "build/fmus"
) -> list[Path]:
    """Build the FMUs of a folder that has one folder per FMU.

    Parameters
    ----------
    root : Path or str
        Folder with ``<name>/<name>.py``.
    names : iterable of str
        Which; all where empty.
    out : Path or str
        Folder for the FMUs.

    Returns
    -------
    list of Path
        The FMUs in the order of their names.

    Raises
    ------
    ShipcosimError
        With the problems of all of them; those without problems are built nevertheless.
    """
    # Problems of all FMUs together; the others are built in any case.
    root = Path(root)
    available = sorted(
        folder.name for folder in root.glob("*") if (folder / f"{folder.name}.py").is_file()
    )
    problems = [
        Problem(str(root), f"has no FMU '{name}'.", suggestion(name, available))
        for name in names
        if name not in available
    ]
    built = []
    stems = {}
    # Names must differ also where file systems ignore case.
    for name in sorted(set(names or available) & set(available)):
        other = stems.setdefault(name.lower(), name)
        if other != name:
            problems.append(
                Problem(
                    str(root / name),
                    f"has the file name of {other} where case does not count.",
                    "Rename one.",
                )
            )
            continue
        try:
            built.append(build_fmu(root / name, out))
        except ShipcosimError as error:
            problems += error.problems
    if problems:
        raise ShipcosimError(problems)
    return built


def _script(source: Path) -> Path:
    # A folder holds the script of its own name.
    script = source / f"{source.resolve().name}.py" if source.is_dir() else source
    if not script.is_file():
        raise error_at(
            str(source),
            f"there is no {script.name}.",
            "An FMU is a folder NAME with NAME.py in it.",
        )
    # The name becomes a Python module and the name of a binary.
    if not (script.stem.isidentifier() and script.stem.isascii()):
        raise error_at(
            str(script),
            "cannot name an FMU.",
            "Use letters, digits and '_'; no digit at the start.",
        )
    return script


@contextlib.contextmanager
def _imported(bundled: Bundle) -> Iterator[ModuleType]:
    """The script's module as the FMU will contain it; unloaded afterwards."""
    before = set(sys.modules)
    # Import from a copy: what the bundle lacks is then missing here too.
    with temporary_folder() as folder:
        for path, data in bundled.files.items():
            file = Path(folder, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(data)
        sys.path.insert(0, folder)
        importlib.invalidate_caches()
        try:
            yield _import(bundled, folder)
        finally:
            sys.path.remove(folder)
            # Unload the private package, so that the next FMU starts clean.
            for name in set(sys.modules) - before:
                if name.partition(".")[0] == bundled.package:
                    del sys.modules[name]


def _import(bundled: Bundle, folder: str) -> ModuleType:
    code = Path(folder, bundled.package)
    try:
        return importlib.import_module(f"{bundled.package}.{bundled.script}")
    except Exception as error:
        # Point at the FMU's own line, not at the importing machinery.
        frames = [
            frame
            for frame in traceback.extract_tb(error.__traceback__)
            if Path(frame.filename).is_relative_to(code)
        ]
        frames = [
            frame
            for frame in frames
            if not Path(frame.filename).is_relative_to(code / "shipcosim" / "fmi")
        ]
        where = (
            f"{Path(frames[-1].filename).relative_to(code)}, line {frames[-1].lineno}"
            if frames
            else bundled.script
        )
        raise error_at(
            where, f"{type(error).__name__}: {error}".replace(f"{bundled.package}.", "")
        ) from error


def _fmu_class(module: ModuleType, script: Path) -> type[Fmu]:
    """The only class of the script that is an FMU and no base class of another."""
    fmu_classes = [
        item
        for item in vars(module).values()
        if isinstance(item, type) and item.__module__ == module.__name__
    ]
    # Classes defined in the script, without those that others extend.
    fmu_classes = [
        cls for cls in fmu_classes if any(base.__name__ == "Fmi2Slave" for base in cls.__mro__)
    ]
    leaves = [
        cls
        for cls in fmu_classes
        if not any(cls is not other and issubclass(other, cls) for other in fmu_classes)
    ]
    if len(leaves) != 1:
        message = (
            f"has {len(leaves)} FMUs ({', '.join(cls.__name__ for cls in leaves)})."
            if leaves
            else "has no class that is an Fmu."
        )
        raise error_at(str(script), message, "One file holds one FMU: class Name(Fmu).")
    _check_class(leaves[0], script)
    return leaves[0]


def _check_class(cls: type[Fmu], script: Path) -> None:
    # An FMU needs an output and a step.
    problems = []
    if not any(variable.causality == "output" for variable in cls.variables):
        problems.append("has no output: name = Output(unit, description).")
    if not any(
        "step" in vars(base) for base in cls.__mro__ if base.__name__ not in ("Fmu", "Fmi2Slave")
    ):
        problems.append("has no step(self, t, h).")
    problems += _never_read(cls, script)
    if problems:
        raise ShipcosimError(
            [Problem(f"{script}, class {cls.__name__}", problem) for problem in problems]
        )
    # Try the start values once: a bad default is found here, not in the host.
    try:
        instance = cls()
        for group in cls.groups:
            if not any(variable.required for variable in group.variables):
                getattr(instance, group.name)
    except Exception as error:
        message = f"its start values are refused: {type(error).__name__}: {error}"
        raise error_at(f"{script}, class {cls.__name__}", message) from error


def _never_read(cls: type[Fmu], script: Path) -> list[str]:
    """Attributes that the script sets but neither declares nor reads: likely misspelt outputs."""
    # Uses of self.NAME in the script.
    nodes = [
        node for node in ast.walk(ast.parse(script.read_bytes())) if isinstance(node, ast.Attribute)
    ]
    nodes = [node for node in nodes if isinstance(node.value, ast.Name) and node.value.id == "self"]
    # Read anywhere, declared, or inherited.
    read = {node.attr for node in nodes if isinstance(node.ctx, ast.Load)} | set(dir(cls))
    read |= {variable.name for variable in cls.variables}
    outputs = [variable.name for variable in cls.variables if variable.causality == "output"]
    lines = {node.attr: node.lineno for node in reversed(nodes)}
    return [
        f"line {lines[name]} sets self.{name}, which is no output and read nowhere. {suggestion(name, outputs)}"
        for name in sorted(lines)
        if name not in read and not name.startswith("_")
    ]


def _description(cls: type[Fmu], script: Path, files: dict[str, bytes]) -> bytes:
    """The model description, with a GUID from its content and all other files."""
    try:
        # Hash the description without GUID and all files: a changed file gives a new GUID.
        blank = model_description(cls, script.stem, "")
        digest = hashlib.sha256(blank)
        for path, data in sorted(files.items()):
            digest.update(f"{path} {len(data)}\n".encode() + data)
        return model_description(cls, script.stem, f"{{{digest.hexdigest()[:32]}}}")
    except ValueError as error:
        raise error_at(f"{script}, class {cls.__name__}", str(error)) from None


def _binaries(identifier: str) -> dict[str, bytes]:
    """Our loader under FMI's name, with pythonfmu's binary, which it loads, and its licence."""
    folder = (
        Path(str(importlib.metadata.distribution("pythonfmu").locate_file("pythonfmu")))
        / "resources"
        / "binaries"
    )
    files = {}
    for platform, suffix in SUFFIXES.items():
        files[f"binaries/{platform}/{identifier}{suffix}"] = loader_for(platform).read_bytes()
        for path in (folder / platform).glob(f"*{suffix}"):
            files[f"binaries/{platform}/{path.name}"] = path.read_bytes()
    licence = importlib.metadata.distribution("pythonfmu").read_text("licenses/LICENSE")
    return files | {
        "documentation/licenses/pythonfmu.txt": (licence or "MIT, NTNU-IHB/PythonFMU").encode()
    }


def documentation(script: Path) -> dict[str, bytes]:
    """Documentation in the FMU: README.md, also as a page, and reference.csv."""
    files = {}
    for name in ("README.md", "reference.csv"):
        path = script.parent / name
        if path.is_file():
            files[f"documentation/{name}"] = path.read_bytes().replace(b"\r\n", b"\n")
    text = files.get("documentation/README.md", b"").decode(errors="replace")
    files["documentation/index.html"] = PAGE.format(
        title=script.stem, text=html.escape(text)
    ).encode()
    return files


def write_archive(path: Path, files: dict[str, bytes]) -> Path:
    """Write an archive whose bytes depend only on the files: sorted, uncompressed, fixed dates."""
    # Fixed order, date and mode: the same source gives the same bytes.
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_STORED) as archive:
        for name, data in sorted(files.items()):
            info = zipfile.ZipInfo(name, EPOCH)
            info.create_system = 3
            info.external_attr = 0o644 << 16
            archive.writestr(info, data)
    try:
        replace_file(path, content.getvalue())
    except OSError as error:
        raise error_at(str(path), f"cannot be written: {error.strerror}.") from None
    return path
