"""SUNDIALS as FMPy brings it: version 5 up to FMPy 0.3.28, then version 7 with contexts."""

from collections.abc import Callable
from ctypes import byref, c_int, c_void_p
from typing import Any

from fmpy.sundials import cvode, libraries, sundials_types

try:
    from fmpy.sundials import sundials_context  # pyright: ignore[reportAttributeAccessIssue]
except ImportError:
    sundials_context: Any = None


class Context:
    """The shared context of one solver's objects. It takes its messages, which SUNDIALS would print.

    Attributes
    ----------
    arguments : tuple
        To be added to calls that make vectors, matrices and solvers.
    """

    def __init__(self):
        self.arguments: tuple[Any, ...] = ()
        types: Any = sundials_types
        # Version 5 has no context; messages go to a handler of each CVode memory, see `watch`.
        if sundials_context is None:
            handler: Any = vars(cvode)["CVErrHandlerFn"]
            self._handler = handler(lambda *message: None)
            return
        # Version 7: all objects belong to a context, and errors go to its handlers. Only ours shall
        # be there.
        context = types.SUNContext()
        sundials_context.SUNContext_Create(types.SUN_COMM_NULL, byref(context))
        self._handler = types.SUNErrHandlerFn(lambda *message: None)
        core_library().SUNContext_ClearErrHandlers(context)  # the one that is there prints
        sundials_context.SUNContext_PushErrHandler(context, self._handler, None)
        self.arguments = (context,)

    def watch(self, memory: Any) -> None:
        """Send the messages of a CVode memory to our handler."""
        if sundials_context is None:
            vars(cvode)["CVodeSetErrHandlerFn"](memory, self._handler, None)

    def close(self) -> None:
        """Free the context, after everything that was made in it."""
        for context in self.arguments:
            core_library().SUNContext_Free(byref(context))
        self.arguments = ()


def core_library() -> Any:
    """Library with the functions for any vector, matrix and solver; version 5 has them in each of its libraries."""
    return vars(libraries)["sundials_cvode" if sundials_context is None else "sundials_core"]


def freeing(name: str, kind: Any) -> Callable[[Any], int]:
    """Function that frees objects of one kind, such as ``SUNMatDestroy``."""
    function = getattr(core_library(), name)
    function.argtypes = [kind]
    function.restype = c_int
    return function


def free_memory(memory: int) -> None:
    """Free a CVode memory."""
    cvode.CVodeFree(byref(c_void_p(memory)))
