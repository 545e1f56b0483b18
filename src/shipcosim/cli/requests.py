"""What the arguments of a command ask for, as the values that a call takes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from shipcosim.errors import Problem, raise_errors
from shipcosim.units import value_of

QUOTED = re.compile(r'\s*"([^"]+)"\s*(=)(.*)', re.DOTALL)
"""A setting whose name is in quotes, as in a scenario: it may have an = in it."""


def parsed_settings(settings: Iterable[str] | None) -> dict[str, Any]:
    """Values of ``--set component.name=value``, each read as TOML; what is no TOML is text.

    Examples
    --------
    >>> parsed_settings(["vessel.mass=5e5", "port.failed=true", "environment.spectrum=kaimal"])
    {'vessel.mass': 500000.0, 'port.failed': True, 'environment.spectrum': 'kaimal'}
    >>> parsed_settings(['"table.k=2"=0.5', "note.text=a=b"])
    {'table.k=2': 0.5, 'note.text': 'a=b'}
    """
    values = {}
    problems = []
    for setting in settings or ():
        quoted = QUOTED.fullmatch(setting)
        name, sign, text = quoted.groups() if quoted else setting.partition("=")
        if not sign or not name.strip():
            problems.append(
                Problem(
                    "--set", f"'{setting}' sets nothing.", "Right would be component.name=value."
                )
            )
        problems += _of_twice("--set", name.strip(), values)
        values[name.strip()] = value_of(text)
    raise_errors(problems)
    return values


def parsed_components(given: Iterable[str] | None, option: str = "--component") -> dict[str, str]:
    """FMUs of ``--component component=FMU`` or another option, each a path or a name.

    Raises
    ------
    ShipcosimError
        If one is none of that.
    """
    components: dict[str, str] = {}
    problems = []
    for pair in given or ():
        name, sign, fmu = (part.strip() for part in pair.partition("="))
        if sign and name and fmu:
            problems += _of_twice(option, name, components)
            components[name] = fmu
        else:
            problems.append(
                Problem(option, f"'{pair}' swaps nothing.", "Right would be component=FMU.")
            )
    raise_errors(problems)
    return components


def _of_twice(option: str, name: str, given: Mapping[str, Any]) -> list[Problem]:
    if name not in given:
        return []
    return [Problem(option, f"'{name}' is given twice.", "Keep one of them.")]


def isolation(isolate: bool, timeout: float | None) -> dict[str, Any]:
    """Options of a run that --isolate and --timeout stand for."""
    return {"isolate": isolate} | ({} if timeout is None else {"timeout": timeout})
