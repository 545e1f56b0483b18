"""How commands end: their exit codes, and errors as one readable block on stderr instead of a traceback."""

import functools
from collections.abc import Callable, Iterable
from typing import Any

import typer

from shipcosim.cli.terminal import say
from shipcosim.errors import Problem, ShipcosimError

FAILED = 1
UNUSABLE = 2
INTERRUPTED = 130
EXIT_CODES = (
    "Exit codes: 0 done; 1 the work ran and what it checked does not hold; 2 unusable input or arguments; "
    "130 interrupted. --debug with any command shows the traceback of an error."
)


def guarded(function: Callable[..., Any]) -> Callable[..., Any]:
    """A command whose errors become a readable block on stderr and an exit code."""

    @functools.wraps(function)
    def wrapper(*args: Any, debug: bool = False, **kwargs: Any) -> Any:
        try:
            return function(*args, debug=debug, **kwargs)
        except typer.Exit:
            raise
        except ShipcosimError as error:
            explain(error.problems, debug)
            raise typer.Exit(UNUSABLE) from None
        except KeyboardInterrupt:
            say("Interrupted.", err=True)
            raise typer.Exit(INTERRUPTED) from None
        except OSError as error:
            # The disk or the rights, not shipcosim: a name that is too long, a folder that nobody may write.
            place = str(error.filename or "system")
            explain([Problem(place, f"{error.strerror or error}.")], debug)
            raise typer.Exit(UNUSABLE) from None
        except Exception as error:
            remedy = "This is a fault of shipcosim. Run the command again with --debug for the traceback."
            explain([Problem("shipcosim", f"{type(error).__name__}: {error}", remedy)], debug)
            raise typer.Exit(UNUSABLE) from None

    return wrapper


def explain(problems: Iterable[Problem], debug: bool = False) -> None:
    """Print problems on stderr, with the traceback of the error being handled where asked for."""
    from shipcosim.cli.console import print_problems

    print_problems(problems)
    if debug:
        import traceback

        traceback.print_exc()
