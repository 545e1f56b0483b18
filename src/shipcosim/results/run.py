"""A run: its table, what was expected of it, and how it shows itself."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.errors import Problem, error_at
from shipcosim.results.shown import HtmlPage, LikeTable, Picture, Result
from shipcosim.results.signals import chosen
from shipcosim.staging import staged

if TYPE_CHECKING:
    import pandas
    import xarray

    from shipcosim.report.notebook.card import Card
    from shipcosim.scenario import Expectation, Scenario, Verdict
    from shipcosim.ssp import AnyPath, System


PARTIAL = ("result-partial.nc", "result-partial.csv", "result-partial.html")
"""Files of a run that did not get to its end; a complete one takes them away."""
PREDICTIONS = "predictions.csv"


@dataclass(frozen=True, repr=False, eq=False)
class Run(LikeTable, Result):
    """What `shipcosim.run` and `shipcosim.simulate` give back. What its table has, it has, too.

    ``run["vessel.x"]``, ``run.sizes``, ``run.sel(time=60.0)`` are those of `table`. Functions of xarray and numpy that
    ask for a Dataset take ``run.table``.

    Attributes
    ----------
    table : xarray.Dataset
        One row per output interval, `time` in s; variables are named ``component.connector``.
    scenario : Scenario
        What happened.
    system : System
        What ran, flat and checked.
    expectations : tuple of Verdict
        Those of the scenario that lie within the run: ``.passed``, ``.worst``, ``.time``, and ``.expect`` as written.
    not_judged : tuple of Expectation
        Those whose times the run did not reach.
    remarks : tuple of Problem
        What does not stop a run and should be known.
    """

    table: xarray.Dataset
    scenario: Scenario
    system: System
    expectations: tuple[Verdict, ...] = ()
    not_judged: tuple[Expectation, ...] = ()
    remarks: tuple[Problem, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether the run got to its end and all that was expected of it holds."""
        from shipcosim.report.run.expectations import is_complete

        return is_complete(self.table) and all(verdict.passed for verdict in self.expectations)

    @property
    def name(self) -> str:
        """Of the scenario, or of the system where there is no scenario file."""
        return self.scenario.name or self.system.name

    @property
    def predictions(self) -> pandas.DataFrame:
        """Every prediction of the run's predictors, beside what became of the ship; no rows where nothing predicts.

        A row for each prediction and horizon: time, component, horizon, predicted and true x, y, psi, errors north,
        east and of heading, radius and half-width of the regions, whether the truth is in them (1, 0, or no number
        where there is no region or the run ends before), and the share of what is learned. SI and radians.
        """
        from shipcosim.report.run.predictions import make_predictions

        return make_predictions(self.table)

    def plot(self, *signals: str) -> Picture:
        """Signals over time, a panel for each unit; moments of events are marked.

        Parameters
        ----------
        *signals : str
            Each a signal, a component, a connector or a pattern: ``"vessel.psi"``, ``"controller"``, ``"thrust"``,
            ``"vessel.tau_*_X"``. Without one: position and heading of the ship, or all signals where there is none.

        Returns
        -------
        Picture

        Raises
        ------
        ShipcosimError
            If there is no such signal.
        """
        from shipcosim.report.notebook.figures import panels_svg
        from shipcosim.report.run.roles import find_roles
        from shipcosim.report.theme.display import display_table

        roles = find_roles(self.table.data_vars)
        pose = (
            [roles.signal(roles.ship, axis) for axis in ("x", "y", "psi")]
            if roles.ship is not None
            else []
        )
        names = chosen(map(str, self.table.data_vars), signals or [n for n in pose if n] or ["*"])
        shown = display_table(self.table, roles.signal(roles.ship, "psi"))
        drawn = [name for name in names if name in shown]
        if not drawn:
            found = f"{', '.join(names)}: no signal among these is a number over time."
            raise error_at(self.name, found, "Only those can be drawn.")
        title = f"{', '.join(signals) or 'signals'} of {self.name}"
        events = sorted({event.time for event in self.scenario.events})
        return Picture(title, panels_svg(shown, drawn, title, events))

    def track(self) -> Picture:
        """The way of the ship on a chart, north up, with where she was to be.

        Raises
        ------
        ShipcosimError
            If nothing in the table is a ship: a component with x, y and psi.
        """
        from shipcosim.report.notebook.run_track import run_track

        svg = run_track(self.table, self.expectations, f"track of {self.name}")
        if svg is None:
            remedy = "`.plot(...)` draws any signals."
            raise error_at(
                self.name, "Nothing here is a ship, with x, y and psi over time.", remedy
            )
        return Picture(f"track of {self.name}", svg)

    def page(self) -> HtmlPage:
        """The page of the run, as `shipcosim run` writes it."""
        from shipcosim.report.run.page import render

        page = render(
            self.table, scenario=self.scenario, verdicts=self.expectations, system=self.system
        )
        return HtmlPage(self.name, page)

    def save(self, folder: AnyPath, *, force: bool = False) -> Path:
        """Write result.nc, result.csv, report.html and, where something predicts, predictions.csv; returns the folder.

        Parameters
        ----------
        folder : path
            Made if needed.
        force : bool
            Replace files of these names there, instead of keeping them in a numbered folder beside it.

        Raises
        ------
        ShipcosimError
            If they cannot be written.
        """
        from shipcosim.report.run.predictions import write_predictions

        with staged(Path(folder), (*PARTIAL, PREDICTIONS), force=force) as stage:
            self._write(stage, "result", "report.html")
            if len(predictions := self.predictions):
                write_predictions(predictions, stage / PREDICTIONS)
        return Path(folder)

    def save_part(self, folder: AnyPath, *, force: bool = False) -> Path:
        """Write result-partial.nc, .csv and .html of a run that did not get to its end; returns the folder.

        Parameters and errors as for `save`.
        """
        with staged(Path(folder), force=force) as stage:
            self._write(stage, "result-partial", "result-partial.html")
        return Path(folder)

    def _write(self, stage: Path, stem: str, page: str) -> None:
        """Write table and page into a folder that is there."""
        from shipcosim.series import write_table

        for suffix in (".nc", ".csv"):
            write_table(self.table, stage / f"{stem}{suffix}")
        self.page().save(stage / page)

    def claims_not_reached(self) -> list[str]:
        """What was expected later than the run went, each as a sentence with the units that people read."""
        from shipcosim.report.run.expectations import claims
        from shipcosim.scenario import units_of, with_numbers

        late = self.scenario.model_copy(update={"expect": list(self.not_judged)})
        return claims(with_numbers(late, units_of(self.system)).expect, self.table)

    def to_pandas(self) -> pandas.DataFrame:
        """The table as a DataFrame over time; units are in ``.table[name].attrs["units"]``."""
        return self.table.to_dataframe()

    def __repr__(self) -> str:
        from shipcosim.report.run.expectations import outcome

        found = outcome(self.table, self.expectations)
        components = {n.rpartition(".")[0] for n in map(str, self.table)}
        size = f"{self.table.sizes['time']} rows of {len(self.table)} signals of {len(components)} components"
        return f"<Run of {self.name!r}: {found.word}. {found.sentence} {size}>"

    def _card(self) -> Card:
        from shipcosim.report.notebook.run_card import run_card

        return run_card(self.table, self.scenario, self.system, self.expectations)
