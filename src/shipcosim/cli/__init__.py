"""The command `shipcosim`. What it is scripted against is in docs and in `shipcosim COMMAND --help`.

`commands` holds one file a command, with its arguments and what it does in order. Everything that takes time to import
is imported inside the commands: help comes at once.
"""

import io
import sys

from shipcosim.cli.app import app
from shipcosim.cli.exit_guard import run_in_child


def main() -> None:
    """Entry point of the command."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a console that knows no '≥' shows '?'
    run_in_child(lambda: app(prog_name="shipcosim"))


__all__ = ["app", "main"]
