"""The command `shipcosim`. What it is scripted against is in docs and in `shipcosim COMMAND --help`.

Everything that takes time to import is imported inside the commands: help comes at once.
"""

import sys

from shipcosim.cli import export_fmu, export_osp  # noqa: F401  add their commands
from shipcosim.cli.app import app


def main() -> None:
    """Entry point of the command."""
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="replace")  # a console that knows no '≥' shows '?'
    app(prog_name="shipcosim")


__all__ = ["app", "main"]
