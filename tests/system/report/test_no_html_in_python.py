"""HTML lives in templates: no string of the pages' Python holds a tag."""

import ast
import re

import pytest

TAG = re.compile(r"</?[a-zA-Z][^<>]*>|&(?:[a-z]+|#\d+);")


def documentation(tree):
    """Docstrings, which may name whatever they like."""
    bodies = [
        node.body
        for node in ast.walk(tree)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
    ]
    first = [body[0] for body in bodies if body and isinstance(body[0], ast.Expr)]
    return {id(statement.value) for statement in first}


def strings_with_tags(source):
    """Lines of those strings, parts of f-strings among them, that hold a tag or an entity of HTML."""
    tree = ast.parse(source)
    said = documentation(tree)
    texts = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    ]
    return [node.lineno for node in texts if id(node) not in said and TAG.search(node.value)]


def test_strings_of_the_report_hold_no_html(root):
    found = {}
    for file in sorted((root / "src" / "shipcosim" / "report").rglob("*.py")):
        if lines := strings_with_tags(file.read_text(encoding="utf-8")):
            found[str(file.relative_to(root))] = lines
    assert not found


@pytest.mark.parametrize(
    "text", ["'<p>'", "f'<b>{x}</b>'", "'a<br>b'", "'&lt;'", "f'<td class={x}>' + '</td>'"]
)
def test_tag_in_a_string_is_found(text):
    assert strings_with_tags(f"x = {text}")


@pytest.mark.parametrize(
    "text", ["'a < b'", "'x<0 and y>0'", "'%{y:.3~g}'", "def f():\n    '''Makes <p>.'''"]
)
def test_what_is_no_tag_is_let_be(text):
    assert not strings_with_tags(text)
