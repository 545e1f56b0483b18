"""Runs of the scenarios of a folder, judged together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shipcosim.errors import Problem
from shipcosim.report import ScenarioRow, overview_outcome, write_overview
from shipcosim.results.run import SCHEMA, VERDICT, Run
from shipcosim.results.shown import Check, Result
from shipcosim.series import write_json

if TYPE_CHECKING:
    from shipcosim.report.notebook.card import Card
    from shipcosim.report.theme.views import Outcome
    from shipcosim.ssp import AnyPath


@dataclass(frozen=True, repr=False, eq=False)
class ScenarioRuns(Result):
    """The scenarios of a folder.

    Attributes
    ----------
    name : str
        Of the folder.
    runs : mapping of str to Run
        By the names of the scenarios.
    """

    name: str
    runs: Mapping[str, Run]

    @property
    def rows(self) -> list[ScenarioRow]:
        """A row for each scenario, as on the page."""
        return [
            ScenarioRow(name, run.scenario.description, f"{name}/{run.checks[0].page}", run.digest)
            for name, run in self.runs.items()
        ]

    @property
    def passed(self) -> bool:
        """Whether all that was expected holds."""
        return all(run.passed for run in self.runs.values())

    @property
    def failures(self) -> tuple[Problem, ...]:
        """Why runs did not get to their end."""
        return tuple(error for run in self.runs.values() for error in run.errors)

    @property
    def outcome(self) -> Outcome:
        """Verdict in one word and one sentence."""
        return overview_outcome(self.rows)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Problems of all runs, each with its scenario."""
        return tuple(
            replace(check, group=name, page=f"{name}/{check.page}")
            for name, run in self.runs.items()
            for check in run.checks
        )

    def as_json(self) -> dict[str, Any]:
        """What verdict.json of the folder holds: that of each run, and the verdict on all."""
        return {
            "schema": SCHEMA,
            "name": self.name,
            "verdict": "passed" if self.passed else "failed",
            "sentence": self.outcome.sentence,
            "scenarios": [run.as_json() | {"name": name} for name, run in self.runs.items()],
            "page": "report.html",
            "files": ["report.html", VERDICT],
        }

    def save(self, folder: AnyPath) -> None:
        """Write report.html and verdict.json into the folder that has the results of each run in one of its own."""
        write_overview(self.rows, Path(folder) / "report.html", title=f"Scenarios of {self.name}")
        write_json(self.as_json(), Path(folder) / VERDICT)

    def _card(self) -> Card:
        from shipcosim.report.notebook.card import Card

        return Card(title=self.name, facts=(), outcome=self.outcome, blocks=())
