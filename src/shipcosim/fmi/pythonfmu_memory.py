"""Making up for what the binary of pythonfmu 0.7.0 does to memory. Left alone, this ends in a crash."""

import ctypes


def keep(*objects: object) -> None:
    """Add to each object a reference that nobody owns, for one that the binary gives up without owning it.

    It does so with the namespace of the entry module for every instance; and with class, instance and messages for
    every exception, after which the host still may, and does, free the instance.
    """
    for kept in objects:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(kept))
