"""Workaround for reference counts in the binary of pythonfmu 0.7.0, which would crash the host."""

import ctypes


def keep(*objects: object) -> None:
    """Add a reference to each object, for the one that the binary drops without owning it.

    It drops one of the entry module's namespace for every instance, and of class, instance and
    messages for every exception, after which the host may still free the instance.
    """
    for kept in objects:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(kept))
