"""Calls that a step may make while it is recorded: arithmetic only.

Other calls are refused: they would run at recording time only.
"""

import gc
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
READS = {"sys.audit", "posix.fspath", "nt.fspath"}
"""What Python calls first where a file or a folder is read."""
RANDOM = "numpy.random"
OWN = "shipcosim.native"
"""Package that records."""


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
    # Numeric modules, the package itself and the FMU's code are allowed.
    allowed = MODULES | {code}

    def watch(frame: Any, event: str, function: Any) -> None:
        # The recording itself runs inside the step and may do more; most calls are its own.
        if event != "c_call" or frame.f_globals.get("__name__", "").startswith(OWN):
            return
        # A method of a compiled type has no module; its object's type has one.
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
        # Random numbers would be drawn once, while recording, and then be constants.
        is_random = module.startswith(RANDOM)
        is_forbidden = module == "builtins" and function.__name__ in FORBIDDEN
        if module.partition(".")[0] in allowed and not is_random and not is_forbidden:
            return
        name = f"{module}.{function.__name__}"
        if name in READS:
            raise Untraceable("it reads files in a step")
        raise Untraceable(f"it calls {name}, which is no arithmetic")

    # A profiler sees every call of a compiled function before it runs; Python code needs no check,
    # as it ends in such calls.
    before = sys.getprofile()
    # The garbage collector would run finalizers here. What is refused in one of them is swallowed,
    # and Python drops the profiler for the rest of the step.
    collects = gc.isenabled()
    gc.disable()
    sys.setprofile(watch)
    try:
        yield
    finally:
        sys.setprofile(before)
        if collects:
            gc.enable()


@contextmanager
def anything() -> Iterator[None]:
    """Lift the restriction while a function runs that stays in Python."""
    before = sys.getprofile()
    sys.setprofile(None)
    try:
        yield
    finally:
        sys.setprofile(before)
