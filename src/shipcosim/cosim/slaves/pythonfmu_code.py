"""Code in FMUs of PythonFMU: modules of one name in several of them, and what their state holds.

PythonFMU imports from the resources of an FMU by plain names. Python keeps one module of a name, so that an FMU can
run the code of another one. FMUs of this package have names of their own.
"""

import ast
import zipfile
from collections import defaultdict
from functools import lru_cache
from pathlib import Path, PurePosixPath

from shipcosim.errors import Problem
from shipcosim.ssp import Component, System

CODE = (".py", ".pyc", ".so", ".pyd")
IMPORTING = {"__import__", "import_module", "exec", "eval", "runpy"}
"""Names in a source that can import anything at any time."""
LIBRARY = "pythonfmu"
"""Package that PythonFMU puts into each FMU. Its versions differ, and their FMUs run with each other's."""
REMEDY = "Run the system alone on our own engine, or give the modules names of their own."


def module_clashes(system: System, *, late_alone: bool = False) -> list[Problem]:
    """Problems of FMUs that bring different Python modules of one name.

    Parameters
    ----------
    system : System
        Whose FMUs are to run in one process.
    late_alone : bool
        Whether modules count only where an FMU may import them after its start. What it imports at its start is its
        own in our master, which then forgets the modules of the others.
    """
    # Contents of each module, and who brings them.
    brought = defaultdict(lambda: defaultdict(list))
    for component in system.components.values():
        path = component.fmu.path
        for name, content in _modules_of(path, path.stat().st_mtime_ns).items():
            brought[name][content].append(component)
    problems = []
    for name, by_content in brought.items():
        owners = [components[0] for components in by_content.values()]
        if len(owners) > 1 and not (late_alone and not any(map(_imports_late, owners))):
            listed = ", ".join(owner.name for owner in owners)
            message = f"each bring another Python module '{name}'; in one process one of them runs the other's code."
            problems.append(Problem(listed, message, REMEDY))
    return problems


def stores_registered_alone(fmu: Path) -> bool:
    """True for an FMU of PythonFMU whose state is that of its registered variables alone.

    That is PythonFMU's own way; attributes that are not registered keep their values. A class may have its own.
    """
    with zipfile.ZipFile(fmu) as archive:
        names = [name for name in archive.namelist() if name.startswith("resources/")]
        code = [n for n in names if n.endswith(".py") and n.split("/")[1] != LIBRARY]
        is_python = "resources/slavemodule.txt" in names
        return is_python and not any(b"def _get_fmu_state" in archive.read(n) for n in code)


@lru_cache(maxsize=256)
def _modules_of(fmu: Path, _changed: int) -> dict[str, frozenset]:
    """Files with check sums of each module that an FMU brings."""
    modules = defaultdict(set)
    with zipfile.ZipFile(fmu) as archive:
        if "resources/slavemodule.txt" in archive.namelist():
            for entry in archive.infolist():
                if (name := _module(entry.filename)) != LIBRARY:
                    modules[name].add((entry.filename, entry.CRC, entry.file_size))
    modules.pop("", None)
    return {name: frozenset(content) for name, content in modules.items()}


def _module(file: str) -> str:
    """Name of the module that a file of an FMU belongs to; empty for files without code."""
    place = PurePosixPath(file)
    is_code = place.parts[0] == "resources" and place.suffix in CODE
    return place.parts[1].partition(".")[0] if is_code else ""


def _imports_late(component: Component) -> bool:
    """True if the code of an FMU may import modules after its start."""
    with zipfile.ZipFile(component.fmu.path) as archive:
        files = [name for name in archive.namelist() if _module(name) not in ("", LIBRARY)]
        return any(_is_late(archive.read(name), PurePosixPath(name).suffix) for name in files)


def _is_late(source: bytes, suffix: str) -> bool:
    """True if code may import modules other than when it is imported itself."""
    if suffix != ".py":
        return True
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError):
        return True
    functions = [
        n for n in ast.walk(tree) if isinstance(n, (ast.FunctionDef, ast.AsyncFunctionDef))
    ]
    inner = [node for function in functions for node in ast.walk(function)]
    names = {getattr(node, "id", getattr(node, "attr", "")) for node in ast.walk(tree)}
    return bool(IMPORTING & names) or any(
        isinstance(n, (ast.Import, ast.ImportFrom)) for n in inner
    )
