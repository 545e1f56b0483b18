"""The card of a result: what a notebook shows of it where it is the last value of a cell."""

from __future__ import annotations

import base64
from dataclasses import dataclass

from shipcosim.report.theme.pages import render
from shipcosim.report.theme.views import Page, Table

COLOURS = {
    "passed": "#007a5a",
    "consistent": "#007a5a",
    "named": "#0072b2",
    "plain": "#52606d",
    "replayed": "#0072b2",
}
WRONG = "#b34700"


@dataclass(frozen=True)
class Block:
    """A table or some lines under a heading; `folded`: shown when it is asked for."""

    heading: str
    table: Table = Table(())
    lines: tuple[str, ...] = ()
    folded: bool = False

    def __bool__(self) -> bool:
        return bool(self.table.rows or self.lines)


@dataclass(frozen=True)
class Card(Page):
    """What a card shows besides title, facts and outcome.

    Attributes
    ----------
    blocks : tuple of Block
        Those with something in them are shown.
    picture : str
        SVG beside the text; none if empty.
    """

    blocks: tuple[Block, ...]
    picture: str = ""

    @property
    def colour(self) -> str:
        """Of the verdict, on white and on black alike."""
        return COLOURS.get(self.outcome.kind, WRONG)

    @property
    def picture_address(self) -> str:
        """The picture as an address, so that no front end takes it for scripted content."""
        return "data:image/svg+xml;base64," + base64.b64encode(self.picture.encode()).decode()


def card_html(card: Card) -> str:
    """A card as HTML: all texts escaped, styles inline, no scripts."""
    return render("notebook/templates/card.html.jinja", card)
