"""Errors for unknown keywords of a call, in one sentence."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

from shipcosim.calls.arguments import path_or_name
from shipcosim.errors import Problem, error_at, raise_errors, suggestion
from shipcosim.options import RunKeywords

Function = TypeVar("Function", bound=Callable[..., Any])


def with_known_keywords(function: Function) -> Function:
    """A function that refuses arguments it does not have with a ShipcosimError, before it does anything.

    ``**options`` of a function are those of `shipcosim.options.RunKeywords`.

    Examples
    --------
    >>> @with_known_keywords
    ... def sail(*, speed=1.0): ...
    >>> sail(sped=2.0)
    Traceback (most recent call last):
    shipcosim.errors.ShipcosimError: sail(): There is no keyword 'sped'. There is: speed. Did you mean 'speed'?
    """
    signature = inspect.signature(function)
    parameters = signature.parameters.values()
    known = [
        one.name for one in parameters if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY)
    ]
    if any(one.kind is one.VAR_KEYWORD for one in parameters):
        known += RunKeywords.__annotations__

    @wraps(function)
    def call(*arguments, **keywords):
        where = f"{function.__name__}()"
        unknown = [
            Problem(where, f"There is no keyword '{k}'.", suggestion(k, known))
            for k in keywords
            if k not in known
        ]
        raise_errors(unknown)
        try:
            given = signature.bind(*arguments, **keywords).arguments
        except TypeError as error:
            text = str(error)
            remedy = f"Its form is {function.__name__}({', '.join(known)})."
            raise error_at(where, f"{text[:1].upper()}{text[1:]}.", remedy) from None
        if given.get("out") is not None:
            path_or_name("out", given["out"])
        return function(*arguments, **keywords)

    return cast(Function, call)
