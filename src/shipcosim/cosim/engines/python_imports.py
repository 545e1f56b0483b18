"""Imports that Python FMUs leave behind in this process when an engine other than ours has run them."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def imports_undone() -> Iterator[None]:
    """Restore `sys.path` at the end, and forget modules that came from entries added to it.

    PythonFMU adds the folder of each FMU. A later run would otherwise take a module of the same name from there.
    """
    before = list(sys.path)
    try:
        yield
    finally:
        added = tuple(entry for entry in sys.path if entry not in before)
        sys.path[:] = before
        # A module may stay in use by its FMU; it only leaves the list of imported modules.
        for name, module in list(sys.modules.items()):
            if added and (getattr(module, "__file__", None) or "").startswith(added):
                del sys.modules[name]
