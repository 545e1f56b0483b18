"""A measured log as it was read, and how it shows itself."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from shipcosim.errors import error_at
from shipcosim.results.shown import LikeTable, Picture
from shipcosim.scenario.signals import chosen

if TYPE_CHECKING:
    import xarray

    from shipcosim.diagnose.finding import Finding
    from shipcosim.ssp import AnyPath


@dataclass(frozen=True, repr=False, eq=False)
class Log(LikeTable):
    """What `shipcosim.read_log` gives back. What its table has, it has, too: ``log["heading"]``, ``log.sizes``.

    Attributes
    ----------
    name : str
        Of the file.
    table : xarray.Dataset
        Every row of the log, over `time`, by roles and in their units: see docs/measured-data.md.
    source : path or xarray.Dataset
        What it was read from.
    channels : path or None
        Channel file by which it was read.
    """

    name: str
    table: xarray.Dataset
    source: AnyPath | xarray.Dataset
    channels: AnyPath | None = None

    @cached_property
    def remarks(self) -> tuple[str, ...]:
        """Remarks: how the columns were read, which were not, what the log lacks, and what was handled."""
        from shipcosim.diagnose.log.remarks import remarks

        return (*map(str, self.table.attrs.get("column_remarks", ())), *remarks(self.table))

    @cached_property
    def faults(self) -> tuple[Finding, ...]:
        """Faults that the channels show by themselves, as ``shipcosim check`` lists them."""
        import numpy as np

        from shipcosim.diagnose.log.checks.examine import examine

        with np.errstate(all="ignore"):  # numbers beyond all bounds are among what it looks for
            return tuple(examine(self.table))

    def plot(self, *channels: str) -> Picture:
        """Channels over time, a panel for each unit.

        Parameters
        ----------
        *channels : str
            Each a channel, a component or a pattern: ``"heading"``, ``"port"``, ``"*.rpm"``; all without one.

        Raises
        ------
        ShipcosimError
            If there is no such channel.
        """
        from shipcosim.report.notebook.figures import panels_svg
        from shipcosim.report.theme.display import display_table

        shown = display_table(self.table)
        names = chosen(map(str, shown.data_vars), channels or ["*"])
        title = f"{', '.join(channels) or 'channels'} of {self.name}"
        return Picture(title, panels_svg(shown, names, title))

    def track(self) -> Picture:
        """The way of the ship on a chart, north up; the ship is not to scale.

        Raises
        ------
        ShipcosimError
            If the log has no position.
        """
        from shipcosim.report.notebook.figures import Path, track_svg

        if not {"north", "east"} <= set(self.table):
            raise error_at(
                self.name, "The log has no position.", "`.plot(...)` draws any channels."
            )
        heading = self.table["heading"].values if "heading" in self.table else None
        path = Path("measured", self.table["north"].values, self.table["east"].values, heading)
        return Picture(f"track of {self.name}", track_svg([path], f"track of {self.name}"))

    def __repr__(self) -> str:
        time = self.table["time"].values
        span = f"{len(time)} rows from {time[0]:g} to {time[-1]:g} s" if len(time) else "no rows"
        return f"<Log {self.name!r}: {span}, {len(self.table)} channels>"

    def _repr_html_(self) -> str:
        from shipcosim.report.notebook.card import card_html
        from shipcosim.report.notebook.log_card import log_card

        has_position = {"north", "east"} <= set(self.table)
        draw = (lambda: self.track().svg) if has_position else None
        return card_html(log_card(self.name, self.table, self.faults, self.remarks, draw))
