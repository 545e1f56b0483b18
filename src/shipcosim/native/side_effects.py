"""What a step may call while it is recorded: arithmetic. Anything else would happen once, and then never again."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from shipcosim.native.symbols import Untraceable

MODULES = {
    "builtins",
    "math",
    "numpy",
    "operator",
    "_operator",
    "itertools",
    "functools",
    "_functools",
    "collections",
}
MODULES |= {
    "_collections",
    "bisect",
    "_bisect",
    "typing",
    "dataclasses",
    "enum",
    "abc",
    "_abc",
    "shipcosim",
    "zlib",
}
FORBIDDEN = {"open", "print", "input", "exec", "eval", "compile", "__import__", "id", "globals"}
RANDOM = "numpy.random"


@contextmanager
def only_arithmetic(code: str) -> Iterator[None]:
    """Refuse calls of compiled functions that do more than compute.

    Parameters
    ----------
    code : str
        Top-level package of the component's own code, which may be called.

    Raises
    ------
    Untraceable
        Before such a function is called.
    """
    allowed = MODULES | {code}

    def watch(frame: Any, event: str, function: Any) -> None:
        if event != "c_call":
            return
        module = function.__module__ or type(getattr(function, "__self__", None)).__module__
        if module == "_contextvars":
            return  # how NumPy treats errors meanwhile
        if module == "_thread" and function.__name__ in (
            "__enter__",
            "__exit__",
            "acquire",
            "release",
        ):
            return  # the lock of a cached property
        is_own = frame.f_globals.get("__name__", "").startswith("shipcosim.native")
        if is_own or (
            module.partition(".")[0] in allowed
            and not module.startswith(RANDOM)
            and not (module == "builtins" and function.__name__ in FORBIDDEN)
        ):
            return
        raise Untraceable(f"it calls {module}.{function.__name__}, which is no arithmetic")

    before = sys.getprofile()
    sys.setprofile(watch)
    try:
        yield
    finally:
        sys.setprofile(before)


@contextmanager
def anything() -> Iterator[None]:
    """Let a function that stays in Python do what it likes."""
    before = sys.getprofile()
    sys.setprofile(None)
    try:
        yield
    finally:
        sys.setprofile(before)
