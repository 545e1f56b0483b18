"""Libraries that studies need and a plain installation lacks."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from shipcosim.errors import Problem, ShipcosimError


@contextmanager
def imported(where: str, found: str, extra: str = "sweep") -> Iterator[None]:
    """For an import of a library that an extra of the package brings.

    Parameters
    ----------
    where, found : str
        As of the problem, where the library is missing.
    extra : str
        That brings it.

    Raises
    ------
    ShipcosimError
        If it is missing, with what to install.
    """
    try:
        yield
    except ImportError:
        raise ShipcosimError(
            Problem(where, found, f"Install it: pip install 'shipcosim[{extra}]'.")
        ) from None
