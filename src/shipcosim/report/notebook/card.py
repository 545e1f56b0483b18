"""The card of a result: what a notebook shows of it where it is the last value of a cell."""

from __future__ import annotations

import base64
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from shipcosim.report.notebook.figures import IN_CARD, can_draw
from shipcosim.report.theme.pages import render
from shipcosim.report.theme.views import Block, Page

COLOURS = {
    "passed": "#007a5a",
    "consistent": "#007a5a",
    "form": "#8a5a00",
    "named": "#0072b2",
    "plain": "#52606d",
    "replayed": "#0072b2",
}
WRONG = "#b34700"
HINT = "The picture needs matplotlib: pip install 'shipcosim[notebook]'."


@dataclass(frozen=True, kw_only=True)
class Card(Page):
    """What a card shows besides title, facts and outcome.

    Attributes
    ----------
    blocks : sequence of Block
        Those with something in them are shown.
    draw : function, optional
        Gives the picture beside the text as SVG; empty where there is nothing to draw.
    """

    blocks: Sequence[Block]
    draw: Callable[[], str] | None = None

    @cached_property
    def picture(self) -> str:
        """The picture as SVG; empty without one, and where matplotlib is missing."""
        if self.draw is None or not can_draw():
            return ""
        within = IN_CARD.set(True)
        try:
            return self.draw()
        finally:
            IN_CARD.reset(within)

    @property
    def hint(self) -> str:
        """What to install for the picture; empty where nothing is missing."""
        return "" if self.draw is None or can_draw() else HINT

    @property
    def colour(self) -> str:
        """Colour of the verdict, legible on white and on black."""
        return COLOURS.get(self.outcome.kind, WRONG)

    @property
    def picture_address(self) -> str:
        """The picture as an address, so that no front end takes it for scripted content."""
        return "data:image/svg+xml;base64," + base64.b64encode(self.picture.encode()).decode()


def card_html(card: Card) -> str:
    """A card as HTML: all texts escaped, styles inline, no scripts."""
    return render("notebook/templates/card.html.jinja", card)
