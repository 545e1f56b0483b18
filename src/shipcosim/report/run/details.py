"""Events, start values, versions and further attributes of a run, as tables to unfold."""

import json
from collections.abc import Iterable, Sequence
from typing import Any

from xarray import Dataset

from shipcosim.errors import capitalised
from shipcosim.report.theme.views import Block, Table
from shipcosim.scenario import Scenario
from shipcosim.ssp import System

CHANGES = {"override": "{} = {}", "bias": "{} + {}", "reset": "{} released"}
SHOWN_ELSEWHERE = ("events", "remarks", "changed", "not_reached", "judged_on")


def details(
    table: Dataset, scenario: Scenario | None = None, system: System | None = None
) -> Sequence[Block]:
    """Events and start values of the scenario, and what the attributes of the table say.

    Parameters
    ----------
    table : xarray.Dataset
        The run.
    scenario : Scenario, optional
        What happened.
    system : System, optional
        Gives the units of start values.

    Returns
    -------
    sequence of Block
    """
    sections = []
    if scenario is not None and scenario.events:
        rows = []
        for event in scenario.events:
            changes = [CHANGES[verb].format(*change) for verb, *change in event.changes]
            rows.append((f"{event.time:g} s", ", ".join(changes)))
        sections.append(_detail("events", rows))
    if scenario is not None and scenario.set:
        sections.append(_detail("start values of the scenario", scenario.set.items()))
    return (
        *sections,
        *(_detail(title, content.items()) for title, content in _attributes(table, system)),
    )


def parsed(value: Any) -> Any:
    """Parse an attribute; NetCDF attributes are flat, so dictionaries are stored as JSON text."""
    if isinstance(value, str) and value[:1] in "{[":
        try:
            return json.loads(value)
        except ValueError:
            return value
    return value


def _attributes(table: Dataset, system: System | None) -> list[tuple[str, dict[str, Any]]]:
    """Attributes of the table: titles, and contents by name."""
    plain: dict[str, Any] = {}
    nested: list[tuple[str, dict[str, Any]]] = []
    for key, value in table.attrs.items():
        # Start values become a table for each component,
        # dictionaries a table each, the rest one table.
        name = str(key)
        content = parsed(value)
        if name == "start_values":
            by_component: dict[str, dict[str, Any]] = {}
            for signal, start in content.items():
                component, _, variable = signal.rpartition(".")
                unit = _unit(system, component, variable) or ""
                shown = start if unit in ("", "1") else f"{start} {unit}"
                title = f"Start values: {component or 'the system'}"
                by_component.setdefault(title, {})[variable] = shown
            nested += by_component.items()
        elif isinstance(content, dict):
            nested.append((name, content))
        elif name not in SHOWN_ELSEWHERE:
            plain[name] = content
    return ([("run", plain)] if plain else []) + nested


def _unit(system: System | None, component: str, name: str) -> str | None:
    if system is None:
        return None
    variables = (
        system.components[component].variables if component in system.components else system.inputs
    )
    return variables[name].unit if name in variables else None


def _detail(title: str, rows: Iterable[tuple[Any, Any]]) -> Block:
    return Block(
        capitalised(title.replace("_", " ")),
        Table([(str(name), _text(value)) for name, value in rows]),
    )


def _text(value: Any) -> str:
    """A value as text; dictionaries and lists as their items, one after the other."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(item)}" for key, item in value.items())
    return ", ".join(map(_text, value)) if isinstance(value, (list, tuple)) else str(value)
