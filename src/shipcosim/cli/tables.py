"""Tables on the terminal: words wrap, numbers stay whole, and columns that do not fit are named."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from itertools import zip_longest
from textwrap import TextWrapper
from typing import TYPE_CHECKING

from rich.cells import cell_len
from rich.text import Text

if TYPE_CHECKING:
    from rich.console import Console

GAP = 2  # spaces between columns
OF_WORDS = 24  # a column with a longer cell is one of words, which wrap
NARROWEST = 16  # width of a column of words, unless one of them is longer
PIPED = 160  # width where there is no terminal, which has one: programs want lines whole

Cell = str | Text


def print_table(console: Console, rows: Iterable[Sequence[Cell]], head: Sequence[str] = ()) -> None:
    """Print a table.

    Parameters
    ----------
    console : Console
        One that wraps nothing itself.
    rows : iterable of sequence of str or Text
        Its cells. A space that does not break keeps a number with its unit.
    head : sequence of str
        Headings; none if empty.
    """
    listed = [[cell if isinstance(cell, Text) else Text(cell) for cell in row] for row in rows]
    lines = [[Text(cell, style="bold") for cell in head], *listed] if head else listed
    if not lines:
        return
    columns = list(zip(*lines, strict=True))
    natural = [max(cell_len(cell.plain) for cell in column) for column in columns]
    # A column keeps its width, or that of its longest word where it holds words.
    least = []
    for column, width in zip(columns, natural, strict=True):
        words = [word for cell in column for word in cell.plain.split(" ")]
        least.append(width if width <= OF_WORDS else max(NARROWEST, *map(cell_len, words)))

    # Leave out columns at the end, but not the first two, until the words wrap into the rest.
    is_wide = console.is_terminal or "COLUMNS" in os.environ
    room = console.width if is_wide else PIPED
    shown = len(columns)
    while head and shown > 2 and _total(least[:shown]) > room:
        shown -= 1
    widths = _fitted(natural[:shown], least[:shown], room)
    for line in lines:
        _print_row(console, line[:shown], widths)
    if shown < len(columns):
        names = ", ".join(filter(None, head[shown:]))
        console.print(Text(f"In a wider terminal also: {names}.", style="dim"))


def _total(widths: Sequence[int]) -> int:
    return sum(widths) + GAP * (len(widths) - 1)


def _fitted(natural: Sequence[int], least: Sequence[int], room: int) -> list[int]:
    """Widths that fit, taken from the widest column that can give."""
    widths = list(natural)
    while _total(widths) > room:
        giving = [number for number, width in enumerate(widths) if width > least[number]]
        if not giving:
            break
        widths[max(giving, key=widths.__getitem__)] -= 1
    return widths


def _print_row(console: Console, cells: Sequence[Text], widths: Sequence[int]) -> None:
    """Print a row, on as many lines as its longest cell needs."""
    wrapped = [
        TextWrapper(max(width, 1), break_long_words=False, break_on_hyphens=False).wrap(cell.plain)
        for cell, width in zip(cells, widths, strict=True)
    ]
    for parts in zip_longest(*wrapped, fillvalue="") if any(wrapped) else [[""] * len(cells)]:
        line = Text()
        for part, cell, width in zip(parts, cells, widths, strict=True):
            line.append(part + " " * (width - cell_len(part) + GAP), style=cell.style)
        line.rstrip()
        console.print(line)
