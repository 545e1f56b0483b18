"""The command `shipcosim list`."""

from typing import Annotated

import typer

from shipcosim.cli.options import Debug
from shipcosim.cli.start.completion import LISTED, words_of
from shipcosim.cli.terminal import say
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
    debug: Debug = False,
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
