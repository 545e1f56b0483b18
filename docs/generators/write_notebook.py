"""Runs the cells of docs/notebook.ipynb and stores what they show, as Jupyter would; needs no Jupyter.

Run `python docs/generators/write_notebook.py` after a cell or a result looks different; it takes a minute. The cells
run in an empty folder, so that nothing in them depends on the repository.
"""

import ast
import contextlib
import io
import json
import os
import tempfile
from pathlib import Path

NOTEBOOK = Path(__file__).resolve().parents[1] / "notebook.ipynb"
SHOWN = {"text/html": "_repr_html_", "image/svg+xml": "_repr_svg_"}
RAISES = "raises-exception"  # Jupyter's tag of a cell that is to fail


def run_cell(source: str, scope: dict) -> tuple[object, str]:
    """Run a cell; the value of its last expression (None where it ends with something else) and what it printed."""
    tree, value, printed = ast.parse(source), None, io.StringIO()
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, "cell", "exec"), scope)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), scope)
    return value, printed.getvalue()


def outputs_of(cell: dict, number: int, scope: dict) -> list[dict]:
    """What a code cell shows, as the notebook's file holds it."""
    try:
        value, printed = run_cell("".join(cell["source"]), scope)
    except Exception as error:
        if RAISES not in cell["metadata"].get("tags", ()):
            raise
        trace = (
            error._render_traceback_() if hasattr(error, "_render_traceback_") else [repr(error)]
        )
        return [
            {
                "output_type": "error",
                "ename": type(error).__name__,
                "evalue": str(error),
                "traceback": trace,
            }
        ]
    shown = [{"output_type": "stream", "name": "stdout", "text": lines(printed)}] if printed else []
    if value is not None:
        data = {
            kind: lines(getattr(value, name)())
            for kind, name in SHOWN.items()
            if hasattr(value, name)
        }
        data["text/plain"] = lines(repr(value))
        shown.append(
            {
                "output_type": "execute_result",
                "execution_count": number,
                "metadata": {},
                "data": data,
            }
        )
    return shown


def lines(text: str) -> list[str]:
    """A text as a notebook's file holds it."""
    return text.splitlines(keepends=True)


def run_notebook(notebook: dict, cells: int | None = None) -> dict:
    """The notebook with the outputs of its first so many code cells made anew, all by default; in an empty folder."""
    scope, number, before = {"__name__": "__main__"}, 0, Path.cwd()
    made = json.loads(json.dumps(notebook))
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            for cell in [one for one in made["cells"] if one["cell_type"] == "code"][:cells]:
                number += 1
                cell |= {"execution_count": number, "outputs": outputs_of(cell, number, scope)}
        finally:
            os.chdir(before)
    return made


if __name__ == "__main__":
    found = run_notebook(json.loads(NOTEBOOK.read_text(encoding="utf-8")))
    NOTEBOOK.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
