"""The command `shipcosim`. What it is scripted against is in docs and in `shipcosim COMMAND --help`.

`commands` holds one file a command, with its arguments and what it does in order. Everything that takes time to import
is imported inside the commands: help comes at once.
"""

import atexit
import gc
import io
import re
import sys

from shipcosim.cli.app import app
from shipcosim.cli.exit_guard import run_in_child

NEW_OBJECTS = 300_000
"""So many objects are made between two searches for unused cycles. Python's 700 cost a tenth of a run's time."""


def main() -> None:
    """Entry point of the command."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a console that knows no '≥' shows '?'
    _refuse_unusable(sys.argv[1:])
    gc.set_threshold(NEW_OBJECTS)
    # The process gives all memory back at its end: a last search through all objects takes another tenth.
    atexit.register(gc.freeze)
    run_in_child(lambda: app(prog_name="shipcosim"))


def _refuse_unusable(arguments: list[str]) -> None:
    """Exit with 2 where an argument or an option's value is empty or no UTF-8.

    As a path an empty one would be the working folder. No page or table can hold a name that is no text.
    """
    for place, argument in enumerate(arguments, start=1):
        message = ""
        if re.fullmatch(r"(--[\w-]+=)?", argument):
            message = "is empty. Give it a value; is a variable of the shell not set?"
        elif any("\ud800" <= sign <= "\udfff" for sign in argument):
            message = "is no text in UTF-8. Rename the file."
        if message:
            sys.stderr.write(f"error: argument {place} of the command:\n{message}\n")
            sys.exit(2)


__all__ = ["app", "main"]
