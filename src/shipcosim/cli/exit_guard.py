"""Guard of the process: code of an FMU that calls ``exit`` must not look like a run that went well.

C ends a process at once there, with the code that the FMU chose, and nothing of Python runs any more. C's own list of
functions to call at the end is all there is: the last one that was added is called first.
"""

import ctypes
import sys

SAID = (
    b"A program library, as a rule that of an FMU, has ended the process; there are no results. "
    b"--isolate runs each FMU in a process of its own and keeps the rows so far."
)


def guard_exit() -> None:
    """Have the process print a message and exit with 1 if a library ends it from now on."""
    _at_exit("_exit", 1)
    _at_exit("warnx", SAID)


def release_exit(code: int) -> None:
    """Allow the process to end, with this exit code."""
    _at_exit("_exit", code)
    _at_exit("fflush", None)  # what C has printed and not written yet


def _at_exit(function: str, argument: int | bytes | None) -> None:
    """Have C call one of its functions with an argument at the end of the process."""
    if sys.platform != "linux":
        return
    c = ctypes.CDLL(None)
    register = getattr(c, "__cxa_atexit")
    register.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    if isinstance(argument, bytes):
        _KEPT.append(ctypes.create_string_buffer(argument))
        argument = ctypes.addressof(_KEPT[-1])
    register(ctypes.cast(getattr(c, function), ctypes.c_void_p), argument, None)


_KEPT: list[ctypes.Array] = []
"""Texts that C will print, which must stay where they are."""
