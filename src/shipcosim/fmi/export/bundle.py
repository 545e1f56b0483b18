"""Python code inside an FMU, under names that no other FMU and no package uses."""

import ast
import hashlib
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from shipcosim.errors import Problem, ShipcosimError, error_at

Import = ast.Import | ast.ImportFrom
SHIPCOSIM = Path(__file__).resolve().parents[2]
ROOT = b'"""What this FMU needs of shipcosim."""\n'
CARRIED_BY_HOST = {"numpy"} | set(sys.stdlib_module_names)
WEIGHTS = "weights"
"""Folder beside a script; its trained weights (.npz) and calibrations (.toml) are packed into the FMU."""


@dataclass
class Module:
    """One Python module that is packed into the FMU."""

    name: str
    path: Path
    source: bytes
    tree: ast.Module
    imports: list[Import] = field(default_factory=list)

    @property
    def is_package(self) -> bool:
        return self.path.name == "__init__.py"

    @property
    def archive_path(self) -> str:
        """Path below the private package."""
        path = self.name.replace(".", "/")
        return f"{path}/__init__.py" if self.is_package else f"{path}.py"


@dataclass(frozen=True)
class Bundle:
    """Files for `resources`, and how to get at the FMU's script in them."""

    entry: str
    package: str
    script: str
    files: dict[str, bytes]


def bundle(script: Path) -> Bundle:
    """Collect and rename what a script needs.

    Parameters
    ----------
    script : Path
        The FMU's Python file. Modules beside it and modules of shipcosim that it imports, directly or not, come along,
        and so do trained weights in the folder `WEIGHTS` beside it.

    Returns
    -------
    Bundle
        Without the entry module, which needs the name of the class, see `entry_module`.

    Raises
    ------
    ShipcosimError
        A file cannot be read or parsed, or imports what neither Python, NumPy nor the FMU has.
    """
    # All modules that the script needs, and its trained weights.
    modules = _collect(script)
    kept = script.parent / WEIGHTS
    files = sorted(file for kind in ("npz", "toml") for file in kept.glob(f"*.{kind}"))
    weights = {f"{WEIGHTS}/{file.name}": file.read_bytes() for file in files}
    # The hash in the package name keeps versions of an FMU apart in one process.
    digest = hashlib.sha256()
    contents = {module.archive_path: module.source for module in modules.values()} | weights
    for path, content in contents.items():
        digest.update(f"{path} {len(content)}\n".encode() + content)
    entry = f"{script.stem}_{digest.hexdigest()[:16]}"
    package = f"{entry}_code"
    # Rename imports to the private package.
    files = {f"{package}/__init__.py": PACKAGE.format(script=script.name).encode()}
    for module in modules.values():
        files[f"{package}/{module.archive_path}"] = _renamed(module, package, modules)
    files |= {f"{package}/{path}": content for path, content in weights.items()}
    return Bundle(entry, package, script.stem, files)


PACKAGE = '''"""{script} and what it needs, under a name that changes with the content."""

import linecache
from pathlib import Path

# tracebacks show their source lines even after the host has deleted the unpacked archive
for path in map(str, Path(__file__).parent.rglob("*.py")):
    text = Path(path).read_text("utf-8")
    linecache.cache[path] = len(text), None, text.splitlines(True), path
'''

ENTRY = '''"""Where the binary enters: it runs this file for every instance, and once more when it is imported."""

import sys
from contextlib import suppress
from os.path import isfile, join

try:
    import {modules}
    from {package}.shipcosim.fmi.pythonfmu_memory import keep
    from {package}.{script} import {cls}

    keep(globals())
finally:
    # the binary has put this folder on the host's path, and does so in other threads meanwhile
    for path in list(sys.path):
        if path and isinstance(path, str) and isfile(join(path, "{entry}.py")):
            with suppress(ValueError):
                sys.path.remove(path)
'''


def entry_module(bundled: Bundle, cls: str) -> bytes:
    """Source of the module that the binary imports; it holds only the class."""
    code = [path for path in sorted(bundled.files) if path.endswith(".py")]
    paths = (path.removesuffix(".py").removesuffix("/__init__") for path in code)
    modules = ", ".join(path.replace("/", ".") for path in paths)
    text = ENTRY.format(
        package=bundled.package,
        script=bundled.script,
        entry=bundled.entry,
        modules=modules,
        cls=cls,
    )
    return text.encode()


