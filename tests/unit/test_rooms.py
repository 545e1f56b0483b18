"""The rooms of docs/dataflow.md: who may import whom, no circle, and who is the only door to which package."""

import ast
from collections import defaultdict

import pytest

MAY_IMPORT = {
    "errors": set(),
    "units": set(),
    "angles": set(),
    "temporary": set(),
    "staging": {"errors", "temporary"},
    "models": {"angles"},
    "snapshot": {"errors", "series", "scenario", "ssp"},
    "options": {"errors", "snapshot"},
    "dialects": {"errors"},
    "series": {"dialects", "errors", "temporary", "units"},
    "fmi": {"models", "errors", "temporary", "units"},
    "interfaces": {"fmi", "models", "angles"},
    "library": {"fmi", "errors", "temporary"},
    "ssp": {"dialects", "library", "series", "errors", "temporary", "units"},
    "scenario": {"library", "series", "ssp", "errors", "units", "angles"},
    "learn": {"library", "angles", "models", "series", "ssp", "scenario", "cosim"},
    "native": {"library", "fmi", "errors", "temporary"},
    "cosim": {
        "temporary",
        "library",
        "series",
        "ssp",
        "scenario",
        "fmi",
        "errors",
        "options",
        "snapshot",
        "units",
        "native",
    },
    "diagnose": {
        "temporary",
        "library",
        "dialects",
        "errors",
        "angles",
        "options",
        "units",
        "models",
        "series",
        "ssp",
        "scenario",
        "cosim",
    },
    "keywords": {"errors", "options"},
    "ships": {"errors", "units", "models", "ssp"},
    "capability": {"library", "errors", "angles", "models", "ships", "ssp"},
    "sweep": {
        "temporary",
        "library",
        "errors",
        "options",
        "staging",
        "units",
        "models",
        "series",
        "ssp",
        "scenario",
        "cosim",
        "capability",
    },
    "checks": {
        "library",
        "errors",
        "series",
        "ssp",
        "ships",
        "scenario",
        "cosim",
        "diagnose",
        "sweep",
    },
    "report": {
        "errors",
        "angles",
        "options",
        "units",
        "models",
        "series",
        "fmi",
        "library",
        "ssp",
        "scenario",
        "cosim",
        "diagnose",
        "capability",
        "sweep",
    },
    "live": {"errors", "temporary", "options", "scenario", "ssp", "cosim"},
    "results": {
        "temporary",
        "errors",
        "keywords",
        "options",
        "staging",
        "series",
        "scenario",
        "ssp",
        "cosim",
        "diagnose",
        "capability",
        "report",
        "sweep",
    },
    "calls": {
        "temporary",
        "errors",
        "keywords",
        "options",
        "staging",
        "units",
        "library",
        "ssp",
        "scenario",
        "cosim",
        "diagnose",
        "capability",
        "sweep",
        "checks",
        "results",
        "ships",
    },
    "cli": {
        "temporary",
        "errors",
        "staging",
        "units",
        "models",
        "series",
        "fmi",
        "library",
        "ssp",
        "ships",
        "scenario",
        "cosim",
        "report",
        "diagnose",
        "capability",
        "learn",
        "native",
        "sweep",
        "results",
        "calls",
        "live",
    },
    "pytest_plugin": {"library", "errors", "checks", "scenario", "results", "calls", "cli"},
}
ONLY_DOOR = {
    "pythonfmu": {"fmi.export"},
    "lxml": {"ssp"},
    "fmpy": {"cosim.slaves", "cosim.export"},
    "libcosimpy": {"cosim.engines"},
    "ecospy": {"cosim.engines"},
    "torch": {"learn"},
    "pint": {"units"},
    "platformdirs": {"library"},
    "jinja2": {"report.theme"},
    "markupsafe": {"report.theme"},
    "matplotlib": {"report.notebook"},
    "typer": {"cli"},
    "pytest": {"pytest_plugin"},
    "scipy": {"diagnose.log.files.matlab", "sweep"},  # 143 MB: an extra
    "rosbags": {"diagnose.log.files.bags"},
    "SALib": {"sweep"},
    "optuna": {"sweep"},
    "distributed": {"sweep.workers"},
    "websockets": {"live.server"},
    "pyarrow": {"series", "sweep.storage"},
}


def name_of(file, root):
    """Dotted name of a module below the package: ``cosim.master.plan``; of a folder for its `__init__`."""
    parts = file.relative_to(root / "src" / "shipcosim").with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def sources(root):
    return sorted((root / "src" / "shipcosim").rglob("*.py"))


