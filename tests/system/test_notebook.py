"""docs/notebook.ipynb: its cells run in an empty folder, and what is stored is what they show."""

import importlib.util
import json

import pytest

FIRST = 4
"""Code cells before the second run: the fast share."""


@pytest.fixture(scope="module")
def generator(root):
    specification = importlib.util.spec_from_file_location(
        "write_notebook", root / "docs/generators/write_notebook.py"
    )
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def stored(generator):
    return json.loads(generator.NOTEBOOK.read_text(encoding="utf-8"))


def code_cells(notebook):
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def said(cell):
    """What a cell prints, gives back and complains of, as plain text: the last digits of pictures may differ."""
    return [
        "".join(one.get("text", ""))
        + "".join(one.get("data", {}).get("text/plain", ""))
        + one.get("evalue", "")
        for one in cell["outputs"]
    ]


def test_the_notebook_is_small_whole_and_of_no_machine(generator, stored, root):
    text = generator.NOTEBOOK.read_text(encoding="utf-8")
    assert len(text) < 400_000 and not any(path in text for path in (str(root), "/tmp/", "/home/"))
    for number, cell in enumerate(code_cells(stored), start=1):
        assert cell["execution_count"] == number and all(
            isinstance(line, str) for line in cell["source"]
        )
    kinds = {
        kind
        for cell in code_cells(stored)
        for one in cell["outputs"]
        for kind in one.get("data", ())
    }
    assert kinds == {"text/plain", "text/html", "image/svg+xml"}


def test_the_first_cells_show_what_is_stored(generator, stored):
    made = generator.run_notebook(stored, FIRST)
    assert list(map(said, code_cells(made)[:FIRST])) == list(map(said, code_cells(stored)[:FIRST]))