def _collect(script: Path) -> dict[str, Module]:
    """All modules that the script imports, directly or indirectly, sorted by name."""
    # Follow imports until no new module turns up.
    modules = {}
    waiting = [(script.stem, script)]
    problems = []
    while waiting:
        name, path = waiting.pop()
        if name in modules:
            continue
        try:
            modules[name] = module = _read(name, path)
        except ShipcosimError as error:
            problems += error.problems
            continue
        # Imports of ours are carried along; others must exist in every host.
        for statement, needed, always in _imports(module):
            located = _locate(needed, script.parent)
            if located:
                module.imports.append(statement)
                waiting += located
            elif always and needed.partition(".")[0] not in CARRIED_BY_HOST:
                where = f"{path}, line {statement.lineno}"
                problems.append(
                    Problem(
                        where,
                        f"imports {needed}.",
                        "An FMU has Python, NumPy, shipcosim.models and files beside it.",
                    )
                )
    if problems:
        raise ShipcosimError(problems)
    return dict(sorted(modules.items()))


def _read(name: str, path: Path) -> Module:
    if name == "shipcosim":  # its own `__init__` would lead to the whole package
        return Module(name, path, ROOT, ast.parse(ROOT))
    try:
        # The same bytes on every platform: no byte order mark, line ends of Unix.
        source = path.read_bytes().removeprefix(b"\xef\xbb\xbf").replace(b"\r\n", b"\n")
        return Module(name, path, source, ast.parse(source, str(path)))
    except OSError as error:
        raise error_at(str(path), f"cannot be read: {error.strerror}.") from None
    except (SyntaxError, ValueError) as error:
        line = getattr(error, "lineno", None)
        raise error_at(
            f"{path}, line {line}" if line else str(path), f"is not Python: {error}."
        ) from None


def _locate(name: str, folder: Path) -> list[tuple[str, Path]]:
    """Modules for a dotted name, its packages included; empty if it is not ours.

    For "shipcosim.models.core.maths" these are three; a name inside a module is left out.
    """
    # Packages from the outside in, as Python imports them.
    parts = name.split(".")
    modules = []
    base = SHIPCOSIM.parent if parts[0] == "shipcosim" else folder
    for length in range(1, len(parts) + 1):
        stem = base.joinpath(*parts[:length])
        path = next(
            (p for p in (stem / "__init__.py", stem.with_name(f"{stem.name}.py")) if p.is_file()),
            None,
        )
        if path is None:
            break
        modules.append((".".join(parts[:length]), path))
    return modules


def _imports(module: Module) -> Iterator[tuple[Import, str, bool]]:
    """(statement, dotted name, True if it runs on import) for each import in a module."""
    for node, always in _running(module.tree, True):
        if isinstance(node, ast.Import):
            yield from ((node, alias.name, always) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = _absolute(node, module)
            yield from ((node, f"{base}.{alias.name}", always) for alias in node.names)


def _absolute(node: ast.ImportFrom, module: Module) -> str:
    """Full name that a "from ... import" refers to."""
    if not node.level:
        # Relative imports count from the package of the module.
        return node.module or ""
    package = module.name.split(".")
    package = package[: len(package) - node.level + module.is_package]
    return ".".join([*package, node.module] if node.module else package)


def _running(node: ast.AST, always: bool) -> Iterator[tuple[ast.AST, bool]]:
    """All nodes below one, and whether they run on import; code that never runs is left out."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and ast.unparse(child.test).startswith(
            ("__name__ ==", "TYPE_CHECKING", "typing.TYPE_")
        ):
            continue
        yield child, always
        optional = isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.Try))
        yield from _running(child, always and not optional)


def _renamed(module: Module, package: str, modules: Mapping[str, Module]) -> bytes:
    """Source with absolute imports of bundled modules redirected into the package; lines stay."""
    lines = module.source.splitlines(keepends=True)
    statements = {(node.lineno, node.col_offset): node for node in module.imports}
    # From the end, so that positions of earlier statements stay valid.
    for _, node in sorted(statements.items(), reverse=True):
        if isinstance(node, ast.ImportFrom) and node.level:
            continue
        first = node.lineno - 1
        last = (node.end_lineno or node.lineno) - 1
        before = lines[first][: node.col_offset]
        after = lines[last][node.end_col_offset :]
        old = b"".join([*lines[first:last], lines[last][: node.end_col_offset]])[
            node.col_offset :
        ].decode()
        # The number of lines must not change: tracebacks then show the right line.
        new = (
            re.sub(r"^(from[\s\\]+)", rf"\g<1>{package}.", old)
            if isinstance(node, ast.ImportFrom)
            else _renamed_import(node, package, modules)
        )
        lines[first : last + 1] = [before + new.encode() + after]
    return b"".join(lines)


def _renamed_import(node: ast.Import, package: str, modules: Mapping[str, Module]) -> str:
    # Keep names that the code uses, whatever the import is called inside.
    names = []
    for alias in node.names:
        root = alias.name.partition(".")[0]
        if root not in modules:
            names.append(ast.unparse(alias))
        elif alias.asname:
            names.append(f"{package}.{alias.name} as {alias.asname}")
        else:
            names += [f"{package}.{alias.name}"] * (root != alias.name) + [
                f"{package}.{root} as {root}"
            ]
    return f"import {', '.join(names)}" + " \\\n" * ((node.end_lineno or node.lineno) - node.lineno)
