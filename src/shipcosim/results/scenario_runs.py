"""Runs of the scenarios of a folder, judged together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shipcosim.errors import Problem, ShipcosimError
from shipcosim.keywords import with_known_keywords
from shipcosim.report import ScenarioRow, overview_outcome, write_overview
from shipcosim.report.run.page import Digest
from shipcosim.report.theme.views import Outcome
from shipcosim.results.run import SCHEMA, VERDICT, Run
from shipcosim.results.shown import Check, Result
from shipcosim.series import write_json

if TYPE_CHECKING:
    from shipcosim.report.notebook.card import Card
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
    refused : mapping of str to ShipcosimError
        Scenarios that could not be read, with why.
    """

    name: str
    runs: Mapping[str, Run]
    refused: Mapping[str, ShipcosimError] = field(default_factory=dict)

    @property
    def rows(self) -> list[ScenarioRow]:
        """A row for each scenario, as on the page."""
        rows = [
            ScenarioRow(name, run.scenario.description, f"{name}/{run.checks[0].page}", run.digest)
            for name, run in self.runs.items()
        ]
        for name, error in self.refused.items():
            outcome = Outcome("failed", "ERROR", str(error))
            rows.append(ScenarioRow(name, "cannot be run", f"#{name}", Digest(outcome, [], ())))
        return rows

    @property
    def passed(self) -> bool:
        """Whether all scenarios ran, and all that was expected holds."""
        return self.is_usable and all(run.passed for run in self.runs.values())

    @property
    def is_usable(self) -> bool:
        """Whether all scenarios could be read."""
        return not self.refused

    @property
    def failures(self) -> tuple[Problem, ...]:
        """Why runs did not begin or did not get to their end."""
        errors = [run.errors for run in self.runs.values()]
        errors += [error.problems for error in self.refused.values()]
        return tuple(chain.from_iterable(errors))

    @property
    def outcome(self) -> Outcome:
        """Verdict in one word and one sentence."""
        return overview_outcome(self.rows)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Problems of all runs, each with its scenario."""
        checks = [
            replace(check, group=name, page=f"{name}/{check.page}")
            for name, run in self.runs.items()
            for check in run.checks
        ]
        for name, error in self.refused.items():
            checks.append(Check("can be run", "error", str(error), name))
        return tuple(checks)

    def as_json(self) -> dict[str, Any]:
        """What verdict.json of the folder holds: that of each run, and the verdict on all."""
        return {
            "schema": SCHEMA,
            "name": self.name,
            "verdict": "passed" if self.passed else "failed",
            "sentence": self.outcome.sentence,
            "scenarios": [run.as_json() | {"name": name} for name, run in self.runs.items()],
            "refused": {name: str(error) for name, error in self.refused.items()},
            "page": "report.html",
            "files": ["report.html", VERDICT],
        }

    @with_known_keywords
    def save(self, folder: AnyPath) -> None:
        """Write report.html and verdict.json into the folder that has the results of each run in one of its own."""
        write_overview(self.rows, Path(folder) / "report.html", title=f"Scenarios of {self.name}")
        write_json(self.as_json(), Path(folder) / VERDICT)

    def _card(self) -> Card:
        from shipcosim.report.notebook.card import Card

        return Card(title=self.name, facts=(), outcome=self.outcome, blocks=())
