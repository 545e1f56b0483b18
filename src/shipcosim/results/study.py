"""A study: its table of runs, its summary, its page, and any of its runs again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from shipcosim.results.shown import HtmlPage, Result
from shipcosim.sweep import Swept

if TYPE_CHECKING:
    import pandas

    from shipcosim.report.notebook.card import Card
    from shipcosim.report.study import StudyTables
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
