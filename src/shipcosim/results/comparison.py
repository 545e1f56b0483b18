"""Two runs laid over each other: by how much they differ, their page, and both in one plot."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.errors import AnyPath, error_at
from shipcosim.results.run import Run
from shipcosim.results.shown import HtmlPage, Picture, SavedResult
from shipcosim.scenario.signals import chosen
from shipcosim.series import read_table

if TYPE_CHECKING:
    import pandas
    import xarray

    from shipcosim.report.notebook.card import Card
    from shipcosim.report.run.comparison import Comparison


@dataclass(frozen=True, repr=False, eq=False)
class RunComparison(SavedResult):
    """What `shipcosim.report` gives back.

    Attributes
    ----------
    names : (str, str)
        What the runs are called.
    tables : (Dataset, Dataset)
        Of the runs. [SI]
    """

    names: tuple[str, str]
    tables: tuple[xarray.Dataset, xarray.Dataset]

    @cached_property
    def comparison(self) -> Comparison:
        """Both runs on common times, their differences, and what the page shows."""
        from shipcosim.report.run.comparison import compared

        return compared(self.tables, self.names)

    def to_pandas(self) -> pandas.DataFrame:
        """A row a signal that differs: unit, rms, largest, its time, and rms over the signal's range."""
        import pandas

        return pandas.DataFrame(self.comparison.differences).set_index("signal")

    def plot(self, *signals: str) -> Picture:
        """Signals of both runs over time, a panel for each unit; without one those that differ most.

        Signals are named as for `Run.plot`.
        """
        from shipcosim.report.notebook.figures import panels_svg

        differing = [difference.signal for difference in self.comparison.differences[:3]]
        both = self.comparison.both
        first = list(map(str, self.comparison.pair.shown[0].data_vars))
        drawn = [
            f"{run}: {name}"
            for name in chosen(first, signals or differing or first[:3])
            for run in self.names
            if f"{run}: {name}" in both
        ]
        title = f"{', '.join(signals) or 'signals'} of {' and '.join(self.names)}"
        return Picture(title, panels_svg(both, drawn, title))

    def page(self) -> HtmlPage:
        """The page, as `shipcosim report` writes it."""
        from shipcosim.report.theme.pages import render

        page = render("run/templates/run.html.jinja", self.comparison.page)
        return HtmlPage(self.comparison.page.title, page)

    def _card(self) -> Card:
        from shipcosim.report.notebook.card import Card
        from shipcosim.report.theme.views import Block

        page = self.comparison.page
        differing = (Block(page.figures_title, page.key_figures),) if page.key_figures else ()
        return Card(title=page.title, facts=page.facts, outcome=page.outcome, blocks=differing)


def table_of(given: AnyPath | Run | xarray.Dataset) -> xarray.Dataset:
    """The table of a run; of a folder of results the one in it."""
    if isinstance(given, Run):
        return given.table
    if not isinstance(given, (str, Path)):
        return given  # pyright: ignore[reportReturnType]
    path = Path(given)
    names = ("result.nc", "result.csv", "result-partial.nc", "result-partial.csv")
    tables = [path / name for name in names if (path / name).is_file()]
    if path.is_dir() and not tables:
        raise error_at(
            str(path), "There is no result.nc in this folder.", "Give the --out of a run."
        )
    return read_table(tables[0] if path.is_dir() else path)
