"""The truth shares no code with the project."""

import ast
import subprocess
import sys
from pathlib import Path

import truth

HERE = Path(truth.__file__).parent


def test_no_file_of_the_truth_names_the_project_in_an_import():
    for file in HERE.glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not any(name.split(".")[0] == "shipcosim" for name in names), file.name


def test_importing_the_truth_loads_nothing_of_the_project():
    code = "import sys, truth; print([m for m in sys.modules if m.split('.')[0] == 'shipcosim'])"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=HERE.parent, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
