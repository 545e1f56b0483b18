"""The command `shipcosim`. What it is scripted against is in docs and in `shipcosim COMMAND --help`.

`commands` holds one file a command, with its arguments and what it does in order. Everything that takes time to import
is imported inside the commands: help comes at once.
"""

import io
import sys

from shipcosim.cli.app import app
from shipcosim.cli.exit_guard import guard_exit, release_exit


def main() -> None:
    """Entry point of the command."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a console that knows no '≥' shows '?'
    guard_exit()
    code = 1
    try:
        app(prog_name="shipcosim")
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
        raise
    finally:
        release_exit(code)


__all__ = ["app", "main"]
