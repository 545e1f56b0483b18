"""The rooms of docs/dataflow.md: who may import whom, and who is the only door to which package."""

import ast

import pytest

MAY_IMPORT = {
    "errors": set(),
    "models": set(),
    "series": {"errors"},
    "fmi": {"models", "errors"},
    "ssp": {"series", "errors"},
    "scenario": {"series", "errors"},
    "cosim": {"series", "ssp", "scenario", "fmi", "errors"},
    "diagnose": {"errors", "models", "series", "ssp", "scenario", "cosim"},
    "report": {"errors", "models", "series", "fmi", "ssp", "scenario", "cosim", "diagnose"},
    "cli": {"errors", "models", "series", "fmi", "ssp", "scenario", "cosim", "report", "diagnose"},
}
ONLY_DOOR = {
    "pythonfmu": {"fmi"},
    "lxml": {"ssp"},
    "fmpy": {"cosim"},
    "libcosimpy": {"cosim"},
    "ecospy": {"cosim"},
    "torch": {"learn"},
    "pint": {"series"},
    "plotly": {"report"},
    "typer": {"cli"},
}


def running(node):
    """All nodes below one but those that are only there for type hints."""
    for child in ast.iter_child_nodes(node):
        if not (isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING"):
            yield child
            yield from running(child)


def imported(file, root):
    """Absolute names of all modules that a file imports, anywhere in it."""
    package = list(file.relative_to(root / "src").with_suffix("").parts)
    for node in running(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names if node.module == "shipcosim")
        elif isinstance(node, ast.ImportFrom):
            base = ".".join(package[: -node.level])
            yield from ([f"{base}.{node.module}"] if node.module else [f"{base}.{alias.name}" for alias in node.names])


def room(module):
    """Room of one of our modules, None for the package itself and for others' modules."""
    parts = module.split(".")
    return parts[1] if parts[0] == "shipcosim" and len(parts) > 1 else None


def sources(root):
    return sorted((root / "src" / "shipcosim").rglob("*.py"))


def test_every_module_stands_in_a_room_of_the_table(root):
    found = {file.relative_to(root / "src" / "shipcosim").parts[0].removesuffix(".py") for file in sources(root)}
    assert found - {"__init__", "__main__"} == set(MAY_IMPORT)


@pytest.mark.parametrize("name", MAY_IMPORT)
def test_room_imports_only_what_its_row_allows(name, root):
    files = [f for f in sources(root) if f.relative_to(root / "src" / "shipcosim").parts[0].removesuffix(".py") == name]
    assert files
    for file in files:
        ours = {room(module) for module in imported(file, root)} - {None, name, "__version__"}
        assert ours <= MAY_IMPORT[name], f"{file.relative_to(root)} may not import {ours - MAY_IMPORT[name]}"


def test_each_foreign_package_enters_through_one_door(root):
    for file in sources(root):
        here = file.relative_to(root / "src" / "shipcosim").parts[0].removesuffix(".py")
        for module in imported(file, root):
            door = ONLY_DOOR.get(module.split(".")[0], {here})
            assert here in door, f"{file.relative_to(root)} imports {module}, which only {door} may"


def test_fmus_import_the_shell_and_the_models_only(root):
    for file in (root / "fmus").rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = [node.module] if isinstance(node, ast.ImportFrom) else [a.name for a in getattr(node, "names", [])]
            if isinstance(node, ast.Import | ast.ImportFrom):
                assert all(room(name) in {"fmi", "models", None} for name in names), f"{file.name}: {names}"
