"""What a result shows: its page and its pictures, as values that a notebook displays and that can be saved."""

from __future__ import annotations

import html
import math
import os
import tempfile
import webbrowser
from abc import ABC, abstractmethod
from collections.abc import Hashable, Iterator
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shipcosim.errors import error_at, it_has
from shipcosim.keywords import with_known_keywords
from shipcosim.series import write_file, write_json
from shipcosim.staging import staged

if TYPE_CHECKING:
    import pandas
    import xarray

    from shipcosim.errors import Problem
    from shipcosim.report.notebook.card import Card
    from shipcosim.report.theme.views import Outcome
    from shipcosim.ssp import AnyPath


HEIGHT = 820  # px, of a page within a notebook


@dataclass(frozen=True)
class HtmlPage:
    """The page of a result: one HTML file that opens anywhere. As the last value of a notebook cell it is shown there.

    Parameters
    ----------
    title : str
        What it is the page of.
    html : str
        All of it.

    Examples
    --------
    >>> HtmlPage("gust", "<!doctype html><title>gust</title>")
    <page 'gust', 0.0 MB: .open() shows it in the browser, .save("page.html") writes it>
    """

    title: str
    html: str = field(repr=False)

    @with_known_keywords
    def save(self, path: AnyPath) -> Path:
        """Write the page to a file; it is there completely or not at all.

        Raises
        ------
        ShipcosimError
            If the file cannot be written.
        """
        write_file(path, self.html.encode())
        return Path(path)

    def open(self) -> Path:
        """Show the page in the browser, from a file in the folder for temporary files; returns that file."""
        descriptor, name = tempfile.mkstemp(prefix="shipcosim-", suffix=".html")
        os.close(descriptor)
        webbrowser.open(self.save(name).as_uri())
        return Path(name)

    def __repr__(self) -> str:
        size = f"{len(self.html.encode()) / 1e6:.1f} MB"
        return f'<page {self.title!r}, {size}: .open() shows it in the browser, .save("page.html") writes it>'

    def _repr_html_(self) -> str:
        content = html.escape(self.html, quote=True)
        frame = f'width="100%" height="{HEIGHT}" style="border:1px solid #dde3e9" title="{html.escape(self.title)}"'
        return f'<iframe srcdoc="{content}" {frame}></iframe>'


@dataclass(frozen=True)
class Picture:
    """A picture as SVG: shown by notebooks and by GitHub's viewer, needs no script.

    Parameters
    ----------
    name : str
        What is drawn.
    svg : str
        All of it.

    Examples
    --------
    >>> Picture("track of gust", "<svg/>")
    <picture 'track of gust': .save("picture.svg") writes it>
    """

    name: str
    svg: str = field(repr=False)

    @with_known_keywords
    def save(self, path: AnyPath) -> Path:
        """Write the picture to an .svg file; errors as for `HtmlPage.save`."""
        write_file(path, self.svg.encode())
        return Path(path)

    def __repr__(self) -> str:
        return f'<picture {self.name!r}: .save("picture.svg") writes it>'

    def _repr_svg_(self) -> str:
        return self.svg


@dataclass(frozen=True)
class Check:
    """One thing that was checked: an expectation, a file, a signal, a run of a study.

    Attributes
    ----------
    name : str
        What must hold.
    status : str
        ``"passed"``, ``"failed"``, ``"error"`` where it could not be checked, ``"skipped"`` where it was not reached.
    message : str
        What was measured, against which limit.
    group : str
        Scenario that it belongs to, where there are several.
    page : str
        Its page in the folder of the results.
    """

    name: str
    status: str
    message: str = ""
    group: str = ""
    page: str = "report.html"

    def __post_init__(self) -> None:
        # Texts for people have spaces that do not break; whoever searches a log of CI types plain ones.
        for part in ("name", "message"):
            object.__setattr__(self, part, getattr(self, part).replace("\u00a0", " "))

    def __str__(self) -> str:
        return f"{self.name}: {self.message}"


def passed_or_failed(holds: bool) -> str:
    """Status of something that was checked."""
    return "passed" if holds else "failed"


class Result(ABC):
    """What all results have: a line for the console, a card for notebooks, what was checked one by one."""

    is_usable = True
    """Whether all of the input could be used; else the command ends with exit code 2."""

    @abstractmethod
    def _card(self) -> Card:
        """What a notebook shows."""

    @property
    def outcome(self) -> Outcome:
        """Verdict in one word and one sentence."""
        return self._card().outcome

    @property
    def passed(self) -> bool:
        """Whether nothing is wrong; else the command ends with exit code 1."""
        return getattr(self, "verdict", "consistent") == "consistent"

    @property
    def failures(self) -> tuple[Problem, ...]:
        """Errors that --quiet prints, too."""
        return ()

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks, one by one; if `passed` is false, one of them failed."""
        card = self._card()
        return (Check(card.title, passed_or_failed(self.passed), card.outcome.sentence),)

    def __repr__(self) -> str:
        card = self._card()
        return f"<{card.title}: {card.outcome.word}. {card.outcome.sentence}>"

    def _repr_html_(self) -> str:
        from shipcosim.report.notebook.card import card_html

        return card_html(self._card())


class SavedResult(Result):
    """A result whose files can be written, as its command writes them."""

    json_name = ""
    """File that gets `as_json`; none if empty."""

    @abstractmethod
    def page(self) -> HtmlPage:
        """Its page."""

    def write(self, stage: Path) -> None:
        """Write the files of `save` into a folder that is there: the page, and the JSON file where there is one."""
        if self.json_name:
            write_json(self.as_json(), stage / self.json_name)  # pyright: ignore[reportAttributeAccessIssue]
        self.page().save(stage / "report.html")

    @with_known_keywords
    def save(self, folder: AnyPath, *, force: bool = False) -> Path:
        """Write the files that the command of the same name leaves; returns the folder.

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
        with staged(Path(folder), force=force) as stage:
            self.write(stage)
        return Path(folder)


class LikeTable:
    """What can be read like its table: signals by name, and all that the table has."""

    table: xarray.Dataset

    def __getitem__(self, name: Hashable) -> xarray.DataArray:
        try:
            return self.table[name]
        except KeyError:
            remedy = it_has(str(name), map(str, self.table.variables))
            raise error_at(str(name), "It is no signal of this table.", remedy) from None

    def __contains__(self, name: object) -> bool:
        return name in self.table

    def __iter__(self) -> Iterator[Hashable]:
        return iter(self.table)

    def __len__(self) -> int:
        return len(self.table)

    def to_pandas(self) -> pandas.DataFrame:
        """The table as a DataFrame over time; columns have their units, as in result.csv: ``"vessel.x [m]"``."""
        units = {name: v.attrs.get("units") for name, v in self.table.data_vars.items()}
        named = {name: f"{name} [{unit}]" for name, unit in units.items() if unit}
        return self.table.to_dataframe().rename(columns=named)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "table":  # a copy asks before there is a table
            raise AttributeError(f"'{type(self).__name__}' has no attribute '{name}'")
        return getattr(self.table, name)


def finite(value: Any) -> Any:
    """Turn numbers that JSON does not have, infinity and NaN, into texts."""
    if isinstance(value, dict):
        return {name: finite(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(part) for part in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def parts_of(record: Any) -> dict[str, Any]:
    """Fields of a record by name, to make a result of it."""
    return {field.name: getattr(record, field.name) for field in fields(record)}
