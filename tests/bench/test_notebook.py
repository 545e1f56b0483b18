"""At night: docs/notebook.ipynb: its cells run in an empty folder, and what is stored is what they show."""

import pytest
from test_notebook import code_cells, generator, said, stored


def test_all_cells_show_what_is_stored(generator, stored):
    made = generator.run_notebook(stored)
    assert list(map(said, code_cells(made))) == list(map(said, code_cells(stored)))
    assert [set(o.get("data", ())) for c in code_cells(made) for o in c["outputs"]] == [
        set(o.get("data", ())) for c in code_cells(stored) for o in c["outputs"]
    ]
