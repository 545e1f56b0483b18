"""Every public function of the models says shapes, units, errors and source; every record the unit of each field.

Numpydoc sections: Parameters with each argument and, for numbers, its unit in brackets; Returns with the unit; Raises
where the function, or a private function that it calls, can raise; References with the source, or with the reason why
there is none ("Definition ...", "Assumed ...", "As `other function`"), in the function or for a whole module in its
first lines. "Parameters and returns as `name`." refers to another function of the module.
"""

import ast
import dataclasses
import importlib
import inspect
import pkgutil
import re
import typing
from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest

import shipcosim.angles
import shipcosim.models

UNIT = re.compile(r"\[[^\]]+\]")
SAME = re.compile(r"Parameters and returns as `(\w+)`")
WITHOUT_UNIT = (str, bool, type(None), Callable, ModuleType, np.random.Generator)


def modules():
    found = pkgutil.walk_packages(shipcosim.models.__path__, "shipcosim.models.")
    return [shipcosim.angles, *(importlib.import_module(module.name) for module in found)]


def own(module, kind):
    """Public members that a module itself defines; what is cached is a function too."""
    for name, member in vars(module).items():
        member = inspect.unwrap(member) if callable(member) else member
        if kind(member) and not name.startswith("_") and member.__module__ == module.__name__:
            yield member


FUNCTIONS = [function for module in modules() for function in own(module, inspect.isfunction)]


def name_of(item):
    return f"{item.__module__.removeprefix('shipcosim.')}.{item.__name__}"


def is_parameter_set(record):
    """Whether the fields of a dataclass have unit and description of their own, see `core.parameters`."""
    return all("unit" in field.metadata for field in dataclasses.fields(record))


def records():
    for module in modules():
        for record in own(module, inspect.isclass):
            if hasattr(record, "_fields") or (
                dataclasses.is_dataclass(record) and not is_parameter_set(record)
            ):
                yield record


def section(docstring, title):
    """Text of a section of a docstring; empty where there is none."""
    found = re.search(rf"^{title}\n-+\n(.*?)(?=^\w[^\n]*\n-+\n|\Z)", docstring, re.M | re.S)
    return found[1] if found else ""


def entries(text):
    """Descriptions of a section by name: ``u, v : float`` counts for both."""
    found = {}
    for head, about in re.findall(r"^(\S[^\n]*)\n((?:[ \n][^\n]*\n?)*)", text, re.M):
        names, _, kind = head.partition(" : ")
        found |= {name.strip(" *"): (kind, about) for name in names.split(",")}
    return found


def is_number(annotation):
    """Whether values of a type have a unit: numbers and their sequences, but no text and no record of ours."""
    if inner := [one for one in typing.get_args(annotation) if one is not Ellipsis]:
        return typing.get_origin(annotation) is not Callable and any(map(is_number, inner))
    return annotation not in WITHOUT_UNIT and not getattr(annotation, "__module__", "").startswith(
        "shipcosim"
    )


def described(function):
    """The docstring that holds for a function: its own, or that of the one to which it refers."""
    docstring = inspect.getdoc(function) or ""
    same = SAME.search(docstring)
    return inspect.getdoc(getattr(inspect.getmodule(function), same[1])) if same else docstring


def raises(function, seen=()):
    """Whether a function, or a private function of its module that it calls, has a raise statement."""
    tree = ast.parse(inspect.cleandoc("\n" + inspect.getsource(function)))
    if any(isinstance(node, ast.Raise) for node in ast.walk(tree)):
        return True
    called = {
        node.func.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    inner = [vars(inspect.getmodule(function)).get(name) for name in called - set(seen)]
    inner = [inspect.unwrap(one) for one in inner if callable(one)]
    inner = [
        one for one in inner if inspect.isfunction(one) and one.__module__ == function.__module__
    ]
    return any(raises(one, (*seen, *called)) for one in inner)


@pytest.mark.parametrize("function", FUNCTIONS, ids=name_of)
def test_arguments_and_result_have_types(function):
    signature = inspect.signature(function)
    missing = [
        name
        for name, parameter in signature.parameters.items()
        if parameter.annotation is parameter.empty
    ]
    assert not missing and signature.return_annotation is not signature.empty


@pytest.mark.parametrize("function", FUNCTIONS, ids=name_of)
def test_every_argument_is_described_and_numbers_have_units(function):
    found, signature = (
        entries(section(described(function), "Parameters")),
        inspect.signature(function),
    )
    if SAME.search(inspect.getdoc(function)):
        assert len(found) == len(signature.parameters)
        return
    assert set(found) == set(signature.parameters)
    for name, parameter in signature.parameters.items():
        assert not is_number(parameter.annotation) or UNIT.search(found[name][1]), name


@pytest.mark.parametrize("function", FUNCTIONS, ids=name_of)
def test_results_have_units(function):
    text, kind = (
        section(described(function), "Returns"),
        inspect.signature(function).return_annotation,
    )
    assert text and (not is_number(kind) or UNIT.search(text))


@pytest.mark.parametrize("function", FUNCTIONS, ids=name_of)
def test_errors_are_described(function):
    assert not raises(function) or section(inspect.getdoc(function), "Raises")


@pytest.mark.parametrize("function", FUNCTIONS, ids=name_of)
def test_sources_are_given(function):
    docstrings = inspect.getdoc(function), inspect.getdoc(inspect.getmodule(function))
    assert any(section(text or "", "References") for text in docstrings)


@pytest.mark.parametrize("record", list(records()), ids=name_of)
def test_fields_of_records_have_units(record):
    docstring = inspect.getdoc(record)
    found = entries(section(docstring, "Parameters"))
    kinds = record.__annotations__
    assert set(found) >= set(kinds)
    assert not [
        name for name, kind in kinds.items() if is_number(kind) and not UNIT.search(found[name][1])
    ]
