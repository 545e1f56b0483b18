"""Making up for what the binary of pythonfmu 0.7.0 does to memory. Left alone, each of these ends in a crash."""

import atexit
import contextlib
import ctypes
import functools
import os
from pathlib import Path


def keep(*objects):
    """Add to each object a reference that nobody owns, for one that the binary gives up without owning it.

    It does so with the namespace of the entry module for every instance; and with class, instance and messages for
    every exception, after which the host still may, and does, free the instance.
    """
    for kept in objects:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(kept))


@functools.cache
def let_go_at_exit(resources):
    """Make the binary drop its static state while the process still runs.

    Where a host exits without unloading the binary, its state would be dropped twice.

    Parameters
    ----------
    resources : str
        The unpacked FMU's folder of that name.
    """
    if os.name == "posix":
        atexit.register(_let_go, list(Path(resources).parent.glob("binaries/*/*.so")))


def _let_go(libraries):
    for path in libraries:
        with contextlib.suppress(OSError):  # it has been unloaded
            ctypes.CDLL(str(path), mode=os.RTLD_NOW | os.RTLD_NOLOAD).finalizePythonInterpreter()