def imported(file):
    """Absolute names of all modules that a file imports, for type hints too, with the names taken from them."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file} imports relatively; write the full name"
            yield from ((node.module, alias.name) for alias in node.names)


@pytest.fixture(scope="module")
def modules(root):
    """Every module of ours by its name, with the modules of ours that it imports."""
    names = {name_of(file, root): file for file in sources(root)}
    needs = {}
    for name, file in names.items():
        needs[name] = set()
        for module, taken in imported(file):
            if module.split(".")[0] == "shipcosim":
                own, inner = (
                    module.removeprefix("shipcosim").lstrip("."),
                    f"{module}.{taken}".removeprefix("shipcosim."),
                )
                needs[name].add(inner if inner in names else own)
        needs[name] -= {name}
    return needs


def room_of(module):
    return module.split(".")[0]


def corner_of(module, modules):
    """The folder of a module within its room; a file that lies directly in a room stands for itself."""
    parts = module.split(".")
    is_folder = any(name.startswith(f"{module}.") for name in modules)
    return module if len(parts) < 2 or (is_folder and len(parts) == 2) else ".".join(parts[:2])


def circles(graph):
    """Groups of nodes that reach one another."""
    reached = {}
    for start in graph:
        waiting, seen = [start], set()
        while waiting:
            for node in graph.get(waiting.pop(), ()):
                if node not in seen:
                    seen.add(node)
                    waiting.append(node)
        reached[start] = seen
    return {
        frozenset(n for n in reached[node] if node in reached.get(n, ()))
        for node in graph
        if node in reached[node]
    }


def test_every_module_stands_in_a_room_of_the_table(modules):
    assert {room_of(module) for module in modules} - {"", "__main__"} == set(MAY_IMPORT)


@pytest.mark.parametrize("name", MAY_IMPORT)
def test_room_imports_only_what_its_row_allows(name, modules):
    for module, needs in modules.items():
        if room_of(module) == name:
            ours = {room_of(needed) for needed in needs} - {"", name}
            assert ours <= MAY_IMPORT[name], f"{module} may not import {ours - MAY_IMPORT[name]}"


def test_no_room_and_no_folder_of_a_room_imports_in_a_circle(modules):
    graph = defaultdict(set)
    for module, needs in modules.items():
        here = corner_of(module, modules)
        graph[here] |= {corner_of(needed, modules) for needed in needs} - {here, ""}
    assert not circles(dict(graph))


def test_no_module_imports_in_a_circle(modules):
    """The package itself names what it offers, which comes from its rooms: it is left out."""
    graph = {name: needs - {""} for name, needs in modules.items() if name}
    assert not circles(graph)


def test_each_foreign_package_enters_through_one_door(root):
    for file in sources(root):
        here = name_of(file, root)
        for module, _ in imported(file):
            doors = ONLY_DOOR.get(module.split(".")[0], {""})
            assert any(here.startswith(door) for door in doors), (
                f"{here} imports {module}, which only {doors} may"
            )


def test_no_import_hides_behind_a_call(root):
    """The builder imports the FMU that it packs, which is no module of ours."""
    for file in sources(root):
        calls = [
            node
            for node in ast.walk(ast.parse(file.read_text("utf-8")))
            if isinstance(node, ast.Call)
        ]
        hidden = [c for c in calls if ast.unparse(c.func).endswith(("import_module", "__import__"))]
        assert not hidden or name_of(file, root) == "fmi.export.builder", file.relative_to(root)


def test_fmus_import_the_shell_interfaces_the_models_and_angles_only(root):
    for file in (root / "fmus").rglob("*.py"):
        rooms = {
            module.split(".")[1]
            for module, _ in imported(file)
            if module.split(".")[0] == "shipcosim"
        }
        assert rooms <= {"fmi", "interfaces", "models", "angles"}, file.name


def test_the_page_states_the_same_table(root):
    page = (root / "docs" / "dataflow.md").read_text(encoding="utf-8")
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in page.splitlines()
        if line.startswith("| `")
    ]
    stated = {
        name.strip("` "): row[2] for row in rows if len(row) == 4 for name in row[0].split(", ")
    }
    assert set(stated) - {"fmus/*"} == set(MAY_IMPORT)
    for name, imports in MAY_IMPORT.items():
        if stated[name] != "all of these":
            assert {room for room in stated[name].split(", ") if room != "-"} == imports, name
