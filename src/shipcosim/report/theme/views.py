"""Records that all page templates fill in: texts and figures without any HTML."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

JsonObject = dict[str, Any]


PlotlyDict = dict[str, Any]
"""A trace of a figure, or a part of its layout, as plotly has it."""


class Fact(NamedTuple):
    """One fact below the title: name and text."""

    name: str
    text: str


def known_facts(texts: Mapping[str, str]) -> Sequence[Fact]:
    """Facts from texts by their names; those without a text are left out."""
    return [Fact(name, text) for name, text in texts.items() if text]


class KeyFigure(NamedTuple):
    """A key figure as text, and its meaning."""

    value: str
    meaning: str


@dataclass(frozen=True)
class Outcome:
    """Verdict of a run or a diagnosis: one word and one sentence; `kind` chooses the colour."""

    kind: str
    word: str
    sentence: str


@dataclass(frozen=True)
class Table:
    """A table of texts."""

    rows: Sequence[Sequence[str]]
    head: Sequence[str] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "rows", tuple(self.rows))


@dataclass(frozen=True)
class Block:
    """A table or some lines under a heading; `folded`: shown when it is asked for."""

    heading: str
    table: Table = Table(())
    lines: Sequence[str] = ()
    folded: bool = False

    def __bool__(self) -> bool:
        return bool(self.table.rows or self.lines)


@dataclass(frozen=True)
class Figure:
    """A plotly figure with its title, unit, and a sentence below.

    Attributes
    ----------
    title, unit, note : str
    traces : sequence of dict
        Traces of plotly. A text is plain text: `templates/figures.js` turns line breaks and special characters into
        what plotly wants. A colour is a name of `palette`. `named`: whether the name of the trace is shown at the
        pointer, yes by default.
    layout : dict
        Layout of plotly, as far as it is this figure's own.
    height : int, optional
        Height on the page, where it is not that of all figures. [px]
    """

    title: str
    unit: str
    traces: Sequence[PlotlyDict]
    layout: dict[str, Any] = field(default_factory=dict)
    note: str = ""
    height: int | None = None

    @property
    def drawn(self) -> dict[str, Any]:
        """The part that the script of the page draws."""
        return {"data": self.traces, "layout": self.layout}


Figures = Sequence[Figure]


@dataclass(frozen=True, kw_only=True)
class Page:
    """Contents of every page.

    Attributes
    ----------
    title : str
        Title in the browser and first heading.
    facts : sequence of Fact
        Below the title.
    outcome : Outcome
    data : mapping or tuple
        What the script of the page draws, as JSON.
    """

    title: str
    facts: Sequence[Fact]
    outcome: Outcome
    data: Mapping[str, Any] | Sequence[Any] = ()


@dataclass(frozen=True, kw_only=True)
class FigurePage(Page):
    """A page whose script draws its figures.

    Attributes
    ----------
    key_figures : sequence of KeyFigure
    figures : sequence of Figure
        All of the page, in the order of `data`.
    """

    key_figures: Sequence[KeyFigure] = ()
    figures: Figures = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "data", [figure.drawn for figure in self.figures])
