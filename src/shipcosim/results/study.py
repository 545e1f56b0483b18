"""A study: its table of runs, its summary, its page, and any of its runs again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from shipcosim.results.run import SCHEMA, VERDICT
from shipcosim.results.shown import Check, HtmlPage, Result, finite
from shipcosim.series import write_json
from shipcosim.sweep import Swept
from shipcosim.sweep.storage import FILES

if TYPE_CHECKING:
    import pandas

    from shipcosim.report.notebook.card import Card
    from shipcosim.report.study import StudyTables
    from shipcosim.report.theme.views import Outcome
    from shipcosim.results.run import Run


@dataclass(frozen=True, repr=False, eq=False)
class StudyResult(Result, Swept):
    """What `shipcosim.sweep` gives back. To start with: ``.runs``, ``.summary``, ``.run(0)``."""

    command: str
    """What a user types to make this study."""
    simulate: Callable[[int], Run] = field(kw_only=True)

    def run(self, number: int) -> Run:
        """A run of the table simulated again, with all its signals.

        Parameters
        ----------
        number : int
            As in the column `run`.

        Raises
        ------
        ShipcosimError
            If there is no such run, or it fails.
        """
        return self.simulate(number)

    @property
    def outcome(self) -> Outcome:
        """Verdict in one word and one sentence."""
        from shipcosim.report.study import outcome_of

        return outcome_of(self._tables())

    @property
    def passed(self) -> bool:
        """Whether every run reached its end."""
        return not self.about["runs"]["failed"]

    @property
    def checks(self) -> tuple[Check, ...]:
        """That each run got to its end; whether expectations hold is a quantity of a study."""
        checks = []
        for number, error in zip(self.runs["run"], self.runs["error"], strict=True):
            columns = self.plan.run(int(number)).columns
            values = ", ".join(f"{name} {value}" for name, value in columns.items())
            checks.append(Check(f"run {number}: {values}", "error" if error else "passed", error))
        return tuple(checks)

    def as_json(self) -> dict[str, Any]:
        """What verdict.json holds and `shipcosim sweep --json` prints."""
        return finite(
            {
                "schema": SCHEMA,
                "name": self.plan.study.name,
                "verdict": "passed" if self.passed else "failed",
                "sentence": self.outcome.sentence,
                "runs": self.about["runs"],
                "errors": [error for error in self.runs["error"] if error],
                "summary": self.summary.to_dict("records"),
                "remarks": self.about.get("remarks", []),
                "page": "report.html",
                "files": sorted(
                    {VERDICT, *(name for name in FILES if (self.folder / name).is_file())}
                ),
            }
        )

    def write(self) -> None:
        """Write report.html and verdict.json beside the tables."""
        self.page().save(self.folder / "report.html")
        write_json(self.as_json(), self.folder / VERDICT)

    def to_pandas(self) -> pandas.DataFrame:
        """The table of runs."""
        return self.runs

    def page(self) -> HtmlPage:
        """The page of the study, as `shipcosim sweep` writes it."""
        from shipcosim.report.study import render

        return HtmlPage(f"Study {self.plan.study.name}", render(self._tables()))

    def _card(self) -> Card:
        from shipcosim.report.notebook.sweep_card import sweep_card

        return sweep_card(self._tables())

    def _tables(self) -> StudyTables:
        from shipcosim.report.study import tables_of

        return tables_of(self, self.command)
