"""The commands `shipcosim list` and `docs`: what there is, to run and to read."""

import re
import webbrowser
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
        message = "There is no such kind of thing."
        raise ShipcosimError([Problem(kind, message, suggestion(kind, LISTED)) for kind in unknown])
    say(listed(kinds or ()))


def docs(
    page: Annotated[
        str | None,
        typer.Argument(metavar="[PAGE]", help="Name of a page; without, the pages, a line each."),
    ] = None,
    terminal: Annotated[
        bool,
        typer.Option("--terminal", help="Show the page here, even where the site is built."),
    ] = False,
) -> None:
    """Open the documentation: in the browser if the site is built, else in the terminal.

    `make docs` builds the site, in a clone. It has no public address yet. What the site makes from the code, such as
    the list of commands, is not on the pages in the terminal.

    Example: shipcosim docs diagnosis
    """
    from shipcosim.cli.start.listing import pages, site_page, table_of_pages

    by_name = pages()
    if page is not None and page not in by_name:
        raise ShipcosimError([Problem(page, "There is no such page.", suggestion(page, by_name))])
    console = make_console()
    site = site_page(by_name[page] if page else None)
    # A pipe gets the text. So does a terminal on a machine without a browser.
    if site and console.is_terminal and not terminal and webbrowser.open(site.as_uri()):
        say(f"Page: {site}")
        return
    if page is None:
        say(table_of_pages(by_name))
        return
    # Marks for the site are no text.
    text = re.sub(r"<!--.*?-->\n*", "", by_name[page].read_text(encoding="utf-8"))
    if not console.is_terminal:
        say(text)
        return
    from rich.markdown import Markdown

    console.print(Markdown(text))
