"""Errors for the arguments of a call, in one sentence: unknown keywords, values of another type."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterable
from functools import wraps
from numbers import Integral, Real
from typing import Any, TypeVar, cast

from shipcosim.errors import Problem, capitalised, error_at, raise_errors, suggestion
from shipcosim.options import RunKeywords

Function = TypeVar("Function", bound=Callable[..., Any])

KINDS: dict[str, tuple[Any, str]] = {
    "AnyPath": ((str, os.PathLike), "a path or name"),
    "str": (str, "a text"),
    "PathLike": (os.PathLike, "a path"),
    "Path": (os.PathLike, "a path"),
    "bool": (bool, "True or False"),
    "float": (Real, "a number"),
    "int": (Integral, "a whole number from 0 on"),
    "Iterable": (Iterable, "a list"),
    "Sequence": (Iterable, "a list"),
    "Callable": (Callable, "a function"),
    "CountProgress": (Callable, "a function"),
    "Progress": (Callable, "a function"),
    "Scenario": ((), "a Scenario"),
    "Run": ((), "a Run"),
    "Dataset": ((), "a Dataset, as of shipcosim.read_table(FILE)"),
    "DataFrame": ((), "a DataFrame"),
    "Snapshot": ((), "a Snapshot"),
    "Reference": ((), "a Reference"),
    "None": ((), ""),
}
"""What values of an annotation are, and words for it. Whatever has another part is checked by the function itself."""

MEANT = {"AnyScenario": "AnyPath | Scenario", "Sequence[AnyPath]": "AnyPath | Sequence"}
"""What an alias stands for, and that a single path is as good as a list of it."""

TIME = {"float", "str"}
"""Parts of a time: its function says in which unit it is wanted."""


def with_known_keywords(function: Function) -> Function:
    """A function that refuses arguments it does not have, or of another type, before it does anything.

    It raises ShipcosimError. None is as good as left out wherever there is a default. ``**options`` of a function are
    those of `shipcosim.options.RunKeywords`.

    Examples
    --------
    >>> @with_known_keywords
    ... def sail(*, speed: float = 1.0): ...
    >>> sail(sped=2.0)
    Traceback (most recent call last):
    shipcosim.errors.ShipcosimError: sail(): There is no keyword 'sped'. There is: speed. Did you mean 'speed'?
    >>> sail(speed="fast")
    Traceback (most recent call last):
    shipcosim.errors.ShipcosimError: sail(): speed = 'fast'. Give a number.
    """
    signature = inspect.signature(function)
    parameters = signature.parameters
    accepted = {
        parameter.name: parameter.annotation
        for parameter in parameters.values()
        if parameter.kind in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY)
        and parameter.name != "self"
    }
    required = {name for name in accepted if parameters[name].default is inspect.Parameter.empty}
    options = next((p.name for p in parameters.values() if p.kind is p.VAR_KEYWORD), "")
    if options:
        accepted |= {
            name: kind.__forward_arg__ for name, kind in RunKeywords.__annotations__.items()
        }
    where = f"{function.__qualname__}()"

    @wraps(function)
    def call(*arguments, **keywords):
        unknown = [
            Problem(where, f"There is no keyword '{k}'.", suggestion(k, accepted))
            for k in keywords
            if k not in accepted
        ]
        raise_errors(unknown)
        try:
            bound = signature.bind(*arguments, **keywords).arguments
        except TypeError as error:
            remedy = f"Its form is {function.__qualname__}({', '.join(accepted)})."
            raise error_at(where, f"{capitalised(str(error))}.", remedy) from None
        # Options stand in a mapping of their own. None is as good as left out where there is a default.
        given = {**bound.pop(options, {}), **bound}
        given = {name: v for name, v in given.items() if v is not None or name in required}
        wrong = []
        for name, value in given.items():
            # Modules without postponed annotations have classes in place of their names.
            annotation = getattr(accepted.get(name), "__name__", str(accepted.get(name)))
            if wanted := _other_kind(annotation, value):
                wrong.append(Problem(where, f"{name} = {value!r:.60}.", f"Give {wanted}."))
        raise_errors(wrong)
        return function(**given)

    return cast(Function, call)


def _other_kind(annotation: str, value: Any) -> str:
    """Words for what an annotation wants where a value is something else; empty if it fits."""
    for alias, meant in MEANT.items():
        annotation = annotation.replace(alias, meant)
    kinds = [part.partition("[")[0].rpartition(".")[2] for part in annotation.split(" | ")]
    # Classes are known by their names: importing xarray takes longer than most calls. A Run or Log is like its table.
    names = {base.__name__.replace("LikeTable", "Dataset") for base in type(value).__mro__}
    is_none = "NoneType" in names and "None" in kinds
    if not set(kinds) <= set(KINDS) or set(kinds) >= TIME or is_none:
        return ""
    for kind in () if "bytes" in names else kinds:
        # An empty path is the folder one is in to Python.
        is_empty = (kind, value) == ("AnyPath", "")
        fits = kind in names or (isinstance(value, KINDS[kind][0]) and not is_empty)
        # True is a number to Python; counts are not negative.
        if fits and (kind == "bool" or "bool" not in names) and (kind != "int" or value >= 0):
            return ""
    return " or ".join(dict.fromkeys(filter(None, (KINDS[kind][1] for kind in kinds))))
