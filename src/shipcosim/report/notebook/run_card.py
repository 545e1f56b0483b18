"""The card of a run."""

from __future__ import annotations

from collections.abc import Sequence

from xarray import Dataset

from shipcosim.report.notebook.card import Card
from shipcosim.report.notebook.run_track import run_track
from shipcosim.report.run.details import parsed
from shipcosim.report.run.page import digest
from shipcosim.report.theme.views import Block, Fact, Table, known_facts
from shipcosim.scenario import Scenario, Verdict
from shipcosim.ssp import System


def run_card(
    table: Dataset, scenario: Scenario, system: System, verdicts: Sequence[Verdict]
) -> Card:
    """Verdict, expectations, track and what signals there are.

    Parameters
    ----------
    table : xarray.Dataset
        The run. [SI]
    scenario, system
        What happened to what.
    verdicts : sequence of Verdict
        On what was expected within the run.
    """
    summary = digest(table, verdicts)
    rows = [
        ("holds" if expectation.passed else "FAILS", *expectation[1:])
        for expectation in summary.expectations
    ]
    name = scenario.name or system.name
    changed = ", ".join(parsed(table.attrs.get("changed", "[]")))
    return Card(
        title=name
        + (f": {scenario.description}" if scenario.description and scenario.name else ""),
        facts=_facts(table, scenario, system),
        outcome=summary.outcome,
        blocks=(
            Block("Expected", Table(rows, ("", "", "during", "worst", "at"))),
            Block("Changed for this run", lines=(changed,) if changed else ()),
            Block("Remarks", lines=tuple(summary.remarks)),
            Block("Signals, by component", Table(_signals(table)), folded=True),
        ),
        draw=lambda: run_track(table, verdicts, f"track of {name}") or "",
    )


def _facts(table: Dataset, scenario: Scenario, system: System) -> Sequence[Fact]:
    """What ran, for how long, in which steps."""
    time = table["time"].values
    span = f"{time[0]:g} to {time[-1]:g} s" if len(time) else "nothing"
    facts = {
        "System": system.name,
        "Simulated": span,
        "Step size": f"{scenario.step_size:g} s",
        "Table": f"{len(time)} rows, {len(table)} signals",
    }
    return known_facts(facts)


def _signals(table: Dataset) -> Sequence[tuple[str, str]]:
    """Connectors by component."""
    parts: dict[str, list[str]] = {}
    for name in map(str, table.data_vars):
        component, _, connector = name.rpartition(".")
        parts.setdefault(component or "system", []).append(connector)
    return [(component, ", ".join(connectors)) for component, connectors in parts.items()]
