"""The commands `shipcosim list` and `docs`: what there is, to run and to read."""

import re
from typing import Annotated

import typer

from shipcosim.cli.start.completion import LISTED, words_of
from shipcosim.cli.terminal import make_console, say
from shipcosim.errors import Problem, ShipcosimError, suggestion


def list_(
    kinds: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[KIND]...",
            help=f"{', '.join(LISTED)}; all if none.",
            autocompletion=words_of(*LISTED),
        ),
    ] = None,
) -> None:
    """Show what has a name, a line each: of the project around, and of what came with shipcosim.

    Example: shipcosim list scenarios
    """
    from shipcosim.cli.start.listing import listed

    unknown = [kind for kind in kinds or () if kind not in LISTED]
    if unknown:
        found = "There is no such kind of thing."
        raise ShipcosimError([Problem(kind, found, suggestion(kind, LISTED)) for kind in unknown])
    say(listed(kinds or ()))


def docs(
    page: Annotated[
        str | None,
        typer.Argument(metavar="[PAGE]", help="Name of a page; without, the pages, a line each."),
    ] = None,
) -> None:
    """Read the documentation in the terminal.

    Example: shipcosim docs diagnosis
    """
    from shipcosim.cli.start.listing import pages, table_of_pages

    found = pages()
    if page is None:
        say(table_of_pages(found))
        return
    if page not in found:
        raise ShipcosimError([Problem(page, "There is no such page.", suggestion(page, found))])
    # Marks for the site are no text.
    text = re.sub(r"<!--.*?-->\n*", "", found[page].read_text(encoding="utf-8"))
    console = make_console()
    if not console.is_terminal:
        say(text)
        return
    from rich.markdown import Markdown

    console.print(Markdown(text))
