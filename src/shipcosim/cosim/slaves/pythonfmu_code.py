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
from shipcosim.ssp import System

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
    late = set()
    for component in system.components.values():
        path = component.fmu.path
        modules, is_late = _modules_of(path, path.stat().st_mtime_ns)
        for name, content in modules.items():
            brought[name][content].append(component.name)
            if is_late:
                late.add(name)
    problems = []
    for name, by_content in brought.items():
        if len(by_content) > 1 and (name in late or not late_alone):
            owners = ", ".join(owners[0] for owners in by_content.values())
            found = f"each bring another Python module '{name}'; in one process one of them runs the other's code."
            problems.append(Problem(owners, found, REMEDY))
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
def _modules_of(fmu: Path, _changed: int) -> tuple[dict[str, frozenset], bool]:
    """Files with check sums of each module that an FMU brings, and whether it may import while it runs."""
    modules = defaultdict(set)
    is_late = False
    with zipfile.ZipFile(fmu) as archive:
        if "resources/slavemodule.txt" not in archive.namelist():
            return {}, False
        for entry in archive.infolist():
            place = PurePosixPath(entry.filename)
            if place.parts[0] == "resources" and place.suffix in CODE:
                name = place.parts[1].partition(".")[0]
                if name == LIBRARY:
                    continue
                modules[name].add((entry.filename, entry.CRC, entry.file_size))
                is_late = is_late or _imports_late(archive.read(entry), place.suffix)
    return {name: frozenset(content) for name, content in modules.items()}, is_late


def _imports_late(source: bytes, suffix: str) -> bool:
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
