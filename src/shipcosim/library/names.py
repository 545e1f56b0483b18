"""Names and what they stand for: each kind has its place in a project, and a line that says what a thing is."""

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from shipcosim.errors import AnyPath
from shipcosim.library.places import roots, shipped

SYSTEM_STRUCTURE = "SystemStructure.ssd"
KINDS = ("scenario", "study", "system", "ship", "fmu", "example")
FOLDERS_OF = {"scenario": "scenarios", "study": "studies"}  # of kinds that are .toml files


class Entry(NamedTuple):
    """A thing that has a name.

    Parameters
    ----------
    name : str
        By which every command finds it.
    line : str
        What it is.
    path : Path
        The file or folder. Of an FMU that of its source.
    """

    name: str
    line: str
    path: Path


def names(kind: str, near: AnyPath | None = None) -> dict[str, Path]:
    """Names of a kind with their paths: those of the project around, then those that the package ships.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    near : path, optional
        In the project; the working folder without.
    """
    paths: dict[str, Path] = {}
    for root in roots(near):
        for name, path in in_root(kind, root):
            paths.setdefault(name, path)
    return paths


def named(kind: str, name: str, near: AnyPath | None = None) -> Path | None:
    """Path of the thing with a name, or None; arguments as for `names`."""
    return names(kind, near).get(name)


def entries(kind: str, near: AnyPath | None = None) -> list[Entry]:
    """Everything of a kind, with a line on each; arguments as for `names`."""
    return [Entry(name, line_of(kind, path), path) for name, path in names(kind, near).items()]


def line_of(kind: str, path: Path) -> str:
    """Description of a thing from its own file, or a note that the file cannot be read."""
    try:
        return {
            "scenario": _description_in_toml,
            "study": _description_in_toml,
            "system": _description_in_ssd,
            "ship": _description_in_toml,
            "fmu": _description_in_python,
            "example": _description_of_example,
        }[kind](path)
    except (
        OSError,
        ValueError,
        SyntaxError,
        RecursionError,
    ):  # TOMLDecodeError and ParseError are among these
        return "(its file cannot be read)"


def fmu_sources(project: Path) -> dict[str, Path]:
    """Folders of FMUs by name, in the order of their names."""
    return {
        f.name: f for f in sorted((project / "fmus").glob("*")) if (f / f"{f.name}.py").is_file()
    }


def in_root(kind: str, root: Path) -> Iterator[tuple[str, Path]]:
    """Names of a kind in a project or in what is shipped, in their order."""
    if kind in FOLDERS_OF:
        folder = root / FOLDERS_OF[kind]
        yield from (
            (f.relative_to(folder).with_suffix("").as_posix(), f)
            for f in sorted(folder.rglob("*.toml"))
        )
    elif kind == "system":
        yield from (
            (f.parent.name, f.parent) for f in sorted(root.glob(f"ssp/*/{SYSTEM_STRUCTURE}"))
        )
        yield from ((f.stem, f) for f in sorted([*root.glob("ssp/*.ssp"), *root.glob("ssp/*.ssd")]))
    elif kind == "ship":
        for folder in (root / "ships", root / "ssp" / "ships"):
            yield from ((f.parent.name, f.parent) for f in sorted(folder.glob("*/ship.toml")))
        yield from ((f.stem, f) for f in sorted(root.glob("ships/*.toml")))
    elif kind == "fmu":
        yield from fmu_sources(root).items()
    elif root == shipped():
        files = (
            f for f in sorted(root.glob("docs/examples/*")) if f.name.endswith((".csv", ".csv.gz"))
        )
        yield from ((f.name.partition(".")[0], f) for f in files)


def _description_in_toml(path: Path) -> str:
    text = (path / "ship.toml" if path.is_dir() else path).read_text(encoding="utf-8-sig")
    return str(tomllib.loads(text).get("description", ""))


def _description_in_ssd(path: Path) -> str:
    """Description of the structure or of its system; what comes after its first element is not read."""
    if path.suffix == ".ssp":
        return "a packed system"
    from xml.etree import ElementTree

    ssd = path / SYSTEM_STRUCTURE if path.is_dir() else path
    try:
        for _, element in ElementTree.iterparse(ssd, events=("start",)):
            if element.get("description") or element.tag.endswith("}Elements"):
                return element.get("description", "")
    except ElementTree.ParseError:
        raise ValueError("no XML") from None
    return ""


def _description_in_python(path: Path) -> str:
    """First line on the FMU's class, else on the file."""
    tree = ast.parse((path / f"{path.name}.py").read_bytes())
    classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
    fmus = [
        node for node in classes if any(ast.unparse(base).endswith("Fmu") for base in node.bases)
    ]
    text = next(filter(None, map(ast.get_docstring, (*fmus, tree))), "")
    return text.partition("\n")[0]


def _description_of_example(path: Path) -> str:
    index = tomllib.loads((path.parent / "examples.toml").read_text(encoding="utf-8"))
    return str(index.get(path.name.partition(".")[0], ""))
