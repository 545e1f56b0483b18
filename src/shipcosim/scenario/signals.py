"""Signals of a table by what a user calls them: their names, components, patterns."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase

from shipcosim.errors import Problem, raise_errors, suggestion


def chosen(names: Iterable[str], wanted: Sequence[str]) -> list[str]:
    """Names that are meant, each once, in the order in which they were asked for.

    Parameters
    ----------
    names : iterable of str
        All signals.
    wanted : sequence of str
        Each a signal (``"vessel.x"``), a component (``"controller"``: all of its signals), a connector
        (``"thrust"``: of every component that has it), or a pattern (``"*.thrust"``, ``"vessel.tau_*_X"``).

    Raises
    ------
    ShipcosimError
        If something asked for is none of these.

    Examples
    --------
    >>> chosen(["vessel.x", "port.thrust", "port.rpm", "tunnel.thrust"], ["port", "*.thrust"])
    ['port.thrust', 'port.rpm', 'tunnel.thrust']
    """
    available = list(names)
    matched = {}
    problems = []
    for pattern in map(str, wanted):
        matching = _matching(available, pattern)
        matched |= dict.fromkeys(matching)
        if not matching:
            problems.append(
                Problem(
                    pattern, "There is no such signal or component.", _remedy(available, pattern)
                )
            )
    raise_errors(problems)
    return list(matched)


def _matching(available: Sequence[str], wanted: str) -> list[str]:
    """Signals that a name means; the nearest meaning comes first."""
    if wanted in available:
        return [wanted]
    of_component = [name for name in available if name.startswith(f"{wanted}.")]
    of_connector = [name for name in available if name.rpartition(".")[2] == wanted]
    return of_component or of_connector or [name for name in available if fnmatchcase(name, wanted)]


def _remedy(available: Sequence[str], wanted: str) -> str:
    """Remedy: signals of the component if it exists, else the components, else all signals."""
    component = wanted.rpartition(".")[0]
    of_component = [name for name in available if component and name.startswith(f"{component}.")]
    components = {name.rpartition(".")[0] for name in available} - {""}
    return suggestion(wanted, of_component or components or available)
