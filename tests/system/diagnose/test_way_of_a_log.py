"""How many files a reader opens who follows a log to its verdict, and how often she comes back to one.

She reads `find_causes` and each function that it calls, in the order of the text; for a function of another file she
opens that, reads it with the functions of the same file that it calls, and comes back. Each function is read once.
Counted are the files, that of the pipeline among them, and the times that she comes back to a file that she has left.
Classes, which hold data, are not counted.
"""

import ast

import pytest

START = "shipcosim.diagnose.pipeline", "find_causes"
# Four doors more than at first: runs as logs, references, what is grossly wrong, the form of the loads.
MOST_FILES, MOST_RETURNS = 16, 21


@pytest.fixture(scope="module")
def module_of(root):
    """Function from a module's name to its functions, and where the names come from that it imports of ours."""

    def read(name):
        tree = ast.parse((root / "src" / f"{name.replace('.', '/')}.py").read_text("utf-8"))
        imports = [n for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)]
        ours = [n for n in imports if n.module.startswith("shipcosim.diagnose.")]
        functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
        return functions, {alias.name: node.module for node in ours for alias in node.names}

    return read


def called(function):
    """Names of the functions that one calls, in the order in which the calls end in the text."""
    calls = [
        n for n in ast.walk(function) if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)
    ]
    return [
        call.func.id
        for call in sorted(calls, key=lambda call: (call.end_lineno, call.end_col_offset))
    ]


def way(module_of, depth=1):
    """Modules in the order in which they are opened and come back to, files `depth` calls away at most."""
    trail, read = [], set()

    def follow(module, name, level):
        if (module, name) in read:
            return
        read.add((module, name))
        functions, imports = module_of(module)
        for other in called(functions[name]):
            trail.append(module)
            if other in functions:
                follow(module, other, level)
            elif other in imports and level < depth and other in module_of(imports[other])[0]:
                follow(imports[other], other, level + 1)
        trail.append(module)

    follow(*START, 0)
    return [
        module for module, before in zip(trail, [None, *trail], strict=False) if module != before
    ]


def test_a_log_reaches_its_verdict_through_few_files_with_few_returns(module_of):
    opened = way(module_of)
    files = set(opened)
    assert len(files) <= MOST_FILES, sorted(files)
    assert len(opened) - len(files) <= MOST_RETURNS, opened
