"""The command, as `python -m shipcosim`."""

from shipcosim.cli import main

main()
